"""Compiled sums over the nodes of many shapes, where array calls would cost more than the sums.

`nodes` (m, N + 1, 3) are shapes [L], `weights` (N + 1,) those of a mean over the arc length. The
modules `trajectory`, `shapes`, `alignment`, `planarity` and `rotation` of this package, and
`undula.analysis.runs.accuracy`, wrap them.
"""

import math
from typing import Any

import numpy as np

from undula.jit.compilation import entry


@entry(
    "rows (m, n), columns (k, 3) int, nodes (m, k, 3)",
    where=lambda columns, k, n: k == 0 or columns.max() < n,
)
def gather(rows: Any, columns: Any, nodes: Any) -> None:
    """Write to nodes the entries of rows (m, n) at columns (N + 1, 3); 0 for a negative column."""
    for i in range(nodes.shape[0]):
        for k in range(nodes.shape[1]):
            for a in range(3):
                nodes[i, k, a] = rows[i, columns[k, a]] if columns[k, a] >= 0 else 0.0


@entry("nodes (m, k, 3), reference (k, 3), weights (k), out (m)")
def distances_from(nodes: Any, reference: Any, weights: Any, out: Any) -> None:
    """Write to out (m,) the RMS distance over arc length of each shape from a reference."""
    # A loop over contiguous coordinates is vectorised by the compiler.
    repeated = np.repeat(weights, 3)
    rows = nodes.reshape(nodes.shape[0], repeated.shape[0])
    target = reference.reshape(repeated.shape[0])
    for i in range(rows.shape[0]):
        total = 0.0
        for j in range(repeated.shape[0]):
            total += repeated[j] * (rows[i, j] - target[j]) ** 2
        out[i] = math.sqrt(total)


@entry("nodes (m, k, 3), weights (k), out (m, 3)")
def means(nodes: Any, weights: Any, out: Any) -> None:
    """Write to out (m, 3) the mean position of each shape."""
    for i in range(nodes.shape[0]):
        x, y, z = 0.0, 0.0, 0.0
        for k in range(nodes.shape[1]):
            x += weights[k] * nodes[i, k, 0]
            y += weights[k] * nodes[i, k, 1]
            z += weights[k] * nodes[i, k, 2]
        out[i, 0], out[i, 1], out[i, 2] = x, y, z


@entry(
    "first (a, k, 3), second (b, k, 3), weights (k), distance (m), angle (m)",
    where=lambda a, b, m: (a == 1 or a == m) and (b == 1 or b == m),
)
def align(first: Any, second: Any, weights: Any, distance: Any, angle: Any) -> None:
    """Write distance and angle (m,) of each pair of shapes after the best rotation of the second.

    Either of the two arrays may contain a single shape, common to all pairs.
    """
    for i in range(distance.shape[0]):
        a, b = first[min(i, first.shape[0] - 1)], second[min(i, second.shape[0] - 1)]
        along, across = 0.0, 0.0
        for k in range(weights.shape[0]):
            # The best rotation is by the argument of the correlation of x + i y.
            along += weights[k] * (a[k, 0] * b[k, 0] + a[k, 1] * b[k, 1])
            across += weights[k] * (a[k, 1] * b[k, 0] - a[k, 0] * b[k, 1])
        angle[i] = math.atan2(across, along)
        modulus, total = math.sqrt(along * along + across * across), 0.0
        cosine, sine = (along / modulus, across / modulus) if modulus > 0.0 else (1.0, 0.0)
        for k in range(weights.shape[0]):
            x = a[k, 0] - cosine * b[k, 0] + sine * b[k, 1]
            y = a[k, 1] - sine * b[k, 0] - cosine * b[k, 1]
            z = a[k, 2] - b[k, 2]
            total += weights[k] * (x * x + y * y + z * z)
        distance[i] = math.sqrt(total)


