"""Progress of a run, and its display for whoever asks for one."""

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from typing import Any

from undula.analysis.record import function_by_name


@dataclass(frozen=True)
class Progress:
    """Progress of a run.

    Attributes
    ----------
    time, end : float
        Time reached and latest end [T].
    step : float
        Length of the present step [T].
    steps : int
        Number of steps so far.
    seconds : float
        Elapsed time [s].
    exponents : tuple of (str, float) or None
        Name and finished share of a computation of Lyapunov exponents.
    """

    time: float
    end: float
    step: float
    steps: int
    seconds: float
    exponents: tuple[str, float] | None = None


def displayed(
    progress: Callable[[Progress], None] | bool | None, *, settling: bool
) -> AbstractContextManager[Callable[[Progress], None] | None]:
    """Return the context of a run with its function of progress, a display for True.

    Parameters
    ----------
    progress : callable, bool or None
        As a user gives it.
    settling : bool
        True for a run whose end time is a limit.
    """
    if progress is True:
        show = function_by_name("undula.terminal.python_progress:run_shown")
        shown: AbstractContextManager[Any] = show("integrating", settling=settling)
        return shown
    return nullcontext(progress or None)
