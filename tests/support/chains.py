"""Bead-spring chains to test claims on, random states, and a slow twin of their equations.

The twin shares nothing with the kernels. Its unknowns are the rates of turning of the links: with
unit vectors b across t_j, a link that turns by q along b displaces all beads from j on by q b / N.
The principle of virtual work projects the equations of the beads on these displacements, where no
tension does work. The elastic part is the slope of the energy, by complex steps, without step
error.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

import naive
from undula.arrays import Array, ComplexArray, Links, State
from undula.models.chain import Chain
from undula.models.loads.analytic import LinearLoad, Load, PointLoad, TipLoad
from undula.models.loads.beads import BeadLoad

#: Whatever a chain can be told; of a list with the beads' drag each takes as many as it has.
OPTIONS: Mapping[str, Mapping[str, Any]] = {
    "plain": {},
    "drag ratio": {"drag_ratio": 2.5},
    "soft clamp": {"base_spring": 0.3},
    "uneven beads": {"bead_drag": tuple(0.4 + 0.3 * (k % 5) for k in range(12))},
    "all beads pushed": {"load": BeadLoad(9.0)},
    "one bead pushed": {"load": BeadLoad(9.0, (1,))},
    "point load": {"load": PointLoad(9.0, 0.37)},
    "density": {"load": LinearLoad(9.0, 0.5)},
    "all at once": {
        "load": LinearLoad(9.0, -0.4),
        "drag_ratio": 1.7,
        "base_spring": 2.0,
        "bead_drag": tuple(2.0 - 0.15 * k for k in range(12)),
    },
}


def chain(links: int, option: str = "plain", *, confined: bool = False) -> Chain:
    """Return a chain with one of the options."""
    told = {"load": TipLoad(9.0)} | dict(OPTIONS[option])
    if "bead_drag" in told:
        told["bead_drag"] = told["bead_drag"][:links]
    return Chain(links, confined=confined, **told)


def random_state(model: Any, seed: int = 0, bend: float = 2.5) -> State:
    """Return a state whose joints turn by random angles up to `bend` [rad]."""
    random = np.random.default_rng(seed)
    tangent, links = np.eye(model.dimension)[-1], []
    for _ in range(model.links):
        across = random.normal(size=model.dimension)
        across -= (across @ tangent) * tangent
        angle = bend * random.uniform()
        tangent = np.cos(angle) * tangent + np.sin(angle) * across / np.linalg.norm(across)
        tangent = tangent / np.linalg.norm(tangent)
        links.append(tangent / model.links)
    return np.cumsum(links, axis=0).ravel()


def tangents_of(model: Chain, x: State) -> Array:
    """Return the unit vectors along the links, (N, d)."""
    nodes = np.reshape(x, (model.links, model.dimension))
    links = np.diff(nodes, axis=0, prepend=0.0)
    return links / np.linalg.norm(links, axis=1, keepdims=True)


def energy(model: Chain, tangents: Any) -> Any:
    """Return the sum of K psi^2 / 2; the tangents may be complex."""
    clamped = np.concatenate([np.eye(model.dimension)[-1:], tangents])
    difference, total = clamped[1:] - clamped[:-1], clamped[1:] + clamped[:-1]
    psi = 2.0 * np.arctan(naive.lengths(difference) / naive.lengths(total))
    springs = np.array([model.base_spring] + [1.0] * (model.links - 1))
    return (0.5 * springs * psi**2).sum()


class Work(NamedTuple):
    """The equations drag q' = pull, with the displacements of the beads that belong to q."""

    displacements: Array  # (N d, k), of the beads by each of the k rates of turning
    drag: Array  # (k, k)
    active: Array  # (k,), of the follower force
    elastic: Array  # (k,), of the springs

    @property
    def velocity(self) -> State:
        """The velocity of the beads."""
        return self.displacements @ np.linalg.solve(self.drag, self.active + self.elastic)

    def rates_of(self, velocity: State) -> Array:
        """Return the rates of turning q' with which the beads have a velocity."""
        return np.linalg.lstsq(self.displacements, velocity)[0]


def virtual_work(model: Chain, x: State) -> Work:
    """Return the equations of a chain at a state, link by link."""
    t, (n, d) = tangents_of(model, x), (model.links, model.dimension)
    columns, elastic = [], []
    for j in range(n):
        for across in np.linalg.svd(t[j : j + 1])[2][1:]:
            turned: ComplexArray = t.astype(complex)
            turned[j] += 1e-30j * across
            elastic.append(-np.imag(energy(model, turned)) / 1e-30)
            moved = np.zeros((n, d))
            moved[j:] = across / n
            columns.append(moved.ravel())
    by = np.array(columns).T
    resistance = _resistance(model, t)
    return Work(by, by.T @ resistance @ by, by.T @ _active_force(model, t), np.array(elastic))


def _resistance(model: Chain, t: Array) -> Array:
    n, d = t.shape
    matrix = np.zeros((n * d, n * d))
    weights = np.ones(n) * model.bead_drag
    for i in range(n):
        mean = t[i] + (t[i + 1] if i + 1 < n else 0.0)
        along = np.outer(mean, mean) / (mean @ mean)
        block = weights[i] * (np.eye(d) - (1.0 - 1.0 / model.drag_ratio) * along)
        matrix[d * i : d * i + d, d * i : d * i + d] = block
    return matrix


def _active_force(model: Chain, t: Array) -> Array:
    head, foot = _shares(model.load, model.links)
    force = -head[:, None] * t
    force[:-1] -= foot[1:, None] * t[1:]
    return np.asarray(force.ravel())


def _shares(load: Load, links: int) -> tuple[Links, Links]:
    if not isinstance(load, BeadLoad):
        return naive.shares(load, links)
    pushed = range(1, links + 1) if load.beads == "all" else load.beads
    parts = [load.force / len(pushed) if bead in pushed else 0.0 for bead in range(1, links + 1)]
    return np.array(parts), np.zeros(links)
