"""States that were solved for: what is common to spinning and flapping, and what to say of none.

`exponents` are the growth rates and angular frequencies [1/T] of small disturbances of a state, by
falling real part, without those that belong to its symmetries (a shift in time, a turn about the
axis), which are exactly 0 and are kept apart as `trivial`: their distance from 0 tells how well
the state was solved for.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from undula.analysis.observables.period_statistics import finely, over_period
from undula.analysis.observables.shapes import Range, envelope, tip_height, tip_radius
from undula.arrays import Array, ComplexArray, Nodes, Shapes
from undula.models.model import Model


@dataclass(frozen=True)
class NotFound:
    """No state was found; false in a condition.

    Attributes
    ----------
    reason : str
        What was tried, how far it came, and what to try next, in one sentence.
    residual : float or None
        The residual at which the search ended, None if there was nothing to search from.
    """

    reason: str
    residual: float | None = None

    def __bool__(self) -> bool:
        """Return False: there is no state."""
        return False


class FixedShape:
    """What is common to states whose shape does not change: it turns evenly, or rests."""

    model: Model
    unknowns: Array
    exponents: ComplexArray

    @property
    def x(self) -> Array:
        """The state of the model, shape (size,)."""
        return self.model.positions(self.unknowns)

    @property
    def nodes(self) -> Nodes:
        """Positions of the nodes (N + 1, 3) [L]."""
        return self.model.nodes(self.x)

    @property
    def force(self) -> float:
        """Total follower force [B/L^2]."""
        return self.model.load.force

    @cached_property
    def bending_energy(self) -> float:
        """Bending energy [B/L]."""
        return float(self.model.observe(self.unknowns[None, :]).bending_energy[0])

    @property
    def energy(self) -> Range:
        """Bending energy [B/L] over a cycle, which is constant."""
        return Range(self.bending_energy, self.bending_energy, self.bending_energy)

    @property
    def tip_radius(self) -> float:
        """Distance of the tip from the axis [L]."""
        return float(tip_radius(self.nodes))

    @property
    def tip_height(self) -> float:
        """Height of the tip above the clamp [L]."""
        return float(tip_height(self.nodes))

    @property
    def leading_rate(self) -> float:
        """Largest growth rate of a disturbance [1/T]."""
        return float(self.exponents[0].real)

    @property
    def stable(self) -> bool:
        """Whether all disturbances decay."""
        return self.leading_rate < 0.0


@dataclass(frozen=True)
class Spinning(FixedShape):
    """A relative equilibrium: a fixed shape that turns about the axis at a constant rate.

    Attributes
    ----------
    model : Model
    unknowns : ndarray of shape (n,)
        Positions and multipliers.
    rate : float
        Rate of turning [rad/T], counterclockwise if positive.
    residual : float
        Largest entry of what is left of the equations, relative to the forces in them.
    exponents : ndarray of shape (k,)
        Of disturbances seen in the frame that turns with it.
    trivial : complex
        The exponent of a turn about the axis: the one next to 0.
    error : float or None
        Estimated error of the frequency against the body that the numbers stand for, of links and
        solver together [turns per T]; None if it was not asked for.
    """

    model: Model
    unknowns: Array
    rate: float
    residual: float
    exponents: ComplexArray
    trivial: complex
    error: float | None = None

    @property
    def frequency(self) -> float:
        """Turns per T."""
        return abs(self.rate) / (2.0 * np.pi)

    @property
    def solver_error(self) -> float:
        """Estimated error of the frequency on these links [turns per T].

        What is left of the equations turns the shape as the exponent does that should be 0.
        """
        return (self.residual * abs(self.rate) + abs(self.trivial)) / (2.0 * np.pi)

    @cached_property
    def power_balance_error(self) -> float:
        """Difference of active power and dissipation, relative to either."""
        active, dissipated = self.model.power(self.x)
        return abs(active - dissipated) / abs(active)

    def __str__(self) -> str:
        """Tell it in one line."""
        word = "stable" if self.stable else "unstable"
        return (
            f"spinning at {self.frequency:.8g} turns per T under force {self.force:.6g}: {word},"
            f" leading rate {self.leading_rate:.4g} /T (trivial one {abs(self.trivial):.1g})"
        )


@dataclass(frozen=True)
class Flapping:
    """A planar beat: a periodic orbit that is its own mirror image half a period later.

    Multipliers and exponents are those of a whole period; those of disturbances in the plane and
    out of it are apart, as neither drives the other.

    Attributes
    ----------
    model : Model
        In space, or confined to the plane; then there are no disturbances out of it.
    period : float
        Time of one beat [T].
    time : ndarray of shape (m,)
        Equally spaced instants over one period [T].
    unknowns : ndarray of shape (m, n)
        Positions and multipliers of the model confined to the plane, at these instants.
    residual : float
        By how much the beat fails to close [L].
    in_plane, out_of_plane : ndarray of shape (k,)
        Exponents [1/T] of disturbances, by falling real part, without trivial ones.
    trivial : tuple of float
        |multiplier - 1| of a shift in time, and of a turn about the axis unless confined.
    time_error : float
        Estimated error of the frequency by the steps in time [beats per T].
    error : float or None
        Estimated error of the frequency against the body that the numbers stand for, of links and
        steps together [beats per T]; None if it was not asked for.
    """

    model: Model
    period: float
    time: Array
    unknowns: Array
    residual: float
    in_plane: ComplexArray
    out_of_plane: ComplexArray
    trivial: tuple[float, ...]
    time_error: float
    error: float | None = None

    @cached_property
    def planar(self) -> Model:
        """The model confined to the plane of the beat."""
        return self.model.with_(confined=True)

    @property
    def nodes(self) -> Shapes:
        """Positions of the nodes (m, N + 1, 3) [L] over the period."""
        return self.planar.nodes(self.planar.positions(self.unknowns))

    @property
    def force(self) -> float:
        """Total follower force [B/L^2]."""
        return self.model.load.force

    @property
    def frequency(self) -> float:
        """Beats per T."""
        return 1.0 / self.period

    @property
    def solver_error(self) -> float:
        """Estimated error of the frequency on these links [beats per T]."""
        return self.time_error

    @cached_property
    def energy(self) -> Range:
        """Bending energy [B/L] over the period."""
        return over_period(self.planar.observe(self.unknowns).bending_energy)

    @cached_property
    def tip_radius(self) -> Range:
        """Distance of the tip from the axis [L] over the period; 0 as it passes."""
        sideways = finely(self.nodes[:, -1, 0])
        return Range(0.0, envelope(sideways).max, float(np.mean(np.abs(sideways))))

    @cached_property
    def tip_height(self) -> Range:
        """Height of the tip above the clamp [L] over the period."""
        return over_period(tip_height(self.nodes))

    @cached_property
    def power_balance_error(self) -> float:
        """Difference of active power and dissipation over the period, relative to either."""
        observed = self.planar.observe(self.unknowns)
        active, dissipated = (
            float(np.mean(power)) for power in (observed.active_power, observed.dissipation)
        )
        return abs(active - dissipated) / abs(active)

    @cached_property
    def exponents(self) -> ComplexArray:
        """Exponents [1/T] of all disturbances, by falling real part, without trivial ones."""
        both = np.concatenate([self.in_plane, self.out_of_plane])
        return both[np.lexsort((-both.imag, -both.real))]

    @property
    def leading_rate_in_plane(self) -> float:
        """Largest growth rate of a disturbance in the plane [1/T]."""
        return float(self.in_plane[0].real)

    @property
    def leading_rate_out_of_plane(self) -> float | None:
        """Largest growth rate of a disturbance out of the plane [1/T], None if confined."""
        return float(self.out_of_plane[0].real) if self.out_of_plane.size else None

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
        out = self.leading_rate_out_of_plane
        outside = "" if out is None else f", out of it {out:.4g} /T"
        return (
            f"flapping at {self.frequency:.8g} beats per T under force {self.force:.6g}: {word},"
            f" leading rate in the plane {self.leading_rate_in_plane:.4g} /T{outside}"
            f" (trivial multipliers to {max(self.trivial):.1g})"
        )
