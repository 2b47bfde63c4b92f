"""A banded matrix with a few dense columns and rows.

    [ A   B ] [ x ]   [ f ]
    [ C   D ] [ y ] = [ g ]

is solved by block elimination with the factors of A. Where A is singular because of a symmetry, its
null vector is known. A shift is then added to the diagonal entry at which that vector is large, and
subtracted by one more border, so that the factors stay well conditioned.

Source: Govaerts (2000), Numerical Methods for Bifurcations of Dynamical Equilibria, chapter 3.
"""

import numpy as np
from scipy.linalg import lapack

from undula.arrays import Array


def to_lapack(band: Array) -> Array:
    """Return band (n, 2 b + 1), stored by rows, in LAPACK's storage (3 b + 1, n) for `dgbtrf`."""
    n, b = band.shape[0], band.shape[1] // 2
    # Padding columns on either side hold the ends of rows that extend beyond the matrix. In memory
    # the next entry of a row is 3 b numbers later, and the same entry of the next row 3 b + 1.
    columns = np.zeros((n + 2 * b, 3 * b + 1))
    item, step = columns.itemsize, 3 * b * columns.itemsize
    np.ndarray(band.shape, buffer=columns, offset=step, strides=(step + item, step))[:] = band
    return columns[b : n + b].T


class BandFactors:
    """Factors of a banded matrix, with partial pivoting.

    Parameters
    ----------
    band : ndarray of shape (n, 2 b + 1)
        band[i, j - i + b] is the entry (i, j).

    Raises
    ------
    LinAlgError
        A pivot vanishes: the matrix is singular to round-off.
    """

    def __init__(self, band: Array) -> None:
        self._b = band.shape[1] // 2
        self._factors, self._pivots, info = lapack.dgbtrf(
            to_lapack(band), self._b, self._b, overwrite_ab=True
        )
        if info != 0:
            raise np.linalg.LinAlgError(f"pivot {info} of a banded matrix vanishes")

    def solve(self, right: Array) -> Array:
        """Return the solution for right-hand sides.

        Parameters
        ----------
        right : ndarray of shape (n,) or (n, k)
            The right-hand sides.

        Returns
        -------
        ndarray
            The solution, of the same shape.
        """
        solution, _ = lapack.dgbtrs(self._factors, self._b, self._b, right, self._pivots)
        return np.asarray(solution)


class BorderedBand:
    """Factors of a banded matrix with q dense columns and rows.

    Parameters
    ----------
    band : ndarray of shape (n, 2 b + 1)
        The matrix A by rows.
    columns, rows : ndarray of shape (n, q) and (q, n)
        B and C.
    corner : ndarray of shape (q, q)
        D.
    shifted : int, optional
        Index at which both null vectors of a singular A, right and left, are not small; its
        diagonal entry is shifted. None for a regular A.

    Raises
    ------
    LinAlgError
        The band, shifted if asked for, is singular to round-off.
    """

    def __init__(
        self, band: Array, columns: Array, rows: Array, corner: Array, shifted: int | None = None
    ) -> None:
        self._n = band.shape[0]
        self._columns, self._rows, self._corner = columns, rows, corner
        if shifted is not None:
            shifted_band = band.copy()
            shift = np.abs(band[shifted]).max()
            shifted_band[shifted, band.shape[1] // 2] += shift
            self._add_shift_border(shifted, shift)
            band = shifted_band
        self._factors = BandFactors(band)

    def _add_shift_border(self, shifted: int, shift: float) -> None:
        """Add the border that subtracts the shift, with the further unknown z = x[shifted]."""
        q = self._corner.shape[0]
        columns, rows = np.zeros((self._n, q + 1)), np.zeros((q + 1, self._n))
        corner = np.zeros((q + 1, q + 1))
        columns[:, :q], rows[:q], corner[:q, :q] = self._columns, self._rows, self._corner
        columns[shifted, q], rows[q, shifted], corner[q, q] = -shift, 1.0, -1.0
        self._columns, self._rows, self._corner = columns, rows, corner

    def solve(
        self, column: Array, row: Array, corner: float, right: Array, last: float
    ) -> tuple[Array, float]:
        """Return x and y of the system with one more column and row.

        Parameters
        ----------
        column, row : ndarray of shape (n + q,)
            The further column and row.
        corner : float
            Their common entry.
        right : ndarray of shape (n + q,)
            Right-hand side of the first n + q equations.
        last : float
            Right-hand side of the last equation.

        Returns
        -------
        x : ndarray of shape (n + q,)
            The first n + q unknowns.
        y : float
            The last unknown.

        Raises
        ------
        LinAlgError
            The bordered matrix is singular.
        """
        n, q = self._n, self._corner.shape[0]
        given = column.size - n
        # The border, with the right-hand side as its last column.
        rows, border = np.empty((q + 1, n)), np.zeros((q + 1, q + 2))
        rows[:q], rows[q] = self._rows, row[:n]
        border[:q, :q], border[:given, q], border[q, :given] = self._corner, column[n:], row[n:]
        border[q, q], border[:given, -1], border[q, -1] = corner, right[n:], last
        columns = np.empty((n, q + 2), order="F")
        columns[:, :q], columns[:, q], columns[:, -1] = self._columns, column[:n], right[:n]
        solutions = self._factors.solve(columns)
        reduced = border - rows @ solutions
        small = np.linalg.solve(reduced[:, :-1], reduced[:, -1])
        x = solutions[:, -1] - solutions[:, :-1] @ small
        return np.concatenate([x, small[:given]]), float(small[q])