@entry("nodes (m, k, 3), reference (k, 3), weights (k)")
def largest_aligned_distance(nodes: Any, reference: Any, weights: Any) -> Any:
    """Return the largest distance of shapes from reference (N + 1, 3) after the best rotations."""
    repeated = np.repeat(weights, 3)
    rows = nodes.reshape(nodes.shape[0], repeated.shape[0])
    # Of the reference: x and y as they are, turned by a right angle, and z.
    along, across, heights = (
        np.zeros(repeated.shape),
        np.zeros(repeated.shape),
        np.zeros(repeated.shape),
    )
    for k in range(weights.shape[0]):
        along[3 * k], along[3 * k + 1] = reference[k, 0], reference[k, 1]
        across[3 * k], across[3 * k + 1] = -reference[k, 1], reference[k, 0]
        heights[3 * k + 2] = reference[k, 2]
    largest = 0.0
    for i in range(rows.shape[0]):
        cosine, sine, square = 0.0, 0.0, 0.0
        for j in range(repeated.shape[0]):
            cosine += repeated[j] * rows[i, j] * along[j]
            sine += repeated[j] * rows[i, j] * across[j]
        modulus = math.sqrt(cosine * cosine + sine * sine)
        cosine, sine = (cosine / modulus, sine / modulus) if modulus > 0.0 else (1.0, 0.0)
        for j in range(repeated.shape[0]):
            turned = cosine * along[j] + sine * across[j] + heights[j]
            square += repeated[j] * (rows[i, j] - turned) ** 2
        largest = max(largest, square)
    return math.sqrt(largest)


@entry("nodes (m, k, 3), weights (k)")
def second_moments(nodes: Any, weights: Any) -> Any:
    """Return the weighted sums of x^2 - y^2 and of 2 x y over all shapes."""
    difference, product = 0.0, 0.0
    for i in range(nodes.shape[0]):
        for k in range(nodes.shape[1]):
            x, y = nodes[i, k, 0], nodes[i, k, 1]
            difference += weights[k] * (x * x - y * y)
            product += weights[k] * 2.0 * x * y
    return difference, product


@entry("nodes (m, k, 3), weights (k)")
def squares_in_plane(nodes: Any, weights: Any, angle: Any) -> Any:
    """Return the weighted sums of squares along and across the plane at an azimuth [rad]."""
    cosine, sine, along, across = math.cos(angle), math.sin(angle), 0.0, 0.0
    for i in range(nodes.shape[0]):
        for k in range(nodes.shape[1]):
            x, y = nodes[i, k, 0], nodes[i, k, 1]
            along += weights[k] * (cosine * x + sine * y) ** 2
            across += weights[k] * (cosine * y - sine * x) ** 2
    return along, across


@entry("nodes (m, k, 3)")
def link_squares(nodes: Any) -> Any:
    """Return the least and the largest square of a link's length over all shapes [L^2]."""
    least, largest = np.inf, 0.0
    for i in range(nodes.shape[0]):
        for k in range(1, nodes.shape[1]):
            square = 0.0
            for a in range(3):
                square += (nodes[i, k, a] - nodes[i, k - 1, a]) ** 2
            least, largest = min(least, square), max(largest, square)
    return least, largest


@entry("nodes (m, k, 3)")
def largest_bend(nodes: Any) -> Any:
    """Return the largest square of the tangent of half the angle between neighbouring links.

    The z axis precedes the first link.
    """
    bend = 0.0
    for i in range(nodes.shape[0]):
        x0, y0, z0 = 0.0, 0.0, 1.0
        for k in range(1, nodes.shape[1]):
            x, y, z = (
                nodes[i, k, 0] - nodes[i, k - 1, 0],
                nodes[i, k, 1] - nodes[i, k - 1, 1],
                nodes[i, k, 2] - nodes[i, k - 1, 2],
            )
            length = math.sqrt(x * x + y * y + z * z)
            x, y, z = x / length, y / length, z / length
            difference = (x - x0) ** 2 + (y - y0) ** 2 + (z - z0) ** 2
            total = (x + x0) ** 2 + (y + y0) ** 2 + (z + z0) ** 2
            bend = max(bend, difference / total)
            x0, y0, z0 = x, y, z
    return bend


@entry("nodes (m, k, 3), out (k - 1)")
def lowest_links(nodes: Any, out: Any) -> None:
    """Write to out (N,) the least z component of the direction of each link, over all shapes."""
    out[:] = 1.0
    for i in range(nodes.shape[0]):
        for k in range(out.shape[0]):
            x, y, z = (
                nodes[i, k + 1, 0] - nodes[i, k, 0],
                nodes[i, k + 1, 1] - nodes[i, k, 1],
                nodes[i, k + 1, 2] - nodes[i, k, 2],
            )
            out[k] = min(out[k], z / math.sqrt(x * x + y * y + z * z))
