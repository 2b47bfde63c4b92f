"""Motions made by hand, whose right name is known, sampled as a run samples them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from undula.arrays import Array

Complex = NDArray[np.complex128]

ARC = np.linspace(0.0, 1.0, 21)
#: A bent shape, twisted about the axis, and how its tip half swings.
BENT = 0.3 * ARC**2 * np.exp(0.8j * ARC)
SWING = ARC * np.exp(-1.3j * ARC)


@dataclass(frozen=True)
class Clock:
    """Sampling: so many periods of unit time, and samples in each."""

    periods: float = 40.0
    samples: float = 48.0

    @property
    def time(self) -> Array:
        return np.arange(round(self.periods * self.samples) + 1) / self.samples


@dataclass(frozen=True)
class Moved:
    """A motion as `first_verdict` takes it."""

    time: Array
    nodes: Array
    energy: Array
    angle: Array

    @property
    def data(self) -> tuple[Array, Array, Array, Array]:
        return self.time, self.nodes, self.energy, self.angle


def line(time: Array, sides: Complex | Array, noise: float = 0.0, seed: int = 0) -> Moved:
    """An inextensible line with nodes at these transverse places (m, N + 1), with noise [L]."""
    random = np.random.default_rng(seed)
    sides = sides + noise * random.normal(size=(*sides.shape, 2)) @ [1.0, 1.0j]
    arc = np.linspace(0.0, 1.0, sides.shape[1])
    slopes = np.diff(sides, axis=1) / arc[1]
    heights = np.cumsum(1.0 - 0.5 * np.abs(slopes) ** 2, axis=1) * arc[1]
    bends = np.diff(slopes, axis=1)
    return _moved(time, sides, heights, 0.5 * np.sum(np.abs(bends) ** 2, axis=1) / arc[1])


def chain(time: Array, links: Array) -> Moved:
    """A chain whose links point this way (m, N, 3), unit vectors."""
    nodes = np.cumsum(links, axis=1) / links.shape[1]
    before = np.concatenate([np.broadcast_to([0.0, 0.0, 1.0], links[:, :1].shape), links], axis=1)
    cosine = np.clip(np.sum(before[:, 1:] * before[:, :-1], axis=2), -1.0, 1.0)
    energy = 0.5 * np.sum(np.arccos(cosine) ** 2, axis=1)
    sides = np.pad(nodes[..., 0] + 1j * nodes[..., 1], ((0, 0), (1, 0)))
    return _moved(time, sides, nodes[..., 2], energy)


def _moved(time: Array, sides: Complex | Array, heights: Array, energy: Array) -> Moved:
    nodes = np.zeros((*sides.shape, 3))
    nodes[..., 0], nodes[..., 1], nodes[:, 1:, 2] = sides.real, sides.imag, heights
    turns = np.angle(np.sum(sides[1:] * sides[:-1].conj(), axis=1))
    return Moved(time, nodes, energy, np.append(0.0, np.cumsum(turns)))


def turned(sides: Complex | Array, cycles: Array | float) -> Complex:
    """Turn places (m, N + 1) about the axis by so many cycles (m,) or by one number."""
    return np.asarray(sides * np.exp(2j * np.pi * np.reshape(cycles, (-1, 1))))


def wave(time: Array, overtone: float = 0.1) -> Array:
    """A wave in the x-z plane, one beat a unit of time."""
    phase = 2.0 * np.pi * time[:, None]
    return np.asarray(
        0.3 * ARC**2 * np.cos(phase - 2.0 * ARC)
        + 0.3 * overtone * ARC**3 * np.cos(3.0 * phase - 4.0 * ARC + 1.0)
    )


def modulated(time: Array, *cycles: tuple[float, float]) -> Complex:
    """The bent shape, modulated by so much at so many cycles a unit of time."""
    total = np.zeros((time.size, ARC.size), dtype=complex)
    for depth, rate in cycles:
        total += depth * np.cos(2.0 * np.pi * rate * time)[:, None] * SWING
    return BENT * (1.0 + total)


def figure_of_eight(time: Array, width: float) -> Complex:
    """To and fro in x while it goes twice to and fro in y, by a part of that."""
    phase = 2.0 * np.pi * time[:, None]
    return np.asarray(
        0.3 * ARC**2 * (np.cos(phase - ARC) + 1j * width * np.sin(2.0 * phase - 1.5 * ARC))
    )


def ellipse(time: Array, width: float) -> Complex:
    """Round an ellipse whose axes have this ratio, once a unit of time."""
    phase = 2.0 * np.pi * time[:, None] - ARC
    return np.asarray(0.3 * ARC**2 * (np.cos(phase) + 1j * width * np.sin(phase)))


def pointing(polar: Array | float, azimuth: Array | float) -> Array:
    """Unit vectors (..., 3) at these angles from the z axis and about it [rad]."""
    polar, azimuth = np.broadcast_arrays(polar, azimuth)
    across = np.sin(polar)
    return np.stack([across * np.cos(azimuth), across * np.sin(azimuth), np.cos(polar)], axis=-1)


def windmill(time: Array, links: int, mills: int, precession: float = 0.0) -> Moved:
    """A chain whose last links turn over and over, one turn a unit of time, the others spinning."""
    phase = 2.0 * np.pi * time
    lower = [pointing(0.4 * (i + 1) / links, 0.7 * phase) for i in range(links - mills)]
    upper = [pointing(phase - 0.3 * i, 0.5 + precession * phase) for i in range(mills)]
    return chain(time, np.stack(lower + upper, axis=1))
