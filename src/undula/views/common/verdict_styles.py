"""Colour and symbol of each verdict, the same in every figure.

The colours are those of Okabe & Ito (2008) and of P. Tol's palettes for the colour-blind; the
symbols distinguish verdicts without colours.
"""

from collections.abc import Iterable
from typing import NamedTuple

from undula.views.common import style


class Look(NamedTuple):
    """Colour of a verdict, its marker in a figure, and its symbol on a page."""

    colour: str
    marker: str
    symbol: str


#: Look of each verdict, in the order of legends.
LOOKS = {
    "straight": Look(style.QUIET, "o", "circle-open"),
    "spinning": Look(style.X_COLOUR, "o", "circle"),
    "modulated spinning": Look("#56B4E9", "h", "hexagon"),
    "planar flapping": Look(style.Y_COLOUR, "s", "square"),
    "non-planar flapping": Look(style.Z_COLOUR, "D", "diamond"),
    "precessing flapping": Look(style.ACTIVE_COLOUR, "^", "triangle-up"),
    "windmilling": Look(style.ENERGY_COLOUR, "*", "star"),
    "chaotic": Look(style.INK, "X", "x"),
    "asymmetric spinning": Look("#332288", "p", "pentagon"),
    "asymmetric flapping": Look("#999933", ">", "triangle-right"),
    "undecided": Look("#CC79A7", "v", "triangle-down"),
    "at rest": Look("#882255", "<", "triangle-left"),
}
_OTHER = Look("#661100", "P", "cross")


def look_of(verdict: str) -> Look:
    """Return the look of a verdict; words that are no verdicts share one look."""
    return LOOKS.get(verdict, _OTHER)


def ordered(verdicts: Iterable[str]) -> list[str]:
    """Return verdicts without repetition in the order of legends, other words last."""
    order = {verdict: place for place, verdict in enumerate(LOOKS)}
    return sorted(set(verdicts), key=lambda verdict: order.get(verdict, len(order)))
