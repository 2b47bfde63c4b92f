"""Densities of the paper's loads, of a total force of 1, along the filament.

After the figure "Axial forces" of Ling, Guo & Kanso (2018), with the power loads of the following
one added.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from undula.arrays import Array, Points
from undula.views.common import style
from undula.views.common.panels import letter_axes

_SLOPES = (-1.0, -0.5, 0.0, 0.5, 1.0)
_POSITIONS = (0.1, 0.3, 0.5, 0.7, 0.9, 1.0)
_EXPONENTS = (1.0, 2.0, 5.0, 10.0)
#: Length of the arrow of a force of 1 [L].
_ARROW = 0.22


def force_profiles() -> Figure:
    """Draw densities of linear and power loads, and concentrated loads, of a total force of 1.

    Returns
    -------
    matplotlib.figure.Figure
        10 by 3.7 inches, not registered with pyplot.
    """
    with style.figure_style():
        figure = Figure(figsize=(10.0, 3.7))
        grid = figure.add_gridspec(1, 3, left=0.055, right=0.935, bottom=0.15, top=0.87, wspace=0.6)
        panels = [figure.add_subplot(grid[k]) for k in range(3)]
        _draw_densities(panels[0], _linear, _SLOPES, r"$\alpha$")
        _draw_arrows(panels[1])
        _draw_densities(panels[2], _power, _EXPONENTS, "$p$")
        names = ("linear", "concentrated", "power law")
        for axes, which, name in zip(panels, "abc", names, strict=True):
            axes.set_xlim(0.0, 1.0)
            axes.set_xlabel(style.ARC_LABEL)
            axes.set_title(name, loc="left")
            letter_axes(figure, axes, which, 0.45)
        for axes in (panels[0], panels[2]):
            axes.set_ylabel(r"density $f_a$  $[F/L]$")
    return figure


def _linear(slope: float, s: Points) -> Array:
    """Return f_a / F = 1 + alpha (2 s - 1)."""
    return 1.0 + slope * (2.0 * s - 1.0)


def _power(exponent: float, s: Points) -> Array:
    """Return f_a / F = (p + 1) s^p."""
    return (exponent + 1.0) * s**exponent


def _draw_densities(
    axes: Axes, density: Callable[[float, Points], Array], values: Sequence[float], symbol: str
) -> None:
    s = np.linspace(0.0, 1.0, 201)
    for value, colour in zip(values, style.shape_colours(len(values)), strict=True):
        heights = density(value, s)
        axes.plot(s, heights, color=colour, lw=1.9, clip_on=False, gid=f"density {value:g}")
        _name(axes, heights[-1], f"{symbol} = {value:g}".replace("-", "−"))
    axes.set_ylim(0.0, 1.05 * float(density(values[-1], s).max()))
    axes.yaxis.set_major_locator(MaxNLocator(5))


def _draw_arrows(axes: Axes) -> None:
    for row, position in enumerate(_POSITIONS):
        axes.plot([0.0, 1.0], [row, row], color=style.SHADOW, lw=2.0, clip_on=False, zorder=1)
        axes.plot([0.0], [row], "s", color=style.INK, ms=5.0, clip_on=False, zorder=3)
        look: Any = {"arrowstyle": "-|>", "color": style.Y_COLOUR, "lw": 1.8}
        look |= {"shrinkA": 0.0, "shrinkB": 0.0, "mutation_scale": 12.0}
        head, tail = (position, row), (position + _ARROW, row)
        arrow = axes.annotate("", head, tail, arrowprops=look, annotation_clip=False)
        arrow.set_gid(f"force {position:g}")
    axes.set_yticks(range(len(_POSITIONS)), [f"{position:g}" for position in _POSITIONS])
    axes.set_ylim(-0.5, len(_POSITIONS) - 0.5)
    axes.set_ylabel(style.parameter_label("load.position"))
    axes.tick_params(axis="y", length=0.0, pad=7.0)
    axes.spines["left"].set_visible(False)


def _name(axes: Axes, height: float, words: str) -> None:
    look: Any = {"xytext": (5, 0), "textcoords": "offset points", "va": "center", "fontsize": 8.5}
    axes.annotate(words, (1.0, height), annotation_clip=False, **look)
