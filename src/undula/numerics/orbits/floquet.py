"""Floquet multipliers of an orbit, with those that are known beforehand taken out.

A monodromy matrix M tells what becomes of small displacements in the course of an orbit, up to its
symmetry. Some of them are known: the velocity comes back as itself, so does the direction S x of a
rotation, reversed if the symmetry reverses the rotation. With V an orthonormal basis of these and U
one of what is orthogonal to them,

    [V U]' M [V U] = [ V' M V   V' M U ]
                     [    0     U' M U ],

so that the other multipliers are the eigenvalues of U' M U. Unlike a choice among the eigenvalues
of M, that is as exact as ever where one of the others meets a known one, at a fold or a branching
of orbits.

Multipliers are exact to about round-off of the largest, so that those which are much smaller than
1e-15 only tell that they are small.
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
        All but the known ones, by falling modulus.
    vectors : ndarray of shape (k, k - t)
        Their eigenvectors, of length 1, without their components along the known directions.
    known_errors : ndarray of shape (t,)
        By how much each known direction v is no eigenvector, |M v - mu v| / |v|: the error of its
        multiplier mu, and a measure of that of the others.
    """

    multipliers: ComplexArray
    vectors: ComplexArray
    known_errors: Array

    def exponents(self, duration: float) -> ComplexArray:
        """Return ln multiplier / T by falling real part, without those gone to the last digit."""
        kept = self.multipliers[np.abs(self.multipliers) > np.finfo(float).tiny]
        values = np.asarray(np.log(kept) / duration, dtype=np.complex128)
        return values[np.lexsort((-values.imag, -values.real))]


def floquet(monodromy: Array, directions: Array, expected: Array) -> Floquet:
    """Return the multipliers of a monodromy matrix (k, k).

    Parameters
    ----------
    monodromy : ndarray of shape (k, k)
    directions : ndarray of shape (k, t)
        Known eigenvectors, linearly independent; t may be 0.
    expected : ndarray of shape (t,)
        Their multipliers.
    """
    t = directions.shape[1]
    others = np.linalg.qr(directions, mode="complete")[0][:, t:]
    values, vectors = np.linalg.eig(others.T @ monodromy @ others)
    order = np.argsort(-np.abs(values), kind="stable")
    wrong = np.linalg.norm(monodromy @ directions - directions * expected, axis=0)
    size = np.linalg.norm(directions, axis=0)
    return Floquet(
        values[order].astype(complex),
        (others @ vectors[:, order]).astype(complex),
        # A motion that has come to rest has no direction, and nothing is known of its error.
        np.divide(wrong, size, out=np.full_like(wrong, np.inf), where=size > 0.0),
    )


def floquet_of(shot: Shot) -> Floquet:
    """Return the multipliers of an orbit among its own displacements."""
    known = [shot.velocity, shot.turning] if shot.turning.any() else [shot.velocity]
    directions = shot.basis.T @ np.stack(known, axis=1)
    return floquet(shot.monodromy, directions, np.ones(len(known)))
