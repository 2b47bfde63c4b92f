"""Equations whose Lyapunov exponents are known, for `systems`.

Lorenz (1963), unknowns (x, y, z), with sigma = 10, rho = 28, beta = 8/3:

    x' = sigma (y - x),    y' = x (rho - z) - y,    z' = x y - beta z;

the exponents add up to the trace of its derivative, -sigma - 1 - beta.

Torus, two oscillators (Stuart & Landau) that turn each other, unknowns (x1, y1, x2, y2):

    r1' = r1 (m1 - r1^2),  angle1' = 1 + r2^2,    r2' = r2 (m2 - r2^2),  angle2' = sqrt(3) - r1^2;

radii settle, so that the exponents are 0, 0, -2 m1, -2 m2.
"""

import math
from typing import Any

import numpy as np

from undula.jit.compilation import kernel

SIGMA, RHO, BETA = 10.0, 28.0, 8.0 / 3.0


@kernel
def lorenz_rate(y: Any, out: Any) -> None:
    out[0] = SIGMA * (y[1] - y[0])
    out[1] = y[0] * (RHO - y[2]) - y[1]
    out[2] = y[0] * y[1] - BETA * y[2]


@kernel
def lorenz_slope(y: Any, out: Any) -> None:
    out[0, 0], out[0, 1] = -SIGMA, SIGMA
    out[1, 0], out[1, 1], out[1, 2] = RHO - y[2], -1.0, -y[0]
    out[2, 0], out[2, 1], out[2, 2] = y[1], y[0], -BETA


@kernel
def torus_rate(system: Any, y: Any, out: Any) -> None:
    one, two = y[0] * y[0] + y[1] * y[1], y[2] * y[2] + y[3] * y[3]
    turns = 1.0 + two, math.sqrt(3.0) - one
    for i, square in enumerate((one, two)):
        grow, u, v = system.growths[i] - square, y[2 * i], y[2 * i + 1]
        out[2 * i] = grow * u - turns[i] * v
        out[2 * i + 1] = grow * v + turns[i] * u


@kernel
def torus_slope(system: Any, y: Any, out: Any) -> None:
    one, two = y[0] * y[0] + y[1] * y[1], y[2] * y[2] + y[3] * y[3]
    turns = 1.0 + two, math.sqrt(3.0) - one
    for i, square in enumerate((one, two)):
        a, b = 2 * i, 2 * i + 1
        grow, u, v = system.growths[i] - square, y[a], y[b]
        out[a, a], out[a, b] = grow - 2.0 * u * u, -turns[i] - 2.0 * u * v
        out[b, a], out[b, b] = turns[i] - 2.0 * u * v, grow - 2.0 * v * v
        sign, other = (1.0, 2) if i == 0 else (-1.0, 0)
        for j in (other, other + 1):
            out[a, j], out[b, j] = -2.0 * sign * v * y[j], 2.0 * sign * u * y[j]


@kernel
def attractor_residual(system: Any, y: Any, w: Any, c: Any, out: Any) -> None:
    if y.shape[0] == 3:
        lorenz_rate(y, out)
    else:
        torus_rate(system, y, out)
    for i in range(y.shape[0]):
        out[i] = w[i] - c * out[i]


@kernel
def attractor_matrix(system: Any, y: Any, c: Any, band: Any) -> None:
    n = y.shape[0]
    slope = np.zeros((n, n))
    if n == 3:
        lorenz_slope(y, slope)
    else:
        torus_slope(system, y, slope)
    for i in range(n):
        for j in range(n):
            band[i, j - i + 3] = (i == j) - c * slope[i, j]
