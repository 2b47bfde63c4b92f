"""Banded linear systems, factored once and solved often.

A matrix A with half-bandwidth b is stored by rows, `band[i, j - i + b] = A[i, j]`, so `band` has
shape (n, 2 b + 1) and is zero where a row extends beyond the matrix. Factors are computed in place
without pivoting: the saddle-point matrices of constrained filaments do not need it, and a vanishing
pivot is reported.

The factors are A = D L U with unit triangles L and U, and the pivots D, stored inverted. Both
sweeps of a solve then have the latency of one multiply-add a row. A row is eliminated in registers,
and the last unknowns stay in registers as well. This takes straight-line code, so that the kernels
are generated for each `Structure`, without the entries that stay zero.
"""

from collections.abc import Callable
from functools import cache
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from undula.jit.compilation import kernel_in_order


class Structure(NamedTuple):
    """Sparsity of a banded matrix, and the order of its unknowns.

    Attributes
    ----------
    half_bandwidth : int
        Number of diagonals on either side of the main diagonal.
    block : int
        Length of the blocks of unknowns.
    entries : frozenset of (int, int, int)
        (r, s, c): row r of a block may have an entry in column c of the block stored s later.
    backwards : bool
        True if the last block of unknowns is stored, and eliminated, first. Right-hand sides and
        solutions are in the natural order.
    """

    half_bandwidth: int
    block: int
    entries: frozenset[tuple[int, int, int]]
    backwards: bool = False

    @property
    def reach(self) -> int:
        """Number of blocks on either side in which a block has entries."""
        return max(abs(shift) for _, shift, _ in self.entries)


def full(half_bandwidth: int) -> Structure:
    """Return the structure of a band that may have entries everywhere."""
    shifts = range(-half_bandwidth, half_bandwidth + 1)
    return Structure(half_bandwidth, 1, frozenset((0, shift, 0) for shift in shifts))


#: Entries (shift, column) of L and of U in each row of a block.
FillIn = list[tuple[list[tuple[int, int]], list[tuple[int, int]]]]


