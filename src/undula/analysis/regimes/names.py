"""The name of a motion that has settled, from what a late window of it shows.

| name | what it is |
| --- | --- |
| spinning | a shape that is steady but for its rotation about z |
| modulated spinning | goes round the axis while its shape swings |
| planar flapping | to and fro in one plane through z |
| precessing flapping | the same in a plane that turns slowly |
| non-planar flapping | to and fro, but in no plane |
| windmilling | links turn about an axis across z |

All but the first are periodic up to a turn, or on a torus; what comes back to no shape may be
chaotic, which its Lyapunov exponent has to tell. Going round is told from going to and fro by the
sense of rotation (`undula.analysis.observables.rotation`): above one half it is the former.
"""

from __future__ import annotations

import numpy as np

from undula.analysis.regimes.evidence import GROWTH_FACTOR, MIN_TURNS, STEADY_SHAPE
from undula.analysis.regimes.late_window import (
    GOES_ROUND,
    PLANAR_TOLERANCE,
    LateWindow,
    Name,
    below,
)
from undula.analysis.regimes.names_without_symmetry import OFF_AXIS, held_name, rests
from undula.analysis.regimes.recurrence import RECURRENT, STEADY_FACTOR
from undula.analysis.regimes.stationary_window import STATIONARY
from undula.analysis.regimes.trends import flattens, out_of_plane, shape_change, swing
from undula.arrays import Shapes

# Share out of the plane below which a beat in a turning plane still is one.
PRECESSING_TOLERANCE = 0.2
# What grows from less than this part of its tolerance is too small to be seen growing.
VISIBLE = 0.05
# Share of the motion that its harmonics may leave unexplained: the highest ones of a violent
# flapping, and one or two more where few samples a period make them fold together.
PERIODIC_TOLERANCE = 0.05
# A plane that turns by less than a shape that comes back may be off, does not turn [rad a period].
PRECESSES = RECURRENT
# Coherence of the turning of a windmilling link: swings stay below 0.3, windmills above 0.7 (their
# axis turns while they are watched).
WINDMILLS = 0.6


def steady(window: LateWindow) -> Name | None:
    """Return the name of a steady shape: one that is seen to turn, or rests where it is held."""
    return name_spinning(window) if window.axisymmetric else rests(window)


def name_spinning(window: LateWindow) -> Name | None:
    """Return the name of a steady shape that is seen to turn."""
    seen = window.seen
    if not seen.spins:
        return None
    change = shape_change(window.nodes)
    grows = change.grows(STEADY_FACTOR, VISIBLE * STEADY_SHAPE)
    return Name(
        "spinning",
        f"rotates steadily: over {abs(seen.turns):.3g} turns its shape changes by"
        f" {seen.shape_change:.2g} of itself",
        min(below((seen.shape_change, STEADY_SHAPE)), abs(seen.turns) / MIN_TURNS),
        f"its shape changes more and more, by {change.last:.2g} lately" if grows else "",
    )


def name_windmilling(window: LateWindow) -> Name | None:
    """Return the name of a motion in which links turn about an axis across z."""
    if not len(window.backwards):
        return None  # so that the whole measure can be saved
    round_it = window.winding
    turning = round_it.coherence >= WINDMILLS
    if not turning.any():
        return None
    links = np.flatnonzero(turning) + 1
    which = f"link {links[0]}" if len(links) == 1 else f"links {links[0]} to {links[-1]}"
    return Name(
        "windmilling",
        f"{which} of {len(turning)} turn about an axis across z,"
        f" {round_it.turns[turning].max():.3g} times in the window",
        float(round_it.coherence[turning].max()) / WINDMILLS,
    )


