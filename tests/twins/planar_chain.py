"""The beat of a plain chain in its plane, in the angles of its links, by scipy alone.

A turn of link j, of length l = 1/N, moves all beads from j on. With its angle a_j to the axis,
t_j = (sin a_j, 0, cos a_j), and beads of drag 1 the balance of moments across it is

    sum_k A_jk cos(a_j - a_k) a_k' = l F sin(a_j - a_N) + m_j - m_{j+1},    m_j = a_{j-1} - a_j

with A_jk = l^2 (N + 1 - max(j, k)), a_0 = 0, m_{N+1} = 0. These springs know no bound; they are
those of the package as long as no joint turns by more than pi. Inclined out of the plane by small
n_j, links obey

    sum_k A_jk n_k' = L_j n_j - l F n_N + g_j n_{j-1} + g_{j+1} n_{j+1},    g_j = m_j / sin m_j,

with n_0 = g_{N+1} = 0 and the balance of forces along link j in the plane,

    L_j = sum_k A_jk sin(a_j - a_k) a_k' + l F cos(a_j - a_N) - g_j cos m_j - g_{j+1} cos m_{j+1}.
"""

from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

from undula.arrays import Array


class Beat(NamedTuple):
    """One beat of a chain that has settled."""

    frequency: float
    low: float  # of the energy
    high: float
    turns: Array  # (N,), the largest of each joint [rad]
    start: Array  # (N,), angles at its beginning


class PlanarChain:
    """Right-hand sides for a number of links under a tip force."""

    def __init__(self, links: int, force: float) -> None:
        self.links, self.pull = links, force / links
        beyond = np.arange(links, 0, -1.0)
        self.drag = np.minimum.outer(beyond, beyond) / links**2

    def in_plane(self, _: float, a: Array) -> Array:
        moment = -np.diff(a, prepend=0.0)
        torque = self.pull * np.sin(a - a[-1]) + moment
        torque[:-1] -= moment[1:]
        rates: Array = np.linalg.solve(self.drag * np.cos(np.subtract.outer(a, a)), torque)
        return rates

    def both(self, time: float, y: Array) -> Array:
        """Return the rates of the angles, and of columns of inclinations out of the plane."""
        a, n = y[: self.links], y[self.links :].reshape(self.links, -1)
        turning = self.in_plane(time, a)
        psi = np.diff(a, prepend=0.0)
        g = np.append(1.0 / np.sinc(psi / np.pi), 0.0)
        before, after = np.vstack([0.0 * n[:1], n[:-1]]), np.vstack([n[1:], 0.0 * n[:1]])
        pull = g[:-1, None] * before + g[1:, None] * after - self.pull * n[-1]
        along = self.drag * np.sin(np.subtract.outer(a, a)) @ turning
        along += self.pull * np.cos(a - a[-1]) - g[:-1] * np.cos(psi)
        along[:-1] -= g[1:-1] * np.cos(psi[1:])
        return np.concatenate(
            [turning, np.linalg.solve(self.drag, along[:, None] * n + pull).ravel()]
        )


_TOLERANCE = {"rtol": 1e-11, "atol": 1e-12}


def beat(links: int, force: float, until: float = 30.0) -> Beat:
    """Return the beat to which a bent chain has settled by some time."""
    chain, start = PlanarChain(links, force), 0.3 * np.arange(1, links + 1) / links

    def tip(_: float, y: Array) -> float:
        return float(y[-1])

    tip.direction = 1.0  # type: ignore[attr-defined]
    settled = solve_ivp(
        chain.in_plane,
        (0.0, until),
        start,
        method="LSODA",
        events=tip,
        dense_output=True,
        **_TOLERANCE,
    )
    (times,), (angles,) = settled.t_events, settled.y_events
    psi = np.diff(settled.sol(np.linspace(*times[-2:], 4001)), axis=0, prepend=0.0)
    energies = 0.5 * (psi**2).sum(axis=0)
    return Beat(
        frequency=float(1.0 / (times[-1] - times[-2])),
        low=float(energies.min()),
        high=float(energies.max()),
        turns=np.abs(psi).max(axis=1),
        start=angles[-1],
    )


def rate_out_of_plane(links: int, force: float, known: Beat) -> float:
    """Return the leading rate of disturbances of a beat, but for that of a turn, which is 0."""
    whole = np.concatenate([known.start, np.eye(links).ravel()])
    ahead = PlanarChain(links, force).both
    found = solve_ivp(ahead, (0.0, 1.0 / known.frequency), whole, method="DOP853", **_TOLERANCE)
    after = found.y[links:, -1].reshape(links, links)
    # A turn about the axis inclines links by the sines of their angles, after a beat as before.
    across = np.linalg.svd(np.sin(known.start)[None, :])[2][1:]
    multipliers = np.linalg.eigvals(across @ after @ across.T)
    return float(np.log(np.abs(multipliers).max())) * known.frequency
