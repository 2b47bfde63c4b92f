"""Names of motions of filaments without rotational symmetry (natural curvature, anisotropy).

| name | motion |
| --- | --- |
| at rest | a bent equilibrium |
| asymmetric spinning | rotation about z with the mean shape off the axis |
| asymmetric flapping | oscillation with the mean shape off the axis, nearly planar |
| precessing flapping | oscillation in a plane that rotates |

Shapes are compared without rotations. A motion with its mean shape on the axis has the name that it
would have with rotational symmetry.
"""

from __future__ import annotations

from undula.analysis.regimes.evidence import MAX_STEADY_CHANGE
from undula.analysis.regimes.late_window import (
    MIN_SENSE_OF_ROTATION,
    PLANAR_TOLERANCE,
    LateWindow,
    Name,
    below,
)

#: Least distance of the mean shape from the axis, relative to the displacement, of an asymmetric
#: motion: ten times the effect of cut periods on a symmetric one.
OFF_AXIS = 0.05
#: Least number of maxima of the displacement, two a beat, in a turn of a precessing plane: a faster
#: rotation has hardly a plane.
MIN_MAXIMA_PER_TURN = 3.0
#: Largest number of maxima of the displacement in a turn of a precessing plane.
MAX_MAXIMA_PER_TURN = 50.0


def name_at_rest(window: LateWindow) -> Name | None:
    """Return the name of a shape that does not move.

    Parameters
    ----------
    window
        The late window of a run.

    Returns
    -------
    Name or None
        None if the shape moves.
    """
    change = window.seen.shape_change
    if not window.seen.steady:
        return None
    reason = f"stays bent: in the window its shape changes by {change:.2g} of itself"
    return Name("at rest", reason, below((change, MAX_STEADY_CHANGE)))


def name_without_symmetry(
    window: LateWindow, description: str, margin: float, still_changing: str
) -> Name:
    """Name a recurrent or quasi-periodic motion without rotational symmetry.

    Parameters
    ----------
    window
        The late window of a run.
    description
        The recurrence or quasi-periodicity in words.
    margin
        Factor by which its criteria are met, at least 1.
    still_changing
        A change that continues, in words; empty without one.

    Returns
    -------
    Name
    """
    sense, bias = abs(window.sense), window.bias
    located = f"{description}; its mean is {bias:.2g} of its displacement off the axis"
    margin = min(margin, max(bias / OFF_AXIS, below((bias, OFF_AXIS))))
    rate = _plane_turns_per_maximum(window)
    if 1.0 / MAX_MAXIMA_PER_TURN <= rate <= 1.0 / MIN_MAXIMA_PER_TURN:
        reason = (
            f"{description}; its plane goes round in {1.0 / rate:.3g} maxima of its displacement"
        )
        margin = min(margin, MAX_MAXIMA_PER_TURN * rate, below((rate, 1.0 / MIN_MAXIMA_PER_TURN)))
        return Name("precessing flapping", reason, margin, still_changing)
    if sense >= MIN_SENSE_OF_ROTATION:
        name = "asymmetric spinning" if bias > OFF_AXIS else "modulated spinning"
        return Name(
            name,
            f"{located}; it goes round",
            min(margin, sense / MIN_SENSE_OF_ROTATION),
            still_changing,
        )
    margin = min(margin, below((sense, MIN_SENSE_OF_ROTATION)))
    if bias > OFF_AXIS:
        return Name("asymmetric flapping", located, margin, still_changing)
    planar = window.seen.planarity <= PLANAR_TOLERANCE
    return Name(
        "planar flapping" if planar else "non-planar flapping", located, margin, still_changing
    )


def _plane_turns_per_maximum(window: LateWindow) -> float:
    """Return the turns of the plane from one maximum to the next, 0 if its sense changes."""
    first, last = window.plane_turns
    maxima = window.recurrence.maxima if window.recurrence else 1
    return 2.0 * min(abs(first), abs(last)) / maxima if first * last > 0.0 else 0.0
