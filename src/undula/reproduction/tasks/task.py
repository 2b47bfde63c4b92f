"""Tasks of a reproduction: commands with their folders, and their stored answers."""

import contextlib
import hashlib
import io
import json
import pkgutil
import shlex
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from undula.errors import InputError
from undula.jit.cache import PACKAGE
from undula.reproduction.claims.catalogue import Item, TaskEntry
from undula.reproduction.claims.evaluate import ClaimAnswer
from undula.reproduction.tasks.folder import ANSWER, KEY, clear, refuse_foreign
from undula.schema.sweep_axes import NOT_DONE
from undula.storage.atomic import write_whole
from undula.storage.digests import sealed_json, unsealed_json
from undula.storage.seal import is_whole
from undula.sweeps.store import load_sweep
from undula.terminal.output import DONE

#: Folder of the sources that hand out commands and judge their answers. A change there leaves all
#: stored answers valid; a change of any other source makes them outdated. The latter includes the
#: views, since commands also draw figures.
_JUDGING = "reproduction/"
#: Results with checksums that commands store in the folder of a task.
_FILES, _SWEEP = ("run.nc", "steps.nc"), "study.zarr"


@dataclass(frozen=True)
class ReproductionTask:
    """A task of the catalogue with its folder.

    Attributes
    ----------
    item, name
        Names of the item and of the task in it.
    entry
        The task in the catalogue.
    command
        Words of the command after `undula`, with folders filled in.
    folder
        Folder of its files and of its answer.
    key
        Digest of all that the answer depends on: the command, its input files and the sources.
    needs
        Folders of the tasks that have to be done before.
    as_in_full
        True if the full report contains the same task.
    """

    item: str
    name: str
    entry: TaskEntry
    command: tuple[str, ...]
    folder: Path
    key: str
    needs: frozenset[Path]
    as_in_full: bool

    @property
    def typed(self) -> str:
        """The command as typed in a shell."""
        return shlex.join(("undula", *self.command))

    def stored(self) -> dict[str, Any] | None:
        """Return the stored outcome, None if it is missing, damaged or outdated."""
        try:
            record = unsealed_json((self.folder / ANSWER).read_bytes())
        except OSError:
            return None
        return record if record is not None and record["key"] == self.key else None

    def is_done(self) -> bool:
        """Return True if the outcome is stored and all stored results are undamaged."""
        sweep = self.folder / _SWEEP
        if self.stored() is None or any(True for _ in _damaged_files(self.folder)):
            return False
        try:
            if not sweep.is_dir():
                return True
            return bool((load_sweep(sweep, shapes=False)["status"] != NOT_DONE).all())
        except InputError:
            return False

    def store(self, outcome: Mapping[str, Any]) -> None:
        """Store the outcome that `run_captured` has returned.

        Raises
        ------
        InputError
            The folder cannot be written or is full.
        """
        content = sealed_json({"key": self.key, **outcome})
        write_whole(self.folder / ANSWER, content, overwrite=True)

    def prepare(self) -> None:
        """Make the folder, without files of another version of the same task.

        Raises
        ------
        InputError
            The folder holds a file that undula has not made, or cannot be written.
        """
        refuse_foreign(self.folder)
        mark = self.folder / KEY
        if _text(mark) != self.key:
            clear(self.folder)
        for damaged in _damaged_files(self.folder):
            # The command would continue a damaged ramp; a sweep repairs its store itself.
            damaged.unlink()
        write_whole(mark, self.key.encode(), overwrite=True)


#: Tasks by `item/task`.
Tasks = Mapping[str, ReproductionTask]


def _damaged_files(folder: Path) -> Iterator[Path]:
    """Yield the damaged result files in the folder of a task."""
    for file in (folder / name for name in _FILES):
        if file.is_file() and not is_whole(file.read_bytes()):
            yield file


def tasks_of(
    items: Mapping[str, Item], inputs: Path, data: Path, *, quick: bool
) -> dict[str, ReproductionTask]:
    """Return the tasks of a report by `item/task`.

    Parameters
    ----------
    items
        Items of the catalogue by name.
    inputs
        Folder of the input files of their commands.
    data
        Folder of all files that the commands write.
    quick
        True for the quick report, which leaves out some tasks.
    """
    return {
        f"{name}/{task.name}": task
        for name, item in items.items()
        for task in _tasks_of_item(name, item, inputs, data / name, quick=quick).values()
    }


