"""Tables of an input file that describe the model and its load.

Numbers are dimensionless: lengths in L, forces in B/L^2 for a filament and in K/L for a chain.
"""

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import BeforeValidator, Field, InstanceOf, PlainSerializer, model_validator

from undula.errors import InputError
from undula.inputs.table import OnlyWith, Table, conflict
from undula.models.chain import MAX_LINKS
from undula.models.filament import MAX_SEGMENTS, MIN_SEGMENTS, Filament
from undula.models.loads.analytic import TipLoad
from undula.models.loads.user_density import TableLoad
from undula.models.natural_curvature import CurvatureTable

Inextensibility = Literal["exact", "weak"]
Profile = Literal["tip", "point", "linear", "power", "table", "beads"]
#: Numbers given as a list and stored as a tuple; single numbers are not converted.
Numbers = Annotated[tuple[float, ...], Field(strict=False), PlainSerializer(list)]
PositiveNumbers = Annotated[
    tuple[Annotated[float, Field(gt=0.0)], ...], Field(strict=False), PlainSerializer(list)
]
BeadNumbers = Annotated[
    tuple[Annotated[int, Field(ge=1)], ...],
    Field(strict=False, min_length=1),
    PlainSerializer(list),
]


def _curvature(given: Any) -> Any:
    """Return a natural curvature given by lists as a `CurvatureTable`, other values unchanged."""
    if isinstance(given, list) and len(given) != 2:
        raise conflict(
            f"model.natural_curvature = {given} is no pair; give two numbers, [k1, k2], or a table"
            " of the lists s, k1, k2"
        )
    if not isinstance(given, Mapping):
        return given
    if given.keys() != {"s", "k1", "k2"}:
        raise conflict(
            f"model.natural_curvature has the keys {', '.join(map(str, given))}; give the lists s,"
            " k1, k2, or two numbers"
        )
    try:
        return CurvatureTable(**given)
    except InputError as error:
        # The message of the table uses the names of the keys.
        message = str(error).removeprefix("CurvatureTable: ")
        raise conflict(f"model.natural_curvature.{message}") from None


def _as_lists(table: CurvatureTable) -> dict[str, list[float]]:
    return {name: list(getattr(table, name)) for name in ("s", "k1", "k2")}


CurvaturePair = Annotated[tuple[float, float], Field(strict=False), PlainSerializer(list)]
GivenCurvature = Annotated[
    CurvaturePair | Annotated[InstanceOf[CurvatureTable], PlainSerializer(_as_lists)],
    BeforeValidator(_curvature),
]


