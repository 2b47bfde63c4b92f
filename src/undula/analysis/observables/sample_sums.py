"""Compiled sums over the samples of one quantity."""

import math
from typing import Any

from undula.jit.compilation import entry


@entry("time (m), values (m)", where=lambda m: m > 0)
def line_slope(time: Any, values: Any, tapered: Any) -> Any:
    """Return the slope of the least-squares line through values (m,) at equally spaced times (m,).

    If tapered, under a Hann weight. Times and values are taken relative to the middle sample, which
    reduces round-off.
    """
    count, middle = time.shape[0], time.shape[0] // 2
    total, first, second, level, product = 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(count):
        weight = 1.0 - math.cos(2.0 * math.pi * (i + 0.5) / count) if tapered else 1.0
        clock, value = time[i] - time[middle], values[i] - values[middle]
        total += weight
        first += weight * clock
        second += weight * clock * clock
        level += weight * value
        product += weight * clock * value
    return (product - first * level / total) / (second - first * first / total)


@entry("values (m)")
def mean_and_deviation(values: Any) -> Any:
    """Return the mean and the standard deviation of values (m,)."""
    total, square = 0.0, 0.0
    for i in range(values.shape[0]):
        total += values[i]
    mean = total / values.shape[0]
    for i in range(values.shape[0]):
        square += (values[i] - mean) ** 2
    return mean, math.sqrt(square / values.shape[0])


@entry("values (m)", where=lambda m: m > 0)
def extremes_and_mean(values: Any) -> Any:
    """Return the extremes of values (m,) and of parabolas through local extremes, and the mean."""
    least, largest, total = values[0], values[0], 0.0
    for i in range(values.shape[0]):
        least, largest = min(least, values[i]), max(largest, values[i])
        total += values[i]
    for i in range(1, values.shape[0] - 1):
        rise, fall = values[i] - values[i - 1], values[i] - values[i + 1]
        if rise + fall == 0.0:
            continue
        vertex = values[i] + (rise - fall) ** 2 / (8.0 * (rise + fall))
        if rise >= 0.0 and fall >= 0.0:
            largest = max(largest, vertex)
        elif rise <= 0.0 and fall <= 0.0:
            least = min(least, vertex)
    return least, largest, total / values.shape[0]


@entry("first (m), second (m), gain (m), loss (m)")
def largest_imbalance(first: Any, second: Any, gain: Any, loss: Any) -> Any:
    """Return the largest imbalance of two energies (m,) with the gain and loss (m,) since start."""
    largest = 0.0
    for i in range(first.shape[0]):
        stored = first[i] + second[i] - (first[0] + second[0])
        largest = max(largest, abs(stored + loss[i] - gain[i]))
    return largest


@entry("values (m), ahead (m)", where=lambda m: m > 0)
def largest_ahead(values: Any, share: Any, ahead: Any) -> Any:
    """Write to ahead (m,) the largest of the later values (m,) from each sample on.

    Returns the last index of the overall largest, and the number of samples whose entry in ahead is
    more than a share of it.
    """
    last = values.shape[0] - 1
    largest = values[last]
    for i in range(last, -1, -1):
        largest = max(largest, values[i])
        ahead[i] = largest
    peak, count = 0, 0
    for i in range(last + 1):
        peak = i if ahead[i] == largest else peak
        count += ahead[i] > share * largest
    return peak, count
