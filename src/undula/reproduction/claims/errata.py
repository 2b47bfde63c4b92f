"""Computations for the errata of the paper in units, test functions and coordinates.

Errata of thresholds, frequencies and energies follow from the answers of commands.
"""

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

from undula.arrays import Points
from undula.models.chain import Chain
from undula.models.loads.analytic import TipLoad

__all__ = [
    "free_end_residual",
    "power_of_length_in_chain_time",
    "rank_of_angles_at_straight",
    "rank_of_test_functions",
    "second_moment_over_area_squared",
    "springs_of_chain",
    "twist_over_bending",
]

#: Number of modes; the hyperbolic functions of further modes exceed 1e6.
MODES = 4
#: Turn of a link for which energies are quadratic to a relative accuracy of 1e-6 [rad].
_SMALL = 1e-3


def second_moment_over_area_squared() -> float:
    """Return I/A² of a disc by integration over strips; the bending stiffness is E I, not E A²."""
    moment, _ = quad(lambda y: y * y * 2.0 * np.sqrt(1.0 - y * y), -1.0, 1.0)
    area, _ = quad(lambda y: 2.0 * np.sqrt(1.0 - y * y), -1.0, 1.0)
    return float(moment / area**2)


def twist_over_bending(poisson: float) -> float:
    """Return the twist stiffness of a circular section over its bending stiffness.

    The twist stiffness is G J and the bending stiffness E I, with I and J by integration and the
    shear modulus G = E / (2 (1 + ν)).
    """
    moment, _ = quad(lambda y: y * y * 2.0 * np.sqrt(1.0 - y * y), -1.0, 1.0)
    polar, _ = quad(lambda r: r * r * 2.0 * np.pi * r, 0.0, 1.0)
    return float(polar / moment / (2.0 * (1.0 + poisson)))


def springs_of_chain(links: int) -> float:
    """Return the number of springs of a chain: energy of all bent joints over that of one."""
    model = Chain(links, TipLoad(0.0))

    def energy(turns: Points) -> float:
        angles = np.cumsum(turns)
        steps = np.stack([np.sin(angles), np.zeros(links), np.cos(angles)], axis=1) / links
        nodes = np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])
        return float(model.energy(model.from_nodes(nodes)))

    single = np.zeros(links)
    single[-1] = _SMALL
    return energy(np.full(links, _SMALL)) / energy(single)


def free_end_residual() -> float:
    """Return the largest moment or shear at the free end of the modes with the printed b."""
    worst = 0.0
    for a in _roots():
        b = (np.cos(a) + np.cosh(a)) / (np.sin(a) + np.sinh(a))
        moment = np.cosh(a) + np.cos(a) - b * (np.sinh(a) + np.sin(a))
        shear = np.sinh(a) - np.sin(a) - b * (np.cosh(a) + np.cos(a))
        worst = max(worst, abs(moment), abs(shear))
    return float(worst)


def rank_of_test_functions(count: int) -> int:
    """Return the rank of `count` test functions, each of which is the sum of all modes."""
    s = np.linspace(0.0, 1.0, 201)
    modes = np.array([_mode(a, s) for a in _roots()])
    functions = np.array([modes.sum(axis=0) for _ in range(count)])
    return int(np.linalg.matrix_rank(functions))


def power_of_length_in_chain_time() -> float:
    """Return the exponent a for which ζ L^a / K is a time, with ζ the drag of a bead."""
    # Rows: exponents of kg, m, s. A drag coefficient is kg/s, K an energy kg m²/s².
    drag, spring, time = np.array([1, 0, -1]), np.array([1, 2, -2]), np.array([0, 0, 1])
    length = np.array([0, 1, 0])
    solution, *_ = np.linalg.lstsq(length[:, None], time - drag + spring, rcond=None)
    return float(solution[0])


def rank_of_angles_at_straight() -> int:
    """Return the number of directions in which the angles θ, φ turn a link along the axis."""
    theta, phi = np.pi / 2.0, 0.3
    along_theta = [-np.sin(theta) * np.cos(phi), -np.sin(theta) * np.sin(phi), np.cos(theta)]
    along_phi = [-np.cos(theta) * np.sin(phi), np.cos(theta) * np.cos(phi), 0.0]
    return int(np.linalg.matrix_rank(np.array([along_theta, along_phi]), tol=1e-9))


def _roots() -> Points:
    """Return the roots of cos a cosh a = -1, one near each odd multiple of pi/2."""
    middles = (np.arange(MODES) + 0.5) * np.pi
    return np.array(
        [brentq(lambda a: np.cos(a) + 1.0 / np.cosh(a), m - 0.5, m + 0.5) for m in middles]
    )


def _mode(a: float, s: Points) -> Points:
    b = (np.cos(a) + np.cosh(a)) / (np.sin(a) + np.sinh(a))
    return np.asarray(np.cosh(a * s) - np.cos(a * s) - b * (np.sinh(a * s) - np.sin(a * s)))