@cache
def fill_in(structure: Structure) -> FillIn:
    """Return the entries of L and U in the rows of a block; shift 1 is the block stored next."""
    m, reach = structure.block, structure.reach
    blocks = 4 * reach + 1  # the block in the middle does not depend on the ends
    rows: list[set[int]] = [set() for _ in range(blocks * m)]
    for block in range(blocks):
        for row, shift, column in structure.entries:
            if 0 <= block + shift < blocks:
                rows[block * m + row].add((block + shift) * m + column)
    for k in range(len(rows)):
        right = {j for j in rows[k] if j > k}
        for later in rows[k + 1 :]:
            if k in later:
                later |= right
    triangles = []
    for k in range(2 * reach * m, (2 * reach + 1) * m):
        entries = [(j // m - 2 * reach, j % m) for j in sorted(rows[k])]
        diagonal = entries.index((0, k % m))
        triangles.append((entries[:diagonal], entries[diagonal + 1 :]))
    return triangles


def _entry(structure: Structure, row: int, shift: int, column: int, behind: int = 0) -> str:
    """Return the source of an entry of a row in the present block, or `behind` blocks before."""
    diagonal = structure.block * shift + column - row + structure.half_bandwidth
    if not 0 <= diagonal <= 2 * structure.half_bandwidth:
        raise ValueError(f"row {row} of a block is filled outside the band of {structure}")
    return f"band[first{behind} + {row}, {diagonal}]"


def _clear_source(structure: Structure) -> str:
    """Return the Python source of `clear`."""
    lines = [
        f"{_entry(structure, row, shift, column)} = 0.0"
        for row, (lower, upper) in enumerate(fill_in(structure))
        for shift, column in [*lower, *upper]
        if (row, shift, column) not in structure.entries
    ]
    return f"""
def clear(band, first0):
    {_indented(lines or ["pass"], 4)}
"""


def _factor_source(structure: Structure) -> str:
    """Return the Python source of `factor`, with the elimination of a block written out."""
    m, lines = structure.block, []
    rows = fill_in(structure)
    for row, (lower, upper) in enumerate(rows):
        names = {entry: f"r{k}" for k, entry in enumerate([*lower, (0, row), *upper])}
        for (shift, column), name in names.items():
            lines.append(f"{name} = {_entry(structure, row, shift, column)}")
        for shift, pivot in lower:
            for further, column in rows[pivot][1]:
                above = _entry(structure, pivot, further, column, behind=-shift)
                lines.append(f"{names[shift + further, column]} -= {names[shift, pivot]} * {above}")
        lines += [f"if not abs({names[0, row]}) > 0.0:", "    return False"]
        lines.append(f"inverse = 1.0 / {names[0, row]}")
        for (shift, column), name in names.items():
            value = "inverse" if (shift, column) == (0, row) else f"{name} * inverse"
            lines.append(f"{_entry(structure, row, shift, column)} = {value}")
    # Rows before the first have zero multipliers: any row may stand in for them.
    firsts = [f"first{s} = {m} * max(block - {s}, 0)" for s in range(structure.reach + 1)]
    return f"""
def factor(band):
    for block in range(band.shape[0] // {m}):
        {_indented([*firsts, *lines], 8)}
    return True
"""


def _solve_source(structure: Structure) -> str:
    """Return the Python source of `solve`, which subtracts the latest unknown last."""
    m, reach = structure.block, structure.reach
    forward: list[str] = []
    backward: list[str] = []
    for row, (lower, upper) in enumerate(fill_in(structure)):
        inverse = _entry(structure, row, 0, row)
        terms = [f"- {_entry(structure, row, s, c)} * x{-s}_{c}" for s, c in lower]
        forward.append(f"x0_{row} = x[natural + {row}] * {inverse} {' '.join(terms)}")
        terms = [f"- {_entry(structure, row, s, c)} * x{s}_{c}" for s, c in reversed(upper)]
        backward.insert(0, f"x0_{row} = x[natural + {row}] {' '.join(terms)}")
    older = pairwise(range(reach, -1, -1))
    store = [f"x[natural + {row}] = x0_{row}" for row in range(m)]
    store += [f"x{old}_{row} = x{new}_{row}" for old, new in older for row in range(m)]
    zeros = [f"x{s}_{row} = 0.0" for s in range(1, reach + 1) for row in range(m)]
    natural = f"natural = {f'n - {m} - first0' if structure.backwards else 'first0'}"
    return f"""
def solve(band, x):
    n = band.shape[0]
    {_indented(zeros, 4)}
    for first0 in range(0, n, {m}):
        {_indented([natural, *forward, *store], 8)}
    {_indented(zeros, 4)}
    for first0 in range(n - {m}, -1, -{m}):
        {_indented([natural, *backward, *store], 8)}
"""


def _indented(lines: list[str], by: int) -> str:
    return ("\n" + by * " ").join(lines)


def _compiled(source: str, name: str) -> Callable[..., Any]:
    namespace: dict[str, Any] = {}
    exec(source, namespace)
    function: Callable[..., Any] = kernel_in_order(namespace[name])
    return function


@cache
def clear_kernel(structure: Structure) -> Callable[..., Any]:
    """Return a compiled `clear(band, first)`: write 0 to the fill-in of a block of rows.

    `first` is the first of these rows. Entries of the matrix itself are not changed.
    """
    return _compiled(_clear_source(structure), "clear")


@cache
def factor_kernel(structure: Structure) -> Callable[..., Any]:
    """Return a compiled `factor(band) -> bool`: factors in place, False where a pivot vanishes."""
    return _compiled(_factor_source(structure), "factor")


@cache
def solve_kernel(structure: Structure) -> Callable[..., Any]:
    """Return a compiled `solve(band, x)`: overwrite the right-hand side x (n,) by the solution."""
    return _compiled(_solve_source(structure), "solve")


def to_dense(band: np.ndarray) -> np.ndarray:
    """Return the (n, n) matrix that `band` (n, 2 b + 1) holds."""
    n, width = band.shape
    b = width // 2
    # Padded rows, read as rows shorter by one entry: each then begins one column farther to the
    # right than the row above.
    sheared = np.zeros((n, n + width))
    sheared[:, :width] = band
    return sheared.ravel()[:-n].reshape(n, -1)[:, b : n + b]
