"""Rotation of a motion about the z axis, and of single links about transverse axes.

The sense of rotation is the signed area swept about the z axis relative to the path length: 1 for a
rotation, 0 for an oscillation. A windmilling link rotates about a transverse axis: its small
rotation vectors add up to a vector across z, while those of an oscillating link cancel and those of
a spinning link point along z.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from undula.analysis.observables.link_sums import link_turns
from undula.analysis.observables.shape_sums import lowest_links
from undula.analysis.observables.shapes import as_shapes, transverse
from undula.arrays import Array, Indices, Shapes

#: Path of a link's direction over which its rotation vectors are added up [turns]: an oscillation
#: has cancelled by then, and the axis of a windmilling link has hardly moved.
SPAN_TURNS = 3.0
#: Least number of such spans from which a lasting rotation is concluded.
MIN_SPANS = 3
#: Largest median rotation of a link between two samples that resolve it [rad].
MAX_LINK_TURN = 1.0


@dataclass(frozen=True)
class LinkRotation:
    """Rotation of the links about transverse axes, each array of shape ``(N,)``, base first.

    Attributes
    ----------
    coherence
        Rotation about a transverse axis over the path length, median over spans of the motion: 1
        for a windmilling link, 0 for an oscillating or a spinning one.
    turns
        Full turns about transverse axes in the window, counted span by span.
    """

    coherence: Array
    turns: Array


def sense_of_rotation(nodes: Shapes) -> float:
    """Return the rotation about z relative to the transverse motion.

    With w = x + i y, it is the sum of Im(conj(w) dw) over nodes and samples, divided by the sum of
    |w| |dw|.

    Parameters
    ----------
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``, m at least 2, samples in order of time.

    Returns
    -------
    float
        From -1 to 1, positive from x to y: 1 for a rotating shape, 0 in a plane and without motion.
    """
    position = transverse(nodes)
    middle, change = 0.5 * (position[1:] + position[:-1]), np.diff(position, axis=0)
    path = float(np.sum(np.abs(middle) * np.abs(change)))
    return float(np.sum((middle.conj() * change).imag)) / path if path > 0.0 else 0.0


def lowest_direction(nodes: Shapes) -> Array:
    """Return the least z component of the direction of each link.

    Parameters
    ----------
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``.

    Returns
    -------
    Array
        Shape ``(N,)``, from -1 to 1, base first.
    """
    lowest = np.empty(nodes.shape[1] - 1)
    lowest_links(as_shapes(nodes), lowest)
    return lowest


def link_rotation(nodes: Shapes, chosen: Indices) -> LinkRotation:
    """Measure the rotation of links about transverse axes.

    Parameters
    ----------
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``, samples in order of time, with less than half a
        turn of a link between two of them.
    chosen
        Indices of the links that are measured, from 0 at the base.

    Returns
    -------
    LinkRotation
        With 0 for the links that are not measured.
    """
    angle, turned = (
        np.empty((len(chosen), len(nodes) - 1)),
        np.empty((len(chosen), len(nodes) - 1, 2)),
    )
    link_turns(as_shapes(nodes), chosen, angle, turned)
    links = nodes.shape[1] - 1
    coherence, turns = np.zeros(links), np.zeros(links)
    far = angle.sum(axis=1) > 2.0 * np.pi * SPAN_TURNS * MIN_SPANS
    for i in np.flatnonzero(far).tolist():
        spans, link = _span_turns(angle[i], turned[i]), chosen[i]
        if len(spans) >= MIN_SPANS and np.median(angle[i]) <= MAX_LINK_TURN:
            coherence[link], turns[link] = np.median(spans), SPAN_TURNS * np.sum(spans)
    return LinkRotation(coherence, turns)


def _span_turns(angle: Array, turned: Array) -> Array:
    """Return the transverse rotation in successive spans of the path, relative to the span."""
    path = np.append(0.0, np.cumsum(angle)) / (2.0 * np.pi)
    marks = np.arange(0.0, path[-1], SPAN_TURNS)
    total = np.vstack([np.zeros(2), np.cumsum(turned, axis=0)]) / (2.0 * np.pi)
    at_marks = np.stack([np.interp(marks, path, total[:, k]) for k in range(2)], axis=1)
    return np.asarray(np.linalg.norm(np.diff(at_marks, axis=0), axis=1) / SPAN_TURNS)
