"""How much of a motion does not repeat with a given period, at any rate of sampling.

A frequency known from one signal is used on all nodes. Harmonics above half the sampling rate
are not lost: they appear folded to lower frequencies, at known places, and are fitted there.
"""

from __future__ import annotations

import numpy as np

from undula.analysis.observables.planarity import in_plane, plane_angle
from undula.analysis.observables.spectrum import hann
from undula.arrays import Array, Instants, Shapes

# In a violent flapping (tip force 300) the harmonics beyond the eighth are below one per cent.
MAX_HARMONICS = 8
# Two harmonics that fold to within this many windings over the window of each other are one to the
# Hann weight; where they coincide the one stands for the other.
RESOLUTION = 2.0


def misfit(time: Instants, nodes: Shapes, frequency: float) -> float:
    """Share of the motion that is no sum of harmonics of the frequency.

    Taken from the heights of all nodes and their deflections along the principal plane, relative to
    the RMS of their variation in time, under a Hann weight.

    Parameters
    ----------
    time
        Equally spaced times [T], shape ``(m,)``, m at least 2.
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``.
    frequency
        Cycles per T, positive, known to well within a winding over the window.

    Returns
    -------
    float
        0 for a periodic motion, 1 for one that has nothing of the frequency or does not move.
    """
    along, _ = in_plane(nodes, plane_angle(nodes))
    signals = np.concatenate([along, nodes[..., 2]], axis=1)
    weights = hann(len(time))[:, None]
    signals = signals - np.sum(weights * signals, axis=0)
    orders = _resolved_orders(len(time), frequency * float(time[1] - time[0]))
    basis = _basis(time, frequency, orders)
    weighted, n = (weights * basis).T, len(orders)
    gram, sums = weighted @ basis, weighted @ signals
    coefficients = np.linalg.solve(
        gram[:n, :n] + gram[n:, n:] + 1j * (gram[:n, n:] - gram[n:, :n]),
        sums[:n] - 1j * sums[n:],
    )
    real, imaginary = coefficients.real, coefficients.imag
    left = signals - basis @ np.concatenate([real, -imaginary])
    beside = basis @ np.concatenate([imaginary, real])
    size, rest = np.sum(weights * signals**2), np.sum(weights * (left**2 + beside**2))
    return float(np.sqrt(rest / size)) if size > 0.0 else 1.0


def _basis(time: Instants, frequency: float, orders: list[int]) -> Array:
    """Real parts of exp(2 pi i k f t) for all orders k, then the imaginary ones: (m, 2 orders).

    One exponential a sample and its powers are much quicker than one for each order, and products
    of real numbers than those of complex ones.
    """
    once = np.exp(2j * np.pi * frequency * (time - np.mean(time)))[:, None]
    powers = np.cumprod(np.broadcast_to(once, (len(time), MAX_HARMONICS)), axis=1)
    powers = np.concatenate([np.ones_like(once), powers], axis=1)[:, np.abs(orders)]
    return np.concatenate([powers.real, np.sign(orders) * powers.imag], axis=1)


def _resolved_orders(samples: int, cycles_per_sample: float) -> list[int]:
    """Harmonics, lowest first, that fold to places of their own."""
    cycles = [difference * cycles_per_sample for difference in range(2 * MAX_HARMONICS + 1)]
    apart = [abs(each - round(each)) * samples >= RESOLUTION for each in cycles]
    chosen = [0]
    for order in (sign * k for k in range(1, MAX_HARMONICS + 1) for sign in (1, -1)):
        if all(apart[abs(order - other)] for other in chosen):
            chosen.append(order)
    return chosen
