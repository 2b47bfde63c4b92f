"""The last part of a run in which the motion no longer changes its character."""

from __future__ import annotations

from collections.abc import Iterator

from undula.analysis.observables.shapes import displacement, mean_position, tip_height, transverse
from undula.analysis.observables.spectrum import hann, spectral_peak
from undula.arrays import Array, Instants, Shapes

# Shares of the run tried as the window, longest first: beyond a half the start is always in view,
# and an eighth of a run is the least worth a verdict about the whole.
SHARES = (1 / 2, 1 / 3, 1 / 4, 1 / 6, 1 / 8)
# The window when none is stationary.
FALLBACK_SHARE = 1 / 3
# Four periods give two in each half: enough for the weighted means of the halves to settle.
MIN_PERIODS = 4.0
# Fewer samples than this in the window say nothing about its two halves.
MIN_SAMPLES = 16
# Halves whose means differ by less than this share are the same: ten times the leakage of the
# weight at two periods, and less than any change of regime.
STATIONARY = 0.02


def drift(away: Instants, nodes: Shapes, bending_energy: Instants) -> float:
    """How much the two halves of a window differ, relative to the whole.

    Compares Hann-weighted means of the squared displacement, the drop of the tip below its straight
    height, and the bending energy; the weight makes a cut through a period harmless.

    Parameters
    ----------
    away
        Displacement from straight [L], shape ``(m,)``, m at least 2.
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``.
    bending_energy
        Energy [B/L], shape ``(m,)``.

    Returns
    -------
    float
        The largest of the three relative differences; 0 when nothing moves.
    """
    signals = (away**2, 1.0 - tip_height(nodes), bending_energy)
    return max(_half_difference(signal) for signal in signals)


def late_windows(time: Instants, nodes: Shapes, bending_energy: Instants) -> Iterator[int]:
    """First samples of the late windows that are stationary and hold four periods, longest first.

    Parameters
    ----------
    time
        Equally spaced times [T], shape ``(m,)``.
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``.
    bending_energy
        Energy [B/L], shape ``(m,)``.

    Yields
    ------
    int
        Index of the sample; after these, that of the last third of the run (or of the last 16
        samples, if that is longer), whatever it is like.
    """
    count, away = len(time), displacement(nodes)
    for share in SHARES:
        start = count - round(share * count)
        if count - start < MIN_SAMPLES:
            break
        late = slice(start, None)
        if drift(away[late], nodes[late], bending_energy[late]) > STATIONARY:
            continue
        if _periods(time[late], nodes[late]) >= MIN_PERIODS:
            yield start
    yield max(0, count - max(MIN_SAMPLES, round(FALLBACK_SHARE * count)))


def _half_difference(values: Array) -> float:
    half = len(values) // 2
    weights = hann(half)
    first, last = float(weights @ values[:half]), float(weights @ values[-half:])
    scale = 0.5 * (abs(first) + abs(last))
    # The drop of the tip is a difference from 1, so below this it is made of rounding.
    return abs(last - first) / scale if scale > 1e-12 else 0.0


def _periods(time: Instants, nodes: Shapes) -> float:
    """Return how often the strongest line of the mean position's spectrum repeats."""
    line = spectral_peak(time, transverse(mean_position(nodes))[:, None])
    return abs(line) * float(time[-1] - time[0])
