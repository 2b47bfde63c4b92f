"""How far a long task is: a bar in a terminal, elsewhere a line every few seconds."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import IO, cast

from undula.terminal.streams import err

#: Called with the part that is done, from 0 to 1, and a few words.
Meter = Callable[[float, str], None]

SECONDS_BETWEEN_LINES = 5.0


@contextmanager
def meter(task: str) -> Iterator[Meter]:
    """Show on standard error how far a task is.

    Parameters
    ----------
    task
        What is being done, in a few words.

    Yields
    ------
    callable
        To be called as often as wanted; it shows what changed a few times a second in a terminal,
        and every few seconds otherwise.
    """
    if err().isatty():
        with _bar(task) as show:
            yield show
    else:
        yield _lines(task)


@contextmanager
def _bar(task: str) -> Iterator[Meter]:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn

    words = TextColumn("{task.fields[words]}", markup=False)
    columns = (TextColumn("{task.description}"), BarColumn(24), TaskProgressColumn(), words)
    with Progress(*columns, console=Console(file=cast(IO[str], err())), transient=True) as progress:
        shown = progress.add_task(task, total=1.0, words="")
        yield lambda part, said: progress.update(shown, completed=part, words=said)


def _lines(task: str) -> Meter:
    last = time.monotonic()

    def show(part: float, words: str) -> None:  # noqa: ARG001
        nonlocal last
        if time.monotonic() - last >= SECONDS_BETWEEN_LINES:
            last = time.monotonic()
            stream = err()
            stream.write(f"{task}: {words}\n")
            stream.flush()

    return show
