"""The command reproduce: its report and rows, what it keeps, and what becomes of a killed one."""

import json
import os
import re
import signal
import subprocess
import sysconfig
import time
from pathlib import Path

import pytest

from small_catalogue import small_catalogue
from undula.app.cli import main

SCRIPTS = Path(sysconfig.get_path("scripts"))
#: A process may have to compile the kernels first.
PATIENCE = 300.0
FIELDS = {"item", "claim", "value", "error", "verdict", "command", "published", "steps"}


def reproduce(capsys, folder: Path, *words: str) -> tuple[int, dict]:
    status = main(["reproduce", "--catalogue", str(folder / "catalogue"), *words, "--json"])
    return status, json.loads(capsys.readouterr().out)


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    small_catalogue(tmp_path / "catalogue")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.slow
def test_everything_is_computed_judged_and_told(folder, capsys) -> None:
    status, answer = reproduce(capsys, folder, "--workers", "1", "--vector")
    assert (status, answer["status"]) == (0, "done")
    told = json.loads((folder / "report" / "claims.json").read_text("utf-8"))["claims"]
    assert told == answer["claims"]
    assert [row["claim"] for row in told] == ["hopf", "spread", "many", "all-forces"]
    assert all(row.keys() >= FIELDS for row in told)
    assert told[0]["steps"] == [
        "undula stability --plot report/data/onset/onset/onset.svg --overwrite"
    ]
    page = (folder / "report" / "index.html").read_text("utf-8")
    assert page.count('<img src="data:image/') == 3
    assert 'src="movies/study-run.mp4"' in page
    assert (folder / "report" / "movies" / "study-run.mp4").stat().st_size > 1000
    # Nothing is fetched: the only addresses are names of the language of vector graphics.
    assert not re.search(r'(src|href)="(https?:)?//', page)
    assert {path.name for path in (folder / "report" / "figures").iterdir()} == {
        "onset-onset.svg",
        "study-diagram.pdf",
        "study-run.pdf",
    }


@pytest.mark.slow
def test_the_command_of_a_row_gives_its_value(folder, capsys) -> None:
    _, answer = reproduce(capsys, folder, "onset", "--workers", "1")
    again = reproduce(capsys, folder, "onset", "--workers", "1", "--fresh")[1]
    assert again["claims"] == answer["claims"]
    row = answer["claims"][0]
    assert main([*row["steps"][0].split()[1:], "--json"]) == 0
    # To the error that the row states: round-off depends on where the arrays lie in memory.
    value = json.loads(capsys.readouterr().out)["hopf_force"]
    assert abs(value - row["value"]) <= row["error"] < 1e-9


@pytest.mark.slow
def test_a_quick_report_leaves_out_what_needs_the_full_one(folder, capsys) -> None:
    _, answer = reproduce(capsys, folder, "onset", "--quick", "--workers", "1")
    judged, left_out = answer["claims"]
    assert (judged["claim"], judged["verdict"]) == ("hopf", "confirmed")
    assert "--quick" in judged["command"]
    assert (left_out["claim"], left_out["verdict"]) == ("spread", "not judged here")
    assert left_out["reason"] == "slow is not computed in the quick report"
    assert left_out["command"] == "undula reproduce onset"


