"""Checks of shapes that a user gives, and their conversion to the links of a model.

A shape is a polygon of nodes (M + 1, 3) from the base, at the origin, to the tip, in any unit and
with pieces of any length. Its arc length counts as the length L of the body.
"""

from typing import Any

import numpy as np

from undula.arrays import Array, Links, Nodes
from undula.errors import InputError

#: Largest relative error of the length 1/N of rigid links in a state, above the errors of runs and
#: of chords instead of arcs; and of extensible links, which a load stretches or compresses.
RIGID_TOLERANCE, ELASTIC_TOLERANCE = 0.1, 1.0
#: Largest distance of the base from the clamp, over the length.
CLAMP_TOLERANCE = 0.01
#: Largest inclination [rad] of the first piece to the axis; no resolved shape exceeds it.
MAX_FIRST_INCLINATION = 0.75 * np.pi


def finite_array(given: Any, what: str) -> Array:
    """Return a user's value as an array of finite floats.

    Parameters
    ----------
    given : array_like
        The value.
    what : str
        Its name, for messages.

    Returns
    -------
    ndarray
        A copy.

    Raises
    ------
    InputError
        It is not an array of finite numbers.
    """
    try:
        values = np.array(given, dtype=float)
    except (TypeError, ValueError):
        raise InputError(
            f"{what} has to be an array of numbers, not {type(given).__name__}"
        ) from None
    if not np.isfinite(values).all():
        index = tuple(int(k) for k in np.argwhere(~np.isfinite(values))[0])
        place = f"[{', '.join(map(str, index))}]" if index else ""
        raise InputError(f"{what}{place} = {values[index]} is not finite; give finite numbers")
    return values


def pieces(nodes: Nodes) -> tuple[Array, Links]:
    """Return the pieces between nodes, and their lengths.

    Parameters
    ----------
    nodes : ndarray, shape (M + 1, 3)
        The nodes.

    Returns
    -------
    along : ndarray, shape (M, 3)
        Vectors from node to node.
    lengths : ndarray, shape (M,)
        Their lengths, above 0.

    Raises
    ------
    InputError
        Two neighbouring nodes coincide.
    """
    along = nodes[1:] - nodes[:-1]
    lengths = np.sqrt((along * along).sum(axis=1))
    # Nodes that differ only by round-off define no direction.
    coincident = np.flatnonzero(lengths <= 1e-12 * lengths.max(initial=0.0))
    if coincident.size:
        raise InputError(
            f"nodes {coincident[0]} and {coincident[0] + 1} of the shape coincide (node 0 is the"
            " base); leave one of them out, or give each its place"
        )
    return along, lengths


def fits(nodes: Nodes, *, extensible: bool) -> bool:
    """Return whether nodes (N + 1, 3) start at the origin and have links of length 1/N."""
    lengths = pieces(nodes)[1] * (len(nodes) - 1)
    tolerance = ELASTIC_TOLERANCE if extensible else RIGID_TOLERANCE
    return bool(np.abs(lengths - 1.0).max() < tolerance) and float(np.abs(nodes[0]).max()) == 0.0


def refuse_misfits(nodes: Nodes, *, extensible: bool) -> None:
    """Raise InputError for nodes (N + 1, 3), the first at the origin, that do not fit N links."""
    if fits(nodes, extensible=extensible):
        return
    links = len(nodes) - 1
    lengths = pieces(nodes)[1]
    worst = int(np.argmax(np.abs(lengths * links - 1.0)))
    raise InputError(
        f"link {worst + 1} of the start is {lengths[worst]:.3g} long, and each of {links} links has"
        f" the length 1/{links} = {1.0 / links:.3g}; give positions from the base to the tip in"
        " units of the length L, or take from_state, which goes by the arc length of its nodes"
    )


def inclinations(nodes: Nodes, links: int) -> Array:
    """Return the inclinations of equal links that follow a polygon of nodes.

    Each piece has the tangent of the curve at its middle; in between tangents are interpolated
    linearly. Where pieces are finer than links, arc lengths are those of chords as long as links,
    and tangents are averaged over the rest of a link, since a curve that was traced on a grid has
    steps. The error is of second order in the lengths of pieces and of links.

    Parameters
    ----------
    nodes : ndarray, shape (M + 1, 3)
        The nodes, base first, in any unit.
    links : int
        Number of links N.

    Returns
    -------
    ndarray, shape (N, 2)
        Inclinations to the axis [rad], in the x and y directions.

    Raises
    ------
    InputError
        Nodes coincide, or do not begin at the clamp.
    """
    along, lengths = pieces(nodes)
    _refuse_other_ends(nodes, float(lengths.sum()))
    tangents = np.vstack([[0.0, 0.0, 1.0], along / lengths[:, None]])  # the clamp first
    if tangents[1, 2] < np.cos(MAX_FIRST_INCLINATION):
        raise InputError(
            "the first piece of the shape leads away from the clamp's axis, by"
            f" {np.arccos(tangents[1, 2]):.3g} rad; give the nodes from the base to the tip, with"
            " the axis along z"
        )
    rest = max(0.0, 1.0 / links - 1.0 / len(lengths))
    ends = np.append(0.0, np.cumsum(lengths)) / lengths.sum()
    ends = _smoothed(ends, nodes, links) if rest > 0.0 else ends
    s = np.append(0.0, 0.5 * (ends[1:] + ends[:-1]))
    middles = (np.arange(links) + 0.5) / links
    x, y, z = (_means(middles, rest, s, tangents[:, a]) for a in range(3))
    across = np.hypot(x, y)
    angle = np.arctan2(across, z)
    factor = np.divide(angle, across, out=np.ones_like(angle), where=across > 0.0)
    return factor[:, None] * np.stack([x, y], axis=-1)


def _refuse_other_ends(nodes: Nodes, length: float) -> None:
    """Raise InputError for nodes whose first is not at the origin."""
    first, last = np.linalg.norm(nodes[0]), np.linalg.norm(nodes[-1])
    if first <= CLAMP_TOLERANCE * length:
        return
    if last <= CLAMP_TOLERANCE * length:
        raise InputError(
            "the last node of the shape is at the clamp, the origin, and not the first; give the"
            " nodes from the base to the tip"
        )
    raise InputError(
        "the first node of the shape is not at the clamp, the origin, but at"
        f" ({nodes[0, 0]:.3g}, {nodes[0, 1]:.3g}, {nodes[0, 2]:.3g}); subtract that from all nodes"
    )


def _smoothed(ends: Array, nodes: Nodes, links: int) -> Array:
    """Return relative arc lengths (M + 1,) of nodes, by chords as long as links."""
    marks = np.linspace(0.0, 1.0, links + 1)
    chords = np.diff([np.interp(marks, ends, nodes[:, a]) for a in range(3)], axis=1)
    along = np.append(0.0, np.cumsum(np.linalg.norm(chords, axis=0)))
    return np.asarray(np.interp(ends, marks, along / along[-1]))


def _means(middles: Array, width: float, s: Array, values: Array) -> Array:
    """Return the means, over pieces of a width, of the linear interpolation of values at s."""
    if width == 0.0:
        return np.interp(middles, s, values)
    low, high = middles - 0.5 * width, middles + 0.5 * width
    grid = np.union1d(s, np.concatenate([low, high]))
    on_grid = np.interp(grid, s, values)
    total = np.append(0.0, np.cumsum(0.5 * (on_grid[1:] + on_grid[:-1]) * np.diff(grid)))
    return np.asarray((np.interp(high, grid, total) - np.interp(low, grid, total)) / width)
