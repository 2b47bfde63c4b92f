"""The tables of an input file, with the default and the range of every key.

Numbers are dimensionless: lengths in L, forces in B/L^2, times in zeta_perp L^4/B.
"""

import math
from collections.abc import Collection, Mapping
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, PlainSerializer, model_validator

from undula.errors import InputError
from undula.models.profiles import TableLoad
from undula.studies.strict_table import OnlyWith, Table, conflict

Inextensibility = Literal["exact", "weak"]
Profile = Literal["tip", "point", "linear", "power", "table"]
Shape = Literal["kicked", "straight", "planar", "helix", "mode", "state"]
LinearMethod = Literal["spectral", "modes", "discrete"]
Handedness = Literal["right", "left"]
#: A list, as TOML and JSON have it, held so that it cannot be changed; its numbers stay strict.
Numbers = Annotated[tuple[float, ...], Field(strict=False), PlainSerializer(list)]


class ModelTable(Table):
    """The table ``[model]``: what moves.

    Attributes
    ----------
    kind
        The family of models.
    segments
        Number of rigid links, at least 4.
    drag_ratio
        Normal over tangential drag coefficient, at least 1.
    inextensibility
        ``"exact"`` by tensions, or ``"weak"`` by a large tensile stiffness.
    tensile_stiffness
        EA L^2/B, above 0; read only for weak inextensibility. The default is 4 (L/a)^2 for a
        rod of circular section with a/L = 1/100.
    confined
        Whether the motion is kept in one plane.
    """

    kind: Literal["filament"] = Field(default="filament", description="'filament'")
    segments: int = Field(default=40, ge=4, description="a whole number of at least 4")
    drag_ratio: float = Field(default=2.0, ge=1.0, description="a number of at least 1")
    inextensibility: Inextensibility = Field(default="exact", description="'exact' or 'weak'")
    tensile_stiffness: float = Field(default=4e4, gt=0.0, description="a number above 0")
    confined: bool = Field(default=False, description="true or false")

    only_with: ClassVar[Mapping[str, OnlyWith]] = {
        "tensile_stiffness": OnlyWith("inextensibility", ("weak",)),
    }


class LoadTable(Table):
    """The table ``[load]``: the follower force and where it acts.

    Attributes
    ----------
    profile
        How the force is spread along the filament.
    force
        Total force F in B/L^2, at least 0.
    position
        Arclength s_a of a point load in L, above 0 and at most 1.
    slope
        Slope alpha of a linear load, from -1 to 1: density F [1 + alpha (2 s - 1)].
    exponent
        Exponent p of a power load, at least 0: density F (p + 1) s^p.
    s, density
        The points of a table load: arclengths in L, increasing from 0 to 1, and the density at
        each of them in any unit, linear in between and scaled to the total; for ``table``, which
        cannot do without.
    """

    profile: Profile = Field(
        default="tip", description="'tip', 'point', 'linear', 'power' or 'table'"
    )
    force: float = Field(default=75.0, ge=0.0, description="a number of at least 0")
    position: float = Field(
        default=1.0, gt=0.0, le=1.0, description="a number above 0 and at most 1"
    )
    slope: float = Field(default=0.0, ge=-1.0, le=1.0, description="a number from -1 to 1")
    exponent: float = Field(default=1.0, ge=0.0, description="a number of at least 0")
    s: Numbers | None = Field(default=None, description="a list of numbers, increasing from 0 to 1")
    density: Numbers | None = Field(default=None, description="a list of numbers, one for each s")

    only_with: ClassVar[Mapping[str, OnlyWith]] = {
        "position": OnlyWith("profile", ("point",)),
        "slope": OnlyWith("profile", ("linear",)),
        "exponent": OnlyWith("profile", ("power",)),
        "s": OnlyWith("profile", ("table",)),
        "density": OnlyWith("profile", ("table",)),
    }

    @model_validator(mode="after")
    def _table_is_a_load(self) -> Self:
        if self.profile != "table":
            return self
        if self.s is None or self.density is None:
            missing = "load.s" if self.s is None else "load.density"
            raise conflict(
                f"load.profile = 'table' needs {missing}; give load.s and load.density as lists of"
                " numbers of one length"
            )
        try:
            TableLoad(self.force, self.s, self.density)
        except InputError as error:
            # The load names its values as the keys are named.
            raise conflict(f"load.{str(error).removeprefix('TableLoad: ')}") from None
        return self

    @property
    def text(self) -> str:
        """The load in a few words, such as ``point force 75 at s = 0.8``."""
        return self.tell()

    def tell(self, swept: Collection[str] = ()) -> str:
        """Return the load in a few words, without the keys that a curve sweeps over."""
        head = (
            f"{self.profile} load"
            if "force" in swept
            else f"{self.profile} force {self.force:.12g}"
        )
        details = {
            "position": f" at s = {self.position:.12g}",
            "slope": f", slope {self.slope:.12g}",
            "exponent": f", exponent {self.exponent:.12g}",
            "s": f" ({len(self.s or ())} points)",
        }
        told = [text for key, text in details.items() if key in self.dump() and key not in swept]
        return head + "".join(told)


class StartTable(Table):
    """The table ``[start]``: the shape at time 0.

    Attributes
    ----------
    shape
        The family of starts.
    amplitude
        Largest inclination to the axis, radians, above 0 and at most pi; for ``state`` a factor
        on the stored inclinations instead, 1 unless given; not for ``straight``.
    seed
        Seed of the random kick, from 0 to 2^63 - 1; for ``kicked``.
    angle
        Azimuth of the plane of the start, radians; for ``planar`` and ``mode``, and 0 for a
        confined model.
    handedness
        Sense of the helix, ``"right"`` or ``"left"``; for ``helix``.
    file
        Result file whose last state is the start, relative to the working folder; for ``state``,
        which cannot do without.
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
    """The table ``[time]``: how long, and how exactly.

    Attributes
    ----------
    until
        Time at which the run ends, above 0, or ``"settled"``: until the motion repeats itself.
    limit
        Time at which a run to ``"settled"`` gives up, above 0.
    samples
        Number of stored times, at least 2.
    rtol
        Error tolerance of a step relative to the inclination of the filament, from 1e-12 to 1e-2.
    atol
        Absolute error tolerance of a step, radians, above 0.
    """

    until: Annotated[float, Field(gt=0.0)] | Literal["settled"] = Field(
        default=1.0, description="a number above 0 or 'settled'"
    )
    limit: float = Field(default=10.0, gt=0.0, description="a number above 0")
    samples: int = Field(default=4000, ge=2, description="a whole number of at least 2")
    rtol: float = Field(default=1e-6, ge=1e-12, le=1e-2, description="a number from 1e-12 to 1e-2")
    atol: float = Field(default=1e-10, gt=0.0, description="a number above 0")

    only_with: ClassVar[Mapping[str, OnlyWith]] = {"limit": OnlyWith("until", ("settled",))}


class StabilityTable(Table):
    """The table ``[stability]``: how the straight state is judged.

    Attributes
    ----------
    method
        ``"spectral"`` on polynomials, ``"modes"`` on the paper's assumed modes, ``"discrete"`` for
        the links as they are; by default spectral wherever links stand for a continuous filament.
    paper_time
        Whether rates and frequencies are given as the paper's printed equation has them, smaller
        by the drag ratio.
    """

    method: LinearMethod | None = Field(
        default=None, description="'spectral', 'modes' or 'discrete'"
    )
    paper_time: bool = Field(default=False, description="true or false")
