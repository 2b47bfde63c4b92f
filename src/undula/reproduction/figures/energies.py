"""Bending energies of spinning and flapping against the force, beside the paper's logarithm.

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
from undula.reproduction.figures.answered_branches import (
    AnsweredBranch,
    parts,
    read_branch,
    same_units,
)
from undula.reproduction.figures.branch_panels import (
    FLAPPING,
    SPINNING,
    branch_handles,
    draw_branch,
    draw_forces,
    force_labels,
)
from undula.views.common import style
from undula.views.common.labels import label_above
from undula.views.common.panels import legend_above, letter_axes, quiet_line

#: The paper's curve is ln(F - 38.7).
_FORCE_OF_THE_LAW = 38.7
_EDGES = (0.085, 0.97)
#: Per cent; where the logarithm is close to zero any difference from it is beyond all bounds.
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
        9 by 6.2 inches, not known to pyplot: (a) energies, (b) by how much that of spinning
        differs from the logarithm.

    Raises
    ------
    InputError
        An answer is of another kind or another model.
    """
    branches = read_branch(spinning), read_branch(flapping)
    units = same_units(*(one.units for one in branches))
    if units["force"] != style.FILAMENT["force"]:
        raise InputError(
            f"the answers have forces in {units['force']}, but the paper's logarithm is a"
            " filament's; give answers about filaments"
        )
    end = max(float(one.forces.max()) for one in branches)
    with style.figure_style():
        figure = Figure(figsize=(9.0, 6.2))
        top = label_above(figure, force_labels(*branches, (0.0, end), _EDGES), *_EDGES)
        place: Any = {"left": _EDGES[0], "right": _EDGES[1], "bottom": 0.085, "top": top}
        grid = figure.add_gridspec(2, 1, hspace=0.16, height_ratios=(5, 3), **place)
        upper = figure.add_subplot(grid[0])
        lower = figure.add_subplot(grid[1], sharex=upper)
        _draw_energies(upper, *branches, end)
        _draw_difference(lower, branches[0])
        for axes, which in ((upper, "a"), (lower, "b")):
            draw_forces(axes, *branches)
            letter_axes(figure, axes, which, 0.65)
        upper.set_xlim(0.0, end)
        upper.tick_params(labelbottom=False)
        upper.set_ylabel(style.energy_label(units))
        lower.set_ylabel("difference\nspinning / ln − 1  [%]")
        lower.set_xlabel(style.force_label(units))
        figure.align_ylabels([upper, lower])
        law = Line2D([], [], color=style.INK, lw=1.3, ls=":", label=r"$\ln(F - 38.7)$, paper")
        envelope = Patch(color=style.Y_COLOUR, alpha=0.2, label="envelope over a beat")
        legend_above(figure, [*branch_handles(branches), envelope, law], _EDGES[0])
    return figure


def _law(forces: Array) -> Array:
    return np.log(forces - _FORCE_OF_THE_LAW)


def _draw_energies(
    axes: Axes, spinning: AnsweredBranch, flapping: AnsweredBranch, end: float
) -> None:
    colour, name = FLAPPING
    for start, last, stable in parts(flapping.stable):
        part = slice(start, last + 1)
        bounds = flapping.forces[part], flapping.low[part], flapping.high[part]
        look: Any = {"color": colour, "alpha": 0.26 if stable else 0.12, "lw": 0.0}
        axes.fill_between(*bounds, gid=f"{name}, envelope", **look)
    for bound in (flapping.low, flapping.high):
        draw_branch(axes, flapping, bound, FLAPPING)
    draw_branch(axes, spinning, spinning.mean, SPINNING)
    forces = np.linspace(_FORCE_OF_THE_LAW + 1.0, end, 400)
    axes.plot(forces, _law(forces), ":", color=style.INK, lw=1.5, zorder=5, gid="logarithm")
    axes.set_ylim(0.0, 1.06 * float(flapping.high.max()))


def _draw_difference(axes: Axes, spinning: AnsweredBranch) -> None:
    difference = np.full(spinning.forces.size, np.nan)
    known = spinning.forces > _FORCE_OF_THE_LAW + 1.0
    law = _law(spinning.forces[known])
    difference[known] = 100.0 * (spinning.mean[known] / law - 1.0)
    draw_branch(axes, spinning, difference, SPINNING)
    quiet_line(axes)
    bound = 1.1 * max(_SHOWN, abs(float(difference[-1])))
    axes.set_ylim(-bound, bound)
