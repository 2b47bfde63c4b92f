"""A fixed shape that turns at a constant rate, as a problem for Newton's method and continuation.

A spinning filament is at rest in a frame that turns with it: its velocity is Omega S x, so that

    R(x) Omega S x = f(x, z),    g(x, z) = 0,    <S x_ref, x> = 0.

The unknowns are u = (y, Omega) with y = (x, z). The last equation picks one of all the turned
copies: the one turned least from a reference.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from undula.analysis.parameters import changed, neighbours
from undula.analysis.states.records import Spinning
from undula.analysis.states.state import by_falling_real_part
from undula.arrays import Array, ComplexArray
from undula.models.model import Model
from undula.numerics.continuation.problem import Evaluation
from undula.numerics.linalg.bordered import BandFactors, BorderedBand

# Root mean square distance from the axis [L] up to which a shape counts as straight: beyond the
# last step of Newton's method, far below that of a spinning state except at its very beginning.
_STRAIGHT = 1e-6
# Offset from an exponent at which inverse iteration begins, relative to it: two steps suffice.
_OFFSET = 1e-6


class StraightShapeError(np.linalg.LinAlgError):
    """The equations are singular at a straight shape, which turns at any rate."""


@dataclass(frozen=True)
class TurningShape:
    """The equations of a spinning state; implements `undula.numerics.continuation.problem.Problem`.

    Attributes
    ----------
    model : Model
    parameter : str
        Name of the parameter that the problem depends on, such as "load.force".
    reference : ndarray of shape (n,)
        Positions and multipliers that fix the phase.
    rate_scale : float
        A rate of turning that counts as 1.
    """

    model: Model
    parameter: str
    reference: Array
    rate_scale: float

    @cached_property
    def weights(self) -> Array:
        """Weights (n + 1,) of a mean square of positions and of the rate over its scale."""
        moving = self.model.equations.differential
        weights: Array = np.append(moving / np.count_nonzero(moving), self.rate_scale**-2)
        return weights

    def with_reference(self, u: Array) -> Self:
        """Return the problem with the phase fixed by a solution."""
        return replace(self, reference=u[:-1])

    def evaluate(self, u: Array, p: float) -> Evaluation:
        """Return residual and derivatives at (u, p).

        Raises
        ------
        StraightShapeError
            The shape is straight.
        """
        residual, linear = self._linearised(changed(self.model, self.parameter, p), u)
        y, rate = u[:-1], float(u[-1])
        return Evaluation(residual, linear, np.append(self._by_parameter(y, rate, p), 0.0))

    def _linearised(self, model: Model, u: Array) -> tuple[Array, BorderedBand]:
        y, rate, equations = u[:-1], float(u[-1]), model.equations
        velocity, dragged = equations.turning(y)
        matrix, _ = equations.parts(y, rate * velocity, rate)
        phase, shifted, least = self._phase
        if phase @ velocity < least:
            raise StraightShapeError
        linear = BorderedBand(
            matrix, dragged[:, None], phase[None, :], np.zeros((1, 1)), shifted=shifted
        )
        residual = equations.residual(y, rate * velocity)
        return np.append(residual, phase @ y), linear

    @cached_property
    def _phase(self) -> tuple[Array, int, float]:
        """The unit vector (n,) along which the reference turns, and the index of its largest entry.

        The last number is the least component along it of a shape's own turning, below which the
        shape counts as straight. If the reference is straight, all shapes do.
        """
        equations = self.model.equations
        phase = equations.turning(self.reference)[0]
        size = float(np.linalg.norm(phase))
        across = float(np.sqrt(np.count_nonzero(equations.differential)))
        unit = phase / size if size > 0.0 else phase
        return unit, int(np.argmax(np.abs(unit))), _STRAIGHT * across

    def _by_parameter(self, y: Array, rate: float, p: float) -> Array:
        below, above, width = neighbours(self.model, self.parameter, p)
        velocity, _ = self.model.equations.turning(y)
        less, more = (side.equations.residual(y, rate * velocity) for side in (below, above))
        return np.asarray((more - less) / width)


class TurningShapeAlone(TurningShape):
    """The same equations under the model's own force alone: three times as fast to evaluate."""

    def evaluate(self, u: Array, p: float) -> Evaluation:  # noqa: ARG002
        """Return residual and derivative at u, with 0 for the derivative by the parameter."""
        return Evaluation(*self._linearised(self.model, u), np.zeros(u.size))


