"""A banded matrix with a few dense columns and rows.

    [ A   B ] [ x ]   [ f ]
    [ C   D ] [ y ] = [ g ]

is solved by block elimination with the factors of A. Where A is singular because of a symmetry,
its null vector is known: a multiple of one diagonal entry, picked where that vector is large, is
added to A and taken off again by one more border, so that the factors stay well conditioned.

Source: Govaerts (2000), Numerical Methods for Bifurcations of Dynamical Equilibria, chapter 3.
"""

import numpy as np
from scipy.linalg import lapack

from undula.arrays import Array


def to_lapack(band: Array) -> Array:
    """Return band (n, 2 b + 1), stored by rows, in LAPACK's storage (3 b + 1, n) for `dgbtrf`."""
    n, b = band.shape[0], band.shape[1] // 2
    # Columns on either side take what rows stick out by. In memory the next entry of a row is 3 b
    # numbers on, the same of the next row 3 b + 1.
    columns = np.zeros((n + 2 * b, 3 * b + 1))
    one, over = columns.itemsize, 3 * b * columns.itemsize
    np.ndarray(band.shape, buffer=columns, offset=over, strides=(over + one, over))[:] = band
    return columns[b : n + b].T


class BandFactors:
    """The factors of a banded matrix, with pivoting.

    Parameters
    ----------
    band : ndarray of shape (n, 2 b + 1)
        band[i, j - i + b] is the entry (i, j).

    Raises
    ------
    LinAlgError
        A pivot vanishes: the matrix is singular to the last digit.
    """

    def __init__(self, band: Array) -> None:
        self._b = band.shape[1] // 2
        self._factors, self._pivots, info = lapack.dgbtrf(
            to_lapack(band), self._b, self._b, overwrite_ab=True
        )
        if info != 0:
            raise np.linalg.LinAlgError(f"pivot {info} of a banded matrix vanishes")

    def solve(self, right: Array) -> Array:
        """Return the solution for right-hand sides of shape (n,) or (n, k)."""
        solution, _ = lapack.dgbtrs(self._factors, self._b, self._b, right, self._pivots)
        return np.asarray(solution)


class BorderedBand:
    """A linearisation that is a banded matrix with q dense columns and rows.

    Parameters
    ----------
    band : ndarray of shape (n, 2 b + 1)
        The matrix A by rows.
    columns, rows : ndarray of shape (n, q) and (q, n)
        B and C.
    corner : ndarray of shape (q, q)
        D.
    soft : int, optional
        An index at which both null vectors of a singular A, right and left, are not small.
    """

    def __init__(
        self, band: Array, columns: Array, rows: Array, corner: Array, soft: int | None = None
    ) -> None:
        self._n = band.shape[0]
        self._columns, self._rows, self._corner = columns, rows, corner
        if soft is not None:
            stiffened = band.copy()
            stiffness = np.abs(band[soft]).max()
            stiffened[soft, band.shape[1] // 2] += stiffness
            self._soften(soft, stiffness)
            band = stiffened
        self._factors = BandFactors(band)

    def _soften(self, soft: int, stiffness: float) -> None:
        """Add the border that takes the stiffness off again: z = x[soft]."""
        q = self._corner.shape[0]
        columns, rows = np.zeros((self._n, q + 1)), np.zeros((q + 1, self._n))
        corner = np.zeros((q + 1, q + 1))
        columns[:, :q], rows[:q], corner[:q, :q] = self._columns, self._rows, self._corner
        columns[soft, q], rows[q, soft], corner[q, q] = -stiffness, 1.0, -1.0
        self._columns, self._rows, self._corner = columns, rows, corner

    def solve(
        self, column: Array, row: Array, corner: float, right: Array, last: float
    ) -> tuple[Array, float]:
        """Return x and y of the system with one more column and row, see `numerics.problem`."""
        n, q = self._n, self._corner.shape[0]
        given = column.size - n
        # The border, and the right-hand side beside it.
        rows, whole = np.empty((q + 1, n)), np.zeros((q + 1, q + 2))
        rows[:q], rows[q] = self._rows, row[:n]
        whole[:q, :q], whole[:given, q], whole[q, :given] = self._corner, column[n:], row[n:]
        whole[q, q], whole[:given, -1], whole[q, -1] = corner, right[n:], last
        columns = np.empty((n, q + 2), order="F")
        columns[:, :q], columns[:, q], columns[:, -1] = self._columns, column[:n], right[:n]
        solved = self._factors.solve(columns)
        reduced = whole - rows @ solved
        small = np.linalg.solve(reduced[:, :-1], reduced[:, -1])
        x = solved[:, -1] - solved[:, :-1] @ small
        return np.concatenate([x, small[:given]]), float(small[q])