def name_flapping(window: LateWindow) -> Name | None:
    """Return the name of a motion in a plane with one frequency."""
    seen = window.seen
    if seen.planarity > PLANAR_TOLERANCE or seen.drift > STATIONARY:
        return None
    if seen.misfit > PERIODIC_TOLERANCE:
        return None
    aside = not window.axisymmetric and window.bias > OFF_AXIS
    return Name(
        "asymmetric flapping" if aside else "planar flapping",
        f"periodic over {seen.periods:.3g} periods with {seen.planarity:.2g} of the motion out of"
        " its plane",
        below((seen.planarity, PLANAR_TOLERANCE), (seen.misfit, PERIODIC_TOLERANCE)),
        leaves_its_plane(window.nodes),
    )


def returning(window: LateWindow) -> Name | None:
    """Return the name of a motion whose shape comes back up to a turn."""
    back = window.back
    if back is None or not back.repeats or back.growth > STEADY_FACTOR:
        return None
    description = (
        f"its shape comes back every {back.period:.4g} T to {back.distance:.1g} of itself, turned"
        f" by {np.degrees(back.turn):.3g} degrees"
    )
    return _kinematic(window, description, below((back.distance, RECURRENT)), _settles(window))


def wandering(window: LateWindow, parting: str) -> Name:
    """Return the name of a motion on a torus: its shape never comes back, nor does it diverge.

    `parting` tells how fast neighbouring motions part.
    """
    description = f"quasi-periodic: its shape never quite comes back, but {parting}"
    return _kinematic(window, description, np.inf, "")


def _kinematic(window: LateWindow, description: str, margin: float, still_changing: str) -> Name:
    """Name a motion by how it moves."""
    if not window.axisymmetric:
        return held_name(window, description, margin, still_changing)
    planar, sense = window.seen.planarity, abs(window.sense)
    if planar <= PLANAR_TOLERANCE:
        margin = min(margin, below((planar, PLANAR_TOLERANCE)))
        told = f"{description}, {planar:.2g} of it out of its plane"
        return Name("planar flapping", told, margin, still_changing)
    if sense >= GOES_ROUND:
        told = f"{description}; it goes round the axis"
        return Name("modulated spinning", told, min(margin, sense / GOES_ROUND), still_changing)
    margin = min(margin, below((sense, GOES_ROUND)))
    beat, turn = window.beat_planarity, abs(window.plane_turn)
    told = f"{description}; each beat is {beat:.2g} off a plane"
    if beat <= PLANAR_TOLERANCE and turn < PRECESSES:
        margin = min(margin, below((beat, PLANAR_TOLERANCE), (turn, PRECESSES)))
        return Name("planar flapping", told, margin, still_changing)
    if beat <= PRECESSING_TOLERANCE and turn >= PRECESSES:
        margin = min(margin, below((beat, PRECESSING_TOLERANCE)), turn / PRECESSES)
        return Name("precessing flapping", told, margin, still_changing)
    flat, turns = beat / PRECESSING_TOLERANCE, below((turn, PRECESSES))
    # One of the two tells it from a beat in a turning plane.
    return Name("non-planar flapping", told, min(margin, max(flat, turns)), still_changing)


def _settles(window: LateWindow) -> str:
    """Tell what still changes of a motion that comes back, if anything does."""
    change = swing(window.nodes).difference
    if change > STATIONARY:
        return f"its swing changes by {change:.1%} between halves of the window"
    return leaves_its_plane(window.nodes)


def leaves_its_plane(nodes: Shapes) -> str:
    """Tell whether what nodes (m, N + 1, 3) have out of their plane grows, or falls back to it."""
    share = out_of_plane(nodes)
    if share.grows(GROWTH_FACTOR, VISIBLE * PLANAR_TOLERANCE):
        return f"it leaves its plane, by {share.first:.2g} and then {share.last:.2g} of itself"
    if share.first > PLANAR_TOLERANCE and (
        share.first > GROWTH_FACTOR * share.last or flattens(nodes)
    ):
        return f"it settles into a plane, {share.first:.2g} and then {share.last:.2g} off it"
    return ""
