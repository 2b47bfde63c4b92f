"""The elastic filament: a linked rod with half cells at its ends, of second order in 1/segments."""

import math
import reprlib
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, Self

import numpy as np

from undula.arrays import Array, Links, State
from undula.errors import InputError, is_number
from undula.models.directors import directors_of, unbent_links
from undula.models.linked_rod import LinkedRod
from undula.models.loads.analytic import DensityLoad
from undula.models.natural_curvature import (
    NaturalCurvature,
    mean_over_pieces,
    require_below_pi,
    validated,
)
from undula.models.rod.tables import (
    DirectedRod,
    ExtensiblePlanarRod,
    ExtensibleSpatialRod,
    PlainRod,
    PlanarRod,
    Rod,
    SpatialRod,
)
from undula.models.units import FILAMENT_UNITS, Units

#: EA L^2 / B = 4 (L/a)^2 of a round filament with a/L = 1/100.
TENSILE_STIFFNESS = 4e4
#: Beyond the largest number, errors of order 1/segments^2 are below those of the steps in time.
MIN_SEGMENTS, MAX_SEGMENTS = 4, 2000

_RODS: dict[tuple[str, bool], type[PlainRod]] = {
    ("exact", False): SpatialRod,
    ("exact", True): PlanarRod,
    ("weak", False): ExtensibleSpatialRod,
    ("weak", True): ExtensiblePlanarRod,
}


