"""Tasks of the catalogue: what is left to do, done by workers, and kept for the next time."""

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
from undula.reproduction.claims.catalogue import Item, Task
from undula.reproduction.claims.evaluate import Answer
from undula.reproduction.tasks.folder import ANSWER, KEY, clear, refuse_foreign
from undula.schema.sweep_axes import NOT_DONE
from undula.storage.atomic import write_whole
from undula.storage.digests import sealed_json, unsealed_json
from undula.storage.seal import is_whole
from undula.sweeps.store import load_sweep
from undula.terminal.output import DONE

#: Sources that read answers and compute none: their changes leave all that is kept as it is.
_JUDGING = (
    "reproduction/claims/evaluate",
    "reproduction/claims/measures",
    "reproduction/claims/errata",
    "reproduction/claims/stated",
    "reproduction/claims/sweep_measures",
    "reproduction/figures/by_name",
    "reproduction/report",
    "reproduction/reproduce",
)
#: What commands store in the folder of a task that carries checksums.
_FILES, _STUDY = ("run.nc", "steps.nc"), "study.zarr"


@dataclass(frozen=True)
class Job:
    """A task with its place on disk.

    Attributes
    ----------
    item, name, task
        Of the catalogue.
    command
        Its words behind `undula`, with folders filled in.
    folder
        Where its files and its answer are.
    key
        What its answer depends on: the command, its input files, and the sources of undula.
    needs
        Folders of the jobs that have to come before.
    as_in_full
        Whether the full report has the same.
    """

    item: str
    name: str
    task: Task
    command: tuple[str, ...]
    folder: Path
    key: str
    needs: frozenset[Path]
    as_in_full: bool

    @property
    def told(self) -> str:
        """The command as it is typed."""
        return shlex.join(("undula", *self.command))

    def kept(self) -> dict[str, Any] | None:
        """Return the record of an earlier call, if it is one of this very job and undamaged."""
        try:
            record = unsealed_json((self.folder / ANSWER).read_bytes())
        except OSError:
            return None
        return record if record is not None and record["key"] == self.key else None

    def is_done(self) -> bool:
        """Tell whether its record is kept, and all is undamaged that its command has stored."""
        study = self.folder / _STUDY
        if self.kept() is None or any(True for _ in _damaged_files(self.folder)):
            return False
        try:
            if not study.is_dir():
                return True
            return bool((load_sweep(study, shapes=False)["status"] != NOT_DONE).all())
        except InputError:
            return False

    def keep(self, record: Mapping[str, Any]) -> None:
        """Store the record of its answer.

        Raises
        ------
        InputError
            The folder cannot be written or is full.
        """
        content = sealed_json({"key": self.key, **record})
        write_whole(self.folder / ANSWER, content, overwrite=True)

    def prepare(self) -> None:
        """Make its folder, without the files of another version of the same task.

        Raises
        ------
        InputError
            There is something in it that undula has not made, or it cannot be written.
        """
        refuse_foreign(self.folder)
        mark = self.folder / KEY
        if _text(mark) != self.key:
            clear(self.folder)
        for damaged in _damaged_files(self.folder):
            # A series would go on with it; a study mends what is damaged of it.
            damaged.unlink()
        write_whole(mark, self.key.encode(), overwrite=True)


def _damaged_files(folder: Path) -> Iterator[Path]:
    """Yield the result files in the folder of a task that are not as they were written."""
    for file in (folder / name for name in _FILES):
        if file.is_file() and not is_whole(file.read_bytes()):
            yield file


def jobs_of(items: Mapping[str, Item], inputs: Path, data: Path, *, quick: bool) -> dict[str, Job]:
    """Return the jobs of items by `item/task`, without those that a quick report leaves out.

    Parameters
    ----------
    items
        By name.
    inputs
        Folder of the input files of their commands.
    data
        Folder of all that the commands write.
    quick
        Whether the report is the quick one.
    """
    return {
        f"{name}/{job.name}": job
        for name, item in items.items()
        for job in _jobs(name, item, inputs, data / name, quick=quick).values()
    }


