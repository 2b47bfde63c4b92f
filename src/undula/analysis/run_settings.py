"""Settings of a run: its length, its samples, its tolerances and the ways in which it may end."""

import math
from dataclasses import dataclass
from enum import Enum
from typing import Literal

import numpy as np

from undula.errors import InputError, is_number
from undula.models.model import Model
from undula.numerics.integration.schemes import NDF
from undula.numerics.integration.step import Options, options

#: Largest number of samples; more are a typing error. Fewer that do not fit in memory are refused
#: in `undula.analysis.runs.memory_needed`.
MAX_SAMPLES = 1_000_000_000
#: Range of the relative tolerance of a step, and largest absolute one [rad]. Above the upper bounds
#: each step may be wrong by a hundredth; below the lower one round-off dominates.
MIN_RTOL, MAX_RTOL, MAX_ATOL = 1e-12, 1e-2, 1e-2
#: Time over which an open-ended run first distributes its samples [T].
FIRST_SPAN = 0.25
#: Longest step of an open-ended run as a share of its limit, so that its state is checked often.
MAX_STEP_SHARE = 0.01
#: Displacement of a node after which the Newton matrix is renewed [L] (docs/notes/stepping.md).
MAX_STALE_DISPLACEMENT = 0.01


class Ending(Enum):
    """Reason for which a run ended, or RUNNING."""

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
    """Length, number of samples and tolerances of a run.

    Attributes
    ----------
    until : float, "settled" or "solved"
        Time at which the run ends [T], positive. "settled": the run ends when the motion repeats
        itself. "solved": it also ends when Newton's method finds a stable state next to it.
    limit : float
        Latest end of a run until "settled" or "solved" [T], positive.
    samples : int
        Number of samples, both ends included, from 2 to 10^9; a run until "settled" or "solved" has
        up to twice as many.
    rtol : float
        Relative error tolerance of a step, from 1e-12 to 1e-2: of the tangents, relative to their
        RMS inclination to the axis.
    atol : float
        Absolute error tolerance of a step [rad], above 0 and at most 1e-2.

    Raises
    ------
    InputError
        A value is out of its range.
    """

    until: float | Literal["settled", "solved"] = 1.0
    limit: float = 10.0
    samples: int = 4000
    rtol: float = 1e-6
    atol: float = 1e-10

    def __post_init__(self) -> None:
        """Refuse values out of their range."""
        if isinstance(self.until, str):
            valid = self.open_ended
        else:
            valid = is_number(self.until) and self.until > 0.0
        if not valid:
            raise InputError(
                f"until = {self.until!r} has to be a positive number, 'settled' or 'solved'"
            )
        if not (is_number(self.limit) and self.limit > 0.0):
            raise InputError(f"limit = {self.limit!r} has to be a positive finite number")
        if not (is_number(self.rtol) and MIN_RTOL <= self.rtol <= MAX_RTOL):
            raise InputError(
                f"rtol = {self.rtol!r} has to be a number from {MIN_RTOL:g} to {MAX_RTOL:g}"
            )
        if not (is_number(self.atol) and 0.0 < self.atol <= MAX_ATOL):
            raise InputError(
                f"atol = {self.atol!r} has to be a number above 0 and at most {MAX_ATOL:g}"
            )
        whole = isinstance(self.samples, int | np.integer) and not isinstance(self.samples, bool)
        if not (whole and 2 <= self.samples <= MAX_SAMPLES):
            raise InputError(
                f"samples = {self.samples!r} has to be a whole number from 2 to {MAX_SAMPLES}"
            )

    @property
    def open_ended(self) -> bool:
        """True if the run ends by its own state, at the limit at the latest."""
        return self.until in ("settled", "solved")

    @property
    def end(self) -> float:
        """Latest time at which the run ends [T]."""
        return self.limit if self.open_ended else float(self.until)

    @property
    def interval(self) -> float:
        """First interval between samples [T]."""
        if self.open_ended:
            return FIRST_SPAN / (self.samples - 1)
        return float(self.until) / (self.samples - 1)

    def options(self, model: Model) -> Options:
        """Return the options of the time stepper for a run of a model.

        Parameters
        ----------
        model : Model
            Model of the filament or chain.

        Returns
        -------
        Options
        """
        return options(
            NDF,
            model.position_mask,
            np.where(model.position_mask == 1.0, model.straight_unknowns(), 0.0),
            rtol=self.rtol,
            atol=self.atol,
            stale_after=MAX_STALE_DISPLACEMENT,
            longest_step=MAX_STEP_SHARE * self.limit if self.open_ended else math.inf,
            frame=model.dimension == 3 and model.axisymmetric,
        )
