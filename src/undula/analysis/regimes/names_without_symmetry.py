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

from undula.analysis.regimes.evidence import STEADY_SHAPE
from undula.analysis.regimes.late_window import (
    GOES_ROUND,
    PLANAR_TOLERANCE,
    LateWindow,
    Name,
    below,
)

#: Mean position over displacement from which a motion is to one side: what a few periods that are
#: cut somewhere leave of a motion about the axis is a tenth of it.
OFF_AXIS = 0.05
#: A plane precesses if it goes round in at least so many maxima of the displacement, of which a
#: beat has two: what turns faster is hardly a plane.
FASTEST = 3.0
#: In more than so many, it does not.
SLOWEST = 50.0


def rests(window: LateWindow) -> Name | None:
    """Return the name of a shape that does not move."""
    change = window.seen.shape_change
    if not window.seen.steady:
        return None
    reason = f"stays bent: in the window its shape changes by {change:.2g} of itself"
    return Name("at rest", reason, below((change, STEADY_SHAPE)))


def held_name(window: LateWindow, description: str, margin: float, still_changing: str) -> Name:
    """Name a motion that moves in a manner, known with a margin, by where it goes."""
    sense, aside = abs(window.sense), window.bias
    where = f"{description}; its mean is {aside:.2g} of its displacement off the axis"
    margin = min(margin, max(aside / OFF_AXIS, below((aside, OFF_AXIS))))
    rounds = _rounds(window)
    if 1.0 / SLOWEST <= rounds <= 1.0 / FASTEST:
        told = (
            f"{description}; its plane goes round in {1.0 / rounds:.3g} maxima of its displacement"
        )
        margin = min(margin, SLOWEST * rounds, below((rounds, 1.0 / FASTEST)))
        return Name("precessing flapping", told, margin, still_changing)
    if sense >= GOES_ROUND:
        word = "asymmetric spinning" if aside > OFF_AXIS else "modulated spinning"
        return Name(
            word, f"{where}; it goes round", min(margin, sense / GOES_ROUND), still_changing
        )
    margin = min(margin, below((sense, GOES_ROUND)))
    if aside > OFF_AXIS:
        return Name("asymmetric flapping", where, margin, still_changing)
    planar = window.seen.planarity <= PLANAR_TOLERANCE
    return Name(
        "planar flapping" if planar else "non-planar flapping", where, margin, still_changing
    )


def _rounds(window: LateWindow) -> float:
    """Return how often the plane goes round from one maximum to the next, 0 if to both sides."""
    first, last = window.plane_turns
    maxima = window.back.maxima if window.back else 1
    return 2.0 * min(abs(first), abs(last)) / maxima if first * last > 0.0 else 0.0
