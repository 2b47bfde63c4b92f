"""The command line: its answers, its exit status, and what stays on disk whatever happens."""

import json
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from cases import mostly_slow
from commands import PATIENCE, UNDULA, Ask, answer, ended, in_process, refused, started
from undula.analysis.run_settings import Schedule
from undula.app.cli import main
from undula.storage.run_file import load_checkpoint, load_result
from undula.terminal.numbers import with_error
from undula.terminal.output import finite
from undula.terminal.run_progress import duration
from undula.views import movie

#: 21 samples, 0.001 T apart, of a run that takes a fraction of a second.
TINY = [
    *("--set", "model.segments=8", "--set", "time.until=0.02", "--set", "time.samples=21"),
    "--no-movie",
]
#: A run that would take minutes, and stores what it has as often as it can.
ENDLESS = [
    *("--set", "model.segments=4", "--set", "load.force=200"),
    *("--set", "time.until=1000", "--set", "time.samples=200001", "--no-movie"),
]
EAGER = """
import sys
from undula.app import cli
from undula.app.commands import run as running
running.SAVE_EVERY, running.SAVING_SHARE = 0.05, 1.0
sys.exit(cli.main())
"""
pytestmark = pytest.mark.usefixtures("own_folder")


@pytest.fixture(scope="module")
def tiny_result(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """Give the bytes of the result file of a tiny run, made once."""
    folder = tmp_path_factory.mktemp("tiny")
    assert main(["run", *TINY, "--out", str(folder)]) == 0
    return (folder / "run.nc").read_bytes()


@pytest.fixture
def stored(tiny_result: bytes) -> Path:
    """Give a fresh result file, with nothing beside it."""
    path = Path("run.nc")
    path.write_bytes(tiny_result)
    return path


def eager(*words: str) -> subprocess.Popen[str]:
    """Start a command that stores its result again and again."""
    return started(sys.executable, "-c", EAGER, *words, group=False)


def wait_for(path: Path, command: subprocess.Popen[str]) -> None:
    """Wait until a command has stored its result for the first time."""
    end = time.monotonic() + PATIENCE
    while not path.exists():
        assert command.poll() is None, command.communicate()[1]
        assert time.monotonic() < end, f"no {path}"
        time.sleep(0.005)


def status_of(path: Path) -> str:
    return json.loads(load_result(path).attrs["summary"])["status"]


def test_a_run_without_a_file_answers_with_one_object_and_nothing_else(ask: Ask) -> None:
    found = answer(ask("run", *TINY, "--json"))
    promised = {
        *("status", "verdict", "reason", "frequency", "bending_energy", "tip_radius", "tip_height"),
        *("power_balance_error", "length_error", "steps", "rejected", "seconds", "output"),
        *("load", "seed", "figure", "movie", "units", "force"),
    }
    assert promised <= found.keys()
    assert found["status"] == "done"
    assert found["load"] == "tip force 75"
    assert (found["force"], found["units"]["force"]) == (75.0, "B/L^2")
    assert found["seed"] == 1
    assert found["bending_energy"].keys() == {"min", "max", "mean"}
    assert found["output"] == "results/run/run.nc"
    assert found["figure"] == "results/run/run.png"
    assert found["movie"] is None
    assert Path(found["figure"]).read_bytes().startswith(b"\x89PNG")


def test_a_file_names_the_folder_of_its_results(ask: Ask) -> None:
    Path("mine.toml").write_text("[load]\nforce = 60.0\n[start]\nshape = 'helix'\n")
    found = answer(ask("run", "mine.toml", *TINY, "--json"))
    assert found["output"] == "results/mine/run.nc"
    assert found["load"] == "tip force 60"
    assert "seed" not in found


def test_people_get_a_short_aligned_summary(ask: Ask) -> None:
    status, said, _ = ask("run", *TINY)
    assert status == 0
    assert said.startswith("tip force 75: ")
    for words in (
        "B/L",
        "tip radius",
        "power balance",
        "results/run/run.nc",
        "results/run/run.png",
    ):
        assert words in said
    columns = {line[:18].rstrip().count("  ") for line in said.splitlines()[1:]}
    assert columns == {1}
    assert max(len(line) for line in said.splitlines()) < 160


def test_the_result_holds_the_input_and_no_trace_of_when_it_was_made(ask: Ask) -> None:
    answer(ask("run", *TINY, "--set", "start.seed=7", "--json"))
    attributes = load_result(Path("results/run/run.nc")).attrs
    stored = json.loads(attributes["input"])
    defaults = {key: getattr(Schedule(), key) for key in ("rtol", "atol")}
    assert stored["time"] == defaults | {"until": 0.02, "samples": 21}
    assert attributes["seed"] == stored["start"]["seed"] == 7
    assert {"input", "seed", "versions", "verdict", "health", "summary"} <= attributes.keys()
    assert "seconds" not in json.loads(attributes["summary"])


def test_the_same_run_twice_gives_identical_files(ask: Ask) -> None:
    for folder in ("first", "second"):
        assert ask("run", *TINY, "--out", folder)[0] == 0
    first, second = (Path(folder, "run.nc").read_bytes() for folder in ("first", "second"))
    assert first == second


BAD_RUNS = [
    ("load.forc=1", "did you mean load.force?"),
    ("load.force=strong", "load.force = 'strong' is text"),
    ("load.force=nan", "not a finite number"),
    ("load.force=inf", "not a finite number"),
    ("model.inextensibility=weak model.tensile_stiffness=-1", "a number above 0"),
    ("model.segments=3", "from 4 to 2000"),
    ("load.profile=linear load.slope=1.5", "from -1 to 1"),
    ("load.profile=point load.position=0", "above 0 and at most 1"),
    ("start.shape=state", "start.file"),
    ("start.shape=state start.file=gone.nc", "gone.nc"),
    ("force=75", "--set load.force=75"),
]


@pytest.mark.parametrize(("changes", "cure"), BAD_RUNS)
def test_bad_input_gets_one_sentence_with_the_cure_and_status_2(
    changes: str, cure: str, ask: Ask
) -> None:
    words = [word for change in changes.split() for word in ("--set", change)]
    status, said, told = ask("run", *words)
    assert (status, said) == (2, "")
    assert len(told.splitlines()) == 1
    assert cure in told
    assert not list(Path().rglob("*.nc"))


BAD_WORDS = {
    "--no-such-option": "No such option",
    "--budget=soon": "--budget",
    "--budget=0": "--budget 0.0 is out of range",
    "gone.toml": "there is no input file gone.toml",
}


@pytest.mark.parametrize("word", BAD_WORDS)
def test_a_wrong_word_gets_one_sentence_and_with_json_an_object_too(word: str, ask: Ask) -> None:
    asked = ask("run", word, "--json")
    found = answer(asked, status=2)
    assert found["status"] == "bad input"
    assert BAD_WORDS[word] in found["error"]
    assert asked[2] == f"undula: {found['error']}\n"
    assert not list(Path().iterdir())


def test_a_folder_that_cannot_be_written_is_refused_before_computing(
    ask: Ask, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("undula.app.commands.run_job.begin", lambda *_: pytest.fail("it was begun"))
    Path("file").touch()
    status, _, told = ask("run", *TINY, "--out", "file/folder")
    assert status == 2
    assert "choose a writable folder" in told


def test_an_existing_result_is_refused_before_computing_and_replaced_when_asked(
    ask: Ask, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert ask("run", *TINY)[0] == 0
    before = Path("results/run/run.nc").read_bytes()
    # A movie of the first run, of which only the mark matters here.
    mark = b"\xa9cmt\0\0\0\x16data\0\0\0\1\0\0\0\0undula"
    Path("results/run/run.mp4").write_bytes(mark)
    with monkeypatch.context() as patched:
        patched.setattr("undula.app.commands.run_job.begin", lambda *_: pytest.fail("it was begun"))
        status, _, told = ask("run", *TINY)
    assert status == 2
    assert "--overwrite" in told
    assert Path("results/run/run.nc").read_bytes() == before
    assert ask("run", *TINY, "--set", "load.force=80", "--overwrite")[0] == 0
    assert Path("results/run/run.nc").read_bytes() != before
    assert not Path("results/run/run.mp4").exists()


@pytest.mark.slow
def test_split_is_whole_to_round_off(ask: Ask) -> None:
    whole = ["--set", "time.until=0.04", "--set", "time.samples=41"]
    assert ask("run", *TINY, *whole, "--out", "whole")[0] == 0
    assert ask("run", *TINY, "--out", "split")[0] == 0
    found = answer(ask("resume", "split/run.nc", "--until", "0.04", "--no-movie", "--json"))
    assert found["output"] == "split/run.nc"
    one, two = (load_result(Path(name, "run.nc")) for name in ("whole", "split"))
    assert one.attrs["input"] == two.attrs["input"]
    for name in ("time", "nodes", "bending_energy", "rotation_angle", "work", "loss"):
        # Not even round-off: the checkpoint holds the whole memory of the integrator.
        np.testing.assert_array_equal(one[name], two[name], err_msg=name)


@pytest.mark.slow
def test_a_run_out_of_its_budget_is_kept_and_goes_on_to_its_end(ask: Ask) -> None:
    # A run is ended between two looks at it, some hundred steps apart; this one has thousands.
    words = [*TINY, "--set", "load.force=200", "--set", "time.until=0.05"]
    assert ask("run", *words, "--out", "whole")[0] == 0
    asked = ask("run", *words, "--budget", "1e-9", "--json")
    found = answer(asked, status=3)
    assert found["status"] == "out of time"
    assert "undula resume results/run/run.nc" in asked[2]
    assert answer(ask("resume", "results/run/run.nc", "--json", "--no-movie"))["status"] == "done"
    one, two = (load_result(Path(name, "run.nc")) for name in ("whole", "results/run"))
    np.testing.assert_array_equal(one["nodes"], two["nodes"])


REFUSED_RESUMES = {
    "nothing left": ([], "give --until T with a later time"),
    "too early": (["--until", "0.01"], "--until 0.01 is not beyond t = 0.02"),
    "no time": (["--until", "nan"], "not a finite number"),
}


@pytest.mark.parametrize("case", REFUSED_RESUMES)
def test_a_resume_that_leads_nowhere_is_refused(case: str, ask: Ask, stored: Path) -> None:
    words, cure = REFUSED_RESUMES[case]
    before = stored.read_bytes()
    status, said, told = ask("resume", str(stored), *words)
    assert (status, said) == (2, "")
    assert cure in told
    assert stored.read_bytes() == before


@pytest.mark.parametrize("command", ["plot", "movie", "resume"])
@pytest.mark.parametrize("content", ["cut", "foreign", "none"])
def test_a_broken_or_foreign_file_is_refused_in_one_sentence(
    command: str, content: str, ask: Ask, tiny_result: bytes
) -> None:
    if content == "cut":
        Path("it.nc").write_bytes(tiny_result[:3000])
    elif content == "foreign":
        Path("it.nc").write_text("time,energy\n")
    asked = ask(command, "it.nc", "--json")
    assert "it.nc" in answer(asked, status=2)["error"]
    assert len(asked[2].splitlines()) == 1


@pytest.mark.slow
def test_figures_and_movies_are_made_from_the_stored_file_alone(
    ask: Ask, stored: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("undula.app.commands.drawing.movie", partial(movie, frames=4))
    assert answer(ask("plot", str(stored), "--json"))["figure"] == "run.png"
    assert answer(ask("movie", str(stored), "--json"))["movie"] == "run.mp4"
    assert ask("plot", str(stored), "--out", "made/a.pdf")[:2] == (0, "made/a.pdf\n")
    assert Path("run.png").read_bytes().startswith(b"\x89PNG")
    assert Path("made/a.pdf").read_bytes().startswith(b"%PDF")
    assert Path("run.mp4").read_bytes()[4:8] == b"ftyp"


def test_an_asked_figure_replaces_nothing_unless_told_to(ask: Ask, stored: Path) -> None:
    Path("mine.svg").write_text("mine")
    words = ["plot", str(stored), "--out", "mine.svg"]
    status, _, told = ask(*words)
    assert status == 2
    assert "--overwrite" in told
    assert Path("mine.svg").read_text() == "mine"
    assert ask(*words, "--overwrite")[0] == 0
    assert "<svg" in Path("mine.svg").read_text()


@pytest.mark.parametrize(("command", "name"), [("plot", "a.gif"), ("movie", "a.avi")])
def test_an_unknown_kind_of_figure_or_movie_is_refused(command: str, name: str, ask: Ask) -> None:
    status, _, told = ask(command, "any.nc", "--out", name)
    assert status == 2
    assert f"--out {name} does not end like a {'figure' if command == 'plot' else 'movie'}" in told


def test_a_movie_that_fails_leaves_the_result_and_says_so(
    ask: Ask, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object, **__: object) -> None:
        raise OSError("the video encoder failed: no space")

    monkeypatch.setattr("undula.app.commands.drawing.movie", fail)
    asked = ask("run", *TINY[:-1], "--json")
    found = answer(asked, status=3)
    assert found["movie"] is None
    assert found["figure"] == "results/run/run.png"
    assert "the video encoder failed: no space" in asked[2]
    assert load_result(Path(found["output"])).sizes["time"] == 21


def test_ctrl_c_leaves_a_result_that_can_be_resumed(ask: Ask) -> None:
    with eager("run", *ENDLESS, "--json") as command:
        wait_for(Path("results/run/run.nc"), command)
        command.send_signal(signal.SIGINT)
        asked = ended(command)
    found = answer(asked, status=3)
    assert found["status"] == "interrupted"
    assert "undula resume results/run/run.nc" in asked.told
    more = answer(ask("resume", found["output"], "--budget", "0.2", "--json"), status=3)
    assert more["time"] > found["time"]


@pytest.mark.parametrize("moment", mostly_slow([0.01, 0.15], lambda moment: moment < 0.1))
def test_kill_leaves_a_whole_file_at_any_moment(moment: float, ask: Ask) -> None:
    with eager("run", *ENDLESS) as command:
        wait_for(Path("results/run/run.nc"), command)
        time.sleep(moment)
        command.kill()
        command.communicate(timeout=PATIENCE)
    path = Path("results/run/run.nc")
    assert status_of(path) == "running"
    assert load_checkpoint(path)["states"].shape[0] == load_result(path).sizes["time"]
    assert ask("resume", str(path), "--budget", "0.01", "--no-movie")[0] == 3


def test_the_units_are_those_of_the_published_table_both_ways(ask: Ask) -> None:
    # Ling, Guo & Kanso (2018), Table 1 and the forces given with it, to the digits printed.
    found = answer(ask("units", "--force", "188", "--force-pn", "75.4", "--json"))
    assert found["units"]["time"] == {"physical": pytest.approx(0.546, abs=5e-4), "unit": "s"}
    assert found["units"]["force"] == {"physical": pytest.approx(2.0), "unit": "pN"}
    assert found["units"]["force_density"]["physical"] == pytest.approx(0.1)
    there, back = found["converted"]
    assert there["physical"] == pytest.approx(376.0)
    assert back["dimensionless"] == pytest.approx(37.7)


def test_other_filaments_have_other_units(ask: Ask) -> None:
    words = ["units", "--length", "10", "--stiffness", "400", "--viscosity", "2"]
    found = answer(ask(*words, "--time", "1", "--frequency-hz", "1", "--json"))
    period = found["units"]["time"]["physical"]
    # T goes as viscosity L^4 / B.
    assert period == pytest.approx(0.5457505 * 2 / 16 * 2)
    assert found["converted"][0]["physical"] == period
    assert found["converted"][1]["dimensionless"] == pytest.approx(period)
    assert "length" in ask("units", "--length", "-1")[2]


def test_people_read_the_units_line_by_line(ask: Ask) -> None:
    status, said, _ = ask("units", "--force", "75")
    assert status == 0
    assert "75 B/L^2        = 150 pN" in said


def test_help_and_version_load_nothing_heavy() -> None:
    heavy = ("numba", "numpy", "scipy", "xarray", "matplotlib", "h5py")
    code = (
        "import sys; from undula.app.cli import main;"
        " status = main(['--help']) or main(['--version']) or main(['run', '--help']);"
        f" sys.exit(status or ','.join(sorted(set(sys.modules) & set({heavy}))) or 0)"
    )
    done = in_process(sys.executable, "-c", code)
    assert (done.status, done.told) == (0, "")


def test_the_installed_command_passes_its_status_on() -> None:
    asked = in_process(UNDULA, "run", "--set", "load.forc=1")
    assert refused(asked) == "load.forc is not a known key; did you mean load.force?"


def test_a_fault_of_the_program_keeps_its_traceback(monkeypatch: pytest.MonkeyPatch) -> None:
    def fault(*_: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr("undula.inputs.input.read_input", fault)
    with pytest.raises(ZeroDivisionError):
        main(["run"])


def test_numbers_that_json_lacks_become_null() -> None:
    asked = {"a": float("nan"), "b": [1.0, float("inf")], "c": {"d": "nan"}}
    assert finite(asked) == {"a": None, "b": [1.0, None], "c": {"d": "nan"}}


@pytest.mark.parametrize(
    ("value", "error", "said"),
    [
        (20.98766, 1.2e-4, "20.9877 ± 0.0001"),
        (-38.3, 15.9, "-38 ± 16"),
        (3.0, None, "3"),
        (3.0, 0.0, "3"),
    ],
)
def test_a_number_is_told_to_the_digits_that_its_error_leaves(
    value: float, error: float | None, said: str
) -> None:
    assert with_error(value, error) == said


def test_a_duration_has_the_unit_that_suits_it() -> None:
    said = [duration(seconds) for seconds in (2.0, 600.0, 36000.0, 8.64e5)]
    assert said == ["2 s", "10 min", "10 h", "10 days"]
