"""Frequencies of a motion over a window, each with an estimate of its own error.

A motion with rotational symmetry has two clocks: how fast it turns about z, and how often its shape
repeats when turns do not count. The whole motion, seen from the laboratory, mixes the two. All
frequencies are in cycles per unit of time (the dimensionless unit T); nothing here is an angular
frequency. Every function wants equally spaced samples.
"""

from __future__ import annotations

import numpy as np

from undula.analysis.observables.fundamental import PART, ROUND_OFF, Frequency, find_frequency
from undula.analysis.observables.sample_sums import line_slope, mean_and_deviation
from undula.analysis.observables.shapes import mean_position, tip_height, transverse
from undula.arrays import Instants, Shapes

__all__ = [
    "Frequency",
    "rotation_frequency",
    "shape_frequency",
    "shape_swings",
    "turning_frequency",
    "whole_motion_frequency",
]

# A quantity that varies by less than this share of its mean does not oscillate: integration errors
# at default tolerances are below it by a factor of ten or more.
STEADY = 1e-4
# A motion this small [L] is round-off.
UNMOVED = 1e-12
# Period doubling or tripling of the shape is looked for up to this factor.
LONGEST_PERIOD = 3


def whole_motion_frequency(time: Instants, nodes: Shapes) -> Frequency | None:
    """Dominant frequency of the mean position seen from the laboratory.

    Taken from x + i y of the mean over the arc length. The sense of a motion that turns is told by
    its `rotation_frequency`.

    Parameters
    ----------
    time
        Equally spaced times [T], shape ``(m,)``.
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``.

    Returns
    -------
    Frequency or None
        Positive. None when the filament rests, when no line stands out, or when the window holds
        fewer than 2.5 periods or a period fewer than 5 samples.
    """
    signal = transverse(mean_position(nodes))[:, None]
    return _without_sense(find_frequency(time, signal)) if np.std(signal) > UNMOVED else None


def turning_frequency(time: Instants, rotation_angle: Instants) -> Frequency | None:
    """Return how often a steady shape comes round: the rate of turning without its sense."""
    return _without_sense(rotation_frequency(time, rotation_angle))


def _without_sense(found: Frequency | None) -> Frequency | None:
    return found and Frequency(abs(found.value), found.error)


def shape_frequency(time: Instants, nodes: Shapes, bending_energy: Instants) -> Frequency | None:
    """How often the shape repeats when turns and reflections do not count.

    Taken jointly from the tip height and the bending energy, which neither a turn about z nor a
    reflection in a plane through z can change. In planar flapping the second half of the period is
    the mirror image of the first, so this is twice the frequency of the flapping.

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
        mean drop of the tip below 1), or for the reasons given for the whole motion.
    """
    moving = _swinging(nodes, bending_energy)
    if not moving:
        return None
    signals = np.stack(moving, axis=1).astype(np.complex128)
    return find_frequency(time, signals, longest_period=LONGEST_PERIOD)


def shape_swings(nodes: Shapes, bending_energy: Instants) -> bool:
    """Whether there is anything for `shape_frequency` to find."""
    return bool(_swinging(nodes, bending_energy))


def _swinging(nodes: Shapes, bending_energy: Instants) -> list[Instants]:
    """Return the quantities that oscillate, with mean 0 and standard deviation 1."""
    found = []
    for values in (1.0 - tip_height(nodes), bending_energy):
        mean, deviation = mean_and_deviation(values)
        # A mean that is round-off has nothing to be relative to.
        if abs(mean) > UNMOVED and deviation > STEADY * abs(mean):
            found.append((values - mean) / deviation)
    return found


def rotation_frequency(time: Instants, rotation_angle: Instants) -> Frequency | None:
    """Mean rate of turning about z: the slope of the rotation angle over 2 pi.

    A straight line under a Hann weight, so that a rate that swings about its mean does not tilt it.
    The error compares it with two overlapping parts of the window and the unweighted line.

    Parameters
    ----------
    time
        Equally spaced times [T], shape ``(m,)``.
    rotation_angle
        Integral of the rate of turning [rad], shape ``(m,)``.

    Returns
    -------
    Frequency or None
        Positive for a turn from x to y, and about 0 for a motion that does not turn. None for fewer
        than 4 samples.
    """
    count = len(time)
    if count < 4:
        return None
    turns = rotation_angle / (2.0 * np.pi)
    value = line_slope(time, turns, True)
    part = max(3, round(PART * count))
    others = [
        line_slope(time[:part], turns[:part], True),
        line_slope(time[-part:], turns[-part:], True),
        line_slope(time, turns, False),
    ]
    spread = max(abs(other - value) for other in others)
    size = 1.0 + float(np.max(np.abs(turns)))
    return Frequency(value, spread + ROUND_OFF * size / float(time[-1] - time[0]))
