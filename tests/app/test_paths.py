"""Names that no file can have, and places that are closed: one sentence from every command."""

import json
import typing
from collections.abc import Iterator
from pathlib import Path

import pytest
import typer

from refusal import complaint
from small_sweeps import AXES, QUICK, sweep_of
from undula.app.cli import app, main
from undula.app.options import a_file, a_path
from undula.inputs.file_names import any_name, file_name
from undula.sweeps.store import open_sweep
from without_rights import are_kept_out, run_without_rights

TINY = "--set model.segments=8 --set time.until=0.02 --set time.samples=21 --no-movie"
LONG = "a" * 300
#: Every command with every word that names a file or folder; the name stands for {}.
COMMANDS = [
    "run {}",
    "run --out {}",
    "run --set start.shape=state --set start.file={} --out new",
    "resume {}",
    "plot {}",
    "plot run.nc --out {}",
    "plot study.zarr --out {}",
    "movie {}",
    "movie run.nc --out {}",
    "step {} --along load.force=1:2:2 --out new",
    "step --along load.force=1:2:2 --out {}",
    "stability {}",
    "solve spinning frequency=120 {} --by load.force",
    "stability --plot {}",
    "find spinning {}",
    "find periodic --run {}",
    "follow spinning {} --along load.force=50:60",
    "follow spinning --along load.force=50:60 --plot {}",
    "follow spinning --along load.force=50:60 --plot new.png --run {}",
    "threshold onset {}",
    "threshold onset --along model.drag_ratio=1:2:2 --plot {}",
    "sweep {}",
    "sweep study.toml --out {}",
    "status {}",
    "reproduce onset --out {}",
    "reproduce --catalogue {} --list",
    "reproduce --catalogue {}",
]
#: Nothing can be called so, or no file can.
NAMES = [
    "",
    ".",
    "..",
    "/",
    "a\0b",
    LONG,
    f"{LONG}.png",
    f"gone/{LONG}",
    "file/x.png",
    "loop/x.png",
]
#: Nothing can be looked at there, or nothing written.
CLOSED = ["closed", "closed/x.png", "closed/a/run.nc", "readonly/x.png", "readonly/a/run.mp4", "/"]
#: What may well be done: results into the folder where one is, or into one that is there.
FOLDERS = ("run --out {}", "step --along load.force=1:2:2 --out {}")
CLOSED_FOLDERS = [
    *(("run --out", name) for name in ("closed", "readonly", "/proc")),
    *(("step --along load.force=1:2:2 --out", name) for name in ("closed", "readonly")),
]
MANY = """
import contextlib, io, json, sys
from undula.app.cli import main
for words in json.loads(sys.argv[1]):
    said, told = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(told):
        status = main(words)
    print(json.dumps([words, status, said.getvalue(), told.getvalue()]))
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Give a folder with a result, a study, a file, a loop, and two that are closed."""
    folder = tmp_path_factory.mktemp("paths")
    assert main(["run", *TINY.split(), "--out", str(folder)]) == 0
    (folder / "run.png").unlink()
    open_sweep(folder / "study.zarr", sweep_of(folder, QUICK + AXES))
    (folder / "file").write_text("")
    (folder / "loop").symlink_to("loop")
    for name, mode in (("closed", 0), ("readonly", 0o555)):
        (folder / name).mkdir()
        (folder / name).chmod(mode)
    yield folder
    for name in ("closed", "readonly"):
        (folder / name).chmod(0o755)


@pytest.fixture(autouse=True)
def _there(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)


def content() -> set[str]:
    return {path.name for path in Path().iterdir()}


def calls(names: list[str]) -> Iterator[list[str]]:
    """Yield the words of every call that is to be refused."""
    for name in names:
        for command in COMMANDS:
            if command not in FOLDERS or not Path(name.replace("\0", "?")[:200]).is_dir():
                yield [word.replace("{}", name) for word in command.split(" ")]


