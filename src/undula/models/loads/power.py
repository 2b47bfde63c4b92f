"""The follower force with a density that is a power of arc length."""

from dataclasses import dataclass

import numpy as np

from undula.arrays import Points
from undula.models.loads.analytic import DensityLoad, require

#: Exponent up to which one polynomial of degree 20 represents s^(p+1) to round-off.
_STEEP_EXPONENT = 18.0
#: Beyond it s^p is nearly exp(-d) at the distance d/p from the tip. Values of d that bound pieces
#: on which degree 20 represents it; below the largest it is lost to round-off.
_LAYER_DEPTHS = (40.0, 20.0, 8.0)
#: Shortest piece at the clamp [L]; shorter pieces would only spoil the conditioning.
_MIN_FIRST_PIECE = 0.1
#: Exponent from which the singularity of s^(p+1) at s = 0 is lost to round-off at degree 20.
_SMOOTH_EXPONENT = 8.0
#: Breaks [L] graded towards that singularity.
_CLAMP_BREAKS = (0.1, 0.33)


@dataclass(frozen=True)
class PowerLoad(DensityLoad):
    """A follower force with the density F (p + 1) s^p.

    Parameters
    ----------
    force : float
        Total force F [B/L^2 for a filament, K/L for a chain], finite, at least 0.
    exponent : float
        Exponent p, finite, at least 0.

    Raises
    ------
    InputError
        A value is out of its range.

    References
    ----------
    Ling, Guo & Kanso (2018), J. R. Soc. Interface 15.

    Examples
    --------
    >>> import undula as un
    >>> print(un.PowerLoad(100.0, exponent=2.0).force_below(0.5))
    12.5
    """

    exponent: float = 1.0

    def __post_init__(self) -> None:
        """Check the values."""
        super().__post_init__()
        require(self, "exponent", 0.0, np.inf, "a finite number, at least 0")

    @property
    def breaks(self) -> tuple[float, ...]:
        """Ends [L] of short pieces where s^(p+1) is singular at the clamp, or steep at the tip."""
        p = self.exponent
        if p > _STEEP_EXPONENT:
            layer = {1.0 - depth / p for depth in _LAYER_DEPTHS}
            return tuple(sorted(s for s in layer if _MIN_FIRST_PIECE <= s < 1.0))
        return _CLAMP_BREAKS if p < _SMOOTH_EXPONENT and p % 1.0 else ()

    # Far below the tip a steep load underflows to 0.
    @np.errstate(under="ignore")
    def force_below(self, s: Points) -> Points:
        """Return F s^(p+1)."""
        return self.force * s ** (self.exponent + 1.0)

    @np.errstate(under="ignore")
    def moment_below(self, s: Points) -> Points:
        """Return F (p + 1) / (p + 2) s^(p+2)."""
        p = self.exponent
        return self.force * (p + 1.0) / (p + 2.0) * s ** (p + 2.0)
