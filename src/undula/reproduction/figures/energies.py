"""Bending energies of spinning and flapping against the force, with the paper's logarithm.

After the figure "Bending energy versus axial force" of Ling, Guo & Kanso (2018).
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from undula.arrays import Array
from undula.errors import InputError
from undula.reproduction.figures.branch_panels import (
    FLAPPING,
    Pair,
    branch_handles,
    draw_branch,
    draw_forces,
    force_labels,
    last_force,
    read_pair,
)
from undula.reproduction.figures.same_units import same_units
from undula.views.branches.named_branches import NamedBranch
from undula.views.common import style
from undula.views.common.labels import label_above
from undula.views.common.panels import legend_above, letter_axes, quiet_line

#: Force [B/L^2] in the paper's curve ln(F - 38.7).
_FORCE_OF_THE_LAW = 38.7
_EDGES = (0.085, 0.97)
#: Range of the difference [%]: close to zero of the logarithm the difference has no bound.
_SHOWN = 20.0


def bending_energies(spinning: Mapping[str, Any], flapping: Mapping[str, Any]) -> Figure:
    """Draw the energy of spinning, the envelope of that of flapping, and the paper's logarithm.

    Parameters
    ----------
    spinning, flapping : mapping
        Answers of `undula follow` about a filament.

    Returns
    -------
    matplotlib.figure.Figure
        9 by 6.2 inches, not registered with pyplot: (a) energies, (b) by how much that of spinning
        differs from the logarithm.

    Raises
    ------
    InputError
        An answer is of another kind or another model.
    """
    pair = read_pair(spinning, flapping)
    units = same_units(spinning["units"], flapping["units"])
    if units["force"] != style.FILAMENT["force"]:
        raise InputError(
            f"the answers have forces in {units['force']}, but the paper's logarithm is a"
            " filament's; give answers about filaments"
        )
    end = last_force(pair)
    with style.figure_style():
        figure = Figure(figsize=(9.0, 6.2))
        top = label_above(figure, force_labels(pair, (0.0, end), _EDGES), *_EDGES)
        place: Any = {"left": _EDGES[0], "right": _EDGES[1], "bottom": 0.085, "top": top}
        grid = figure.add_gridspec(2, 1, hspace=0.16, height_ratios=(5, 3), **place)
        upper = figure.add_subplot(grid[0])
        lower = figure.add_subplot(grid[1], sharex=upper)
        _draw_energies(upper, pair, end)
        _draw_difference(lower, pair[0])
        for axes, which in ((upper, "a"), (lower, "b")):
            draw_forces(axes, pair)
            letter_axes(figure, axes, which, 0.65)
        upper.set_xlim(0.0, end)
        upper.tick_params(labelbottom=False)
        upper.set_ylabel(style.energy_label(units))
        lower.set_ylabel("difference\nspinning / ln − 1  [%]")
        lower.set_xlabel(style.force_label(units))
        figure.align_ylabels([upper, lower])
        law = Line2D([], [], color=style.INK, lw=1.3, ls=":", label=r"$\ln(F - 38.7)$, paper")
        envelope = Patch(color=FLAPPING[0], alpha=0.2, label="envelope over a beat")
        legend_above(figure, [*branch_handles(pair), envelope, law], _EDGES[0])
    return figure


def _law(forces: Array) -> Array:
    return np.log(forces - _FORCE_OF_THE_LAW)


def _draw_energies(axes: Axes, pair: Pair, end: float) -> None:
    spinning, flapping = pair
    line = flapping.line
    for part, stable in line.parts:
        look: Any = {"color": flapping.colour, "alpha": 0.26 if stable else 0.12, "lw": 0.0}
        look["gid"] = f"{flapping.name}, envelope"
        axes.fill_between(line.values[part], line.low[part], line.high[part], **look)
    for bound in (line.low, line.high):
        draw_branch(axes, flapping, bound)
    draw_branch(axes, spinning, spinning.line.mean)
    forces = np.linspace(_FORCE_OF_THE_LAW + 1.0, end, 400)
    axes.plot(forces, _law(forces), ":", color=style.INK, lw=1.5, zorder=5, gid="logarithm")
    axes.set_ylim(0.0, 1.06 * float(line.high.max()))


def _draw_difference(axes: Axes, spinning: NamedBranch) -> None:
    line = spinning.line
    difference = np.full(line.values.size, np.nan)
    above = line.values > _FORCE_OF_THE_LAW + 1.0
    difference[above] = 100.0 * (line.mean[above] / _law(line.values[above]) - 1.0)
    draw_branch(axes, spinning, difference)
    quiet_line(axes)
    bound = 1.1 * max(_SHOWN, abs(float(difference[-1])))
    axes.set_ylim(-bound, bound)
