"""Nothing of anybody's is lost to what commands write: names are claimed, marks looked at."""

import errno
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from functools import partial
from pathlib import Path

import pytest
from matplotlib.figure import Figure

from commands import PATIENCE, Ask, answer, refused, started
from refusal import complaint
from small_catalogue import small_catalogue
from small_sweeps import AXES, QUICK, sweep_of
from undula.app.cli import main
from undula.reproduction.tasks.folder import MARK, locked_report
from undula.storage.atomic import write_whole
from undula.storage.marks import carries_mark
from undula.storage.outputs import claimed
from undula.sweeps.store import open_sweep
from undula.views import movie
from undula.views.common.figure_file import figure_bytes

TINY = ["--set", "model.segments=8", "--set", "time.until=0.02", "--set", "time.samples=21"]
#: A run that would take minutes, and stores what it has as often as it can.
ENDLESS = [
    *("run", "--set", "model.segments=4", "--set", "load.force=200", "--set", "time.until=1000"),
    *("--set", "time.samples=200001", "--no-movie"),
]
EAGER = """
import sys
from undula.app import cli
from undula.app.commands import run as running
running.SAVE_EVERY, running.SAVING_SHARE = 0.05, 1.0
sys.exit(cli.main())
"""
HOLDER = """
import sys, time
from pathlib import Path
from undula.storage.outputs import claimed
with claimed(*map(Path, sys.argv[1:])):
    print("held", flush=True)
    time.sleep(600)
"""
MINE = b"years of work"


pytestmark = pytest.mark.usefixtures("own_folder")


