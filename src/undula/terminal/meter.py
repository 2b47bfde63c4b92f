"""Progress of long work: a bar in a terminal, elsewhere a line every few seconds."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import IO, cast

from undula.terminal.streams import err

#: Function of the fraction that is done, from 0 to 1, and of a few words.
Meter = Callable[[float, str], None]

#: Time between two lines outside a terminal [s].
SECONDS_BETWEEN_LINES = 5.0


@contextmanager
def meter(title: str) -> Iterator[Meter]:
    """Show the progress of long work on standard error.

    Parameters
    ----------
    title
        The work in a few words.

    Yields
    ------
    Meter
        May be called at any rate; it shows the state a few times a second in a terminal, and every
        few seconds otherwise.
    """
    if err().isatty():
        with _bar(title) as show:
            yield show
    else:
        yield _lines(title)


@contextmanager
def _bar(title: str) -> Iterator[Meter]:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn

    text = TextColumn("{task.fields[words]}", markup=False)
    columns = (TextColumn("{task.description}"), BarColumn(24), TaskProgressColumn(), text)
    with Progress(*columns, console=Console(file=cast(IO[str], err())), transient=True) as progress:
        bar = progress.add_task(title, total=1.0, words="")
        yield lambda part, words: progress.update(bar, completed=part, words=words)


def _lines(title: str) -> Meter:
    last = time.monotonic()

    def show(part: float, words: str) -> None:  # noqa: ARG001
        nonlocal last
        if time.monotonic() - last >= SECONDS_BETWEEN_LINES:
            last = time.monotonic()
            stream = err()
            stream.write(f"{title}: {words}\n")
            stream.flush()

    return show
