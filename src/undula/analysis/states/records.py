"""Records of spinning, flapping and resting states; fields of all states are those of `State`."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from undula.analysis.observables.period_statistics import over_period, oversampled
from undula.analysis.observables.shapes import Range, envelope, tip_height
from undula.analysis.states.state import FixedShape, State, by_falling_real_part
from undula.arrays import Array, ComplexArray, Shapes
from undula.models.model import Model


@dataclass(frozen=True, repr=False)
class Spinning(FixedShape):
    """A relative equilibrium: a constant shape that turns about the axis at a constant rate.

    Attributes
    ----------
    rate : float
        Rate of turning [rad/T], counterclockwise if positive.
    residual : float
        Largest entry of the residual, relative to the forces of the equations.
    exponents : ndarray of shape (k,)
        Exponents [1/T] of disturbances in the frame that turns with the shape.
    trivial : complex
        The exponent of a turn about the axis: the one next to 0.
    model, unknowns, error
        As in `undula.analysis.states.state.State`.

    Examples
    --------
    >>> import undula as un
    >>> state = un.find(un.Filament(8, un.TipLoad(75.0)), "spinning")
    >>> state.nodes.shape, bool(abs(state.trivial) < 1e-6 * abs(state.rate))
    ((9, 3), True)
    """

    kind: ClassVar[str] = "spinning"

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
    def period(self) -> float:
        """Time of a turn [T]."""
        return 2.0 * np.pi / abs(self.rate) if self.rate else math.inf

    @property
    def solver_error(self) -> float:
        """Estimated error of the frequency on these links [turns per T].

        The residual turns the shape at the rate of the exponent that should be 0.
        """
        return (self.residual * abs(self.rate) + abs(self.trivial)) / (2.0 * np.pi)

    @cached_property
    def power_balance_error(self) -> float:
        """Difference of active power and dissipation, relative to the former."""
        active, dissipated = self.model.power(self.x)
        return abs(active - dissipated) / abs(active)

    def __str__(self) -> str:
        """Return kind, frequency, force and stability in one line."""
        word = "stable" if self.stable else "unstable"
        return (
            f"spinning at {self.frequency:.8g} turns per T {self._accuracy} under force"
            f" {self.force:.6g}: {word}, leading rate {self.leading_rate:.4g} /T"
        )


@dataclass(frozen=True, repr=False)
class Equilibrium(FixedShape):
    """A shape at rest.

    Attributes
    ----------
    residual : float
        Largest force that is not in balance [B/L^2].
    error : float or None
        None: the frequency is 0 exactly.
    model, unknowns, exponents
        As in `undula.analysis.states.state.State`.

    Examples
    --------
    >>> import undula as un
    >>> curved = un.Filament(8, un.TipLoad(10.0), natural_curvature=(1.0, 0.0))
    >>> state = un.find(curved, "equilibrium")
    >>> state.nodes.shape, round(state.tip_radius.mean, 3)
    ((9, 3), 0.206)
    """

    kind: ClassVar[str] = "equilibrium"

    model: Model
    unknowns: Array
    residual: float
    exponents: ComplexArray
    error: float | None = None

    @property
    def frequency(self) -> float:
        """Cycles per T: 0."""
        return 0.0

    @property
    def period(self) -> float:
        """Infinite: nothing repeats."""
        return math.inf

    @property
    def solver_error(self) -> float:
        """Error of the frequency: 0."""
        return 0.0

    @property
    def power_balance_error(self) -> float:
        """Difference of active power and dissipation: 0, as both vanish."""
        return 0.0

    def __str__(self) -> str:
        """Return force, stability and radius of the tip in one line."""
        word = "stable" if self.stable else "unstable"
        return (
            f"at rest under force {self.force:.6g} ({self.model.links} links, forces balance to"
            f" {self.residual:.1g}): {word}, leading rate {self.leading_rate:.4g} /T, tip"
            f" {self.tip_radius.mean:.4g} L off the axis"
        )


@dataclass(frozen=True, repr=False)
class Flapping(State):
    """A planar beat: a periodic orbit that is its own mirror image half a period later.

    Multipliers and exponents are those of a whole period. Disturbances in the plane and out of it
    are independent of each other and kept apart.

    Attributes
    ----------
    model : Model
        In space, or confined to the plane; then there are no disturbances out of it.
    time : ndarray of shape (m,)
        Equally spaced instants over one period [T].
    unknowns : ndarray of shape (m, n)
        Of the model confined to the plane, at these instants.
    residual : float
        Distance by which the beat fails to close [L].
    in_plane, out_of_plane : ndarray of shape (k,)
        Exponents [1/T] of disturbances, by falling real part, without trivial ones.
    trivial : tuple of float
        |multiplier - 1| of a shift in time, and of a turn about the axis unless confined.
    time_error : float
        Estimated error of the frequency by the steps in time [beats per T].
    period, error
        As in `undula.analysis.states.state.State`.

    Examples
    --------
    >>> import undula as un
    >>> beat = un.find(un.Filament(4, un.TipLoad(75.0), confined=True), "flapping")
    >>> beat.nodes.shape, beat.leading_rate_out_of_plane
    ((64, 5, 3), None)
    """

    kind: ClassVar[str] = "flapping"

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
    def frequency(self) -> float:
        """Beats per T."""
        return 1.0 / self.period

    @property
    def solver_error(self) -> float:
        """Estimated error of the frequency on these links [beats per T]."""
        return self.time_error

    @cached_property
    def bending_energy(self) -> Range:
        """Bending energy [B/L] over the period."""
        return over_period(self.planar.observe(self.unknowns).bending_energy)

    @cached_property
    def tip_radius(self) -> Range:
        """Distance of the tip from the axis [L] over the period; 0 as it crosses the axis."""
        sideways = oversampled(self.nodes[:, -1, 0])
        return Range(0.0, envelope(sideways).max, float(np.mean(np.abs(sideways))))

    @cached_property
    def tip_height(self) -> Range:
        """Height of the tip above the clamp [L] over the period."""
        return over_period(tip_height(self.nodes))

    @cached_property
    def power_balance_error(self) -> float:
        """Difference of active power and dissipation over the period, relative to the former."""
        observed = self.planar.observe(self.unknowns)
        active, dissipated = (
            float(np.mean(power)) for power in (observed.active_power, observed.dissipation)
        )
        return abs(active - dissipated) / abs(active)

    @cached_property
    def exponents(self) -> ComplexArray:
        """Exponents [1/T] of all disturbances, by falling real part, without trivial ones."""
        return by_falling_real_part(np.concatenate([self.in_plane, self.out_of_plane]))

    @property
    def leading_rate_in_plane(self) -> float:
        """Largest growth rate of a disturbance in the plane [1/T]."""
        return float(self.in_plane[0].real)

    @property
    def leading_rate_out_of_plane(self) -> float | None:
        """Largest growth rate of a disturbance out of the plane [1/T], None if confined."""
        return float(self.out_of_plane[0].real) if self.out_of_plane.size else None

    def __str__(self) -> str:
        """Return kind, frequency, force and stability in one line."""
        word = "stable" if self.stable else "unstable"
        out = self.leading_rate_out_of_plane
        outside = "" if out is None else f", out of it {out:.4g} /T"
        return (
            f"flapping at {self.frequency:.8g} beats per T {self._accuracy} under force"
            f" {self.force:.6g}: {word}, leading rate in the plane"
            f" {self.leading_rate_in_plane:.4g} /T{outside}"
        )
