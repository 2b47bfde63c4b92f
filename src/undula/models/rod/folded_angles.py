"""Angles between neighbouring links of a rod, from the positions of its nodes."""

import numpy as np

from undula.arrays import Array


def folded_angles(by_node: Array) -> Array:
    """Return the angles between neighbouring links (..., N) [rad], from 0 to pi.

    The first one is between the clamp's axis and the first link.

    Parameters
    ----------
    by_node : ndarray of shape (..., N, d)
        Coordinates of the nodes that move [L], the one along the axis last.
    """
    # Coordinate by coordinate: an array for each is much faster than one for all.
    dimension = by_node.shape[-1]
    links = [np.diff(by_node[..., a], axis=-1, prepend=0.0) for a in range(dimension)]
    length = np.sqrt(sum(component * component for component in links))
    apart, together = np.zeros_like(length), np.zeros_like(length)
    for a, component in enumerate(links):
        outer = component / length
        inner = np.empty_like(outer)
        inner[..., 0] = 1.0 if a == dimension - 1 else 0.0  # the clamp
        inner[..., 1:] = outer[..., :-1]
        apart += (outer - inner) ** 2
        together += (outer + inner) ** 2
    return np.asarray(2.0 * np.arctan2(np.sqrt(apart), np.sqrt(together)))
