"""Floquet multipliers of an orbit, with the trivial multipliers deflated.

A monodromy matrix M maps small displacements along an orbit, up to its symmetry. Some eigenvectors
are known: the velocity, and the direction S x of a rotation, which is reversed if the symmetry
reverses the rotation. With V an orthonormal basis of these trivial directions and U one of their
orthogonal complement,

    [V U]' M [V U] = [ V' M V   V' M U ]
                     [    0     U' M U ],

so that the other multipliers are the eigenvalues of U' M U. A choice among the eigenvalues of M
would lose accuracy where another multiplier meets a trivial one, at a fold or a branch point of
orbits; this deflation does not.

Multipliers are exact to about round-off of the largest multiplier: of those much smaller than 1e-15
only the smallness is known.
"""

from dataclasses import dataclass

import numpy as np

from undula.arrays import Array, ComplexArray
from undula.numerics.orbits.shooting import Shot


@dataclass(frozen=True)
class Floquet:
    """The multipliers of an orbit.

    Attributes
    ----------
    multipliers : ndarray of shape (k - t,)
        All but the trivial multipliers, by descending modulus.
    vectors : ndarray of shape (k, k - t)
        Their eigenvectors, of length 1, without their components along the trivial directions.
    trivial_errors : ndarray of shape (t,)
        Residual |M v - mu v| / |v| of each trivial direction v: the error of its multiplier mu, and
        an estimate of the error of the others.
    """

    multipliers: ComplexArray
    vectors: ComplexArray
    trivial_errors: Array

    def exponents(self, duration: float) -> ComplexArray:
        """Return the Floquet exponents ln(multiplier) / T.

        Parameters
        ----------
        duration : float
            The time T of the monodromy matrix, above 0.

        Returns
        -------
        ndarray of shape (m,)
            The exponents by descending real part, without those of multipliers that underflow.
        """
        kept = self.multipliers[np.abs(self.multipliers) > np.finfo(float).tiny]
        values = np.asarray(np.log(kept) / duration, dtype=np.complex128)
        return values[np.lexsort((-values.imag, -values.real))]


def floquet(monodromy: Array, directions: Array, expected: Array) -> Floquet:
    """Return the multipliers of a monodromy matrix (k, k).

    Parameters
    ----------
    monodromy : ndarray of shape (k, k)
        The monodromy matrix.
    directions : ndarray of shape (k, t)
        Trivial eigenvectors, linearly independent; t may be 0.
    expected : ndarray of shape (t,)
        Their multipliers.

    Returns
    -------
    Floquet
        The other multipliers, and the errors of the trivial ones.
    """
    t = directions.shape[1]
    others = np.linalg.qr(directions, mode="complete")[0][:, t:]
    values, vectors = np.linalg.eig(others.T @ monodromy @ others)
    order = np.argsort(-np.abs(values), kind="stable")
    residuals = np.linalg.norm(monodromy @ directions - directions * expected, axis=0)
    lengths = np.linalg.norm(directions, axis=0)
    return Floquet(
        values[order].astype(complex),
        (others @ vectors[:, order]).astype(complex),
        # A motion that rests has no direction, and the error of its multiplier is unknown.
        np.divide(residuals, lengths, out=np.full_like(residuals, np.inf), where=lengths > 0.0),
    )


def floquet_of(shot: Shot) -> Floquet:
    """Return the multipliers of an orbit for its own displacements.

    Parameters
    ----------
    shot : Shot
        The motion along the orbit.

    Returns
    -------
    Floquet
        The multipliers; the velocity and, with a rotation, S y are trivial directions.
    """
    trivial = [shot.velocity, shot.turning] if shot.turning.any() else [shot.velocity]
    directions = shot.basis.T @ np.stack(trivial, axis=1)
    return floquet(shot.monodromy, directions, np.ones(len(trivial)))
