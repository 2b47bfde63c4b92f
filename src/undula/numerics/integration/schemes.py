"""Coefficient tables of the stiff steppers.

A backward differentiation formula of order k, on a uniform grid of step h, in backward differences
D:

    sum_{j=1}^k gamma_j D^j y_n + (1 - kappa_k) gamma_k d = h y'(t_{n+1}),
    gamma_k = sum_{j=1}^k 1/j,

where d = y_{n+1} - sum_{j=0}^k D^j y_n. Its local error is (kappa_k gamma_k + 1/(k+1)) d to leading
order. kappa = 0 gives the classical formulas; Klopfenstein and Shampine's kappa lowers the error at
some cost in stability. Source: Shampine & Reichelt, SIAM J. Sci. Comput. 18 (1997) 1, table 1.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np


@dataclass(frozen=True)
class BackwardDifferentiation:
    """A family of backward differentiation formulas.

    Attributes
    ----------
    name : str
        Name of the family.
    kappa : tuple of float
        kappa_k for k = 1..max order; the order of member k is k.
    stability_angle : tuple of float
        A(alpha)-stability of each member [degrees].
    """

    name: str
    kappa: tuple[float, ...]
    stability_angle: tuple[float, ...]

    @property
    def max_order(self) -> int:
        """Highest order of the family."""
        return len(self.kappa)

    @cached_property
    def tables(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Gamma, alpha = (1 - kappa) gamma and the error constants, indexed by order.

        Index 0 is a placeholder. All three continue to max order + 1, with kappa = 0.
        """
        orders = np.arange(1, self.max_order + 1)
        kappa = np.concatenate(([0.0], self.kappa, [0.0]))
        gamma = np.concatenate(([0.0], np.cumsum(1.0 / np.append(orders, self.max_order + 1))))
        error = kappa * gamma + 1.0 / np.arange(1, self.max_order + 3)
        return gamma, (1.0 - kappa) * gamma, error


BDF = BackwardDifferentiation(
    name="BDF",
    kappa=(0.0, 0.0, 0.0, 0.0, 0.0),
    stability_angle=(90.0, 90.0, 86.0, 73.0, 51.0),
)

NDF = BackwardDifferentiation(
    name="NDF",
    kappa=(-0.1850, -1.0 / 9.0, -0.0823, -0.0415, 0.0),
    stability_angle=(90.0, 90.0, 80.0, 66.0, 51.0),
)

SCHEMES = (BDF, NDF)