@dataclass(frozen=True)
class Filament(LinkedRod):
    """A clamped-free elastic filament in viscous fluid under an axial follower force.

    Parameters
    ----------
    segments : int
        Number of links, from 4 to 2000. Errors fall as 1/segments^2.
    load : DensityLoad
        The axial follower force, see `undula.models.loads.analytic`.
    drag_ratio : float
        Normal over tangential drag coefficient, gamma, at least 1.
    inextensibility : {"exact", "weak"}
        Rigid links, or extensible links of a large tensile stiffness.
    tensile_stiffness : float
        EA L^2 / B of the weak form, positive; without effect for the exact form.
    confined : bool
        Confine the motion to the x-z plane.
    natural_curvature : tuple of float, CurvatureTable or callable
        Components k1, k2 of the curvature at rest [1/L] about the material directors d1 and d2,
        which are e_x and e_y at the clamp: constant, a table, or a function from arc lengths (n,)
        to (k1, k2), see `undula.models.natural_curvature`.
    bending_ratio : float
        Stiffness against bending about d2 over that about d1, which is B; positive.
    twist : {"paper", "rigid", "elastic"}
        Treatment of twist for a curved or anisotropic filament: no twist, with the twist moment
        dropped from the forces, as in the paper; no twist, with the moment as constraint; or a
        finite stiffness. Without effect for a straight isotropic filament, which does not twist.
    twist_stiffness : float
        C/B of the elastic twist, positive; without effect for the other two.
    keep_directors : bool
        Include directors in the unknowns even if they are not needed, for a family of filaments
        some of which need them.

    Raises
    ------
    InputError
        A value is out of its range, or two values exclude each other.

    References
    ----------
    Ling, Guo & Kanso (2018), J. R. Soc. Interface 15: the model, with half cells added at the ends.

    Examples
    --------
    >>> import undula as un
    >>> model = un.Filament(segments=20, load=un.TipLoad(75.0))
    >>> model.links, model.units.force
    (20, 'B/L^2')
    """

    segments: int
    load: DensityLoad
    drag_ratio: float = 2.0
    inextensibility: Literal["exact", "weak"] = "exact"
    tensile_stiffness: float = TENSILE_STIFFNESS
    confined: bool = False
    natural_curvature: NaturalCurvature = (0.0, 0.0)
    bending_ratio: float = 1.0
    twist: Literal["paper", "rigid", "elastic"] = "rigid"
    twist_stiffness: float = 1.0
    keep_directors: bool = False

    def __post_init__(self) -> None:
        """Check the values."""
        if (
            isinstance(self.segments, bool)
            or not isinstance(self.segments, int | np.integer)
            or not MIN_SEGMENTS <= self.segments <= MAX_SEGMENTS
        ):
            raise InputError(
                f"segments = {self.segments!r} makes no filament;"
                f" give a whole number from {MIN_SEGMENTS} to {MAX_SEGMENTS}"
            )
        if not isinstance(self.load, DensityLoad):
            raise InputError(
                f"load = {self.load!r} is no load that a filament can bear; give one such as"
                " TipLoad(75.0)"
            )
        if not (is_number(self.drag_ratio) and self.drag_ratio >= 1.0):
            raise InputError(
                f"drag_ratio = {self.drag_ratio!r} has to be a finite number, at least 1"
            )
        if not isinstance(self.confined, bool):
            raise InputError(f"confined = {self.confined!r} has to be True or False")
        if self.inextensibility not in ("exact", "weak"):
            raise InputError(
                f"inextensibility = {self.inextensibility!r} has to be 'exact' or 'weak'"
            )
        if not (is_number(self.tensile_stiffness) and self.tensile_stiffness > 0.0):
            raise InputError(
                f"tensile_stiffness = {self.tensile_stiffness!r} has to be a positive finite number"
            )
        self._check_directors()

    def _check_directors(self) -> None:
        object.__setattr__(self, "natural_curvature", validated(self.natural_curvature))
        for name in ("bending_ratio", "twist_stiffness"):
            value = getattr(self, name)
            if not (is_number(value) and value > 0.0):
                raise InputError(f"{name} = {value!r} has to be a positive finite number")
        if self.twist not in ("paper", "rigid", "elastic"):
            raise InputError(f"twist = {self.twist!r} has to be 'paper', 'rigid' or 'elastic'")
        if not self.material_frame:
            return
        require_below_pi(self.natural_curvature, self.segments, MAX_SEGMENTS)
        what = "natural_curvature" if self.piece_curvature.any() else "bending_ratio"
        what = what if self.without_rotational_symmetry else "keep_directors"
        for other, wanted in (("confined", False), ("inextensibility", "exact")):
            if getattr(self, other) != wanted:
                raise InputError(
                    f"{what} = {reprlib.repr(getattr(self, what))} does not go with {other} ="
                    f" {getattr(self, other)!r}; use {other} = {wanted!r}"
                )

    @cached_property
    def piece_curvature(self) -> Array:
        """Natural curvature (N + 1, 2) [1/L] of the pieces of the joints, and of the end piece.

        Pieces end at the middles of links; the end piece is the outer half of the last link.
        """
        return mean_over_pieces(self.natural_curvature, self.segments)

    @cached_property
    def without_rotational_symmetry(self) -> bool:
        """True with natural curvature or anisotropic bending: no symmetry about the axis."""
        return self.bending_ratio != 1.0 or bool(self.piece_curvature.any())

    @property
    def material_frame(self) -> bool:
        """True if directors are among the unknowns; no rotations about the axis are then used."""
        return self.keep_directors or self.without_rotational_symmetry

    @cached_property
    def system(self) -> Rod:
        """The tables, with half cells at both ends, which make them second-order accurate."""
        n, h = self.segments, 1.0 / self.segments
        joint, weight = np.full(n, 1.0 / h), np.full(n, h)
        joint[0], weight[-1] = 2.0 / h, 0.5 * h
        outer_force, inner_force = self.load.shares(n)
        tensile = math.inf if self.inextensibility == "exact" else self.tensile_stiffness
        tables = (joint, weight, outer_force, inner_force, h, 1.0 - 1.0 / self.drag_ratio, tensile)
        if not self.material_frame:
            return _RODS[self.inextensibility, self.confined](*tables)
        natural = self.piece_curvature[:-1] / joint[:, None]
        tip = self._last_load_direction(outer_force, inner_force)
        compliance = 1.0 / self.twist_stiffness if self.twist == "elastic" else 0.0
        transmitted = 0.0 if self.twist == "paper" else 1.0
        return DirectedRod(*tables, natural, self.bending_ratio, compliance, transmitted, tip)

    def _last_load_direction(self, outer_force: Links, inner_force: Links) -> Array:
        """Return the tangent at the last link's load: components (3,) on directors and tangent.

        There is no bending moment there, so that the curvature is the natural curvature.
        """
        total = outer_force[-1] + inner_force[-1]
        load_offset = np.clip(outer_force[-1] / total, 0.0, 1.0) - 0.5 if total != 0.0 else 0.0
        turn = load_offset / self.segments * self.piece_curvature[-1]
        angle = np.hypot(*turn)
        components = np.sinc(angle / np.pi) * turn
        return np.array([components[1], -components[0], np.cos(angle)])

    @property
    def links(self) -> int:
        """Number of links."""
        return self.segments

    @property
    def units(self) -> Units:
        """Units of the model's numbers."""
        return FILAMENT_UNITS

    @property
    def continuum_load(self) -> DensityLoad | None:
        """The load of the continuous filament that rigid links approximate.

        None for extensible links, natural curvature or anisotropic bending.
        """
        return (
            self.load
            if self.inextensibility == "exact" and not self.without_rotational_symmetry
            else None
        )

    def linearised(self) -> tuple[Array, Array]:
        """Return stiffness and drag (N, N) of small displacements of the straight filament.

        Raises
        ------
        InputError
            The filament has natural curvature or anisotropic bending.
        """
        if self.without_rotational_symmetry:
            raise InputError(
                "small motions about the straight state are those of a filament without natural"
                " curvature that bends alike about both directors: use natural_curvature = (0, 0)"
                " and bending_ratio = 1, or ask for its equilibrium, its threshold onset, or a"
                " periodic motion"
            )
        bare = replace(self, keep_directors=False) if self.keep_directors else self
        return super(Filament, bare).linearised()

    def rest(self) -> State:
        """Return the state without bending moments, the equilibrium without a load."""
        if not isinstance(self.system, DirectedRod):
            return self.straight()
        tangents = np.cumsum(unbent_links(self.system.natural), axis=0)
        return self.from_nodes(np.concatenate([np.zeros((1, 3)), tangents]) * self.system.link)

    def reflect(self, x: State) -> State:
        """Return the state reflected in the plane x = 0; InputError if that is not a symmetry."""
        if self.piece_curvature[:, 1].any():
            raise InputError(
                "a filament with natural curvature about its second director is no mirror image of"
                " itself; give it curvature about the first one alone"
            )
        return super().reflect(x)

    def directors(self, unknowns: Array) -> Array:
        """Return the directors of each link; of a link that twists, those of its lower half.

        Parameters
        ----------
        unknowns : ndarray, shape (..., n)
            Vectors of unknowns.

        Returns
        -------
        ndarray, shape (..., N, 3, 3)
            (d1, d2, t) as rows, right-handed, orthonormal to round-off; d1 is e_x at the clamp.
        """
        turns = np.zeros((*unknowns.shape[:-1], self.links))
        if isinstance(self.system, DirectedRod):
            twist = self.system.compliance * self.system.link * self.twist_moments(unknowns)
            turns[..., 1:] = np.cumsum(twist, axis=-1)[..., :-1]
        return directors_of(self.nodes(self.positions(unknowns)), turns)

    def twist_moments(self, unknowns: Array) -> Array:
        """Return the twist moments (..., N) [B/L] of links, from unknowns (..., n).

        With twist = "paper" they are computed, but dropped from the forces.
        """
        by_node = self.equations.layout.by_node(unknowns)
        if isinstance(self.system, DirectedRod):
            return np.asarray(by_node[..., -1])
        return np.zeros(by_node.shape[:-1])

    def with_links(self, links: int) -> Self | None:
        """Return the same filament made of another number of segments."""
        return replace(self, segments=links)