@dataclass(frozen=True)
class Disturbances:
    """Small disturbances q of a spinning state in its own frame: dq/dt = A q.

    Attributes
    ----------
    basis : ndarray of shape (n, k)
        Orthonormal displacements; q are coordinates in it.
    shift : float
        A rate that is no eigenvalue [1/T].
    inverse : ndarray of shape (k, k)
        The inverse of shift - A.
    """

    basis: Array
    shift: float
    inverse: Array

    @classmethod
    def of(cls, model: Model, y: Array, rate: float) -> Self:
        """Return the disturbances of unknowns (n,) at a rate of turning [rad/T]."""
        equations = model.equations
        velocity, _ = equations.turning(y)
        matrix, drag = equations.parts(y, rate * velocity, rate)
        # Any shift that is not an eigenvalue serves; exponents of interest are of the rate's size.
        shift = max(1.0, abs(rate))
        basis = equations.displacements(y)
        inverse = BandFactors(matrix + shift * drag).solve(_times(drag, basis))
        return cls(basis, shift, basis.T @ inverse)

    @cached_property
    def exponents(self) -> ComplexArray:
        """Growth rates and angular frequencies (k,) [1/T], by falling real part."""
        inverse = np.asarray(np.linalg.eigvals(self.inverse), dtype=np.complex128)
        return by_falling_real_part(self.shift - 1.0 / inverse)

    def amplitude(self, exponent: complex) -> ComplexArray:
        """Return the vector (n,) whose product with a displacement is the amplitude of a mode."""
        offset = _OFFSET * (1.0 + 1.0j) * abs(exponent)
        shifted = self.inverse.T - np.eye(len(self.inverse)) / (self.shift - exponent - offset)
        vector = np.linalg.solve(shifted, np.ones(len(shifted), dtype=np.complex128))
        vector = np.linalg.solve(shifted, vector / np.linalg.norm(vector))
        return np.asarray(self.basis @ (vector / np.linalg.norm(vector)), dtype=np.complex128)


def turning_state(
    model: Model, y: Array, rate: float, disturbances: Disturbances | None = None
) -> Spinning:
    """Return the record of a spinning state, with its residual and its exponents.

    Parameters
    ----------
    model : Model
        In space.
    y : ndarray of shape (n,)
        Positions and multipliers.
    rate : float
        Rate of turning [rad/T].
    disturbances : Disturbances, optional
        Those of the state, if they have been computed already.
    """
    velocity, dragged = model.equations.turning(y)
    residual = model.equations.residual(y, rate * velocity)
    values = (disturbances or Disturbances.of(model, y, rate)).exponents
    trivial = int(np.argmin(np.abs(values)))
    return Spinning(
        model=model,
        unknowns=y,
        rate=rate,
        residual=float(np.abs(residual).max() / np.abs(rate * dragged).max()),
        exponents=np.delete(values, trivial),
        trivial=complex(values[trivial]),
    )


def rotating_spectrum(model: Model, y: Array, rate: float) -> ComplexArray:
    """Return the exponents of disturbances of a spinning state in its own frame.

    Parameters
    ----------
    model : Model
        Model of the filament or chain.
    y : ndarray of shape (n,)
        Positions and multipliers.
    rate : float
        Rate of turning [rad/T].

    Returns
    -------
    ndarray of shape (k,)
        Growth rates and angular frequencies [1/T], by falling real part.
    """
    return Disturbances.of(model, y, rate).exponents


def _times(band: Array, columns: Array) -> Array:
    """Return the product of a band (n, 2 b + 1) with columns (n, k)."""
    n, b = band.shape[0], band.shape[1] // 2
    product = np.zeros_like(columns)
    for offset in range(-b, b + 1):
        if not band[:, b + offset].any():
            continue
        rows = slice(max(0, -offset), min(n, n - offset))
        shifted = columns[rows.start + offset : rows.stop + offset]
        product[rows] += band[rows, b + offset, None] * shifted
    return product
