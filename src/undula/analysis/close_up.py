"""The last periods of a run, sampled more finely than the rest.

A long run has too few samples a period to tell what it does or to draw it. Its last periods are
then computed once more from a mark that the simulation has kept, which gives the very same
trajectory.
"""

import numpy as np

from undula.analysis.motion import Motion
from undula.analysis.regimes import straight_verdict
from undula.analysis.settling import Watch
from undula.analysis.simulation import Simulation

#: A run with this many samples a period needs no close-up; one gets twice as many.
ENOUGH_A_PERIOD = 24.0
#: Periods in a close-up, if the marks reach back so far: frequencies gain with their square.
PERIODS = 16.0
#: Of a motion that has not settled, so many: an irregular one takes more to be told as such.
PERIODS_UNSETTLED = 160.0
#: Most samples of a close-up.
MOST_SAMPLES = 8000


def close_up(simulation: Simulation, whole: Motion) -> Motion | None:
    """Return the last periods of a simulation at fine intervals.

    None where its samples will do, or where they, the whole motion, show that it returns to
    straight: a decay is not seen better in its last part.
    """
    fast, slow = _periods(simulation.watch, simulation.time)
    if fast is None or simulation.interval * ENOUGH_A_PERIOD <= fast:
        return None
    if straight_verdict(whole.time, whole.nodes) is not None:
        return None
    end = simulation.time
    periods = PERIODS if simulation.settled else PERIODS_UNSETTLED
    start = max(end - periods * slow, simulation.earliest_mark)
    interval = max(0.5 * fast / ENOUGH_A_PERIOD, (end - start) / MOST_SAMPLES)
    count = int((end - start) / interval)
    if count < 2:
        return None
    # Round-off must not put the first before the mark.
    times = np.maximum(end - interval * np.arange(count, -1, -1, dtype=np.float64), start)
    return Motion.of(simulation.model, times, simulation.again(times))


def _periods(watch: Watch, duration: float) -> tuple[float | None, float]:
    """Return the shortest and the longest period at work late in the run [T]."""
    returns = [time for time, _ in watch.returns]
    candidates = [watch.paces[-1].turn] if watch.paces else []
    if len(returns) > 2:
        beat = 2.0 * (returns[-1] - returns[0]) / (len(returns) - 1)  # two maxima of energy a beat
        candidates.append(beat)
    periods = [period for period in candidates if period and period <= duration]
    return (min(periods), max(periods)) if periods else (None, duration)
