"""Tables of an input file for the work on a model: start, time and stability.

Numbers are dimensionless: times in zeta_perp L^4/B for a filament, in zeta L^2/K for a chain.
"""

import math
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, model_validator

from undula.analysis.run_settings import MAX_ATOL, MAX_RTOL, MAX_SAMPLES, MIN_RTOL
from undula.inputs.table import OnlyWith, Table, conflict

Shape = Literal["kicked", "straight", "planar", "helix", "mode", "state"]
LinearMethod = Literal["spectral", "modes", "discrete"]
Handedness = Literal["right", "left"]


class StartTable(Table):
    """The table ``[start]``: the shape at time 0.

    Attributes
    ----------
    shape
        Kind of the start.
    amplitude
        Largest inclination to the axis [rad], above 0 and at most pi; for ``state`` a factor on the
        stored inclinations, by default 1; not for ``straight``.
    seed
        Seed of the random kick, from 0 to 2^63 - 1; for ``kicked``.
    angle
        Azimuth of the plane of the start [rad]; for ``planar`` and ``mode``, and 0 for a confined
        model.
    handedness
        Sense of the helix, ``"right"`` or ``"left"``; for ``helix``.
    file
        Result file whose last state is the start, relative to the working folder; required for
        ``state``.
    """

    shape: Shape = Field(
        default="kicked",
        description="'kicked', 'straight', 'planar', 'helix', 'mode' or 'state'",
    )
    amplitude: float = Field(
        default=1e-2, gt=0.0, le=math.pi, description="a number above 0 and at most pi"
    )
    seed: int = Field(default=1, ge=0, lt=2**63, description="a whole number from 0 to 2^63 - 1")
    angle: float = Field(default=0.0, description="a finite number (radians)")
    handedness: Handedness = Field(default="right", description="'right' or 'left'")
    file: str | None = Field(default=None, min_length=1, description="the name of a result file")

    only_with: ClassVar[Mapping[str, OnlyWith]] = {
        "amplitude": OnlyWith("shape", ("kicked", "planar", "helix", "mode", "state")),
        "seed": OnlyWith("shape", ("kicked",)),
        "angle": OnlyWith("shape", ("planar", "mode")),
        "handedness": OnlyWith("shape", ("helix",)),
        "file": OnlyWith("shape", ("state",)),
    }

    @model_validator(mode="before")
    @classmethod
    def _state_is_taken_as_it_is(cls, given: Any) -> Any:
        if isinstance(given, Mapping) and given.get("shape") == "state":
            return {"amplitude": 1.0, **given}
        return given

    @model_validator(mode="after")
    def _state_has_a_file(self) -> Self:
        if self.shape == "state" and self.file is None:
            raise conflict(
                "start.shape = 'state' needs start.file; give start.file = the name of a result"
                " file"
            )
        return self


class TimeTable(Table):
    """The table ``[time]``: duration, samples and tolerances.

    Attributes
    ----------
    until
        Time at which the run ends, above 0; or ``"settled"``, when the motion recurs; or
        ``"solved"``, the same or as soon as the motion approaches a stable straight or spinning
        state that is solved for, whose name and numbers the result then has. By default 1 for a
        filament, and the corresponding N^2 for a chain.
    limit
        Longest time of a run to ``"settled"`` or ``"solved"``, above 0. By default 10 for a
        filament, and 10 N^2 for a chain.
    samples
        Number of stored times, from 2 to 10^9.
    rtol
        Error tolerance of a step relative to the inclination of the filament, from 1e-12 to 1e-2.
    atol
        Absolute error tolerance of a step [rad], above 0 and at most 1e-2.
    """

    until: Annotated[float, Field(gt=0.0)] | Literal["settled", "solved"] = Field(
        default=1.0, description="a number above 0, 'settled' or 'solved'"
    )
    limit: float = Field(default=10.0, gt=0.0, description="a number above 0")
    samples: int = Field(
        default=4000, ge=2, le=MAX_SAMPLES, description=f"a whole number from 2 to {MAX_SAMPLES}"
    )
    rtol: float = Field(
        default=1e-6,
        ge=MIN_RTOL,
        le=MAX_RTOL,
        description=f"a number from {MIN_RTOL:g} to {MAX_RTOL:g}",
    )
    atol: float = Field(
        default=1e-10,
        gt=0.0,
        le=MAX_ATOL,
        description=f"a number above 0 and at most {MAX_ATOL:g}",
    )

    only_with: ClassVar[Mapping[str, OnlyWith]] = {
        "limit": OnlyWith("until", ("settled", "solved"))
    }


class StabilityTable(Table):
    """The table ``[stability]``: method of the stability analysis of the straight state.

    Attributes
    ----------
    method
        ``"spectral"`` with polynomials, ``"modes"`` with the assumed modes of the paper,
        ``"discrete"`` for the links themselves; by default spectral wherever links represent a
        continuous filament.
    paper_time
        If true, rates and frequencies are in the time unit of the paper's printed equation, and
        thus smaller by the drag ratio.
    """

    method: LinearMethod | None = Field(
        default=None, description="'spectral', 'modes' or 'discrete'"
    )
    paper_time: bool = Field(default=False, description="true or false")