def _tasks_of_item(
    item_name: str, item: Item, inputs: Path, data: Path, *, quick: bool
) -> dict[str, ReproductionTask]:
    """Return the tasks of an item by name."""
    made: dict[str, ReproductionTask] = {}

    def task_of(name: str) -> ReproductionTask:
        if name not in made:
            entry = item.tasks[name]
            needed = {other: task_of(other) for other in entry.needs(quick=quick)}
            made[name] = _task(item_name, name, entry, needed, inputs, data, quick=quick)
        return made[name]

    for name, entry in item.tasks.items():
        if entry.command(quick=quick) is not None:
            task_of(name)
    return made


def _task(
    item: str,
    name: str,
    entry: TaskEntry,
    needed: Mapping[str, ReproductionTask],
    inputs: Path,
    data: Path,
    *,
    quick: bool,
) -> ReproductionTask:
    template = entry.command(quick=quick) or ""
    as_in_full = template == entry.call and all(task.as_in_full for task in needed.values())
    folder = data / (name if as_in_full else f"{name}-quick")
    places = {other: str(task.folder) for other, task in needed.items()}
    places |= {"out": str(folder), "inputs": _shown(inputs)}
    command = tuple(_filled(word, places) for word in shlex.split(template))
    read = [path for path in map(Path, command) if path.parent == Path(places["inputs"])]
    digest = hashlib.sha256(_source_digest().encode())
    parts = [template, *map(_input_text, read)]
    for part in (*parts, *(task.key for task in needed.values())):
        digest.update(b"\0" + part.encode())
    before = frozenset(task.folder for task in needed.values())
    return ReproductionTask(
        item, name, entry, command, folder, digest.hexdigest(), before, as_in_full
    )


def _input_text(path: Path) -> str:
    text = _text(path)
    if text is None:
        raise InputError(f"the input {path} of a command cannot be read; mend the catalogue")
    return text


def _text(path: Path) -> str | None:
    """Return the text of a file, None if it cannot be read."""
    try:
        return path.read_text("utf-8")
    except (OSError, UnicodeDecodeError):
        return None


@cache
def _source_digest() -> str:
    """Return a digest of all sources except those that only judge the answers of commands."""
    digest = hashlib.sha256()
    for path in sorted(PACKAGE.rglob("*.py")):
        name = path.relative_to(PACKAGE).as_posix()
        if not name.startswith(_JUDGING):
            digest.update(name.encode() + path.read_bytes())
    return digest.hexdigest()


def _filled(word: str, places: Mapping[str, str]) -> str:
    """Return a word of a command with paths in place of names in braces."""
    for name, place in places.items():
        word = word.replace(f"{{{name}}}", place)
    return word


def _shown(path: Path) -> str:
    """Return a path relative to the working folder, if it is below, for short commands."""
    try:
        return str(path.relative_to(Path.cwd()))
    except ValueError:
        return str(path)


def answers_of(item: Item, name: str, tasks: Tasks) -> dict[str, ClaimAnswer]:
    """Return the stored answers of the tasks of an item, by the names that it uses for them."""
    places = {local: f"{name}/{local}" for local in item.tasks} | item.uses
    answers = {}
    for local, place in places.items():
        task = tasks.get(place)
        record = task.stored() if task else None
        if task is not None and record is not None and record["status"] == DONE:
            answers[local] = ClaimAnswer(record["answer"], task.folder)
    return answers


def run_captured(
    run_command: str, command: tuple[str, ...], *, quietly: bool = True
) -> dict[str, Any]:
    """Run a command of `undula` in this process and capture its answer.

    Parameters
    ----------
    run_command
        Import path, as ``package.module:function``, of the function that runs a command from its
        words and returns the exit status. Unlike the function, the path can be sent to workers.
    command
        Words of the command, without `undula`.
    quietly
        If true, progress is not written to standard error.

    Returns
    -------
    dict
        `status`, the exit status; `answer`, the JSON answer; `said`, the last line on standard
        error; `seconds` of wall time.
    """
    began = time.monotonic()
    answered, said = io.StringIO(), io.StringIO()
    with contextlib.ExitStack() as stack:
        stack.enter_context(contextlib.redirect_stdout(answered))
        if quietly:
            stack.enter_context(contextlib.redirect_stderr(said))
        try:
            status = pkgutil.resolve_name(run_command)([*command, "--json"])
        except Exception as error:
            status = 1
            said.write(f"{type(error).__name__}: {error}\n")
    lines = said.getvalue().strip().splitlines()
    try:
        answer = json.loads(answered.getvalue())
    except ValueError:
        answer = {}
    return {
        "status": status,
        "answer": answer,
        "said": answer.get("error") or (lines[-1] if lines else ""),
        "seconds": round(time.monotonic() - began, 3),
    }
