"""Motions that are exactly known for a discretisation, and how far a computed one is off.

Both motions are periodic and solved for as such, to round-off (spinning) or some 1e-9 (flapping),
by undula and for the very discretisation that a solver integrates: for the textbook's a filament
with the same tables. `disagreement` of the two right-hand sides is round-off. A trajectory is then
compared with the exact motion instead of with somebody's trajectory at a tight tolerance.
"""

from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

import undula as un
from contenders.textbook import TENSILE_STIFFNESS, Array

#: Tip forces at which filaments spin and flap.
FORCES = {"spinning": 75.0, "flapping": 200.0}
#: Of the plane of flapping, which is no coordinates' plane [rad].
AZIMUTH = 1.0


class FullCells(un.Filament):
    """The filament with the textbook's cells, all alike, in undula's own equations."""

    @cached_property
    def system(self) -> Any:
        """The tables, with the half cells at both ends made whole."""
        half = un.Filament.system.func(self)  # type: ignore[attr-defined]
        joint, weight = half.joint.copy(), half.weight.copy()
        joint[0], weight[-1] = joint[1], weight[0]
        return half._replace(joint=joint, weight=weight)


def model_of(layout: str, segments: int, force: float) -> un.Filament:
    """Return the model of a layout: undula's, or the textbook's with stiff or with rigid links."""
    load = un.TipLoad(force)
    if layout == "undula":
        return un.Filament(segments, load)
    if layout == "textbook, rigid":
        return FullCells(segments, load)
    if layout == "textbook":
        return FullCells(
            segments, load, inextensibility="weak", tensile_stiffness=TENSILE_STIFFNESS
        )
    raise ValueError(f"no layout {layout!r}")


@dataclass(frozen=True)
class Orbit:
    """A periodic motion as a Fourier series: x(t) = Re sum of c_k exp(2 pi i k frequency t)."""

    model: un.Filament
    frequency: float  # [1/T]
    coefficients: NDArray[np.complex128]  # c (k, 3 n)

    @property
    def start(self) -> Array:
        """The state at time 0."""
        return self.at(np.zeros(1))[0]

    def at(self, phase: Array) -> Array:
        """Return the states (m, 3 n) at phases in cycles."""
        return np.real(self._waves(phase) @ self.coefficients)

    def _slope(self, phase: Array) -> Array:
        k = np.arange(len(self.coefficients))
        return np.real((self._waves(phase) * (2j * np.pi * k)) @ self.coefficients)

    def _waves(self, phase: Array) -> NDArray[np.complex128]:
        return np.exp(2j * np.pi * np.outer(phase, np.arange(len(self.coefficients))))

    def ahead(self, times: Array, states: Array) -> Array:
        """Return by how many cycles the states (m, 3 n) at `times` are ahead of the motion."""
        phase = self.frequency * times
        ahead = np.zeros(times.size)
        for _ in range(20):  # nearest point of the orbit, by Gauss and Newton
            slope = self._slope(phase + ahead)
            away = states - self.at(phase + ahead)
            ahead += np.clip(np.sum(away * slope, 1) / np.sum(slope * slope, 1), -0.05, 0.05)
        return ahead

    def frequency_error(self, times: Array, states: Array) -> float:
        """Return the relative error of the frequency that the states show after one period.

        It is the slope of their phase; the first period is left out, as a solver's own attractor is
        not quite the exact one.
        """
        late = times * self.frequency >= 1.0 - 1e-9
        cycles = self.frequency * times[late]
        return float(abs(np.polyfit(cycles, self.ahead(times, states)[late], 1)[0]))

    def tip_error(self, times: Array, states: Array) -> float:
        """Return the largest distance of the tip from where it should be [L]."""
        away = (states - self.at(self.frequency * times))[:, -3:]
        return float(np.linalg.norm(away, axis=1).max())


@cache
def orbit(layout: str, segments: int, motion: str) -> Orbit:
    """Solve for a motion of a layout."""
    model = model_of(layout, segments, FORCES[motion])
    found: Any = un.find(model, motion)
    if not found:
        raise RuntimeError(f"{layout}, {segments} segments: {found.reason}")
    if motion == "spinning":
        turned = (model.rotate(found.x, -np.sign(found.rate) * a) for a in (0.0, 0.5 * np.pi))
        ahead, aside = (x.reshape(-1, 3) for x in turned)
        mean, wave = ahead.copy(), ahead + 1j * aside
        mean[:, :2], wave[:, 2] = 0.0, 0.0
        return Orbit(model, found.frequency, np.array([mean.ravel(), wave.ravel()]))
    shapes = np.array([model.rotate(model.from_nodes(each), AZIMUTH) for each in found.nodes])
    waves = np.fft.rfft(shapes, axis=0)[:-1] / len(shapes)
    waves[1:] *= 2.0
    return Orbit(model, found.frequency, waves)
