"""Progress of counted work and of work that approaches a value, with the remaining time.

Searches have no known length; their meter shows the current value.
"""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from undula.terminal.meter import meter
from undula.terminal.run_progress import duration


@contextmanager
def counted(title: str) -> Iterator[Callable[[int, int], None]]:
    """Yield a progress function of the number of done and of all items."""
    began = time.monotonic()
    with meter(title) as show:

        def update(done: int, total: int) -> None:
            to_go = (time.monotonic() - began) * (total - done) / done
            show(done / total, f"{done} of {total}, {duration(to_go)} to go")

        yield update


@contextmanager
def stepped(title: str, parameter: str, done: int, total: int) -> Iterator[Callable[..., None]]:
    """Yield a progress function of the number of done steps, the parameter value and the time.

    Parameters
    ----------
    title
        The work in a few words.
    parameter
        Name of the parameter.
    done
        Number of steps from an earlier call, which do not count for the remaining time.
    total
        Number of all steps.
    """
    began: float | None = None
    with meter(title) as show:

        def update(now: int, value: float, reached: float) -> None:
            nonlocal began
            began = time.monotonic() if began is None else began  # after compilation
            words = f"{now} of {total} steps, {parameter} = {value:.6g} at t = {reached:.4g} T"
            to_go = (time.monotonic() - began) * (total - now) / max(now - done, 1)
            show(now / total, f"{words}, {duration(to_go)} to go" if now > done else words)

        yield update


@contextmanager
def swept(
    title: str, total: int, left: int, things: str = "points"
) -> Iterator[Callable[[int, int], None]]:
    """Yield a progress function of the number of remaining and of failed points.

    Parameters
    ----------
    title
        The work in a few words.
    total
        Number of all points.
    left
        Number of remaining points at the beginning; earlier points do not count for the time.
    things
        Name of the points in the plural.
    """
    began = time.monotonic()
    with meter(title) as show:

        def update(now: int, failed: int) -> None:
            words = f"{total - now} of {total} {things}" + (f" ({failed} failed)" if failed else "")
            if now < left:
                to_go = (time.monotonic() - began) * now / (left - now)
                words += f", {duration(to_go)} to go"
            show((total - now) / total, words)

        yield update


@contextmanager
def approached(title: str, start: float, end: float) -> Iterator[Callable[[float], None]]:
    """Yield a progress function of the value that was reached between `start` and `end`.

    Parameters
    ----------
    title
        The work in a few words.
    start
        Value at the beginning.
    end
        Value at the end.
    """
    began = time.monotonic()
    with meter(title) as show:

        def update(value: float) -> None:
            part = min(1.0, max(1e-3, (value - start) / (end - start)))
            to_go = (time.monotonic() - began) * (1.0 - part) / part
            show(part, f"at {value:.6g} of {end:.6g}, about {duration(to_go)} to go")

        yield update


@contextmanager
def searching(title: str) -> Iterator[Callable[..., None]]:
    """Yield a progress function of the number of links and the force that was reached."""
    with meter(title) as show:

        def update(links: int, force: float | None = None) -> None:
            show(0.0, f"{links} links" if force is None else f"{links} links, force {force:.6g}")

        yield update


@contextmanager
def located(title: str, parameter: str) -> Iterator[Callable[[float], None]]:
    """Yield a progress function of the value of a parameter that was reached.

    Parameters
    ----------
    title
        The work in a few words.
    parameter
        Name of the parameter.
    """
    with meter(title) as show:

        def update(value: float) -> None:
            show(0.0, f"{parameter} {value:.6g}")

        yield update
