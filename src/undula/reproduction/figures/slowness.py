"""Difference of the frequencies of spinning and flapping, against the force.

After a statement in the caption of the figure "Frequency of oscillations versus linear stability
analysis" of Ling, Guo & Kanso (2018).
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from undula.errors import InputError
from undula.reproduction.figures.branch_panels import draw_forces, force_labels, read_pair
from undula.reproduction.figures.same_units import same_units
from undula.views.common import style
from undula.views.common.labels import label_above
from undula.views.common.panels import legend_above, quiet_line

#: Difference that the paper gives [%].
_BAND = (15.0, 20.0)
#: Number of forces at which the branches are compared.
_COMPARED = 400


def slowness(spinning: Mapping[str, Any], flapping: Mapping[str, Any]) -> Figure:
    """Draw the relative difference of both frequencies, with the range that the paper gives.

    Parameters
    ----------
    spinning, flapping : mapping
        Answers of `undula follow`, over forces of which some are the same.

    Returns
    -------
    matplotlib.figure.Figure
        9 by 4 inches, not registered with pyplot.

    Raises
    ------
    InputError
        An answer is of another kind, or the two have no force in common.
    """
    pair = read_pair(spinning, flapping)
    units = same_units(spinning["units"], flapping["units"])
    low = max(float(branch.line.values.min()) for branch in pair)
    high = min(float(branch.line.values.max()) for branch in pair)
    if low >= high:
        raise InputError(f"spinning ends at {high:g} and flapping begins at {low:g}: no overlap")
    forces = np.linspace(low, high, _COMPARED)
    fast, slow = (b.line.interpolated(b.line.frequencies, forces) for b in pair)
    edges = (0.085, 0.97)
    with style.figure_style():
        figure = Figure(figsize=(9.0, 4.0))
        top = label_above(figure, force_labels(pair, (0.0, high), edges), *edges)
        axes = figure.add_axes((edges[0], 0.145, edges[1] - edges[0], top - 0.145))
        axes.axhspan(*_BAND, color=style.FOCUS, lw=0.0, gid="paper")
        look: Any = {"color": style.INK, "lw": 2.0, "gid": "slowness"}
        axes.plot(forces, 100.0 * (1.0 - slow / fast), **look)
        draw_forces(axes, pair)
        quiet_line(axes)
        axes.set_xlim(0.0, high)
        axes.set_xlabel(style.force_label(units))
        axes.set_ylabel("1 − flapping / spinning\nfrequency  [%]")
        handles = [
            Line2D([], [], color=style.INK, lw=2.0, label="solved states"),
            Patch(color=style.FOCUS, label="15 to 20 %, Ling, Guo & Kanso (2018)"),
        ]
        legend_above(figure, handles, edges[0])
    return figure
