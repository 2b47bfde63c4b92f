"""One colour and one symbol for each verdict, the same in every diagram.

Colours are those of Okabe & Ito (2008) and of P. Tol's palettes for the colour-blind; symbols tell
verdicts apart without them.
"""

from collections.abc import Iterable
from typing import NamedTuple

from undula.views.common import style


class Look(NamedTuple):
    """How a verdict is drawn: its colour, its marker in a figure, and its symbol on a page."""

    colour: str
    marker: str
    symbol: str


_LOOKS = {
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
}
_OTHER = Look("#882255", "<", "triangle-left")


def look_of(verdict: str) -> Look:
    """Return the look of a verdict; those that are not known share one."""
    return _LOOKS.get(verdict, _OTHER)


def ordered(verdicts: Iterable[str]) -> list[str]:
    """Return verdicts without repetition, in the order in which legends name them."""
    known = list(_LOOKS)
    return sorted(set(verdicts), key=lambda one: known.index(one) if one in known else len(known))
