"""Progress of tasks that count what they have done or approach a value, with a time estimate.

Of a search nobody knows how far it is from its end; it tells where it is.
"""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from undula.terminal.meter import meter
from undula.terminal.run_progress import duration


@contextmanager
def counted(task: str) -> Iterator[Callable[[int, int], None]]:
    """Yield a function to be called with the number of things done and of all."""
    began = time.monotonic()
    with meter(task) as show:

        def tell(done: int, total: int) -> None:
            to_go = (time.monotonic() - began) * (total - done) / done
            show(done / total, f"{done} of {total}, {duration(to_go)} to go")

        yield tell


@contextmanager
def stepped(task: str, parameter: str, done: int, total: int) -> Iterator[Callable[..., None]]:
    """Yield a function to be called with a number of steps done, its parameter's value and a time.

    `done` steps of all were done before; what they took says nothing about those to come.
    """
    began: float | None = None
    with meter(task) as show:

        def tell(now: int, value: float, reached: float) -> None:
            nonlocal began
            began = time.monotonic() if began is None else began  # by now all is compiled
            here = f"{now} of {total} steps, {parameter} = {value:.6g} at t = {reached:.4g} T"
            to_go = (time.monotonic() - began) * (total - now) / max(now - done, 1)
            show(now / total, f"{here}, {duration(to_go)} to go" if now > done else here)

        yield tell


@contextmanager
def swept(
    task: str, total: int, left: int, things: str = "points"
) -> Iterator[Callable[[int, int], None]]:
    """Yield a function to be called with the number of points that are left and that have failed.

    So many of all are left at the beginning; how long those before took says nothing of them.
    """
    began = time.monotonic()
    with meter(task) as show:

        def tell(now: int, failed: int) -> None:
            words = f"{total - now} of {total} {things}" + (f" ({failed} failed)" if failed else "")
            if now < left:
                to_go = (time.monotonic() - began) * now / (left - now)
                words += f", {duration(to_go)} to go"
            show((total - now) / total, words)

        yield tell


@contextmanager
def approached(task: str, start: float, end: float) -> Iterator[Callable[[float], None]]:
    """Yield a function to be called with the value that was reached on the way to `end`."""
    began = time.monotonic()
    with meter(task) as show:

        def tell(value: float) -> None:
            part = min(1.0, max(1e-3, (value - start) / (end - start)))
            to_go = (time.monotonic() - began) * (1.0 - part) / part
            show(part, f"at {value:.6g} of {end:.6g}, about {duration(to_go)} to go")

        yield tell


@contextmanager
def searching(task: str) -> Iterator[Callable[..., None]]:
    """Yield a function to be called with the number of links, and the force that was reached."""
    with meter(task) as show:

        def tell(links: int, force: float | None = None) -> None:
            show(0.0, f"{links} links" if force is None else f"{links} links, force {force:.6g}")

        yield tell
