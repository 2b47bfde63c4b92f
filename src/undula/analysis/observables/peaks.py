"""Prominent maxima of a sampled signal."""

import numpy as np

from undula.arrays import Array

#: Rise of a maximum above the minima next to it, as a share of the range of the signal; smaller
#: ones are noise.
PROMINENCE = 0.02


def prominent_maxima(values: Array, height: float) -> Array:
    """Return the indices of maxima that rise by more than a height above the minima next to them.

    Parameters
    ----------
    values
        Samples, shape ``(m,)``, m at least 1.
    height
        Least rise, at least 0, in the unit of the values.

    Returns
    -------
    Array
        Shape ``(k,)``, rising.
    """
    rises = np.diff(values) > 0.0
    maxima: list[int] = []
    lowest, top = float(values[0]), -1
    for i in (np.flatnonzero(rises[1:] != rises[:-1]) + 1).tolist():
        if top < 0:
            lowest = min(lowest, values[i])
            top = i if values[i] > lowest + height else -1
        elif values[i] > values[top]:
            top = i
        elif values[i] < values[top] - height:
            maxima.append(top)
            lowest, top = values[i], -1
    return np.array(maxima, dtype=int)
