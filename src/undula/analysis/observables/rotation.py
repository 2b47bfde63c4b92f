"""How a motion goes round: about the axis, or link by link about an axis across it.

The sense of rotation compares what is swept about the z axis with the way that is gone: 1 for a
motion that goes round and round, 0 for one that goes to and fro. Links that windmill turn about a
transverse axis: the vectors of their small turns then add up to one across z, while those of a link
that swings cancel and those of a spinning one point along z.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from undula.analysis.observables.link_sums import link_turns
from undula.analysis.observables.shape_sums import lowest_links
from undula.analysis.observables.shapes import as_shapes, transverse
from undula.arrays import Array, Indices, Shapes

#: Way of a link's direction over which its turning is added up, in full turns: a swing to and fro
#: has cancelled by then, and the axis of a windmill has hardly moved.
SPAN = 3.0
#: Fewer spans than this show no lasting turning.
FEWEST_SPANS = 3
#: A link that turns by more between two samples, in the median, is not followed by them [rad].
FOLLOWED = 1.0


@dataclass(frozen=True)
class LinkRotation:
    """How the links go round about axes across z, each array of shape ``(N,)``, base first.

    Attributes
    ----------
    coherence
        Turning about a transverse axis over the way gone, median over spans of the motion: 1 for a
        link that windmills, 0 for one that swings or spins.
    turns
        Full turns about transverse axes in the window, counted span by span.
    """

    coherence: Array
    turns: Array


def sense_of_rotation(nodes: Shapes) -> float:
    """Rotation about z over motion across it, from -1 to 1, positive from x to y.

    The sum over nodes of Im(conj(w) dw) over that of |w| |dw|, with w = x + i y: 1 for a turning
    shape, 0 in a plane.

    Parameters
    ----------
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``, m at least 2, samples in order of time.
    """
    sides = transverse(nodes)
    middle, moved = 0.5 * (sides[1:] + sides[:-1]), np.diff(sides, axis=0)
    way = float(np.sum(np.abs(middle) * np.abs(moved)))
    return float(np.sum((middle.conj() * moved).imag)) / way if way > 0.0 else 0.0


def lowest_direction(nodes: Shapes) -> Array:
    """Return the least z component of the direction of each link, shape ``(N,)``."""
    lowest = np.empty(nodes.shape[1] - 1)
    lowest_links(as_shapes(nodes), lowest)
    return lowest


def winding(nodes: Shapes, chosen: Indices) -> LinkRotation:
    """Measure how links turn about axes across z.

    Parameters
    ----------
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``, samples in order of time, dense enough for a
        link to turn by less than half a turn in between.
    chosen
        Indices of the links that are measured; the others are said not to turn.
    """
    angle, turned = (
        np.empty((len(chosen), len(nodes) - 1)),
        np.empty((len(chosen), len(nodes) - 1, 2)),
    )
    link_turns(as_shapes(nodes), chosen, angle, turned)
    links = nodes.shape[1] - 1
    coherence, turns = np.zeros(links), np.zeros(links)
    far = angle.sum(axis=1) > 2.0 * np.pi * SPAN * FEWEST_SPANS
    for i in np.flatnonzero(far).tolist():
        spans, link = _spans(angle[i], turned[i]), chosen[i]
        if len(spans) >= FEWEST_SPANS and np.median(angle[i]) <= FOLLOWED:
            coherence[link], turns[link] = np.median(spans), SPAN * np.sum(spans)
    return LinkRotation(coherence, turns)


def _spans(angle: Array, turned: Array) -> Array:
    """Return the transverse turning in successive spans of the way, each relative to the span."""
    way = np.append(0.0, np.cumsum(angle)) / (2.0 * np.pi)
    marks = np.arange(0.0, way[-1], SPAN)
    total = np.vstack([np.zeros(2), np.cumsum(turned, axis=0)]) / (2.0 * np.pi)
    at = np.stack([np.interp(marks, way, total[:, k]) for k in range(2)], axis=1)
    return np.asarray(np.linalg.norm(np.diff(at, axis=0), axis=1) / SPAN)
