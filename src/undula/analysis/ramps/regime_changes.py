"""Where the verdict changes along a series of steps, and where it depends on the way.

A verdict is a word here, whatever it means: "undecided" is one like the others.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise

from undula.analysis.ramps.ramp import Step


@dataclass(frozen=True)
class Regime:
    """Neighbouring steps of one way that have one verdict, and the values they reach from and to.

    Attributes
    ----------
    direction, verdict : str
    start, end : float
        Values of the first and of the last of them, in the order of the steps.
    steps : int
    """

    direction: str
    verdict: str
    start: float
    end: float
    steps: int


@dataclass(frozen=True)
class RegimeChange:
    """Two neighbouring steps of one way whose verdicts differ: the change lies between them.

    Attributes
    ----------
    direction : str
    before, after : str
        The verdicts.
    start, end : float
        The last value with the one verdict and the first with the other, in the order of the steps.
    """

    direction: str
    before: str
    after: str
    start: float
    end: float

    def distance(self, value: float) -> float:
        """Return how far a value of the parameter is from where the change lies."""
        low, high = sorted((self.start, self.end))
        return max(low - value, value - high, 0.0)


@dataclass(frozen=True)
class Hysteresis:
    """Neighbouring values at which the verdict on the way up and on the way down differ.

    Attributes
    ----------
    low, high : float
        The first and the last of these values.
    up, down : str
        The verdicts.
    """

    low: float
    high: float
    up: str
    down: str


def ways(steps: Sequence[Step]) -> Mapping[str, Sequence[Step]]:
    """Return the steps there and, if there are any, the steps back, by direction.

    The way back begins with the last step of the way there.
    """
    if not steps:
        return {}
    there = [step for step in steps if step.direction == steps[0].direction]
    back = list(steps[len(there) :])
    return {there[0].direction: there} | ({back[0].direction: [there[-1], *back]} if back else {})


def regimes(steps: Sequence[Step]) -> tuple[Regime, ...]:
    """Return the regimes of a series in the order in which they were met, way by way."""
    found = []
    for direction, way in ways(steps).items():
        for verdict, group in groupby(way, key=lambda step: step.verdict):
            same = list(group)
            found.append(Regime(direction, verdict, same[0].value, same[-1].value, len(same)))
    return tuple(found)


def regime_changes(steps: Sequence[Step]) -> tuple[RegimeChange, ...]:
    """Return the changes between the regimes of a series, way by way."""
    return tuple(
        RegimeChange(earlier.direction, earlier.verdict, later.verdict, earlier.end, later.start)
        for earlier, later in pairwise(regimes(steps))
        if earlier.direction == later.direction
    )


def hysteresis(steps: Sequence[Step]) -> tuple[Hysteresis, ...]:
    """Return the values at which the two ways end in different verdicts, from low to high."""
    verdicts = {
        direction: {step.value: step.verdict for step in way}
        for direction, way in ways(steps).items()
    }
    if len(verdicts) < 2:
        return ()
    up, down = verdicts["up"], verdicts["down"]
    common = [(value, up[value], down[value]) for value in sorted(up.keys() & down.keys())]
    found = []
    for pair, group in groupby(common, key=lambda one: one[1:]):
        values = [value for value, *_ in group]
        if pair[0] != pair[1]:
            found.append(Hysteresis(values[0], values[-1], *pair))
    return tuple(found)


def nearest(changes: Sequence[RegimeChange], value: float) -> RegimeChange | None:
    """Return the change that lies nearest to a value, the earliest of several; None without any."""
    return min(changes, key=lambda change: change.distance(value), default=None)
