"""Hopf points of chains in fifty digits, from a recursion link by link.

Links at small inclinations u_j exp(i omega t) have beads at y_j = l (u_1 + ... + u_j) and joints
with moments m_j = K_{j-1} (u_{j-1} - u_j), u_0 = 0. From one link to the next the balance of
moments loses the inclination of the last link, along which the force acts:

    i omega l w_j y_j = l F (u_j - u_{j+1}) + m_j - 2 m_{j+1} + m_{j+2},    j = 1 .. N-1,

so that all follow from u_1 and u_2. At the tip m_{N+1} = 0 and i omega l w_N y_N = m_N: a
determinant of two by two. Complex numbers are pairs (re, im) in the last axis of object arrays.
"""

from decimal import Decimal, localcontext
from typing import Any

import numpy as np


def exact_hopf(
    links: int, near: tuple[float, float], ends: tuple[str, str] = ("1", "1")
) -> tuple[float, float]:
    """Return force and angular frequency of the Hopf point near a guess, by Newton's method.

    `ends` are the base spring and the drag of the last bead, in decimals.
    """
    p, omega = (Decimal(value) for value in near)
    with localcontext() as context:
        context.prec = 50
        step = Decimal("1e-20")
        for _ in range(8):
            at = _determinant(links, p, omega, ends)
            by_p = (_determinant(links, p + step, omega, ends) - at) / step
            by_omega = (_determinant(links, p, omega + step, ends) - at) / step
            whole = by_p[0] * by_omega[1] - by_p[1] * by_omega[0]
            p -= (at[0] * by_omega[1] - at[1] * by_omega[0]) / whole
            omega -= (by_p[0] * at[1] - by_p[1] * at[0]) / whole
        return float(p), float(omega)


def _determinant(links: int, force: Decimal, omega: Decimal, ends: tuple[str, str]) -> Any:
    one, nought, length = Decimal(1), Decimal(0), 1 / Decimal(links)
    spring, last = (Decimal(end) for end in ends)
    # Two motions at once: with u_1 = 1, u_2 = 0 and the other way round.
    u = np.array([[[one, nought], [nought, nought]], [[nought, nought], [one, nought]]])
    before, moment = -spring * u[0], u[0] - u[1]
    inclination, y = u[1], length * u[0]
    for j in range(1, links):
        ahead = _turned(omega * length * y) - length * force * moment - before + 2 * moment
        y = y + length * inclination
        if j + 1 < links:
            before, moment, inclination = moment, ahead, inclination - ahead
    end = moment - last * _turned(omega * length * y)
    return _product(ahead[0], end[1]) - _product(ahead[1], end[0])


def _turned(z: Any) -> Any:
    """Return i z."""
    return np.stack([-z[..., 1], z[..., 0]], axis=-1)


def _product(a: Any, b: Any) -> Any:
    return np.array([a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]])
