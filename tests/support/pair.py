"""Two chains side by side with an unknown of their own: a model that is no single rod.

Unknowns are one entry that the equations hold at 0, then those of the first chain, then those of
the second: no stride fits them.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import numpy as np
from scipy.linalg import block_diag

from undula.arrays import Array, Nodes, State
from undula.models.chain import Chain
from undula.models.model import Energetics
from undula.models.rod.dae import RodFlow
from undula.models.units import Units


@dataclass(frozen=True)
class PairEquations:
    """Equations of two rods and of an entry c = 0 in front of them."""

    rods: tuple[RodFlow, RodFlow]

    @property
    def half_bandwidth(self) -> int:
        return max(rod.half_bandwidth for rod in self.rods)

    @property
    def differential(self) -> Any:
        return np.concatenate([[False], *(rod.differential for rod in self.rods)])

    @property
    def across(self) -> Any:
        return np.concatenate([[False], *(rod.across for rod in self.rods)])

    def split(self, y: Array) -> tuple[Array, Array]:
        first = 1 + self.rods[0].layout.size
        return y[..., 1:first], y[..., first:]

    def _each(self, function: Callable[..., Array], *vectors: Array, front: Array) -> Array:
        parts = [
            function(rod, *(np.ascontiguousarray(part) for part in given))
            for rod, given in zip(
                self.rods, zip(*map(self.split, vectors), strict=True), strict=True
            )
        ]
        return np.concatenate([front[..., None], *parts], axis=-1)

    def residual(self, y: Array, w: Array) -> Array:
        return self._each(RodFlow.residual, y, w, front=y[..., 0])

    def parts(self, y: Array, w: Array, turn: float) -> tuple[Array, Array]:
        b = self.half_bandwidth
        whole, drag = np.zeros((1, 2 * b + 1)), np.zeros((1, 2 * b + 1))
        whole[0, b] = 1.0
        bands = [
            rod.parts(*map(np.ascontiguousarray, given), turn)
            for rod, given in zip(
                self.rods, zip(self.split(y), self.split(w), strict=True), strict=True
            )
        ]
        assert all(rod.half_bandwidth == b for rod in self.rods)
        wholes, drags = zip(*bands, strict=True)
        return np.concatenate([whole, *wholes]), np.concatenate([drag, *drags])

    def turning(self, y: Array) -> tuple[Array, Array]:
        front = np.zeros(y.shape[:-1])
        return (
            self._each(lambda rod, part: rod.turning(part)[0], y, front=front),
            self._each(lambda rod, part: rod.turning(part)[1], y, front=front),
        )

    def rotated(self, y: Array, angle: float) -> Array:
        return self._each(lambda rod, part: rod.rotated(part, angle), y, front=y[..., 0])

    def mirrored(self, y: Array) -> Array:
        return self._each(RodFlow.mirrored, y, front=y[..., 0])

    def from_plane(self, y: Array) -> Array:
        ends = np.cumsum([1, *(rod.layout.links * (rod.layout.stride - 1) for rod in self.rods)])
        parts = [
            rod.from_plane(np.ascontiguousarray(y[..., start:end]))
            for rod, start, end in zip(self.rods, ends, ends[1:], strict=False)
        ]
        return np.concatenate([y[..., :1], *parts], axis=-1)

    def displacements(self, y: Array) -> Array:
        bases = [
            rod.displacements(part) for rod, part in zip(self.rods, self.split(y), strict=True)
        ]
        return np.vstack([np.zeros((1, sum(base.shape[1] for base in bases))), block_diag(*bases)])


@dataclass(frozen=True)
class Pair:
    """Two chains that do not act on one another, under forces of a fixed ratio."""

    chains: tuple[Chain, Chain]
    ratio: float = 0.2

    @property
    def load(self) -> Any:
        return self.chains[1].load

    @property
    def links(self) -> int:
        return sum(chain.links for chain in self.chains)

    @property
    def dimension(self) -> int:
        return self.chains[1].dimension

    @property
    def units(self) -> Units:
        return self.chains[1].units

    @property
    def axisymmetric(self) -> bool:
        return True

    @property
    def unwrapped(self) -> bool:
        return False

    @cached_property
    def equations(self) -> PairEquations:
        return PairEquations((self.chains[0].equations, self.chains[1].equations))

    def with_links(self, links: int) -> None:  # noqa: ARG002
        return None

    def with_(self, **changes: Any) -> Self:
        first = changes | ({"force": self.ratio * changes["force"]} if "force" in changes else {})
        chains = self.chains[0].with_(**first), self.chains[1].with_(**changes)
        return type(self)(chains, self.ratio)

    def split(self, x: Array) -> tuple[Array, Array]:
        return x[..., : self.chains[0].size], x[..., self.chains[0].size :]

    def straight(self) -> State:
        return np.concatenate([chain.straight() for chain in self.chains])

    def straight_unknowns(self) -> Array:
        return self.unknowns(self.straight())

    def unknowns(self, x: State) -> Array:
        parts = zip(self.chains, self.split(x), strict=True)
        return np.concatenate([[0.0], *(chain.unknowns(part) for chain, part in parts)])

    def positions(self, unknowns: Array) -> State:
        parts = zip(self.chains, self.equations.split(unknowns), strict=True)
        return np.concatenate([chain.positions(part) for chain, part in parts], axis=-1)

    def displaced(self, along_x: Array, along_y: Array | None = None) -> State:
        first = self.chains[0].links
        return np.concatenate(
            [
                chain.displaced(along_x[part], None if along_y is None else along_y[part])
                for chain, part in zip(self.chains, (slice(first), slice(first, None)), strict=True)
            ]
        )

    def linearised(self) -> tuple[Array, Array]:
        pairs = zip(*(chain.linearised() for chain in self.chains), strict=True)
        stiffness, drag = (block_diag(*matrices) for matrices in pairs)
        return stiffness, drag

    def joint_angles(self, unknowns: Array) -> Array:
        parts = zip(self.chains, self.equations.split(unknowns), strict=True)
        return np.concatenate([chain.joint_angles(part) for chain, part in parts], axis=-1)

    def nodes(self, x: State) -> Nodes:
        parts = zip(self.chains, self.split(x), strict=True)
        return np.concatenate([chain.nodes(part) for chain, part in parts], axis=-2)

    def rotate(self, x: State, angle: float) -> State:
        parts = zip(self.chains, self.split(x), strict=True)
        return np.concatenate([chain.rotate(part, angle) for chain, part in parts])

    def power(self, x: State) -> tuple[float, float]:
        parts = zip(self.chains, self.split(x), strict=True)
        both = np.array([chain.power(part) for chain, part in parts]).sum(axis=0)
        return float(both[0]), float(both[1])

    def observe(self, unknowns: Array) -> Energetics:
        parts = zip(self.chains, self.equations.split(unknowns), strict=True)
        first, second = (chain.observe(part) for chain, part in parts)
        return Energetics(
            *(a + b for a, b in zip(vars(first).values(), vars(second).values(), strict=True))
        )
