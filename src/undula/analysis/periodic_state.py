"""A relative periodic orbit, as a record: a shape that repeats itself up to a turn."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from undula.analysis.observables import Range, tip_height, tip_radius, winding_angle
from undula.analysis.periodic import over_period
from undula.arrays import Array, ComplexArray, Shapes
from undula.models.model import Model


@dataclass(frozen=True)
class Periodic:
    """A motion that repeats itself after a time, turned by an angle: x(t + T) = R(angle) x(t).

    The angle is 0 for a body that is held in one direction.

    Modulated spinning, precessing flapping and other toroidal motions are of this kind.

    Attributes
    ----------
    model : Model
    duration : float
        The time after which the shape repeats itself [T].
    angle : float
        The angle by which it has turned then [rad].
    unknowns : ndarray of shape (m, n)
        Positions and multipliers at equally spaced instants, the last one after `duration`.
    residual : float
        By how much the motion fails to close [L].
    exponents : ndarray of shape (k,)
        Of disturbances [1/T], by falling real part, without trivial ones.
    trivial : tuple of float
        Errors of the multipliers of a shift in time and of a turn about the axis.
    error : float or None
        Estimated error of the frequency against the body that the links stand for [cycles per T],
        None where the links are the body, or if it was not asked for.
    """

    model: Model
    duration: float
    angle: float
    unknowns: Array
    residual: float
    exponents: ComplexArray
    trivial: tuple[float, ...]
    error: float | None = None

    @property
    def nodes(self) -> Shapes:
        """Positions of the nodes (m, N + 1, 3) [L]."""
        return self.model.nodes(self.model.positions(self.unknowns))

    @property
    def start(self) -> Array:
        """The state of the model at the beginning, shape (size,)."""
        end = self.model.positions(self.unknowns[-1])
        return self.model.rotate(end, -self.angle) if self.model.axisymmetric else end

    @property
    def force(self) -> float:
        """Total follower force [B/L^2]."""
        return self.model.load.force

    @cached_property
    def turned(self) -> float:
        """The angle by which the motion has turned after `duration`, full turns counted [rad].

        The equations know it up to full turns only; the filament's deflection tells the rest.
        """
        start = self.model.nodes(self.start)[None]
        winding = winding_angle(np.concatenate([start, self.nodes]))
        full_turns = np.round((winding[-1] - winding[0] - self.angle) / (2.0 * np.pi))
        return float(self.angle + 2.0 * np.pi * full_turns)

    @property
    def frequency(self) -> float:
        """Turns per T, in the mean; repetitions of the motion where no turn is a symmetry."""
        if not self.model.axisymmetric:
            return self.shape_frequency
        return abs(self.turned) / (2.0 * np.pi * self.duration)

    @property
    def shape_frequency(self) -> float:
        """Repetitions of the shape per T."""
        return 1.0 / self.duration

    @cached_property
    def energy(self) -> Range:
        """Bending energy [B/L]."""
        return over_period(self.model.observe(self.unknowns).bending_energy)

    @cached_property
    def tip_radius(self) -> Range:
        """Distance of the tip from the axis [L]."""
        return over_period(tip_radius(self.nodes))

    @cached_property
    def tip_height(self) -> Range:
        """Height of the tip above the clamp [L]."""
        return over_period(tip_height(self.nodes))

    @cached_property
    def power_balance_error(self) -> float:
        """Difference of active power and dissipation in the mean, relative to either."""
        observed = self.model.observe(self.unknowns)
        active, dissipated = np.mean(observed.active_power), np.mean(observed.dissipation)
        return float(abs(active - dissipated) / abs(active))

    @property
    def leading_rate(self) -> float:
        """Largest growth rate of a disturbance [1/T]."""
        return float(self.exponents[0].real)

    @property
    def stable(self) -> bool:
        """Whether all disturbances decay."""
        return self.leading_rate < 0.0

    def __str__(self) -> str:
        """Tell it in one line."""
        word = "stable" if self.stable else "unstable"
        return (
            f"{self.shape_frequency:.8g} shapes and {self.frequency:.8g} turns per T under force"
            f" {self.force:.6g}: {word}, leading rate {self.leading_rate:.4g} /T"
        )