@pytest.fixture(autouse=True, scope="module")
def _short_movies() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("undula.app.commands.drawing.movie", partial(movie, frames=4))
        yield


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Give a folder with result, figure and movie of a tiny run, not to be changed."""
    folder = tmp_path_factory.mktemp("made")
    assert main(["run", *TINY, "--out", str(folder)]) == 0
    return folder


@pytest.fixture
def result(made: Path) -> Path:
    """Give a fresh result file, with nothing beside it."""
    Path("run.nc").write_bytes((made / "run.nc").read_bytes())
    return Path("run.nc")


def files_of(folder: Path = Path()) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


# ---------------------------------------------------------------- the claim


@pytest.mark.parametrize("also", ["run.nc", "run.png"])
def test_a_claim_is_held_until_its_process_ends_however_that_ends(also: str) -> None:
    holder = subprocess.Popen(
        [sys.executable, "-c", HOLDER, "run.nc", "run.png"], stdout=subprocess.PIPE, text=True
    )
    with holder:
        assert holder.stdout is not None
        assert holder.stdout.readline() == "held\n"
        sentence = complaint(lambda: ExitStack().enter_context(claimed(Path(also))))
        assert sentence.startswith(f"another undula is at work on {also}; wait for it")
        holder.send_signal(signal.SIGKILL)
    with claimed(Path("run.nc"), Path("run.png")):
        pass
    assert list(Path().iterdir()) == []


def test_where_there_are_no_locks_names_are_claimed_without(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def flock(*_: object) -> None:
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    monkeypatch.setattr("fcntl.flock", flock)
    with claimed(Path("run.nc")) as claim:
        claim.write(Path("run.nc"), b"new")
    assert files_of() == {"run.nc": b"new"}


def test_claims_on_other_names_of_the_folder_do_not_meet() -> None:
    with claimed(Path("a.png")), claimed(Path("b.png")):
        pass
    assert list(Path().iterdir()) == []


@pytest.mark.parametrize("target", ["mine", "nowhere"])
def test_a_link_in_place_of_a_lock_is_not_followed(target: str) -> None:
    Path("mine").write_bytes(MINE)
    Path(".run.nc.lock").symlink_to(target)
    assert "is a link" in complaint(lambda: ExitStack().enter_context(claimed(Path("run.nc"))))
    assert files_of()["mine"] == MINE
    assert not Path("nowhere").exists()


def test_a_file_of_others_serves_as_a_lock_and_stays_as_it_is() -> None:
    Path(".run.nc.lock").write_bytes(MINE)
    with claimed(Path("run.nc")):
        assert "at work" in complaint(lambda: ExitStack().enter_context(claimed(Path("run.nc"))))
    assert files_of() == {".run.nc.lock": MINE}


def test_a_link_in_place_of_the_lock_of_a_store_is_not_followed() -> None:
    store = open_sweep(Path("s.zarr"), sweep_of(Path(), QUICK + AXES))
    Path("mine").write_bytes(MINE)
    Path("s.zarr/.lock").symlink_to(Path("mine").absolute())
    assert "is a link" in complaint(lambda: ExitStack().enter_context(store.alone()))
    assert Path("mine").read_bytes() == MINE
    Path("s.zarr/.lock").unlink()
    before = set(Path("s.zarr").iterdir())
    with store.alone():
        assert "at work on s.zarr" in complaint(
            lambda: ExitStack().enter_context(open_sweep(store.path, store.sweep).alone())
        )
    assert set(Path("s.zarr").iterdir()) == before


def put_ours(path: Path) -> None:
    path.write_bytes(figure_bytes(Figure(), path.suffix))


def put_foreign(path: Path) -> None:
    Figure().savefig(path)


def put_link(path: Path) -> None:
    put_ours(Path("theirs.png"))
    path.symlink_to("theirs.png")


def put_loose_link(path: Path) -> None:
    path.symlink_to("nowhere.png")


#: What is in the place of an output, and what the claim says if it is new, renewed, or overwritten.
PLACES = [
    (put_ours, "exists already", None, None),
    (put_foreign, "exists already", "does not carry the mark", None),
    (put_link, "exists already", "is a link", None),
    (put_loose_link, "exists already", "is a link", None),
    (Path.mkdir, "is a folder", "is a folder", "is a folder"),
    (os.mkfifo, "is no plain file", "is no plain file", "is no plain file"),
]


@pytest.mark.parametrize(("put", "new", "renewed", "overwritten"), PLACES)
def test_what_is_in_the_place_of_an_output_is_replaced_only_if_it_may_be(
    put: Callable[[Path], None], new: str | None, renewed: str | None, overwritten: str | None
) -> None:
    path = Path("figure.png")
    put(path)
    ways = [(new, {}), (renewed, {"renewed": [path]}), (overwritten, {"overwrite": True})]
    for why, options in ways:
        before = os.lstat(path)
        with ExitStack() as held:
            if why is not None:
                sentence = complaint(lambda o=options: held.enter_context(claimed(path, **o)))
                assert sentence.startswith(f"{path} {why}")
                assert os.path.samestat(os.lstat(path), before)
            else:
                held.enter_context(claimed(path, **options)).write(path, b"new")
                assert path.read_bytes() == b"new"
                put_ours(path)
    if Path("theirs.png").exists():
        assert carries_mark(Path("theirs.png"))
    assert not Path("nowhere.png").exists()


def test_what_comes_between_claim_and_writing_is_not_replaced_either() -> None:
    path = Path("figure.png")
    with claimed(path, renewed=[path]) as claim:
        path.write_bytes(MINE)
        assert "does not carry the mark" in complaint(lambda: claim.write(path, b"new"))
    assert path.read_bytes() == MINE


def test_a_link_is_replaced_itself_and_never_written_through() -> None:
    Path("mine").write_bytes(MINE)
    Path("run.nc").symlink_to("mine")
    write_whole(Path("run.nc"), b"new", overwrite=True)
    assert files_of() == {"mine": MINE, "run.nc": b"new"}
    assert not Path("run.nc").is_symlink()


@pytest.mark.parametrize("join", [os.link, os.symlink, None])
def test_what_a_command_reads_is_never_its_output(join: Callable[..., None] | None) -> None:
    Path("in.nc").write_bytes(MINE)
    if join is not None:
        join("in.nc", "out.nc")
    out = Path("in.nc" if join is None else "out.nc")
    for overwrite in (False, True):
        made = claimed(out, overwrite=overwrite, reads=[Path("in.nc")])
        assert "reads" in complaint(lambda held=made: ExitStack().enter_context(held))
    assert Path("in.nc").read_bytes() == MINE


def test_our_files_carry_the_mark_and_those_of_others_do_not(made: Path) -> None:
    for ending in (".png", ".pdf", ".svg"):
        put_ours(Path(f"ours{ending}"))
        put_foreign(Path(f"theirs{ending}"))
        assert carries_mark(Path(f"ours{ending}")), ending
        assert not carries_mark(Path(f"theirs{ending}")), ending
    for name in ("run.nc", "run.png", "run.mp4"):
        assert carries_mark(made / name), name
        Path(name).symlink_to(made / name)
        assert not carries_mark(Path(name)), f"link to {name}"
    assert not carries_mark(Path("gone.png"))


def test_figures_hold_no_trace_of_when_they_were_made(monkeypatch: pytest.MonkeyPatch) -> None:
    def bytes_at(second: int, ending: str) -> bytes:
        monkeypatch.setenv("SOURCE_DATE_EPOCH", str(second))
        figure = Figure()
        figure.add_subplot().plot([0, 1])
        return figure_bytes(figure, ending)

    for ending in (".png", ".pdf", ".svg"):
        assert bytes_at(1, ending) == bytes_at(10**9, ending), ending


# ---------------------------------------------------------------- run, resume, plot, movie, step


@pytest.mark.parametrize("words", [["plot"], ["resume", "--until", "1"]])
def test_a_result_that_is_called_like_a_figure_is_not_replaced_by_one(
    words: list[str], result: Path, ask: Ask
) -> None:
    os.rename(result, "kept.png")
    before = files_of()
    for further in ([], ["--overwrite"]):
        assert "reads" in refused(ask(words[0], "kept.png", *words[1:], *further))
    os.link("kept.png", "other.nc")
    assert "reads" in refused(ask("plot", "other.nc", "--out", "kept.png", "--overwrite"))
    assert files_of() == before | {"other.nc": before["kept.png"]}


@pytest.mark.parametrize("name", ["run.png", "run.mp4"])
def test_a_view_of_others_is_told_before_a_run_begins(
    name: str, ask: Ask, monkeypatch: pytest.MonkeyPatch
) -> None:
    Path(name).write_bytes(MINE)
    monkeypatch.setattr("undula.app.commands.run_job.begin", lambda *_: pytest.fail("it was begun"))
    assert f"{name} does not carry the mark" in refused(ask("run", *TINY, "--out", "."))
    assert files_of() == {name: MINE}


@pytest.mark.slow
def test_a_run_leaves_the_movie_of_others_and_removes_our_older_one(made: Path) -> None:
    Path("run.mp4").write_bytes(MINE)
    assert main(["run", *TINY, "--no-movie", "--out", "."]) == 0
    assert main(["run", *TINY, "--no-movie", "--overwrite", "--out", "."]) == 0
    assert Path("run.mp4").read_bytes() == MINE
    Path("run.mp4").write_bytes((made / "run.mp4").read_bytes())
    assert main(["run", *TINY, "--no-movie", "--overwrite", "--out", "."]) == 0
    assert files_of().keys() == {"run.nc", "run.png"}


def test_asked_to_a_run_replaces_the_figure_of_others() -> None:
    Path("run.png").write_bytes(MINE)
    assert main(["run", *TINY, "--no-movie", "--overwrite", "--out", "."]) == 0
    assert carries_mark(Path("run.png"))


def test_a_start_is_not_replaced_by_the_run_that_begins_from_it(result: Path, ask: Ask) -> None:
    before = result.read_bytes()
    start = ["--set", "start.shape=state", "--set", "start.file=./run.nc"]
    assert "reads" in refused(ask("run", *TINY, *start, "--out", ".", "--overwrite"))
    assert result.read_bytes() == before


@pytest.mark.slow
def test_a_figure_of_others_is_told_before_a_run_is_taken_up(result: Path, ask: Ask) -> None:
    before = result.read_bytes()
    Path("run.png").write_bytes(MINE)
    words = ["resume", "run.nc", "--until", "0.021", "--no-movie"]
    assert "run.png does not carry the mark" in refused(ask(*words))
    assert files_of() == {"run.nc": before, "run.png": MINE}
    assert main([*words, "--overwrite"]) == 0
    assert carries_mark(Path("run.png"))
    assert result.read_bytes() != before
    assert main(["resume", "run.nc", "--until", "0.022", "--no-movie"]) == 0


@pytest.mark.parametrize(("command", "name"), [("plot", "run.png"), ("movie", "run.mp4")])
def test_views_beside_a_result_are_renewed_if_they_are_ours(
    command: str, name: str, made: Path, result: Path, ask: Ask
) -> None:
    Path(name).write_bytes(MINE)
    assert f"{name} does not carry the mark" in refused(ask(command, result))
    assert Path(name).read_bytes() == MINE
    Path(name).write_bytes((made / name).read_bytes()[:-1])
    assert main([command, str(result)]) == 0
    assert Path(name).read_bytes() == (made / name).read_bytes()


def test_the_figure_of_a_study_is_renewed_if_it_is_ours(ask: Ask) -> None:
    open_sweep(Path("s.zarr"), sweep_of(Path(), QUICK + AXES))
    Path("s.png").write_bytes(MINE)
    assert "s.png does not carry the mark" in refused(ask("plot", "s.zarr"))
    assert Path("s.png").read_bytes() == MINE
    assert main(["plot", "s.zarr", "--overwrite"]) == 0
    assert main(["plot", "s.zarr"]) == 0
    assert main(["plot", "s.zarr", "--out", "s.html"]) == 0
    assert carries_mark(Path("s.html"))


def test_a_figure_of_others_is_told_before_steps_are_made(
    ask: Ask, monkeypatch: pytest.MonkeyPatch
) -> None:
    Path("steps.png").write_bytes(MINE)
    monkeypatch.setattr("undula.app.commands.step.ramp_steps", lambda *_, **__: pytest.fail("made"))
    assert "steps.png does not carry the mark" in refused(
        ask("step", "--along", "load.force=1:2:1", "--out", ".")
    )
    assert files_of() == {"steps.png": MINE}


def test_an_answer_is_told_where_its_figure_cannot_be_written(
    ask: Ask, monkeypatch: pytest.MonkeyPatch
) -> None:
    from undula.app.commands import stability

    before = stability.analyse

    def meanwhile(*_: object) -> object:
        Path("figure.png").write_bytes(MINE)
        return before(*_)

    monkeypatch.setattr(stability, "analyse", meanwhile)
    asked = ask("stability", "--plot", "figure.png", "--json")
    found = answer(asked, status=3)
    assert found["hopf_force"] > 0.0
    assert found["figure"] is None
    assert "figure.png exists already" in asked.told
    assert Path("figure.png").read_bytes() == MINE


# ---------------------------------------------------------------- the report


def test_a_folder_of_others_is_no_report(ask: Ask) -> None:
    small_catalogue(Path("catalogue"))
    Path("thesis/data/onset/onset").mkdir(parents=True)
    for name in ("thesis.tex", "data/onset/onset/key", "data/onset/onset/measured.csv"):
        Path("thesis", name).write_bytes(MINE)
    told = refused(ask("reproduce", "onset", "--catalogue", "catalogue", "--out", "thesis"))
    assert f"there is no {MARK} in it" in told
    assert files_of(Path("thesis/data/onset/onset")) == {"key": MINE, "measured.csv": MINE}


@pytest.mark.slow
def test_files_of_others_in_a_report_are_told_and_stay(ask: Ask) -> None:
    words = ["reproduce", "onset", "--catalogue", "catalogue", "--workers", "1"]
    small_catalogue(Path("catalogue"))
    task = Path("report/data/onset/onset")
    with locked_report(Path("report")):
        assert "at work" in refused(ask(*words))
    task.mkdir(parents=True)
    for name in (task / "onset.svg", task / "measured.csv", Path("report/index.html")):
        name.write_bytes(MINE)
        assert f"{name} was not made by undula; move it" in refused(ask(*words))
        assert name.read_bytes() == MINE
        name.unlink()
    (task / "key").write_text("that of another version")
    (task / "older.svg").write_bytes(figure_bytes(Figure(), ".svg"))
    assert main(words) == 0
    assert files_of(task).keys() == {"key", "answer.json", "onset.svg"}
    assert {path.name for path in Path("report").iterdir()} == {
        *(MARK, "index.html", "claims.json", "data")
    }


# ---------------------------------------------------------------- several processes


def endless(folder: str) -> subprocess.Popen[str]:
    """Start a run, and wait until it has stored its result for the first time."""
    run = started(sys.executable, "-c", EAGER, *ENDLESS, "--out", folder, group=False)
    end = time.monotonic() + PATIENCE
    while not Path(folder, "run.nc").exists():
        assert run.poll() is None
        assert time.monotonic() < end
        time.sleep(0.01)
    return run


@pytest.mark.slow
def test_of_two_runs_into_one_folder_the_second_is_refused_at_once(
    ask: Ask,
) -> None:
    with endless("r") as first:
        for further in ([], ["--overwrite"]):
            assert "another undula is at work on r/run.nc" in refused(
                ask(*("run", *TINY, *further, "--out", "r"))
            )
        assert "another undula is at work on r/run.nc" in refused(ask("resume", "r/run.nc"))
        assert "another undula is at work on r/run.png" in refused(ask("plot", "r/run.nc"))
        first.send_signal(signal.SIGINT)
        first.communicate(timeout=PATIENCE)
    assert first.returncode == 3
    assert files_of(Path("r")).keys() == {"run.nc", "run.png"}


@pytest.mark.slow
def test_after_a_run_was_killed_the_next_one_has_its_names() -> None:
    with endless("r") as first:
        first.kill()
        first.communicate(timeout=PATIENCE)
    assert main(["run", *TINY, "--no-movie", "--overwrite", "--out", "r"]) == 0
    left = {name for name in files_of(Path("r")) if not name.endswith(".part")}
    assert left == {"run.nc", "run.png"}
