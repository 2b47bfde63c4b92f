"""Late windows of a run in which the motion is stationary."""

from __future__ import annotations

from collections.abc import Iterator

from undula.analysis.observables.shapes import displacement, mean_position, tip_height, transverse
from undula.analysis.observables.spectrum import hann, spectral_peak
from undula.arrays import Array, Instants, Shapes

# Lengths of the windows that are tried, as shares of the run, longest first: more than a half
# always contains the start, and less than an eighth does not represent the run.
WINDOW_SHARES = (1 / 2, 1 / 3, 1 / 4, 1 / 6, 1 / 8)
# Length of the window of a run without a stationary one, as a share of the run.
FALLBACK_SHARE = 1 / 3
# Least number of periods in a window: two in each half, for weighted means that have converged.
MIN_PERIODS = 4.0
# Least number of samples in a window, for a comparison of its halves.
MIN_SAMPLES = 16
# Largest relative difference of the means of the halves of a stationary window: ten times the
# leakage of the weight at two periods, and less than any change of regime.
MAX_STATIONARY_DRIFT = 0.02


def drift(away: Instants, nodes: Shapes, bending_energy: Instants) -> float:
    """Return the relative difference between the two halves of a window.

    It compares Hann-weighted means of the squared displacement, of the drop of the tip below its
    straight height, and of the bending energy. The weight removes the effect of a cut period.

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
        Largest of the three relative differences, at least 0; 0 without motion.
    """
    signals = (away**2, 1.0 - tip_height(nodes), bending_energy)
    return max(_half_difference(signal) for signal in signals)


def late_windows(time: Instants, nodes: Shapes, bending_energy: Instants) -> Iterator[int]:
    """Yield the first samples of the stationary late windows with four periods, longest first.

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
        Index of the sample; last, that of the last third of the run (or of the last 16 samples, if
        that is longer), stationary or not.
    """
    count, away = len(time), displacement(nodes)
    for share in WINDOW_SHARES:
        start = count - round(share * count)
        if count - start < MIN_SAMPLES:
            break
        part = slice(start, None)
        if drift(away[part], nodes[part], bending_energy[part]) > MAX_STATIONARY_DRIFT:
            continue
        if _periods(time[part], nodes[part]) >= MIN_PERIODS:
            yield start
    yield max(0, count - max(MIN_SAMPLES, round(FALLBACK_SHARE * count)))


def _half_difference(values: Array) -> float:
    half = len(values) // 2
    weights = hann(half)
    first, last = float(weights @ values[:half]), float(weights @ values[-half:])
    scale = 0.5 * (abs(first) + abs(last))
    # The drop of the tip is a difference from 1, and round-off below this.
    return abs(last - first) / scale if scale > 1e-12 else 0.0


def _periods(time: Instants, nodes: Shapes) -> float:
    """Return the number of periods of the strongest spectral line of the mean position."""
    line = spectral_peak(time, transverse(mean_position(nodes))[:, None])
    return abs(line) * float(time[-1] - time[0])
