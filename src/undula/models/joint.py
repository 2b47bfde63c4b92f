"""The elastic joint between two links: energy K psi^2 / 2 of the angle psi between them.

Its moment is needed as g(c) = psi / sin(psi), a smooth function of c = cos(psi) that is 1 for
aligned links and infinite for folded ones (psi = pi).
"""

import math
from typing import Any

from undula.compiled import kernel

#: Below this z = sin^2(psi/2) twelve terms of the series are exact to round-off (0.03^12 = 5e-19).
_SERIES_BELOW = 0.03
#: psi / sin(psi) = sum of coefficient n times z^n.
_SERIES = tuple(
    math.prod([2.0 * k / (2.0 * k + 1.0) for k in range(1, n + 1)], start=1.0) for n in range(12)
)
_SERIES_SLOPE = tuple((n + 1) * _SERIES[n + 1] for n in range(11))


@kernel
def stiffening(c: Any) -> Any:
    """Return g = psi / sin(psi) at c = cos(psi)."""
    z = 0.5 * (1.0 - c)
    if z < _SERIES_BELOW:
        g = _SERIES[11]
        for n in range(10, -1, -1):
            g = g * z + _SERIES[n]
        return g
    return math.acos(c) / math.sqrt(1.0 - c * c)


@kernel
def stiffening_slope(c: Any) -> Any:
    """Return dg/dc at c = cos(psi)."""
    z = 0.5 * (1.0 - c)
    if z < _SERIES_BELOW:
        slope = _SERIES_SLOPE[10]
        for n in range(9, -1, -1):
            slope = slope * z + _SERIES_SLOPE[n]
        return -0.5 * slope
    return (c * stiffening(c) - 1.0) / (1.0 - c * c)