def _jobs(item_name: str, item: Item, inputs: Path, data: Path, *, quick: bool) -> dict[str, Job]:
    """Return the jobs of an item by the names of their tasks."""
    made: dict[str, Job] = {}

    def job_of(name: str) -> Job:
        if name not in made:
            task = item.tasks[name]
            needed = {other: job_of(other) for other in task.needs(quick=quick)}
            made[name] = _job(item_name, name, task, needed, inputs, data, quick=quick)
        return made[name]

    for name, task in item.tasks.items():
        if task.command(quick=quick) is not None:
            job_of(name)
    return made


def _job(
    item: str,
    name: str,
    task: Task,
    needed: Mapping[str, Job],
    inputs: Path,
    data: Path,
    *,
    quick: bool,
) -> Job:
    template = task.command(quick=quick) or ""
    as_in_full = template == task.call and all(job.as_in_full for job in needed.values())
    folder = data / (name if as_in_full else f"{name}-quick")
    places = {other: str(job.folder) for other, job in needed.items()}
    places |= {"out": str(folder), "inputs": _shown(inputs)}
    command = tuple(_filled(word, places) for word in shlex.split(template))
    read = [path for path in map(Path, command) if path.parent == Path(places["inputs"])]
    digest = hashlib.sha256(_computing().encode())
    parts = [template, *map(_input_text, read)]
    for part in (*parts, *(job.key for job in needed.values())):
        digest.update(b"\0" + part.encode())
    before = frozenset(job.folder for job in needed.values())
    return Job(item, name, task, command, folder, digest.hexdigest(), before, as_in_full)


def _input_text(path: Path) -> str:
    text = _text(path)
    if text is None:
        raise InputError(f"the input {path} of a command cannot be read; mend the catalogue")
    return text


def _text(path: Path) -> str | None:
    """Return the text of a file, None if there is none."""
    try:
        return path.read_text("utf-8")
    except (OSError, UnicodeDecodeError):
        return None


@cache
def _computing() -> str:
    """Return a digest of all sources but those that only judge and show what commands answer."""
    digest = hashlib.sha256()
    for path in sorted(PACKAGE.rglob("*.py")):
        name = path.relative_to(PACKAGE).as_posix()
        if not name.startswith(_JUDGING):
            digest.update(name.encode() + path.read_bytes())
    return digest.hexdigest()


def _filled(word: str, places: Mapping[str, str]) -> str:
    for name, place in places.items():
        word = word.replace(f"{{{name}}}", place)
    return word


def _shown(path: Path) -> str:
    """Return a path from the working folder, if it is below, so that commands can be typed."""
    try:
        return str(path.relative_to(Path.cwd()))
    except ValueError:
        return str(path)


def answers_of(item: Item, name: str, jobs: Mapping[str, Job]) -> dict[str, Answer]:
    """Return the answers that are kept of the tasks of an item, by the names that it uses."""
    places = {local: f"{name}/{local}" for local in item.tasks} | item.uses
    answers = {}
    for local, place in places.items():
        job = jobs.get(place)
        record = job.kept() if job else None
        if job is not None and record is not None and record["status"] == DONE:
            answers[local] = Answer(record["answer"], job.folder)
    return answers


def carry_out(
    run_command: str, command: tuple[str, ...], *, quietly: bool = True
) -> dict[str, Any]:
    """Run a command of `undula` in this process.

    Parameters
    ----------
    run_command
        Import path, as ``package.module:function``, of the function that runs a command from its
        words and returns the exit status. A path instead of the function can be sent to workers.
    command
        Its words, without `undula`.
    quietly
        Whether its progress is kept from standard error.

    Returns
    -------
    dict
        `status`, the exit status; `answer`, its JSON; `said`, the last line on standard error;
        `seconds`.
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
