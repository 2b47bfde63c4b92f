"""Share of a motion that is not periodic with a given frequency, at any sampling rate.

A frequency measured on one signal is tested on all nodes. Harmonics above half the sampling rate
are aliased to known lower frequencies and are fitted there.
"""

from __future__ import annotations

import numpy as np

from undula.analysis.observables.planarity import in_plane, plane_angle
from undula.analysis.observables.spectrum import hann
from undula.arrays import Array, Instants, Shapes

# Largest number of harmonics: in flapping at a tip force of 300 B/L^2 those beyond the eighth are
# below one per cent.
MAX_HARMONICS = 8
# Least distance of two aliased harmonics that the Hann weight resolves [cycles over the window]; of
# two closer ones only the lower is fitted.
RESOLUTION_CYCLES = 2.0


def misfit(time: Instants, nodes: Shapes, frequency: float) -> float:
    """Return the share of the motion that is no sum of harmonics of the frequency.

    It is measured on the heights of all nodes and their deflections within the principal plane,
    relative to the RMS of their variation in time, under a Hann weight.

    Parameters
    ----------
    time
        Equally spaced times [T], shape ``(m,)``, m at least 2.
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``.
    frequency
        Positive [cycles/T], with an error of less than one cycle over the window.

    Returns
    -------
    float
        From 0 for a periodic motion to 1 for one without a part of this frequency or without
        motion.
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
    real_rest = signals - basis @ np.concatenate([real, -imaginary])
    imaginary_rest = basis @ np.concatenate([imaginary, real])
    square = np.sum(weights * signals**2)
    rest = np.sum(weights * (real_rest**2 + imaginary_rest**2))
    return float(np.sqrt(rest / square)) if square > 0.0 else 1.0


def _basis(time: Instants, frequency: float, orders: list[int]) -> Array:
    """Return real, then imaginary parts of exp(2 pi i k f t) for all orders k: (m, 2 orders).

    Powers of one exponential a sample take less time than an exponential for each order, and real
    products less than complex ones.
    """
    first = np.exp(2j * np.pi * frequency * (time - np.mean(time)))[:, None]
    powers = np.cumprod(np.broadcast_to(first, (len(time), MAX_HARMONICS)), axis=1)
    powers = np.concatenate([np.ones_like(first), powers], axis=1)[:, np.abs(orders)]
    return np.concatenate([powers.real, np.sign(orders) * powers.imag], axis=1)


def _resolved_orders(samples: int, cycles_per_sample: float) -> list[int]:
    """Return the orders of harmonics, lowest first, whose aliases the window resolves."""
    cycles = [difference * cycles_per_sample for difference in range(2 * MAX_HARMONICS + 1)]
    resolved = [abs(value - round(value)) * samples >= RESOLUTION_CYCLES for value in cycles]
    chosen = [0]
    for order in (sign * k for k in range(1, MAX_HARMONICS + 1) for sign in (1, -1)):
        if all(resolved[abs(order - other)] for other in chosen):
            chosen.append(order)
    return chosen