class ModelTable(Table):
    """The table ``[model]``: the filament or chain.

    Attributes
    ----------
    kind
        The family of models: ``"filament"`` or ``"chain"``.
    segments
        Number of rigid links of a filament, from 4 to 2000.
    links
        Number of links of a chain, from 1 to 1000.
    drag_ratio
        Normal over tangential drag coefficient, at least 1; by default 2 for a filament and 1 for a
        chain.
    inextensibility
        ``"exact"`` with tensions, or ``"weak"`` with a large tensile stiffness; for a filament.
    tensile_stiffness
        EA L^2/B, above 0; for weak inextensibility. The default is 4 (L/a)^2 for a rod of circular
        section with a/L = 1/100.
    base_spring
        Stiffness of the spring that clamps a chain [K], above 0.
    bead_drag
        Drag of every bead of a chain, or a list with one value for each bead from the base on
        [zeta].
    confined
        True for motion in one plane.
    natural_curvature
        Curvature at rest about the two directors of a filament [1/L]: a pair, or a table of points.
        Like a bending ratio other than 1, it excludes `confined` and weak inextensibility.
    bending_ratio
        Stiffness of a filament against bending about its second director over that about the
        first, above 0.
    twist
        Model of twist of a filament: ``"paper"``, ``"rigid"`` or ``"elastic"``.
    twist_stiffness
        C/B, above 0; for elastic twist.
    spring
        Angle in the energy of a chain's joint: ``"angle"``, from 0 to pi, or ``"unwrapped"``,
        continued beyond pi, for a confined chain.
    """

    kind: Literal["filament", "chain"] = Field(
        default="filament", description="'filament' or 'chain'"
    )
    segments: int = Field(
        default=40,
        ge=MIN_SEGMENTS,
        le=MAX_SEGMENTS,
        description=f"a whole number from {MIN_SEGMENTS} to {MAX_SEGMENTS}",
    )
    links: int = Field(
        default=6, ge=1, le=MAX_LINKS, description=f"a whole number from 1 to {MAX_LINKS}"
    )
    drag_ratio: float = Field(default=2.0, ge=1.0, description="a number of at least 1")
    inextensibility: Inextensibility = Field(default="exact", description="'exact' or 'weak'")
    tensile_stiffness: float = Field(default=4e4, gt=0.0, description="a number above 0")
    base_spring: float = Field(default=1.0, gt=0.0, description="a number above 0")
    bead_drag: Annotated[float, Field(gt=0.0)] | PositiveNumbers = Field(
        default=1.0, description="a number above 0, or a list with one for each bead"
    )
    confined: bool = Field(default=False, description="true or false")
    natural_curvature: GivenCurvature = Field(
        default=(0.0, 0.0), description="a list of two numbers, or a table of the lists s, k1, k2"
    )
    bending_ratio: float = Field(default=1.0, gt=0.0, description="a number above 0")
    twist: Literal["paper", "rigid", "elastic"] = Field(
        default="rigid", description="'paper', 'rigid' or 'elastic'"
    )
    twist_stiffness: float = Field(default=1.0, gt=0.0, description="a number above 0")
    spring: Literal["angle", "unwrapped"] = Field(
        default="angle", description="'angle' or 'unwrapped'"
    )

    only_with: ClassVar[Mapping[str, OnlyWith]] = {
        "segments": OnlyWith("kind", ("filament",)),
        "links": OnlyWith("kind", ("chain",)),
        "inextensibility": OnlyWith("kind", ("filament",)),
        "tensile_stiffness": OnlyWith("inextensibility", ("weak",)),
        "natural_curvature": OnlyWith("kind", ("filament",)),
        "bending_ratio": OnlyWith("kind", ("filament",)),
        "twist": OnlyWith("kind", ("filament",)),
        "twist_stiffness": OnlyWith("twist", ("elastic",)),
        "base_spring": OnlyWith("kind", ("chain",)),
        "bead_drag": OnlyWith("kind", ("chain",)),
        "spring": OnlyWith("kind", ("chain",)),
    }

    @model_validator(mode="before")
    @classmethod
    def _beads_are_round(cls, given: Any) -> Any:
        """Make the drag ratio of a chain 1 by default."""
        if isinstance(given, Mapping) and given.get("kind") == "chain":
            return {"drag_ratio": 1.0, **given}
        return given

    @model_validator(mode="after")
    def _unwrapped_angles_lie_in_a_plane(self) -> Self:
        if self.spring == "unwrapped" and not self.confined:
            raise conflict(
                "model.spring = 'unwrapped' has no meaning in space, where no angle exceeds pi; use"
                " model.confined = true or model.spring = 'angle'"
            )
        return self

    @model_validator(mode="after")
    def _directors_are_possible(self) -> Self:
        """Refuse the values with which a filament that needs directors cannot be made."""
        directors = self.natural_curvature, self.bending_ratio
        if self.kind != "filament" or directors == ((0.0, 0.0), 1.0):
            return self  # without directors, or with a default that needs none
        try:
            Filament(
                segments=self.segments,
                load=TipLoad(0.0),
                inextensibility=self.inextensibility,
                confined=self.confined,
                natural_curvature=self.natural_curvature,
                bending_ratio=self.bending_ratio,
            )
        except InputError as error:
            # The message of the filament uses the names of the keys.
            raise conflict(f"model.{error}") from None
        return self

    @model_validator(mode="after")
    def _every_bead_has_its_drag(self) -> Self:
        if isinstance(self.bead_drag, tuple) and len(self.bead_drag) != self.links:
            raise conflict(
                f"model.bead_drag lists {len(self.bead_drag)} beads, and with model.links ="
                f" {self.links} there are {self.links}; give one number for each, or one for all"
            )
        return self


class LoadTable(Table):
    """The table ``[load]``: the follower force and its distribution.

    Attributes
    ----------
    profile
        Distribution of the force along the filament.
    force
        Total force F, at least 0. By default 75 B/L^2 for a filament, and the corresponding
        75/N K/L for a chain.
    position
        Arc length s_a of a point load [L], above 0 and at most 1.
    slope
        Slope alpha of a linear load, from -1 to 1: density F [1 + alpha (2 s - 1)].
    exponent
        Exponent p of a power load, at least 0: density F (p + 1) s^p.
    s, density
        Points of a table load: arc lengths [L], increasing from 0 to 1, and the density there in
        any unit, linear in between and scaled to the total; required for ``table``.
    beads
        Numbers of the beads of a chain that share the force equally, from 1 at the base, or
        ``"all"``; for ``beads``.
    """

    profile: Profile = Field(
        default="tip", description="'tip', 'point', 'linear', 'power', 'table' or 'beads'"
    )
    force: float = Field(default=75.0, ge=0.0, description="a number of at least 0")
    position: float = Field(
        default=1.0, gt=0.0, le=1.0, description="a number above 0 and at most 1"
    )
    slope: float = Field(default=0.0, ge=-1.0, le=1.0, description="a number from -1 to 1")
    exponent: float = Field(default=1.0, ge=0.0, description="a number of at least 0")
    s: Numbers | None = Field(default=None, description="a list of numbers, increasing from 0 to 1")
    density: Numbers | None = Field(default=None, description="a list of numbers, one for each s")
    beads: Literal["all"] | BeadNumbers = Field(
        default="all", description="'all' or a list of different whole numbers, from 1 on"
    )

    only_with: ClassVar[Mapping[str, OnlyWith]] = {
        "position": OnlyWith("profile", ("point",)),
        "slope": OnlyWith("profile", ("linear",)),
        "exponent": OnlyWith("profile", ("power",)),
        "s": OnlyWith("profile", ("table",)),
        "density": OnlyWith("profile", ("table",)),
        "beads": OnlyWith("profile", ("beads",)),
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
            # The message of the load uses the names of the keys.
            raise conflict(f"load.{str(error).removeprefix('TableLoad: ')}") from None
        return self