@pytest.mark.parametrize("name", NAMES, ids=lambda name: repr(name[:8]))
def test_a_name_that_nothing_has_is_told_in_one_sentence(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    before = content()
    for words in calls([name]):
        capsys.readouterr()
        status = main(words)
        said = capsys.readouterr()
        assert (status, said.out, said.err.count("\n")) == (2, "", 1), (words, said)
    assert content() == before


@pytest.mark.slow
def test_a_place_that_is_closed_is_told_in_one_sentence() -> None:
    if not are_kept_out(Path("closed")):
        pytest.skip("no folder is closed to this user, and no rights can be given up")
    before = content()
    asked = [*calls(CLOSED), *([*command.split(), name] for command, name in CLOSED_FOLDERS)]
    done = run_without_rights(MANY, [json.dumps(asked)])
    assert done.returncode == 0, done.stderr[-2000:]
    told = [json.loads(line) for line in done.stdout.splitlines()]
    assert len(told) == len(asked)
    for words, status, said, sentence in told:
        assert (status, said, sentence.count("\n")) == (2, "", 1), (words, sentence)
    assert content() == before


@pytest.mark.slow
def test_a_store_that_is_read_only_is_read_and_not_written(tmp_path: Path) -> None:
    if not are_kept_out(Path("closed")):
        pytest.skip("no folder is closed to this user, and no rights can be given up")
    store, broken = tmp_path / "s.zarr", tmp_path / "b.zarr"
    for path in (store, broken):
        open_sweep(path, sweep_of(tmp_path, QUICK + AXES))
    closed = [store, *(path for path in store.rglob("*") if path.is_dir())]
    for path in closed:
        path.chmod(0o555)
    (broken / "status").chmod(0)
    sweep = str(tmp_path / "study.toml")
    asked = [
        ["status", str(store)],
        ["plot", str(store)],
        ["sweep", sweep, "--out", str(store), "--workers", "1"],
        ["plot", str(store), "--out", str(store / "x.png")],
        ["plot", str(store), "--borders", "--out", str(tmp_path / "b.png")],
        ["status", str(broken)],
        ["sweep", sweep, "--out", str(broken), "--workers", "1"],
    ]
    done = run_without_rights(MANY, [json.dumps(asked)])
    for path in (*closed, broken / "status"):
        path.chmod(0o755)
    assert done.returncode == 0, done.stderr[-2000:]
    told = [json.loads(line) for line in done.stdout.splitlines()]
    assert [status for _, status, _, _ in told] == [0, 0, 2, 2, 2, 2, 2]
    for words, _, said, sentence in told[2:]:
        assert (said, sentence.count("\n")) == ("", 1), (words, sentence)
        assert "Permission denied" in sentence


def test_every_word_that_names_a_file_is_looked_at_and_tried_here() -> None:
    commands = dict(typer.main.get_command(app).commands)
    for name, command in commands.items():
        tried = [one.split() for one in COMMANDS if one.split()[0] == name]
        before = {words[words.index("{}") - 1] for words in tried if "{}" in words}
        hints = typing.get_type_hints(command.callback, include_extras=True)
        for parameter in command.params:
            kind, option = (*typing.get_args(hints.get(parameter.name)), None, None)[:2]
            if "Path" not in str(kind):
                continue
            assert option.parser in (a_file, a_path), (name, parameter.name)
            if parameter.param_type_name == "argument":
                assert any(not word.startswith("--") for word in before), (name, parameter.name)
            else:
                assert before & {*parameter.opts}, (name, parameter.name)


@pytest.mark.parametrize("read", [any_name, file_name])
def test_a_name_that_can_be_had_is_taken_as_it_is(read) -> None:
    for name in ("run.nc", "gone/run.nc", "./a", "-", "~", "ü.nc"):
        assert read(name) == Path(name)
    assert "no name" in complaint(lambda: read(""))


def test_a_folder_is_no_name_of_a_file() -> None:
    for name in (".", "..", "/", "a/.."):
        assert any_name(name) == Path(name)
        assert "is a folder" in complaint(lambda name=name: file_name(name))
