"""A fixed shape that turns at a constant rate, as a problem for Newton's method and continuation.

In the frame that turns with it a spinning filament is at rest: its velocity is Omega S x, so that

    R(x) Omega S x = f(x, z),    g(x, z) = 0,    <S x_ref, x> = 0.

The unknowns are u = (y, Omega) with y = (x, z); the last equation picks one of all the turned
copies, the one turned least from a reference.
"""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from undula.analysis.parameters import changed, neighbours
from undula.arrays import Array, ComplexArray
from undula.errors import InputError
from undula.models.model import Model
from undula.numerics.bordered import BandFactors, BorderedBand
from undula.numerics.problem import Evaluation

# Root mean square distance from the axis [L] up to which a shape passes for straight: beyond the
# last step of Newton's method, far below that of a spinning state but at its very beginning.
_STRAIGHT = 1e-6


@dataclass(frozen=True)
class TurningShape:
    """The equations of a spinning state; implements `undula.numerics.problem.Problem`.

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

    @property
    def weights(self) -> Array:
        """A mean square of positions, and the square of the rate relative to its scale."""
        moves = self.model.equations.differential
        weights: Array = np.append(moves / np.count_nonzero(moves), self.rate_scale**-2)
        return weights

    def referred_to(self, u: Array) -> Self:
        """Return the problem with the phase fixed by a solution."""
        return replace(self, reference=u[:-1])

    def evaluate(self, u: Array, p: float) -> Evaluation:
        """Return residual and derivatives at (u, p)."""
        y, rate = u[:-1], float(u[-1])
        equations = changed(self.model, self.parameter, p).equations
        velocity, dragged = equations.turning(y)
        matrix, _ = equations.parts(y, rate * velocity, rate)
        phase = self._phase(velocity)
        linear = BorderedBand(
            matrix,
            dragged[:, None],
            phase[None, :],
            np.zeros((1, 1)),
            soft=int(np.argmax(np.abs(phase))),
        )
        residual = equations.residual(y, rate * velocity)
        return Evaluation(
            np.append(residual, phase @ y), linear, np.append(self._by_parameter(y, rate, p), 0.0)
        )

    def _phase(self, velocity: Array) -> Array:
        """Return the unit vector along which the reference turns; refuse a straight shape."""
        phase = self.model.equations.turning(self.reference)[0]
        size = float(np.linalg.norm(phase))
        across = np.sqrt(np.count_nonzero(self.model.equations.differential))
        if size == 0.0 or phase @ velocity < _STRAIGHT * size * across:
            raise InputError(
                "a straight shape turns at any rate, so that no spinning state is near it;"
                " begin with one that is bent"
            )
        return np.asarray(phase / size)

    def _by_parameter(self, y: Array, rate: float, p: float) -> Array:
        below, above, width = neighbours(self.model, self.parameter, p)
        velocity, _ = self.model.equations.turning(y)
        less, more = (side.equations.residual(y, rate * velocity) for side in (below, above))
        return np.asarray((more - less) / width)


def rotating_spectrum(model: Model, y: Array, rate: float) -> ComplexArray:
    """Return the exponents of disturbances of a spinning state, seen in its own frame.

    Parameters
    ----------
    model : Model
    y : ndarray of shape (n,)
        Positions and multipliers.
    rate : float
        Rate of turning [rad/T].

    Returns
    -------
    ndarray of shape (k,)
        Growth rates and angular frequencies [1/T], by falling real part.
    """
    equations = model.equations
    velocity, _ = equations.turning(y)
    matrix, drag = equations.parts(y, rate * velocity, rate)
    # Any shift that is no eigenvalue will do; those of interest are of the size of the rate.
    shift = max(1.0, abs(rate))
    basis = equations.displacements(y)
    answer = BandFactors(matrix + shift * drag).solve(_times(drag, basis))
    inverse = np.asarray(np.linalg.eigvals(basis.T @ answer), dtype=np.complex128)
    values = shift - 1.0 / inverse
    return values[np.lexsort((-values.imag, -values.real))]


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
