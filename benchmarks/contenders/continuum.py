"""How far frequencies are from the continuum's: half cells at the ends against whole ones."""

from typing import Any

import numpy as np

from contenders import page
from contenders.orbits import orbit

#: Segments of undula's layout that the textbook's are compared with.
OURS = 20
_FINE = (40, 80)


def distances(motion: str, segments: tuple[int, ...]) -> dict[str, Any]:
    """Return relative errors of both layouts, with rigid links, from the limit of undula's."""
    coarse, fine = (orbit("undula", n, motion).frequency for n in _FINE)
    limit = fine + (fine - coarse) / 3.0  # errors fall as 1/n^2
    theirs = [abs(orbit("textbook, rigid", n, motion).frequency / limit - 1.0) for n in segments]
    ours = abs(orbit("undula", OURS, motion).frequency / limit - 1.0)
    slope = float(np.polyfit(np.log(segments), np.log(theirs), 1)[0])
    # From the finest on, as the order is reached there.
    needed = segments[-1] * (theirs[-1] / ours) ** (-1.0 / slope)
    return {
        "limit": limit,
        "undula": ours,
        "textbook": theirs,
        "segments": list(segments),
        "order": -slope,
        "needed": needed,
    }


def table(found: dict[str, Any]) -> str:
    """Return them as a table in Markdown."""
    heading = [
        "relative error of the frequency",
        f"undula, {OURS} segments",
        *(f"textbook, {n}" for n in found["segments"]),
        "its order",
        f"segments it needs for undula's {OURS}",
    ]
    row = [
        f"limit {found['limit']:.2f} per T",
        f"{found['undula']:.1e}",
        *(f"{error:.1e}" for error in found["textbook"]),
        f"{found['order']:.2f}",
        f"{found['needed']:.0f}",
    ]
    return page.table(heading, [row])
