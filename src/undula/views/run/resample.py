"""The motion between stored samples: local polynomials in time, in a frame that turns with it.

Six neighbouring samples give the value at a time (Lagrange's form, fewer at need). At eight
samples a cycle of a sine the error is 0.1 per cent of its amplitude. A steady rotation costs
nothing: positions are turned back by the stored angle, interpolated, and turned forward again.
"""

import numpy as np
from numpy.typing import NDArray

from undula.views.run.scene import Floats, Scene

_WIDTH = 6


def stencil(times: Floats, asked: Floats) -> tuple[NDArray[np.intp], Floats]:
    """Find the samples around each asked time, and the weight of each.

    Parameters
    ----------
    times : ndarray of shape (m,)
        Rising times of the samples, m >= 2.
    asked : ndarray of shape (k,)
        Times within the range of `times`.

    Returns
    -------
    tuple of ndarrays of shape (k, w), w = min(6, m)
        Indices into `times`, and weights that sum to 1 in every row.
    """
    width = min(_WIDTH, len(times))
    after = np.searchsorted(times, asked)
    first = np.clip(after - width // 2, 0, len(times) - width)
    index = first[:, None] + np.arange(width)
    knots = times[index]
    weights = np.ones_like(knots)
    for j in range(width):
        others = np.delete(knots, j, axis=1)
        weights[:, j] = np.prod((asked[:, None] - others) / (knots[:, j, None] - others), axis=1)
    return index, weights


def nodes_at(scene: Scene, asked: Floats, nodes: slice = slice(None)) -> Floats:
    """Give the shape at any times within the run.

    Parameters
    ----------
    scene : Scene
        The run.
    asked : ndarray of shape (k,)
        Times within the run [T].
    nodes : slice
        Which nodes are wanted; all by default.

    Returns
    -------
    ndarray of shape (k, n, 3)
        Positions [L], from the close-up where it reaches; those of the nearest sample if the
        samples are too sparse to join.
    """
    if scene.close is None:
        return _nodes_among_samples(scene, asked, nodes)
    late = asked >= scene.close.start
    early = _nodes_among_samples(scene, asked[~late], nodes)
    positions = np.empty((len(asked), *early.shape[1:]))
    positions[~late], positions[late] = early, _nodes_among_samples(scene.close, asked[late], nodes)
    return positions


def _nodes_among_samples(scene: Scene, asked: Floats, nodes: slice) -> Floats:
    positions = scene.nodes[:, nodes]
    if not scene.interpolable:
        return positions[_nearest(scene.times, asked)]
    index, weights = stencil(scene.times, asked)
    turn, picked = scene.turn[index], positions[index]
    plane = (picked[..., 0] + 1j * picked[..., 1]) * np.exp(-1j * turn)[..., None]
    turned = np.einsum("kw,kwn->kn", weights, plane)
    turned = turned * np.exp(1j * np.sum(weights * turn, axis=1))[:, None]
    height = np.einsum("kw,kwn->kn", weights, picked[..., 2])
    return np.stack([turned.real, turned.imag, height], axis=-1)


def tip_at(scene: Scene, asked: Floats) -> Floats:
    """Give the position of the free end at any times within the run: shape (k, 3), [L]."""
    return nodes_at(scene, asked, slice(-1, None))[:, 0]


def values_at(scene: Scene, values: Floats, asked: Floats) -> Floats:
    """Give a quantity that is stored once per sample, shape (m,), at any times: shape (k,)."""
    if not scene.interpolable:
        return values[_nearest(scene.times, asked)]
    index, weights = stencil(scene.times, asked)
    return np.asarray(np.sum(weights * values[index], axis=1))


def curve_times(scene: Scene, start: float, end: float, count: int) -> Floats:
    """Choose the times at which to draw: `count` even ones, or as many stored samples at most."""
    if scene.interpolable and len(scene.times) > 3:
        return np.linspace(max(start, scene.start), end, count)
    inside = scene.times[(scene.times >= start) & (scene.times <= end)]
    even = np.linspace(0, len(inside) - 1, count).round().astype(int)
    return np.asarray(inside[np.unique(even)])


def _nearest(times: Floats, asked: Floats) -> NDArray[np.intp]:
    middles = (times[1:] + times[:-1]) / 2
    return np.asarray(np.searchsorted(middles, asked), dtype=np.intp)
