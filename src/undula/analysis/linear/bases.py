"""Basis functions for small displacements of a clamped-free filament.

A basis gives the displacements y_i(s) with y_i(0) = y_i'(0) = 0 at the clamp, and the curvatures
u_i = y_i''. It is scaled so that the bending matrix int u_i u_j ds is the identity; all other
matrices are then bounded for any number of functions.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from scipy.optimize import brentq

from undula.arrays import Array, Points
from undula.numerics.linalg.legendre import legendre_elements


class Basis(Protocol):
    """A set of functions on [0, 1]."""

    @property
    def panels(self) -> Points:
        """Edges of the panels of the Gauss quadrature, from 0 to 1 [L]."""

    @property
    def points(self) -> int:
        """Number of Gauss points on a panel, enough for products of two functions."""

    def evaluate(self, s: Points) -> tuple[Array, Array]:
        """Return displacements and curvatures at arc lengths s (m,), each of shape (m, n)."""


@dataclass(frozen=True)
class LegendreElements:
    """Curvatures that are polynomials on elements, with exponential convergence for smooth loads.

    The curvature is smooth on each element where the load is, and may jump between elements: the
    displacement is its double integral from the clamp, so that no conditions couple the elements.

    Attributes
    ----------
    breaks : tuple of float
        Inner edges of the elements, rising, between 0 and 1 [L].
    degree : int
        Degree of the curvature on each element, at least 0.
    """

    breaks: tuple[float, ...]
    degree: int

    @property
    def panels(self) -> Points:
        """Edges of the elements, from 0 to 1 [L]."""
        return np.array([0.0, *self.breaks, 1.0])

    @property
    def points(self) -> int:
        """Number of Gauss points, exact for the square of a displacement, and more for the load."""
        return self.degree + 12

    def evaluate(self, s: Points) -> tuple[Array, Array]:
        """Return displacements and curvatures at arc lengths s (m,), each of shape (m, n)."""
        curvatures, displacements = legendre_elements(self.panels, self.degree, s)
        return displacements, curvatures


@dataclass(frozen=True)
class BeamModes:
    """Free vibrations of a clamped-free beam, the assumed modes of the paper.

    With cos a_n cosh a_n = -1 and b_n = (cos a_n + cosh a_n) / (sin a_n + sinh a_n),

        Phi_n(s) = cosh a_n s - cos a_n s - b_n (sinh a_n s - sin a_n s),    y_n = Phi_n / a_n^2.

    The hyperbolic parts are written as an exponential that decays from the clamp and one that
    decays from the tip: their difference would be lost in round-off from n = 10 on.

    Source: Ling, Guo & Kanso (2018), section "Linear stability analysis".

    Attributes
    ----------
    count : int
        Number of modes, at least 1.
    """

    count: int

    @property
    def panels(self) -> Points:
        """Edges of equal panels, each a few wavelengths of the shortest mode long."""
        return np.linspace(0.0, 1.0, max(2, self.count // 4) + 1)

    @property
    def points(self) -> int:
        """Number of Gauss points: the square of the shortest mode on a panel to round-off."""
        return 24

    @cached_property
    def roots(self) -> Array:
        """Roots a_n > 0 of cos a cosh a = -1, shape (n,)."""
        middle = (np.arange(self.count) + 0.5) * np.pi
        return np.array(
            [brentq(lambda a: np.cos(a) + 1.0 / np.cosh(a), m - 0.5, m + 0.5) for m in middle]
        )

    def evaluate(self, s: Points) -> tuple[Array, Array]:
        """Return displacements and curvatures at arc lengths s (m,), each of shape (m, n)."""
        a, s = self.roots, np.asarray(s)[:, None]
        decay = np.exp(-a)
        denominator = 1.0 + 2.0 * np.sin(a) * decay - decay**2  # 2 e^-a (sin a + sinh a)
        b = (1.0 + 2.0 * np.cos(a) * decay + decay**2) / denominator
        from_tip = (np.sin(a) - np.cos(a) - decay) / denominator * np.exp(-a * (1.0 - s))
        hyperbolic = from_tip + 0.5 * (1.0 + b) * np.exp(-a * s)
        circular = np.cos(a * s) - b * np.sin(a * s)
        return (hyperbolic - circular) / a**2, hyperbolic + circular
