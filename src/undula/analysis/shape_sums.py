"""Compiled sums over the nodes of many shapes, for arrays so small that calls would cost the most.

Shapes are `nodes` (m, N + 1, 3) [L] and `weights` (N + 1,) those of a mean over the arc length. The
functions around them, in `observables`, `alignment`, `planes`, `turning` and `health`, say what
they are good for.
"""

import math
from typing import Any

import numpy as np

from undula.compiled import entry


@entry
def distances_from(nodes: Any, places: Any, weights: Any, out: Any) -> None:
    """Write to out (m,) how far each shape is from places (N + 1, 3), RMS over the arc length."""
    for i in range(nodes.shape[0]):
        total = 0.0
        for k in range(nodes.shape[1]):
            square = 0.0
            for a in range(3):
                square += (nodes[i, k, a] - places[k, a]) ** 2
            total += weights[k] * square
        out[i] = math.sqrt(total)


@entry
def align(first: Any, second: Any, weights: Any, distance: Any, angle: Any) -> None:
    """Write distance and angle (m,) of each pair of shapes after the best turn of the second.

    Either of the two may be one shape only.
    """
    for i in range(distance.shape[0]):
        a, b = first[min(i, first.shape[0] - 1)], second[min(i, second.shape[0] - 1)]
        along, across = 0.0, 0.0
        for k in range(weights.shape[0]):
            along += weights[k] * (a[k, 0] * b[k, 0] + a[k, 1] * b[k, 1])
            across += weights[k] * (a[k, 1] * b[k, 0] - a[k, 0] * b[k, 1])
        angle[i] = math.atan2(across, along)
        cosine, sine, total = math.cos(angle[i]), math.sin(angle[i]), 0.0
        for k in range(weights.shape[0]):
            x = a[k, 0] - cosine * b[k, 0] + sine * b[k, 1]
            y = a[k, 1] - sine * b[k, 0] - cosine * b[k, 1]
            z = a[k, 2] - b[k, 2]
            total += weights[k] * (x * x + y * y + z * z)
        distance[i] = math.sqrt(total)


@entry
def second_moments(nodes: Any, weights: Any) -> Any:
    """Return the weighted sums of x^2 - y^2 and of 2 x y over all shapes."""
    difference, product = 0.0, 0.0
    for i in range(nodes.shape[0]):
        for k in range(nodes.shape[1]):
            x, y = nodes[i, k, 0], nodes[i, k, 1]
            difference += weights[k] * (x * x - y * y)
            product += weights[k] * 2.0 * x * y
    return difference, product


@entry
def squares_in_plane(nodes: Any, weights: Any, angle: Any) -> Any:
    """Return the weighted sums of squares along and across the plane at an azimuth."""
    cosine, sine, along, across = math.cos(angle), math.sin(angle), 0.0, 0.0
    for i in range(nodes.shape[0]):
        for k in range(nodes.shape[1]):
            x, y = nodes[i, k, 0], nodes[i, k, 1]
            along += weights[k] * (cosine * x + sine * y) ** 2
            across += weights[k] * (cosine * y - sine * x) ** 2
    return along, across


@entry
def link_squares(nodes: Any) -> Any:
    """Return least and largest square of a link's length, and the largest bend.

    That is the square of the tangent of half the angle between neighbouring links, the z axis
    before the first.
    """
    least, largest, bend = np.inf, 0.0, 0.0
    for i in range(nodes.shape[0]):
        x0, y0, z0 = 0.0, 0.0, 1.0
        for k in range(1, nodes.shape[1]):
            x, y, z = (
                nodes[i, k, 0] - nodes[i, k - 1, 0],
                nodes[i, k, 1] - nodes[i, k - 1, 1],
                nodes[i, k, 2] - nodes[i, k - 1, 2],
            )
            square = x * x + y * y + z * z
            least, largest = min(least, square), max(largest, square)
            length = math.sqrt(square)
            x, y, z = x / length, y / length, z / length
            apart = (x - x0) ** 2 + (y - y0) ** 2 + (z - z0) ** 2
            together = (x + x0) ** 2 + (y + y0) ** 2 + (z + z0) ** 2
            bend = max(bend, apart / together)
            x0, y0, z0 = x, y, z
    return least, largest, bend


@entry
def extremes(values: Any) -> Any:
    """Return the least and the largest of samples (m,) and of the parabolas through their tops."""
    least, largest = values[0], values[0]
    for i in range(values.shape[0]):
        least, largest = min(least, values[i]), max(largest, values[i])
    for i in range(1, values.shape[0] - 1):
        rise, fall = values[i] - values[i - 1], values[i] - values[i + 1]
        if rise + fall == 0.0:
            continue
        vertex = values[i] + (rise - fall) ** 2 / (8.0 * (rise + fall))
        if rise >= 0.0 and fall >= 0.0:
            largest = max(largest, vertex)
        elif rise <= 0.0 and fall <= 0.0:
            least = min(least, vertex)
    return least, largest


@entry
def lowest_links(nodes: Any, out: Any) -> None:
    """Write to out (N,) the least z component of each link's direction."""
    out[:] = 1.0
    for i in range(nodes.shape[0]):
        for k in range(out.shape[0]):
            x, y, z = (
                nodes[i, k + 1, 0] - nodes[i, k, 0],
                nodes[i, k + 1, 1] - nodes[i, k, 1],
                nodes[i, k + 1, 2] - nodes[i, k, 2],
            )
            out[k] = min(out[k], z / math.sqrt(x * x + y * y + z * z))
