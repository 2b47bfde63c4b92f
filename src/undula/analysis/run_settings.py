"""How long a run goes on, what it samples, how exactly it computes, and how it may end."""

import math
from dataclasses import dataclass
from enum import Enum
from typing import Literal

import numpy as np

from undula.errors import InputError, is_number
from undula.models.model import Model
from undula.numerics.integration.schemes import NDF
from undula.numerics.integration.step import Options, options

#: More samples than this are a slip of the finger; what of fewer does not fit in the memory of the
#: machine is refused besides (`room`).
MOST_SAMPLES = 1_000_000_000
#: Tolerances of a step beyond which an error of a hundredth, of the motion or of a radian, would
#: pass in each. Below the least rtol there is round-off alone.
LEAST_RTOL, MOST_RTOL, MOST_ATOL = 1e-12, 1e-2, 1e-2
#: First interval of a run to the settled state, as a part of the one of a run over one time unit.
FINER = 0.25
#: Longest step of a run to the settled state, as a part of its limit: the looks must not be too
#: rare.
LONGEST_STEP = 0.01
#: A matrix serves until a node has moved by this part of the length (docs/notes/stepping.md).
STALE_AFTER = 0.01


class Ending(Enum):
    """Why a run is where it is."""

    RUNNING = "running"
    DONE = "done"
    SETTLED = "settled"
    SOLVED = "solved"
    IRREGULAR = "irregular"
    LIMIT = "limit reached"
    INTERRUPTED = "interrupted"
    OUT_OF_TIME = "out of time"
    FAILED = "failed"


@dataclass(frozen=True)
class Schedule:
    """How long a run goes on, what it samples, and how exactly it computes.

    Attributes
    ----------
    until : float, "settled" or "solved"
        Time at which the run ends [T]; or until it repeats itself; or until then at the latest, or
        until Newton's method finds a stable state next to it.
    limit : float
        Time at which a run to the settled state gives up [T].
    samples : int
        Number of samples, ends included, from 2 to 10^9; a run to the settled state has up to twice
        as many.
    rtol, atol : float
        Error tolerance of a step: of the tangents, relative to their RMS inclination to the axis,
        from 1e-12 to 1e-2, and absolute [rad], above 0 and at most 1e-2.
    """

    until: float | Literal["settled", "solved"] = 1.0
    limit: float = 10.0
    samples: int = 4000
    rtol: float = 1e-6
    atol: float = 1e-10

    def __post_init__(self) -> None:
        """Refuse values that make no run."""
        if isinstance(self.until, str):
            known = self.open_ended
        else:
            known = is_number(self.until) and self.until > 0.0
        if not known:
            raise InputError(
                f"until = {self.until!r} has to be a positive number, 'settled' or 'solved'"
            )
        if not (is_number(self.limit) and self.limit > 0.0):
            raise InputError(f"limit = {self.limit!r} has to be a positive finite number")
        if not (is_number(self.rtol) and LEAST_RTOL <= self.rtol <= MOST_RTOL):
            raise InputError(
                f"rtol = {self.rtol!r} has to be a number from {LEAST_RTOL:g} to {MOST_RTOL:g}"
            )
        if not (is_number(self.atol) and 0.0 < self.atol <= MOST_ATOL):
            raise InputError(
                f"atol = {self.atol!r} has to be a number above 0 and at most {MOST_ATOL:g}"
            )
        whole = isinstance(self.samples, int | np.integer) and not isinstance(self.samples, bool)
        if not (whole and 2 <= self.samples <= MOST_SAMPLES):
            raise InputError(
                f"samples = {self.samples!r} has to be a whole number from 2 to {MOST_SAMPLES}"
            )

    @property
    def open_ended(self) -> bool:
        """Whether the run itself tells when it ends, before a limit."""
        return self.until in ("settled", "solved")

    @property
    def end(self) -> float:
        """Time at which the run ends at the latest [T]."""
        return self.limit if self.open_ended else float(self.until)

    @property
    def interval(self) -> float:
        """First interval between samples [T]."""
        if self.open_ended:
            return FINER / (self.samples - 1)
        return float(self.until) / (self.samples - 1)

    def options(self, model: Model) -> Options:
        """Return the options of the stepper for this run of `model`."""
        return options(
            NDF,
            model.position_mask,
            np.where(model.position_mask == 1.0, model.straight_unknowns(), 0.0),
            rtol=self.rtol,
            atol=self.atol,
            stale_after=STALE_AFTER,
            longest_step=LONGEST_STEP * self.limit if self.open_ended else math.inf,
            frame=model.dimension == 3 and model.axisymmetric,
        )
