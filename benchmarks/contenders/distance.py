"""Times at the same distance from the continuum: undula's few segments, others' many.

Extrapolated by the power law through the two largest sizes that were measured, and said so.
"""

from dataclasses import asdict
from typing import Any

import numpy as np

from contenders import continuum, page
from contenders.push import MASS, Accuracy, Pushed
from contenders.windows import BOUND, Timed
from contenders.windows import OURS as _ALL

_DEFAULT = "scipy BDF, numpy"
OURS = tuple(_ALL)


def beyond(sizes: list[int], seconds: list[float], size: float) -> float:
    """Return the time at another size [s]."""
    exponent = np.log(seconds[-1] / seconds[-2]) / np.log(sizes[-1] / sizes[-2])
    return float(seconds[-1] * (size / sizes[-1]) ** exponent)


def compare(
    found: list[dict[str, Timed]],
    pushed: list[Pushed],
    accuracy: Accuracy,
    distance: dict[str, Any],
) -> dict[str, Any]:
    """Return the ratios of a motion, measured as far as they are and extrapolated."""
    ours = next(one for one in found if one[OURS[0]].segments == continuum.OURS)
    theirs = [one[_DEFAULT] for one in found if _DEFAULT in one]
    sizes, seconds = [one.segments for one in theirs], [one.best for one in theirs]
    elements = abs(accuracy.coarseness) / distance["undula"]
    stepped = beyond([p.segments for p in pushed], [p.window for p in pushed], elements)
    needed = beyond(sizes, seconds, distance["needed"])
    best = {name: ours[name].best for name in OURS}
    return {
        "measured size": sizes[-1],
        "measured distance": distance["textbook"][distance["segments"].index(sizes[-1])],
        "measured": {name: seconds[-1] / one for name, one in best.items()},
        "size": distance["needed"],
        "extrapolated": {name: needed / one for name, one in best.items()},
        "elements": elements,
        "PyElastica": {name: stepped / one for name, one in best.items()},
        "accuracy": asdict(accuracy),
        "inertia error": abs(accuracy.inertia) * MASS,
        "lighter": float(np.sqrt(abs(accuracy.inertia) * MASS / BOUND)),
    }


def table(one: dict[str, Any]) -> str:
    """Return them as a table in Markdown."""
    inertia = f"{one['inertia error']:.0e}; without it {one['lighter']:.1f} times longer"
    rows = [
        [
            name,
            f"{one['measured'][name]:,.0f}",
            f"{one['extrapolated'][name]:,.0f}",
            f"{one['PyElastica'][name]:,.0f}",
        ]
        for name in OURS
    ]
    away = f"{one['measured distance']:.1e} away"
    heading = [
        f"times {continuum.OURS} segments of",
        f"{_DEFAULT}: {one['measured size']} segments, {away}, measured",
        f"{one['size']:.0f} segments, as near, extrapolated",
        f"PyElastica: {one['elements']:.0f} elements, as near, extrapolated"
        f" (error by inertia {inertia})",
    ]
    return page.table(heading, rows)
