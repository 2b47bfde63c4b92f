"""Names of settled motions of filaments with rotational symmetry, from a late window.

| name | motion |
| --- | --- |
| spinning | steady rotation about z without a change of shape |
| modulated spinning | rotation about z with an oscillating shape |
| planar flapping | oscillation in one plane through z |
| precessing flapping | oscillation in a plane that rotates slowly |
| non-planar flapping | oscillation without a plane |
| windmilling | rotation of links about a transverse axis |

All but the first are periodic up to a rotation, or quasi-periodic. A motion without recurrence may
be chaotic, which its Lyapunov exponents decide. The sense of rotation
(`undula.analysis.observables.rotation`) separates rotation, above one half, from oscillation.
"""

from __future__ import annotations

import numpy as np

from undula.analysis.regimes.evidence import MAX_STEADY_CHANGE, MIN_GROWTH_FACTOR, MIN_TURNS
from undula.analysis.regimes.late_window import (
    MIN_SENSE_OF_ROTATION,
    PLANAR_TOLERANCE,
    LateWindow,
    Name,
    below,
)
from undula.analysis.regimes.names_without_symmetry import (
    OFF_AXIS,
    name_at_rest,
    name_without_symmetry,
)
from undula.analysis.regimes.recurrence import MAX_RECURRENCE_DISTANCE, MAX_STEADY_FACTOR
from undula.analysis.regimes.stationary_window import MAX_STATIONARY_DRIFT
from undula.analysis.regimes.trends import (
    displacement_variance,
    flattens,
    out_of_plane,
    shape_change,
)
from undula.arrays import Shapes

# Largest out-of-plane share of a beat in a rotating plane.
PRECESSING_PLANE_TOLERANCE = 0.2
# Least part of a tolerance from which growth is detected.
MIN_VISIBLE_SHARE = 0.05
# Largest share of a periodic motion that its harmonics leave: the highest harmonics of flapping at
# large forces, and one or two more where few samples a period alias them together.
PERIODIC_TOLERANCE = 0.05
# Least rotation of a precessing plane [rad a period]: the tolerance of the recurrence.
MIN_PRECESSION_TURN = MAX_RECURRENCE_DISTANCE
# Least coherence of the rotation of a windmilling link: oscillating links stay below 0.3,
# windmilling ones above 0.7 (their axis rotates within the window).
MIN_WINDMILLING_COHERENCE = 0.6


def name_steady(window: LateWindow) -> Name | None:
    """Return the name of a steady shape: spinning, or at rest without rotational symmetry.

    Parameters
    ----------
    window
        The late window of a run.

    Returns
    -------
    Name or None
        None if the shape is not steady.
    """
    return name_spinning(window) if window.axisymmetric else name_at_rest(window)


def name_spinning(window: LateWindow) -> Name | None:
    """Return the name of a steady shape that makes at least one turn.

    Parameters
    ----------
    window
        The late window of a run.

    Returns
    -------
    Name or None
        None if the motion is not spinning.
    """
    seen = window.seen
    if not seen.spinning:
        return None
    change = shape_change(window.nodes)
    grows = change.grows(MAX_STEADY_FACTOR, MIN_VISIBLE_SHARE * MAX_STEADY_CHANGE)
    return Name(
        "spinning",
        f"rotates steadily: over {abs(seen.turns):.3g} turns its shape changes by"
        f" {seen.shape_change:.2g} of itself",
        min(below((seen.shape_change, MAX_STEADY_CHANGE)), abs(seen.turns) / MIN_TURNS),
        f"its shape changes more and more, by {change.last:.2g} lately" if grows else "",
    )


def name_windmilling(window: LateWindow) -> Name | None:
    """Return the name of a motion in which links rotate about a transverse axis.

    Parameters
    ----------
    window
        The late window of a run.

    Returns
    -------
    Name or None
        None if the motion is not windmilling.
    """
    if not len(window.backwards):
        return None  # without a measurement of the rotation of links
    rotation = window.link_rotation
    turning = rotation.coherence >= MIN_WINDMILLING_COHERENCE
    if not turning.any():
        return None
    links = np.flatnonzero(turning) + 1
    which = f"link {links[0]}" if len(links) == 1 else f"links {links[0]} to {links[-1]}"
    return Name(
        "windmilling",
        f"{which} of {len(turning)} turn about an axis across z,"
        f" {rotation.turns[turning].max():.3g} times in the window",
        float(rotation.coherence[turning].max()) / MIN_WINDMILLING_COHERENCE,
    )


