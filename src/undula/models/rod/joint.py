"""The elastic joint between two links: energy K psi^2 / 2 of the angle psi between them.

Its moment enters as g(c) = psi / sin(psi), a smooth function of c = cos(psi) that is 1 for aligned
links and infinite for folded links (psi = pi). There the energy has a kink: the moment is K pi on
either side, with opposite directions. Within `FOLDED` of pi, g is constant, so that the moment is
K g sin(psi), which passes through 0: the kink is rounded off.
"""

import math
from typing import Any

from undula.jit.compilation import kernel

#: Below this z = sin^2(psi/2) twelve terms of the series are exact to round-off (0.03^12 = 5e-19).
_SERIES_BELOW = 0.03
#: psi / sin(psi) = sum of coefficient n times z^n.
_SERIES = tuple(
    math.prod([2.0 * k / (2.0 * k + 1.0) for k in range(1, n + 1)], start=1.0) for n in range(14)
)
#: Angle from pi within which the kink is rounded off [rad]. At this angle a relative error of 1e-7
#: in the length of links, as in a run, changes sin(psi)^2 by less than a hundredth.
FOLDED = 1e-2
_FOLDED_COSINE = -math.cos(FOLDED)
_FOLDED_STIFFENING = (math.pi - FOLDED) / math.sin(FOLDED)
_FOLDED_CHORD = 2.0 * (1.0 - _FOLDED_COSINE)
_FOLDED_ENERGY = 0.5 * (math.pi - FOLDED) ** 2
_SERIES_SLOPE = tuple((n + 1) * _SERIES[n + 1] for n in range(11))
_SERIES_CURVATURE = tuple((n + 2) * (n + 1) * _SERIES[n + 2] for n in range(12))


@kernel
def stiffening(c: Any) -> Any:
    """Return g = psi / sin(psi) at c = cos(psi)."""
    z = 0.5 * (1.0 - c)
    if z < _SERIES_BELOW:
        # Groups of four terms, which are independent of one another.
        low = _SERIES[0] + _SERIES[1] * z + (_SERIES[2] + _SERIES[3] * z) * z * z
        middle = _SERIES[4] + _SERIES[5] * z + (_SERIES[6] + _SERIES[7] * z) * z * z
        high = _SERIES[8] + _SERIES[9] * z + (_SERIES[10] + _SERIES[11] * z) * z * z
        return low + (middle + high * (z * z) * (z * z)) * (z * z) * (z * z)
    if c < _FOLDED_COSINE:
        return _FOLDED_STIFFENING
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
    if c < _FOLDED_COSINE:
        return 0.0
    return (c * stiffening(c) - 1.0) / (1.0 - c * c)


@kernel
def stiffening_curvature(c: Any) -> Any:
    """Return d^2g/dc^2 at c = cos(psi)."""
    z = 0.5 * (1.0 - c)
    if z < _SERIES_BELOW:
        curvature = _SERIES_CURVATURE[11]
        for n in range(10, -1, -1):
            curvature = curvature * z + _SERIES_CURVATURE[n]
        return 0.25 * curvature
    if c < _FOLDED_COSINE:
        return 0.0
    return (stiffening(c) + 3.0 * c * stiffening_slope(c)) / (1.0 - c * c)


@kernel
def joint_energy(chord: Any) -> Any:
    """Return the energy of a joint with K = 1 at chord = |t - t'|^2 = 2 (1 - cos(psi)).

    The chord resolves small angles, which the cosine does not.
    """
    if chord > _FOLDED_CHORD:
        return _FOLDED_ENERGY + 0.5 * _FOLDED_STIFFENING * (chord - _FOLDED_CHORD)
    angle = 2.0 * math.asin(0.5 * math.sqrt(chord))
    return 0.5 * angle * angle
