"""Progress of a run that Python has started: a bar in a terminal, lines in a notebook."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from undula.analysis.runs.progress import Progress
from undula.terminal.meter import meter
from undula.terminal.run_progress import pace, part_done


@contextmanager
def run_shown(title: str, *, settling: bool) -> Iterator[Callable[[Progress], None]]:
    """Yield a function that shows the progress of a run.

    Parameters
    ----------
    title
        The work in a few words.
    settling
        True for a run that ends when it has settled; its end time is then a limit.
    """
    with meter(title) as show:
        first: Progress | None = None

        def update(progress: Progress) -> None:
            nonlocal first
            first = first or progress
            if progress.exponents is not None:
                name, part = progress.exponents
                show(part, name)
            else:
                show(part_done(progress), pace(progress, first, settling=settling))

        yield update
