"""Changes of the verdict along a ramp, and hysteresis between its two directions.

Verdicts are compared as words; "undecided" is one of them.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise

from undula.analysis.ramps.ramp import Step


@dataclass(frozen=True)
class Regime:
    """Neighbouring steps in one direction that have one verdict.

    Attributes
    ----------
    direction : {"up", "down"}
        Direction in which the parameter changes.
    verdict : str
        Verdict of all the steps.
    start, end : float
        Values of the first and of the last step, in the order of the steps.
    steps : int
        Number of steps.
    """

    direction: str
    verdict: str
    start: float
    end: float
    steps: int


@dataclass(frozen=True)
class RegimeChange:
    """Two neighbouring steps in one direction whose verdicts differ: the change lies between them.

    Attributes
    ----------
    direction : {"up", "down"}
        Direction in which the parameter changes.
    before, after : str
        The verdicts.
    start, end : float
        The last value with the first verdict and the first with the second, in the order of the
        steps.
    """

    direction: str
    before: str
    after: str
    start: float
    end: float

    def distance(self, value: float) -> float:
        """Return the distance of a value of the parameter from the interval of the change."""
        low, high = sorted((self.start, self.end))
        return max(low - value, value - high, 0.0)


@dataclass(frozen=True)
class Hysteresis:
    """Neighbouring values at which the verdicts of the upward and the downward ramp differ.

    Attributes
    ----------
    low, high : float
        The first and the last of these values.
    up, down : str
        The verdicts by direction.
    """

    low: float
    high: float
    up: str
    down: str


def by_direction(steps: Sequence[Step]) -> Mapping[str, Sequence[Step]]:
    """Return the forward steps and, if there are any, the steps back, by direction.

    The steps back begin with the last forward step, at which the ramp turns.
    """
    if not steps:
        return {}
    forward = [step for step in steps if step.direction == steps[0].direction]
    back = list(steps[len(forward) :])
    branches = {forward[0].direction: forward}
    return branches | ({back[0].direction: [forward[-1], *back]} if back else {})


def regimes(steps: Sequence[Step]) -> tuple[Regime, ...]:
    """Return the regimes of a ramp in the order of its steps, direction by direction."""
    result = []
    for direction, branch in by_direction(steps).items():
        for verdict, group in groupby(branch, key=lambda step: step.verdict):
            same = list(group)
            result.append(Regime(direction, verdict, same[0].value, same[-1].value, len(same)))
    return tuple(result)


def regime_changes(steps: Sequence[Step]) -> tuple[RegimeChange, ...]:
    """Return the changes between neighbouring regimes of a ramp, direction by direction."""
    return tuple(
        RegimeChange(earlier.direction, earlier.verdict, later.verdict, earlier.end, later.start)
        for earlier, later in pairwise(regimes(steps))
        if earlier.direction == later.direction
    )


def hysteresis(steps: Sequence[Step]) -> tuple[Hysteresis, ...]:
    """Return the values at which both directions have different verdicts, from low to high."""
    verdicts = {
        direction: {step.value: step.verdict for step in branch}
        for direction, branch in by_direction(steps).items()
    }
    if len(verdicts) < 2:
        return ()
    up, down = verdicts["up"], verdicts["down"]
    common = [(value, up[value], down[value]) for value in sorted(up.keys() & down.keys())]
    result = []
    for pair, group in groupby(common, key=lambda point: point[1:]):
        values = [value for value, *_ in group]
        if pair[0] != pair[1]:
            result.append(Hysteresis(values[0], values[-1], *pair))
    return tuple(result)


def nearest(changes: Sequence[RegimeChange], value: float) -> RegimeChange | None:
    """Return the change nearest to a value, the earliest of several; None without changes."""
    return min(changes, key=lambda change: change.distance(value), default=None)
