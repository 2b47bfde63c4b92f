"""Record of a relative periodic orbit: a shape that repeats itself up to a turn."""

import warnings
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from undula.analysis.observables.period_statistics import over_period, oversampled
from undula.analysis.observables.shapes import Range, mean_position, tip_height, transverse
from undula.analysis.states.state import State
from undula.arrays import Array, ComplexArray, Shapes
from undula.models.model import Model

# Largest number of cycles in a period at which a spectral line counts as the mean of the motion.
_AT_REST = 1e-6


@dataclass(frozen=True, repr=False)
class Periodic(State):
    """A motion that repeats itself after a time, turned by an angle: x(t + T) = R(angle) x(t).

    Modulated spinning, precessing flapping and other toroidal motions are of this kind.

    Attributes
    ----------
    period : float
        The time after which the shape repeats itself [T].
    angle : float
        The angle by which it has turned then [rad]; 0 for a body without rotational symmetry.
    unknowns : ndarray of shape (m, n)
        At equally spaced instants, the last one after a period.
    residual : float
        Distance by which the motion fails to close [L].
    trivial : tuple of float
        Errors of the multipliers of a shift in time and of a turn about the axis.
    time_error : float
        Estimated error of the frequency by the steps in time [cycles per T].
    model, exponents, error
        As in `undula.analysis.states.state.State`.

    Examples
    --------
    A planar beat recurs after half its period, turned by pi:

    >>> import undula as un
    >>> model = un.Filament(4, un.TipLoad(75.0))
    >>> beat = un.find(un.integrate(model, un.planar(model, 0.1), until=0.2), "periodic")
    >>> beat.nodes.shape, round(abs(beat.angle), 6), round(abs(beat.turns), 6)
    ((32, 5, 3), 3.141593, 0.5)
    """

    kind: ClassVar[str] = "periodic"

    model: Model
    period: float
    angle: float
    unknowns: Array
    residual: float
    exponents: ComplexArray
    trivial: tuple[float, ...]
    time_error: float = np.nan
    error: float | None = None

    @property
    def duration(self) -> float:
        """Former name of `period`."""
        message = "Periodic.duration is now period; the old name goes with the next release"
        warnings.warn(message, DeprecationWarning, stacklevel=2)
        return self.period

    @property
    def nodes(self) -> Shapes:
        """Positions of the nodes (m, N + 1, 3) [L]."""
        return self.model.nodes(self.model.positions(self.unknowns))

    @property
    def start(self) -> Array:
        """The state of the model at the beginning, shape (size,)."""
        end = self.model.positions(self.unknowns[-1])
        return self.model.rotate(end, -self.angle) if self.model.axisymmetric else end

    @cached_property
    def turns(self) -> float:
        """Cycles in a period of the strongest line of the mean position, in the laboratory frame.

        The shape fixes its turn up to full turns only. The strongest line fixes the rest, as it
        does for the frequency of a run. Positive from x to y.
        """
        across = self._turned_back(transverse(mean_position(self.nodes)))
        lines = np.fft.fft(across)
        cycles = self.angle / (2.0 * np.pi) + np.fft.fftfreq(across.size, 1.0 / across.size)
        moving = np.where(np.abs(cycles) > _AT_REST, np.abs(lines), 0.0)
        return float(cycles[np.argmax(moving)])

    @property
    def frequency(self) -> float:
        """Cycles per T of the strongest line of the motion, as for a run."""
        return abs(self.turns) / self.period

    @property
    def solver_error(self) -> float:
        """Estimated error of the frequency on these links [cycles per T]."""
        return self.time_error

    @property
    def shape_frequency(self) -> float:
        """Repetitions of the shape per T."""
        return 1.0 / self.period

    @cached_property
    def bending_energy(self) -> Range:
        """Bending energy [B/L]."""
        return over_period(self.model.observe(self.unknowns).bending_energy)

    @cached_property
    def tip_radius(self) -> Range:
        """Distance of the tip from the axis [L]."""
        # Near the axis the distance has a kink, which the path of the tip has not.
        across = self._turned_back(transverse(self.nodes[:, -1]))
        return over_period(np.hypot(oversampled(across.real), oversampled(across.imag)))

    def _turned_back(self, across: ComplexArray) -> ComplexArray:
        """Return x + i y (m,) in a frame that turns with the motion, in which it is periodic."""
        # Samples begin one interval after the start and include the end of the period.
        periods = np.arange(1, across.size + 1) / across.size
        return np.asarray(across * np.exp(-1j * self.angle * periods), dtype=np.complex128)

    @cached_property
    def tip_height(self) -> Range:
        """Height of the tip above the clamp [L]."""
        return over_period(tip_height(self.nodes))

    @cached_property
    def power_balance_error(self) -> float:
        """Difference of active power and dissipation over a period, relative to the former."""
        observed = self.model.observe(self.unknowns)
        active, dissipated = np.mean(observed.active_power), np.mean(observed.dissipation)
        return float(abs(active - dissipated) / abs(active))

    def __str__(self) -> str:
        """Return frequencies, force and stability in one line."""
        word = "stable" if self.stable else "unstable"
        return (
            f"periodic at {self.frequency:.8g} cycles per T {self._accuracy},"
            f" {self.shape_frequency:.8g} shapes per T, under force {self.force:.6g}: {word},"
            f" leading rate {self.leading_rate:.4g} /T"
        )