def name_flapping(window: LateWindow) -> Name | None:
    """Return the name of a motion in a plane with one frequency.

    Parameters
    ----------
    window
        The late window of a run.

    Returns
    -------
    Name or None
        None if the motion is not planar or not periodic.
    """
    seen = window.seen
    if seen.planarity > PLANAR_TOLERANCE or seen.drift > MAX_STATIONARY_DRIFT:
        return None
    if seen.misfit > PERIODIC_TOLERANCE:
        return None
    off_axis = not window.axisymmetric and window.bias > OFF_AXIS
    return Name(
        "asymmetric flapping" if off_axis else "planar flapping",
        f"periodic over {seen.periods:.3g} periods with {seen.planarity:.2g} of the motion out of"
        " its plane",
        below((seen.planarity, PLANAR_TOLERANCE), (seen.misfit, PERIODIC_TOLERANCE)),
        plane_change(window.nodes),
    )


def name_recurrent(window: LateWindow) -> Name | None:
    """Return the name of a motion whose shape recurs, up to rotations.

    Parameters
    ----------
    window
        The late window of a run.

    Returns
    -------
    Name or None
        None without recurrence.
    """
    recurrence = window.recurrence
    if recurrence is None or not recurrence.repeats or recurrence.growth > MAX_STEADY_FACTOR:
        return None
    description = (
        f"its shape comes back every {recurrence.period:.4g} T to {recurrence.distance:.1g} of"
        f" itself, turned by {np.degrees(recurrence.turn):.3g} degrees"
    )
    return _name_by_kinematics(
        window,
        description,
        below((recurrence.distance, MAX_RECURRENCE_DISTANCE)),
        _remaining_change(window),
    )


def name_quasi_periodic(window: LateWindow, divergence: str) -> Name:
    """Return the name of a quasi-periodic motion, which neither recurs nor diverges.

    Parameters
    ----------
    window
        The late window of a run.
    divergence
        The divergence of neighbouring motions in words.

    Returns
    -------
    Name
    """
    description = f"quasi-periodic: its shape never quite comes back, but {divergence}"
    return _name_by_kinematics(window, description, np.inf, "")


def _name_by_kinematics(
    window: LateWindow, description: str, margin: float, still_changing: str
) -> Name:
    """Name a recurrent or quasi-periodic motion by its kinematics."""
    if not window.axisymmetric:
        return name_without_symmetry(window, description, margin, still_changing)
    planar, sense = window.seen.planarity, abs(window.sense)
    if planar <= PLANAR_TOLERANCE:
        margin = min(margin, below((planar, PLANAR_TOLERANCE)))
        reason = f"{description}, {planar:.2g} of it out of its plane"
        return Name("planar flapping", reason, margin, still_changing)
    if sense >= MIN_SENSE_OF_ROTATION:
        reason = f"{description}; it goes round the axis"
        return Name(
            "modulated spinning", reason, min(margin, sense / MIN_SENSE_OF_ROTATION), still_changing
        )
    margin = min(margin, below((sense, MIN_SENSE_OF_ROTATION)))
    beat, turn = window.beat_planarity, abs(window.plane_turn)
    reason = f"{description}; each beat is {beat:.2g} off a plane"
    if beat <= PLANAR_TOLERANCE and turn < MIN_PRECESSION_TURN:
        margin = min(margin, below((beat, PLANAR_TOLERANCE), (turn, MIN_PRECESSION_TURN)))
        return Name("planar flapping", reason, margin, still_changing)
    if beat <= PRECESSING_PLANE_TOLERANCE and turn >= MIN_PRECESSION_TURN:
        margin = min(margin, below((beat, PRECESSING_PLANE_TOLERANCE)), turn / MIN_PRECESSION_TURN)
        return Name("precessing flapping", reason, margin, still_changing)
    flatness, slowness = beat / PRECESSING_PLANE_TOLERANCE, below((turn, MIN_PRECESSION_TURN))
    # One of the two criteria excludes a beat in a rotating plane.
    return Name("non-planar flapping", reason, min(margin, max(flatness, slowness)), still_changing)


def _remaining_change(window: LateWindow) -> str:
    """Return the change that continues in a recurrent motion in words, empty without one."""
    change = displacement_variance(window.nodes).difference
    if change > MAX_STATIONARY_DRIFT:
        return f"its swing changes by {change:.1%} between halves of the window"
    return plane_change(window.nodes)


def plane_change(nodes: Shapes) -> str:
    """Return the change of the out-of-plane share in words.

    Parameters
    ----------
    nodes
        Node positions [L], shape ``(m, N + 1, 3)``, m at least 4.

    Returns
    -------
    str
        Empty if the share neither grows nor falls.
    """
    share = out_of_plane(nodes)
    if share.grows(MIN_GROWTH_FACTOR, MIN_VISIBLE_SHARE * PLANAR_TOLERANCE):
        return f"it leaves its plane, by {share.first:.2g} and then {share.last:.2g} of itself"
    if share.first > PLANAR_TOLERANCE and (
        share.first > MIN_GROWTH_FACTOR * share.last or flattens(nodes)
    ):
        return f"it settles into a plane, {share.first:.2g} and then {share.last:.2g} off it"
    return ""
