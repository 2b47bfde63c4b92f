"""Signals that ask a program to end: what was computed is kept, one sentence, status 3."""

import os
import re
import signal
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import undula as un
from commands import Ask, answer, ended, in_process, started
from undula.interrupts import END_SIGNALS, end_signals_raise, interruptible
from undula.storage.ramp_file import load_ramp
from undula.storage.run_file import load_result
from undula.terminal.output import INTERRUPTED

#: The command, which tells its progress at once and all the time.
TALKING = """
import sys
from undula.app import cli
from undula.terminal import meter
meter.SECONDS_BETWEEN_LINES = 0.0
sys.exit(cli.main())
"""
each_signal = pytest.mark.parametrize("ending", END_SIGNALS, ids=lambda one: one.name)


@pytest.fixture(autouse=True)
def _handlers_stay_as_they_are() -> Iterator[None]:
    before = {one: signal.getsignal(one) for one in END_SIGNALS}
    yield
    assert {one: signal.getsignal(one) for one in END_SIGNALS} == before


def sends(ending: signal.Signals, times: int = 1) -> Any:
    """Return what sends a signal to this process when it is first called."""
    sent: list[object] = []

    def send(*what: object) -> None:
        if not sent:
            for _ in range(times):
                signal.raise_signal(ending)
        sent.append(what)

    return send


@each_signal
def test_every_signal_ends_a_run_with_what_it_has(ending: signal.Signals) -> None:
    model = un.Filament(4, un.TipLoad(50.0))
    with end_signals_raise():
        run = un.integrate(model, un.kicked(model), until=50.0, progress=sends(ending))
    assert run.ending.value == "interrupted"


@each_signal
def test_a_signal_that_is_sent_twice_at_once_is_one_request(ending: signal.Signals) -> None:
    with end_signals_raise(), interruptible() as interrupted:
        sends(ending, times=2)()
        assert interrupted()


