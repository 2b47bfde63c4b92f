"""Maxima of a sampled signal that rise clearly above the minima next to them."""

import numpy as np

from undula.arrays import Array

#: A maximum rises above the minima next to it by this share of the whole swing; others are noise.
PROMINENCE = 0.02


def prominent_maxima(values: Array, height: float) -> Array:
    """Return the indices of maxima that rise by more than a height above the minima next to them.

    Parameters
    ----------
    values
        Samples, shape ``(m,)``.
    height
        At least 0.
    """
    rises = np.diff(values) > 0.0
    found: list[int] = []
    lowest, top = float(values[0]), -1
    for i in (np.flatnonzero(rises[1:] != rises[:-1]) + 1).tolist():
        if top < 0:
            lowest = min(lowest, values[i])
            top = i if values[i] > lowest + height else -1
        elif values[i] > values[top]:
            top = i
        elif values[i] < values[top] - height:
            found.append(top)
            lowest, top = values[i], -1
    return np.array(found, dtype=int)
