"""Frequencies of a motion over a window, each with an estimate of its error.

A motion with rotational symmetry has two frequencies: that of the rotation about z, and that of the
shape up to rotations. The motion in the laboratory frame mixes the two. All frequencies are in
cycles per T, not angular, and all functions take equally spaced samples.
"""

from __future__ import annotations

import numpy as np

from undula.analysis.observables.fundamental import (
    PART_SHARE,
    ROUND_OFF_CYCLES,
    Frequency,
    find_frequency,
)
from undula.analysis.observables.sample_sums import line_slope, mean_and_deviation
from undula.analysis.observables.shapes import mean_position, tip_height, transverse
from undula.arrays import Instants, Shapes

__all__ = [
    "Frequency",
    "frequency_fields",
    "rotation_frequency",
    "shape_frequency",
    "shape_swings",
    "turning_frequency",
    "whole_motion_frequency",
]

# Standard deviation, relative to the mean, below which a quantity does not oscillate: integration
# errors at default tolerances are below it by a factor of ten or more.
STEADY_DEVIATION = 1e-4
# Largest motion that round-off makes [L].
ROUND_OFF_LENGTH = 1e-12
# Largest ratio of the period of the shape to that of its strongest line: period tripling.
MAX_PERIOD_RATIO = 3


def whole_motion_frequency(time: Instants, nodes: Shapes) -> Frequency | None:
    """Return the dominant frequency of the mean position in the laboratory frame.

    It is measured on x + i y of the mean over the arc length. The sense of rotation is the sign of
    `rotation_frequency`.

    Parameters
    ----------
    time
        Equally spaced times [T], shape ``(m,)``.
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``.

    Returns
    -------
    Frequency or None
        Positive. None when the filament rests, when no spectral line stands out, or when the window
        holds fewer than 2.5 periods or a period fewer than 5 samples.
    """
    signal = transverse(mean_position(nodes))[:, None]
    return (
        _without_sense(find_frequency(time, signal)) if np.std(signal) > ROUND_OFF_LENGTH else None
    )


def turning_frequency(time: Instants, rotation_angle: Instants) -> Frequency | None:
    """Return the rotation frequency of a steady shape without its sign.

    Parameters
    ----------
    time
        Equally spaced times [T], shape ``(m,)``.
    rotation_angle
        Integral of the rate of rotation [rad], shape ``(m,)``.

    Returns
    -------
    Frequency or None
        Not negative. None for fewer than 4 samples.
    """
    return _without_sense(rotation_frequency(time, rotation_angle))


def _without_sense(frequency: Frequency | None) -> Frequency | None:
    return frequency and Frequency(abs(frequency.value), frequency.error)


def shape_frequency(time: Instants, nodes: Shapes, bending_energy: Instants) -> Frequency | None:
    """Return the frequency at which the shape repeats up to rotations and reflections.

    It is measured jointly on the tip height and the bending energy, which are invariant under
    rotations about z and reflections in planes through z. In planar flapping the second half of a
    period is the mirror image of the first, so that it is twice the frequency of the flapping.

    Parameters
    ----------
    time
        Equally spaced times [T], shape ``(m,)``.
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``.
    bending_energy
        Energy [B/L], shape ``(m,)``.

    Returns
    -------
    Frequency or None
        Positive. None when both quantities are steady to 1e-4 of their mean (the height: of the
        mean drop of the tip below 1), or for the reasons of `whole_motion_frequency`.
    """
    oscillating = _swinging(nodes, bending_energy)
    if not oscillating:
        return None
    signals = np.stack(oscillating, axis=1).astype(np.complex128)
    return find_frequency(time, signals, longest_period=MAX_PERIOD_RATIO)


def shape_swings(nodes: Shapes, bending_energy: Instants) -> bool:
    """Return True if the shape oscillates, so that `shape_frequency` has a signal.

    Parameters
    ----------
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``.
    bending_energy
        Energy [B/L], shape ``(m,)``.
    """
    return bool(_swinging(nodes, bending_energy))


def _swinging(nodes: Shapes, bending_energy: Instants) -> list[Instants]:
    """Return the quantities that oscillate, with mean 0 and standard deviation 1."""
    oscillating = []
    for values in (1.0 - tip_height(nodes), bending_energy):
        mean, deviation = mean_and_deviation(values)
        # A mean of round-off is no scale for a relative deviation.
        if abs(mean) > ROUND_OFF_LENGTH and deviation > STEADY_DEVIATION * abs(mean):
            oscillating.append((values - mean) / deviation)
    return oscillating


def rotation_frequency(time: Instants, rotation_angle: Instants) -> Frequency | None:
    """Return the mean rate of rotation about z: the slope of the rotation angle over 2 pi.

    The slope is that of a straight line fitted under a Hann weight, which an oscillation of the
    rate does not tilt. The error compares it with fits to two overlapping parts of the window and
    with the unweighted fit.

    Parameters
    ----------
    time
        Equally spaced times [T], shape ``(m,)``.
    rotation_angle
        Integral of the rate of rotation [rad], shape ``(m,)``.

    Returns
    -------
    Frequency or None
        Positive for a rotation from x to y, about 0 without rotation. None for fewer than 4
        samples.
    """
    count = len(time)
    if count < 4:
        return None
    turns = rotation_angle / (2.0 * np.pi)
    value = line_slope(time, turns, True)
    part = max(3, round(PART_SHARE * count))
    others = [
        line_slope(time[:part], turns[:part], True),
        line_slope(time[-part:], turns[-part:], True),
        line_slope(time, turns, False),
    ]
    deviation = max(abs(other - value) for other in others)
    scale = 1.0 + float(np.max(np.abs(turns)))
    return Frequency(value, deviation + ROUND_OFF_CYCLES * scale / float(time[-1] - time[0]))


def frequency_fields(name: str, frequency: Frequency | None) -> dict[str, float | None]:
    """Return a frequency and its error in plain JSON types.

    Parameters
    ----------
    name
        Key of the frequency; that of its error is the name with "_error".
    frequency
        None for a quantity without a frequency, which gives two times None.
    """
    if frequency is None:
        return {name: None, f"{name}_error": None}
    return {name: float(frequency.value), f"{name}_error": float(frequency.error)}