def test_a_wrong_published_value_is_told_by_the_exit_status(tmp_path, capsys, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    small_catalogue(tmp_path / "catalogue", onset=("published = 37.7", "published = 38.7"))
    status, answer = reproduce(capsys, tmp_path, "onset", "--workers", "1")
    assert status == 1
    row = answer["claims"][0]
    assert (row["verdict"], row["expected"], row["as_expected"]) == (
        "corrected",
        "confirmed",
        False,
    )
    page = (tmp_path / "report" / "index.html").read_text("utf-8")
    assert "known to be confirmed" in page


@pytest.mark.slow
def test_what_is_kept_is_not_computed_again(folder, capsys) -> None:
    reproduce(capsys, folder, "onset", "--workers", "1")
    kept = folder / "report" / "data" / "onset" / "onset" / "answer.json"
    before = kept.stat().st_mtime_ns
    reproduce(capsys, folder, "onset", "--workers", "1")
    assert kept.stat().st_mtime_ns == before
    # Half of an answer, as a crash of the machine may leave it, counts as none.
    kept.write_bytes(kept.read_bytes()[:40])
    status, answer = reproduce(capsys, folder, "onset", "--workers", "1")
    assert (status, answer["claims"][0]["verdict"]) == (0, "confirmed")


def test_items_are_listed(folder, capsys) -> None:
    status, answer = reproduce(capsys, folder, "--list")
    assert status == 0
    assert [one["name"] for one in answer["items"]] == ["onset", "study"]


@pytest.mark.parametrize(
    ("words", "culprit"),
    [
        (("onsett",), "onset"),
        (("--out", "full"), "full"),
        (("--out", "catalogue/paper.toml"), "paper.toml"),
        (("--budget", "-1"), "--budget"),
        (("--catalogue", "nowhere"), "nowhere"),
    ],
)
def test_mistakes_are_told_in_one_sentence(folder, capsys, words, culprit) -> None:
    (folder / "full").mkdir()
    (folder / "full" / "thesis.tex").write_text("years of work", encoding="utf-8")
    status, answer = reproduce(capsys, folder, *words)
    assert (status, answer["status"]) == (2, "bad input")
    assert culprit in answer["error"]
    assert (folder / "full" / "thesis.tex").exists()


@pytest.mark.slow
def test_a_task_that_fails_is_told_and_the_others_are_done(tmp_path, capsys, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    wrong = ("--set load.profile=linear --set load.slope=0", "--set load.profile=linnear")
    small_catalogue(tmp_path / "catalogue", onset=wrong)
    status = main(["reproduce", "onset", "--catalogue", "catalogue", "--workers", "1", "--json"])
    said = capsys.readouterr()
    assert status == 3
    assert "linnear" in said.err
    rows = json.loads(said.out)["claims"]
    assert [(row["claim"], row["verdict"]) for row in rows] == [
        ("hopf", "confirmed"),
        ("spread", "not judged here"),
    ]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("ends_with", "status"), [(signal.SIGKILL, -signal.SIGKILL), (signal.SIGINT, 3)]
)
def test_what_was_killed_or_interrupted_goes_on(folder, ends_with, status) -> None:
    command = [SCRIPTS / "undula", "reproduce", "--catalogue", "catalogue", "--workers", "1"]
    # The first answer is that of the study, which uses all cores; the others are still to come.
    first = subprocess.Popen(command, start_new_session=True, stderr=subprocess.DEVNULL)
    end = time.monotonic() + PATIENCE
    while not list(folder.glob("report/data/*/*/answer.json")):
        assert time.monotonic() < end
        assert first.poll() is None
        time.sleep(0.02)
    # As Ctrl-C in a terminal does, to all processes of the command.
    os.killpg(first.pid, ends_with)
    assert first.wait(timeout=PATIENCE) == status
    kept = {path: path.stat().st_mtime_ns for path in folder.glob("report/data/*/*/answer.json")}
    assert len(kept) < 6
    done = subprocess.run([*command, "--json"], capture_output=True, timeout=PATIENCE, check=False)
    answer = json.loads(done.stdout)
    assert (done.returncode, answer["status"]) == (0, "done")
    assert {path: path.stat().st_mtime_ns for path in kept} == kept
    undisturbed = [*command, "--out", "other", "--json"]
    other = subprocess.run(undisturbed, capture_output=True, timeout=PATIENCE, check=True)
    values = [(row["claim"], row["value"]) for row in json.loads(other.stdout)["claims"]]
    assert [(row["claim"], row["value"]) for row in answer["claims"]] == values
