"""Shapes that a user gives: which are refused, with the cure, and how others are taken.

A shape is a polygon of nodes (M + 1, 3) from the base, at the origin, to the tip. Its own arc
length is that of the polygon, whatever the unit and however unequal its pieces; it counts as the
length L of the body.
"""

from typing import Any

import numpy as np

from undula.arrays import Array, Links, Nodes
from undula.errors import InputError

#: Links of a state have their length 1/N to this part, beyond the errors of any run and of chords
#: in the place of arcs; to this part those that stretch, as they have as soon as they bear a load.
RIGID_SLACK, ELASTIC_SLACK = 0.1, 1.0
#: A base that is farther from the origin than this part of the length is not at the clamp.
AT_CLAMP = 0.01
#: A first piece that leads back from the clamp by more than this angle [rad]: no body does so that
#: its pieces resolve.
BACKWARDS = 0.75 * np.pi


def numbers(given: Any, what: str) -> Array:
    """Return what a user gives as an array of finite floats."""
    try:
        values = np.array(given, dtype=float)
    except (TypeError, ValueError):
        raise InputError(
            f"{what} has to be an array of numbers, not {type(given).__name__}"
        ) from None
    if not np.isfinite(values).all():
        at = tuple(int(k) for k in np.argwhere(~np.isfinite(values))[0])
        place = f"[{', '.join(map(str, at))}]" if at else ""
        raise InputError(f"{what}{place} = {values[at]} is not finite; give finite numbers")
    return values


def pieces(nodes: Nodes) -> tuple[Array, Links]:
    """Return the pieces (M, 3) between nodes (M + 1, 3) and their lengths (M,), none of them 0."""
    along = nodes[1:] - nodes[:-1]
    lengths = np.sqrt((along * along).sum(axis=1))
    # Nodes that differ by round-off alone have no direction between them either.
    none = np.flatnonzero(lengths <= 1e-12 * lengths.max(initial=0.0))
    if none.size:
        raise InputError(
            f"nodes {none[0]} and {none[0] + 1} of the shape coincide (node 0 is the base); leave"
            " one of them out, or give each its place"
        )
    return along, lengths


def fits(nodes: Nodes, *, extensible: bool) -> bool:
    """Tell whether nodes (N + 1, 3) are those of a body of N links as they are."""
    lengths = pieces(nodes)[1] * (len(nodes) - 1)
    slack = ELASTIC_SLACK if extensible else RIGID_SLACK
    return bool(np.abs(lengths - 1.0).max() < slack) and float(np.abs(nodes[0]).max()) == 0.0


def refuse_misfits(nodes: Nodes, *, extensible: bool) -> None:
    """Refuse nodes (N + 1, 3), the first at the origin, that no body of N links has."""
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
    """Return the inclinations (N, 2) [rad] of N equal links that follow a polygon of nodes.

    Each piece has the tangent of the curve at its middle, and in between they are taken linearly.
    Where pieces are finer than links, arc lengths are those of chords as long as links, and
    tangents are averaged over the rest of a link: a curve that was traced on a grid goes up and
    down by steps. The error is of second order in the lengths of pieces and of links.

    Raises
    ------
    InputError
        Nodes coincide, or do not begin at the clamp.
    """
    along, lengths = pieces(nodes)
    _refuse_other_ends(nodes, float(lengths.sum()))
    tangents = np.vstack([[0.0, 0.0, 1.0], along / lengths[:, None]])  # the clamp first
    if tangents[1, 2] < np.cos(BACKWARDS):
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
    """Refuse nodes whose first one is not at the origin."""
    first, last = np.linalg.norm(nodes[0]), np.linalg.norm(nodes[-1])
    if first <= AT_CLAMP * length:
        return
    if last <= AT_CLAMP * length:
        raise InputError(
            "the last node of the shape is at the clamp, the origin, and not the first; give the"
            " nodes from the base to the tip"
        )
    raise InputError(
        "the first node of the shape is not at the clamp, the origin, but at"
        f" ({nodes[0, 0]:.3g}, {nodes[0, 1]:.3g}, {nodes[0, 2]:.3g}); subtract that from all nodes"
    )


def _smoothed(ends: Array, nodes: Nodes, links: int) -> Array:
    """Return arc lengths (M + 1,) of nodes, as parts of the whole, by chords as long as links."""
    marks = np.linspace(0.0, 1.0, links + 1)
    chords = np.diff([np.interp(marks, ends, nodes[:, a]) for a in range(3)], axis=1)
    along = np.append(0.0, np.cumsum(np.linalg.norm(chords, axis=0)))
    return np.asarray(np.interp(ends, marks, along / along[-1]))


def _means(middles: Array, width: float, s: Array, values: Array) -> Array:
    """Return the means over pieces of this width of what is linear between values at s."""
    if width == 0.0:
        return np.interp(middles, s, values)
    low, high = middles - 0.5 * width, middles + 0.5 * width
    grid = np.union1d(s, np.concatenate([low, high]))
    there = np.interp(grid, s, values)
    total = np.append(0.0, np.cumsum(0.5 * (there[1:] + there[:-1]) * np.diff(grid)))
    return np.asarray((np.interp(high, grid, total) - np.interp(low, grid, total)) / width)
