"""Compiled sums over the rotation of links from one sample to the next."""

import math
from typing import Any

from undula.jit.compilation import entry


@entry(
    "nodes (m, k, 3), chosen (c) int, angle (c, m - 1), turned (c, m - 1, 2)",
    where=lambda chosen, c, k: c == 0 or (chosen.min() >= 0 and chosen.max() < k - 1),
)
def link_turns(nodes: Any, chosen: Any, angle: Any, turned: Any) -> None:
    """Write the rotations of chosen links (c,) between samples of nodes (m, N + 1, 3).

    The angle [rad] is written to angle (c, m - 1), the x and y components of the rotation vector to
    turned (c, m - 1, 2).
    """
    for i in range(chosen.shape[0]):
        link, x0, y0, z0 = chosen[i], 0.0, 0.0, 0.0
        for j in range(nodes.shape[0]):
            x = nodes[j, link + 1, 0] - nodes[j, link, 0]
            y = nodes[j, link + 1, 1] - nodes[j, link, 1]
            z = nodes[j, link + 1, 2] - nodes[j, link, 2]
            length = math.sqrt(x * x + y * y + z * z)
            x, y, z = x / length, y / length, z / length
            if j > 0:
                u, v, w = y0 * z - z0 * y, z0 * x - x0 * z, x0 * y - y0 * x
                sine = math.sqrt(u * u + v * v + w * w)
                turn = math.atan2(sine, x0 * x + y0 * y + z0 * z)
                factor = turn / sine if sine > 0.0 else 1.0
                angle[i, j - 1] = turn
                turned[i, j - 1, 0], turned[i, j - 1, 1] = factor * u, factor * v
            x0, y0, z0 = x, y, z
