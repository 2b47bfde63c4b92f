"""Names of motions of a body that is held in one direction, as one that is curved by nature is.

| name | what it is |
| --- | --- |
| at rest | bent and still |
| asymmetric spinning | goes round the axis, its mean to one side of it |
| asymmetric flapping | to and fro about a mean to one side, in a plane or next to one |
| precessing flapping | to and fro in a plane that goes round |

Motions that differ by a turn are not the same here: to come back a shape has to come back as it is.
With its mean on the axis a motion has the name that it would have without a hold.
"""

from __future__ import annotations

from undula.analysis.evidence import STEADY_SHAPE
from undula.analysis.late import GOES_ROUND, PLANAR_TOLERANCE, Late, Name, below

#: Mean position over displacement from which a motion is to one side: what a few periods that are
#: cut somewhere leave of a motion about the axis is a tenth of it.
ASIDE = 0.05
#: A tip that goes round the axis less than once in so many repetitions of the shape does not.
SLOWEST = 50.0
#: Turns in either half of a window that count as going round.
FEWEST_TURNS = 0.5


def rests(late: Late) -> Name | None:
    """Return the name of a shape that does not move."""
    change = late.seen.shape_change
    if not late.seen.steady:
        return None
    reason = f"stays bent: in the window its shape changes by {change:.2g} of itself"
    return Name("at rest", reason, below((change, STEADY_SHAPE)))


def held_name(late: Late, manner: str, margin: float, unrest: str) -> Name:
    """Name a motion that moves in a manner, known with a margin, by where it goes."""
    sense, aside = abs(late.sense), late.bias
    where = f"{manner}; its mean is {aside:.2g} of its displacement off the axis"
    margin = min(margin, max(aside / ASIDE, below((aside, ASIDE))))
    if sense >= GOES_ROUND:
        word = "asymmetric spinning" if aside > ASIDE else "modulated spinning"
        return Name(word, f"{where}; it goes round", min(margin, sense / GOES_ROUND), unrest)
    margin = min(margin, below((sense, GOES_ROUND)))
    rounds, slowest = _rounds(late), _slowest(late)
    if rounds >= slowest:
        told = f"{manner}; its plane goes round {sum(late.drifts):.3g} times in the window"
        return Name("precessing flapping", told, min(margin, rounds / slowest), unrest)
    if rounds > 0.0:
        margin = min(margin, below((rounds, slowest)))
    if aside > ASIDE:
        return Name("asymmetric flapping", where, margin, unrest)
    planar = late.seen.planarity <= PLANAR_TOLERANCE
    return Name("planar flapping" if planar else "non-planar flapping", where, margin, unrest)


def _rounds(late: Late) -> float:
    """Return how often the tip goes round in either half of the window, 0 if to both sides."""
    first, last = late.drifts
    return min(abs(first), abs(last)) if first * last > 0.0 else 0.0


def _slowest(late: Late) -> float:
    """Return how often it has to go round in half a window to be said to."""
    repetitions = late.back.maxima if late.back else 1
    return max(FEWEST_TURNS, 0.5 * repetitions / SLOWEST)
