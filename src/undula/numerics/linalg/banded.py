"""Banded linear systems: factor once, solve often.

A matrix A with half-bandwidth b is stored by rows, `band[i, j - i + b] = A[i, j]`, so `band` has
shape (n, 2 b + 1) and is zero where a row sticks out of the matrix. Factors are computed in place
without pivoting: the saddle-point matrices of constrained filaments need none, and a pivot that
vanishes is reported.

The factors are A = D L U with unit triangles L, U and D the pivots (stored inverted): then both
sweeps of a solve cost one multiply-add of latency a row. A row is eliminated while it sits in
registers, and what the last rows were solved for stays in registers as well, which takes
straight-line code; that is why the kernels are written out for each `Structure`. Where it says that
entries stay zero they are left out.
"""

from collections.abc import Callable
from functools import cache
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from undula.jit.compilation import kernel_in_order


class Structure(NamedTuple):
    """Which entries of a banded matrix may differ from zero, and the order of its unknowns.

    Attributes
    ----------
    half_bandwidth : int
    block : int
        Unknowns come in blocks of this length.
    entries : frozenset of (int, int, int)
        (r, s, c): row r of a block may have an entry in column c of the block stored s later.
    backwards : bool
        The last block of unknowns is stored, and eliminated, first. Right-hand sides and solutions
        are in the natural order.
    """

    half_bandwidth: int
    block: int
    entries: frozenset[tuple[int, int, int]]
    backwards: bool = False

    @property
    def reach(self) -> int:
        """Number of blocks on either side that a block has entries in."""
        return max(abs(shift) for _, shift, _ in self.entries)


def full(half_bandwidth: int) -> Structure:
    """Return the structure of a band that may have entries everywhere."""
    shifts = range(-half_bandwidth, half_bandwidth + 1)
    return Structure(half_bandwidth, 1, frozenset((0, shift, 0) for shift in shifts))


#: Entries (shift, column) of L and of U in each row of a block.
Rows = list[tuple[list[tuple[int, int]], list[tuple[int, int]]]]


@cache
def filled(structure: Structure) -> Rows:
    """Return where L and U have entries; a shift of 1 is to the block that is stored next."""
    m, reach = structure.block, structure.reach
    blocks = 4 * reach + 1  # the one in the middle does not feel the ends
    rows: list[set[int]] = [set() for _ in range(blocks * m)]
    for at in range(blocks):
        for row, shift, column in structure.entries:
            if 0 <= at + shift < blocks:
                rows[at * m + row].add((at + shift) * m + column)
    for k in range(len(rows)):
        right = {j for j in rows[k] if j > k}
        for later in rows[k + 1 :]:
            if k in later:
                later |= right
    found = []
    for k in range(2 * reach * m, (2 * reach + 1) * m):
        named = [(j // m - 2 * reach, j % m) for j in sorted(rows[k])]
        diagonal = named.index((0, k % m))
        found.append((named[:diagonal], named[diagonal + 1 :]))
    return found


def _entry(structure: Structure, row: int, shift: int, column: int, behind: int = 0) -> str:
    """Return the source of an entry of a row in the block at hand, or so many blocks before."""
    at = structure.block * shift + column - row + structure.half_bandwidth
    if not 0 <= at <= 2 * structure.half_bandwidth:
        raise ValueError(f"row {row} of a block is filled outside the band of {structure}")
    return f"band[first{behind} + {row}, {at}]"


def _blank_source(structure: Structure) -> str:
    """Python source of `blank`."""
    lines = [
        f"{_entry(structure, row, shift, column)} = 0.0"
        for row, (lower, upper) in enumerate(filled(structure))
        for shift, column in [*lower, *upper]
        if (row, shift, column) not in structure.entries
    ]
    return f"""
def blank(band, first0):
    {_indented(lines or ["pass"], 4)}
"""


def _factor_source(structure: Structure) -> str:
    """Python source of `factor`, with the elimination of a block written out."""
    m, lines = structure.block, []
    rows = filled(structure)
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
    # Multipliers of rows before the first are zero, whatever they are multiplied by.
    firsts = [f"first{s} = {m} * max(at - {s}, 0)" for s in range(structure.reach + 1)]
    return f"""
def factor(band):
    for at in range(band.shape[0] // {m}):
        {_indented([*firsts, *lines], 8)}
    return True
"""


def _solve_source(structure: Structure) -> str:
    """Python source of `solve`: the nearest unknown is subtracted last, as it is known last."""
    m, reach = structure.block, structure.reach
    forward: list[str] = []
    backward: list[str] = []
    for row, (lower, upper) in enumerate(filled(structure)):
        inverse = _entry(structure, row, 0, row)
        known = [f"- {_entry(structure, row, s, c)} * x{-s}_{c}" for s, c in lower]
        forward.append(f"x0_{row} = x[natural + {row}] * {inverse} {' '.join(known)}")
        known = [f"- {_entry(structure, row, s, c)} * x{s}_{c}" for s, c in reversed(upper)]
        backward.insert(0, f"x0_{row} = x[natural + {row}] {' '.join(known)}")
    older = pairwise(range(reach, -1, -1))
    keep = [f"x[natural + {row}] = x0_{row}" for row in range(m)]
    keep += [f"x{old}_{row} = x{new}_{row}" for old, new in older for row in range(m)]
    nothing = [f"x{s}_{row} = 0.0" for s in range(1, reach + 1) for row in range(m)]
    natural = f"natural = {f'n - {m} - first0' if structure.backwards else 'first0'}"
    return f"""
def solve(band, x):
    n = band.shape[0]
    {_indented(nothing, 4)}
    for first0 in range(0, n, {m}):
        {_indented([natural, *forward, *keep], 8)}
    {_indented(nothing, 4)}
    for first0 in range(n - {m}, -1, -{m}):
        {_indented([natural, *backward, *keep], 8)}
"""


def _indented(lines: list[str], by: int) -> str:
    return ("\n" + by * " ").join(lines)


def _written_out(source: str, name: str) -> Callable[..., Any]:
    namespace: dict[str, Any] = {}
    exec(source, namespace)
    written: Callable[..., Any] = kernel_in_order(namespace[name])
    return written


@cache
def blank_kernel(structure: Structure) -> Callable[..., Any]:
    """Return a compiled `blank(band, first)`: write 0 where a block of rows is going to fill in.

    `first` is the first of these rows. What the matrix itself may have there is left alone.
    """
    return _written_out(_blank_source(structure), "blank")


@cache
def factor_kernel(structure: Structure) -> Callable[..., Any]:
    """Return a compiled `factor(band) -> bool`: factors in place, False where a pivot vanishes."""
    return _written_out(_factor_source(structure), "factor")


@cache
def solve_kernel(structure: Structure) -> Callable[..., Any]:
    """Return a compiled `solve(band, x)`: overwrite the right-hand side x (n,) by the solution."""
    return _written_out(_solve_source(structure), "solve")


def to_dense(band: np.ndarray) -> np.ndarray:
    """Return the (n, n) matrix that `band` (n, 2 b + 1) holds."""
    n, width = band.shape
    b = width // 2
    # Rows with room for what sticks out of them, read as ones that are shorter by an entry: so each
    # begins one column farther to the right than the row above.
    sheared = np.zeros((n, n + width))
    sheared[:, :width] = band
    return sheared.ravel()[:-n].reshape(n, -1)[:, b : n + b]