@each_signal
def test_a_later_signal_ends_at_once(
    ending: signal.Signals, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("undula.interrupts._SAME_REQUEST", 0.0)

    def twice() -> None:
        with end_signals_raise(), interruptible():
            sends(ending, times=2)()

    with pytest.raises(KeyboardInterrupt):
        twice()


def test_a_block_within_another_knows_and_tells_what_was_noted() -> None:
    with end_signals_raise(), interruptible() as outer:
        with interruptible() as inner:
            signal.raise_signal(signal.SIGTERM)
            assert inner()
            assert not outer()
        assert outer()
        with interruptible() as later:
            assert later()


def test_what_was_to_be_ignored_stays_ignored() -> None:
    # As nohup has it.
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with end_signals_raise(), interruptible() as interrupted:
            signal.raise_signal(signal.SIGHUP)
            assert not interrupted()
    finally:
        signal.signal(signal.SIGHUP, before)


def test_a_program_that_uses_the_package_keeps_its_own_ways() -> None:
    heard: list[int] = []
    before = signal.signal(signal.SIGTERM, lambda number, _: heard.append(number))
    try:
        with end_signals_raise(), interruptible() as interrupted:
            signal.raise_signal(signal.SIGTERM)
            assert heard == [signal.SIGTERM]
            assert not interrupted()
    finally:
        signal.signal(signal.SIGTERM, before)


# ---------------------------------------------------------------- commands, in this process


FEW = ["--set", "model.segments=4", "--set", "time.until=0.01", "--set", "time.samples=20"]


@each_signal
def test_a_series_of_steps_keeps_its_steps(
    ending: signal.Signals,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    ask: Ask,
) -> None:
    # In the moment in which the first step is stored.
    monkeypatch.setattr("undula.app.commands.step._Saver.__call__", sends(ending, times=2))
    words = ["step", *FEW, "--along", "load.force=10:30:3", "--out", str(tmp_path), "--json"]
    asked = ask(*words)
    found = answer(asked, status=3)
    assert found["status"] == "interrupted"
    assert "interrupted after 1 of 3 steps; the same command goes on" in asked.told
    assert load_ramp(tmp_path / "steps.nc").sizes["step"] == 1


@each_signal
def test_a_branch_is_told_as_far_as_it_was_followed(
    ending: signal.Signals, monkeypatch: pytest.MonkeyPatch, ask: Ask
) -> None:
    send = sends(ending)
    monkeypatch.setattr("undula.analysis.states.follow_branch.unstable", lambda _: send() or 0)
    words = ["follow", "spinning", "--set", "model.segments=4", "--along", "load.force=60:200"]
    asked = ask(*words, "--json")
    found = answer(asked, status=3)
    assert found["status"] == "interrupted"
    assert 2 <= len(found["points"]) <= 3
    assert asked.told.endswith(
        "undula: interrupted; what was found until then is told, the same command begins anew\n"
    )


def test_a_curve_of_thresholds_is_told_as_far_as_it_is_known(
    monkeypatch: pytest.MonkeyPatch, ask: Ask, tmp_path: Path
) -> None:
    monkeypatch.setattr("undula.analysis.solvers.thresholds.onset", _and_send(signal.SIGTERM))
    words = ["threshold", "onset", "--along", "model.drag_ratio=1:2:5", "--json"]
    asked = ask(*words, "--plot", str(tmp_path / "curve.png"))
    found = answer(asked, status=3)
    assert found["status"] == "interrupted"
    assert [one["model.drag_ratio"] for one in found["thresholds"]] == [1.0]
    assert "what was found until then is told" in asked.told
    assert (tmp_path / "curve.png").exists()


def _and_send(ending: signal.Signals) -> Any:
    from undula.analysis.linear.stability import onset

    def found(*given: Any, **options: Any) -> Any:
        signal.raise_signal(ending)
        return onset(*given, **options)

    return found


def test_exponents_that_are_stopped_leave_the_run_and_say_so(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    ask: Ask,
) -> None:
    monkeypatch.setattr("undula.analysis.regimes.lyapunov._directions", lambda *_: send() or 1)
    send = sends(signal.SIGTERM)
    asked = ask(*_spinning(tmp_path, "--lyapunov"))
    found = answer(asked, status=3)
    assert found["status"] == "done"
    assert found["lyapunov"] is None
    assert found["without_lyapunov"] == "they were interrupted"
    assert "no Lyapunov exponents: they were interrupted; the run without them is in" in asked.told
    assert load_result(tmp_path / "run.nc").attrs["summary"]


@pytest.mark.slow
def test_exponents_heed_the_budget_and_show_how_far_they_are(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, ask: Ask
) -> None:
    monkeypatch.setattr("undula.terminal.meter.SECONDS_BETWEEN_LINES", 0.0)
    # What takes no time without this takes longer than the budget at the third block.
    blocks = iter(range(400))
    monkeypatch.setattr(
        "undula.analysis.regimes.lyapunov._directions", lambda *_: _slow(next(blocks))
    )
    asked = ask(*_spinning(tmp_path, "--lyapunov", "--budget", "4"))
    found = answer(asked, status=3)
    assert found["without_lyapunov"] == "they were out of their budget of time"
    assert "Lyapunov exponents, 1% done" in asked.told
    assert found["seconds"] < 8.0


def _slow(block: int) -> int:
    time.sleep(4.0 if block == 3 else 0.0)
    return 1


def _spinning(out: Path, *more: str) -> list[str]:
    keys = ("model.segments=4", "load.force=60", "time.until=0.5", "time.samples=200")
    changes = [word for key in keys for word in ("--set", key)]
    return ["run", *changes, "--no-movie", "--out", str(out), "--json", *more]


def test_a_command_without_a_result_says_that_it_was_interrupted(
    monkeypatch: pytest.MonkeyPatch, ask: Ask
) -> None:
    def find(*_: object, **__: object) -> None:
        signal.raise_signal(signal.SIGTERM)

    monkeypatch.setattr("undula.app.commands.find.find_state", find)
    asked = ask("find", "spinning", "--set", "model.segments=4")
    told = "undula: interrupted before there was a result; nothing has been kept\n"
    assert asked == (130, "", told)


# ---------------------------------------------------------------- real processes


@pytest.mark.parametrize(
    "ending", [signal.SIGTERM, pytest.param(signal.SIGHUP, marks=pytest.mark.slow)]
)
def test_a_running_command_keeps_its_result(ending: signal.Signals, tmp_path: Path) -> None:
    keys = ("model.segments=4", "load.force=200", "time.until=1000", "time.samples=200001")
    words = [word for key in keys for word in ("--set", key)]
    run = ["run", *words, "--no-movie", "--out", tmp_path, "--json"]
    command = started(sys.executable, "-c", TALKING, *run)
    assert command.stderr is not None
    while not re.search(r"t = 0\.[1-9]", command.stderr.readline()):
        assert command.poll() is None
    # As time limits do it: to the process, and once more to its group.
    command.send_signal(ending)
    os.killpg(command.pid, ending)
    asked = ended(command)
    found = answer(asked, status=3)
    assert found["status"] == "interrupted"
    assert "Traceback" not in asked.told
    assert f"go on with: undula resume {tmp_path / 'run.nc'}" in asked.told
    assert float(load_result(tmp_path / "run.nc")["time"][-1]) == found["time"] > 0.0


def test_ctrl_c_while_the_program_is_imported_ends_it_quietly() -> None:
    program = (
        "import sys\n"
        "class Pressed:\n"
        "    def find_spec(self, name, *_):\n"
        "        if name == 'typer':\n"
        "            raise KeyboardInterrupt\n"
        "sys.meta_path.insert(0, Pressed())\n"
        "from undula.app.start import main\n"
        "sys.exit(main())\n"
    )
    assert in_process(sys.executable, "-c", program) == (INTERRUPTED, "", "")
