"""A spinning and a flapping motion side by side: shapes, paths of the tip, and energies.

After the figures "Transition from 3D spinning to 2D flapping" and "Two-link chain" of Ling, Guo &
Kanso (2018).
"""

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from undula.arrays import Array
from undula.reproduction.figures.branch_panels import FLAPPING, SPINNING
from undula.reproduction.figures.same_units import same_units
from undula.views.common import style
from undula.views.common.panels import legend_above, letter, letter_axes
from undula.views.run.portrait import shape_times
from undula.views.run.reading import read_scene
from undula.views.run.resample import curve_times, nodes_at, tip_at, values_at
from undula.views.run.scene import Scene
from undula.views.run.space import draw_shapes, draw_tip_path, space_axes

#: Numbers of shapes, of points of a curve, and of periods over which curves are drawn.
_SHAPES, _POINTS, _PERIODS = 24, 700, 2.0
#: Largest number of nodes that are drawn as the beads of a chain.
_MOST_BEADS = 12


@dataclass(frozen=True)
class _Motion:
    """A run with its force, and the colour and dashes of its lines."""

    scene: Scene
    force: float
    colour: str
    dashes: str

    @property
    def title(self) -> str:
        """Its verdict and its force."""
        return f"{self.scene.verdict}, $F$ = {self.force:g}"


def transition(spinning_run: xr.Dataset, flapping_run: xr.Dataset) -> Figure:
    """Draw a spinning and a flapping run: shapes, paths from above, heights and energies.

    Parameters
    ----------
    spinning_run, flapping_run : xarray.Dataset
        Stored runs of one kind of model, as `undula.load_result` returns them.

    Returns
    -------
    matplotlib.figure.Figure
        10 by 6.4 inches, not registered with pyplot: (a) shapes of the last period, (b) the tip
        from above, (c) its height and (d) the bending energy against time, over two periods.

    Raises
    ------
    InputError
        A run has too few samples or lacks a variable, or they are in different units.
    """
    motions = _motions(spinning_run, flapping_run)
    with style.figure_style():
        figure = Figure(figsize=(10.0, 6.4))
        letter(figure, (0.012, 0.895), "a")
        for motion, left in zip(motions, (0.035, 0.345), strict=True):
            _draw_shapes(figure, motion, (left, 0.5, 0.285, 0.36))
        _draw_key(figure, (0.215, 0.475, 0.17, 0.012))
        above = figure.add_axes((0.745, 0.53, 0.235, 0.36))
        _draw_paths(above, motions)
        letter_axes(figure, above, "b", 0.62)
        lower = [figure.add_axes((left, 0.09, 0.4, 0.285)) for left in (0.08, 0.58)]
        _draw_curves(lower[0], motions, lambda scene, times: tip_at(scene, times)[:, 2])
        _draw_curves(lower[1], motions, _energy_at)
        lower[0].set_ylabel("tip height\n" r"$z$  $[L]$")
        lower[1].set_ylabel(style.energy_label(motions[0].scene.units))
        for axes, which in zip(lower, "cd", strict=True):
            letter_axes(figure, axes, which, 0.7)
        legend_above(figure, _handles(motions), 0.03)
    return figure


def two_links(spinning_run: xr.Dataset, flapping_run: xr.Dataset) -> Figure:
    """Draw a spinning and a flapping run: shapes of both, and their energies over two periods.

    Parameters
    ----------
    spinning_run, flapping_run : xarray.Dataset
        Stored runs of one kind of model, as `undula.load_result` returns them.

    Returns
    -------
    matplotlib.figure.Figure
        10 by 3.9 inches, not registered with pyplot.

    Raises
    ------
    InputError
        A run has too few samples or lacks a variable, or they are in different units.
    """
    motions = _motions(spinning_run, flapping_run)
    with style.figure_style():
        figure = Figure(figsize=(10.0, 3.9))
        for motion, left, which in zip(motions, (0.03, 0.335), "ab", strict=True):
            letter(figure, (left - 0.018, 0.845), which)
            _draw_shapes(figure, motion, (left, 0.2, 0.28, 0.6))
        _draw_key(figure, (0.215, 0.135, 0.17, 0.02))
        axes = figure.add_axes((0.735, 0.145, 0.25, 0.675))
        _draw_curves(axes, motions, _energy_at)
        axes.set_ylabel(style.energy_label(motions[0].scene.units))
        letter_axes(figure, axes, "c", 0.7)
        legend_above(figure, _handles(motions), 0.03)
    return figure


def _motions(spinning: xr.Dataset, flapping: xr.Dataset) -> tuple[_Motion, _Motion]:
    first, second = (
        _Motion(
            read_scene(run).detail, float(json.loads(run.attrs["summary"])["force"]), colour, dashes
        )
        for run, (colour, _), dashes in (
            (spinning, SPINNING, "-"),
            (flapping, FLAPPING, "--"),
        )
    )
    same_units(first.scene.units, second.scene.units)
    return first, second


def _draw_shapes(figure: Figure, motion: _Motion, place: tuple[float, float, float, float]) -> None:
    shapes = nodes_at(motion.scene, shape_times(motion.scene, _SHAPES))
    axes = space_axes(figure, place, shapes)
    path = tip_at(motion.scene, curve_times(motion.scene, *motion.scene.shown, _POINTS))
    draw_tip_path(axes, path, joined=motion.scene.interpolable)
    draw_shapes(axes, shapes)
    if shapes.shape[1] <= _MOST_BEADS:
        axes.plot(
            *shapes[-1].T, "o", ms=4.5, color=style.shape_colours(1)[0], zorder=7, gid="beads"
        )
    look: Any = {"ha": "center", "color": motion.colour, "fontsize": 9.5, "gid": "title"}
    figure.text(place[0] + 0.5 * place[2], place[1] + place[3] + 0.035, motion.title, **look)


def _draw_key(figure: Figure, place: tuple[float, float, float, float]) -> None:
    """Draw the colour bar of the shapes' phases."""
    colours: Any = ScalarMappable(Normalize(0, 1), ListedColormap(style.shape_colours(_SHAPES)))
    bar = figure.colorbar(colours, cax=figure.add_axes(place), location="bottom")
    bar.outline.set_visible(False)
    bar.set_label(style.PHASE_LABEL, labelpad=1, fontsize=8.0)
    bar.set_ticks([0.0, 0.5, 1.0])


def _draw_paths(axes: Axes, motions: Sequence[_Motion]) -> None:
    widest = 0.0
    for motion in motions:
        path = tip_at(motion.scene, curve_times(motion.scene, *motion.scene.shown, _POINTS))
        widest = max(widest, float(np.abs(path[:, :2]).max()))
        look: Any = {"color": motion.colour, "lw": 1.8, "ls": motion.dashes}
        axes.plot(path[:, 0], path[:, 1], gid=f"path, {motion.scene.verdict}", **look)
    axes.plot([0.0], [0.0], "s", color=style.INK, ms=5.0)
    bound = 1.1 * widest
    axes.set(xlim=(-bound, bound), ylim=(-bound, bound), aspect="equal", anchor="SW")
    axes.locator_params(nbins=5)
    axes.set_xlabel(r"tip $x$  $[L]$")
    axes.set_ylabel(r"tip $y$  $[L]$", labelpad=0)


def _energy_at(scene: Scene, times: Array) -> Array:
    return values_at(scene, scene.energy, times)


def _draw_curves(
    axes: Axes, motions: Sequence[_Motion], quantity: Callable[[Scene, Array], Array]
) -> None:
    """Draw a quantity over the last two periods of the slower motion, from their beginning on."""
    lengths = [
        min(_PERIODS * motion.scene.period, motion.scene.duration)
        if motion.scene.period is not None
        else motion.scene.end - motion.scene.shown[0]
        for motion in motions
    ]
    length = min(max(lengths), *(motion.scene.duration for motion in motions))
    for motion in motions:
        scene = motion.scene
        times = curve_times(scene, scene.end - length, scene.end, _POINTS)
        look: Any = {"color": motion.colour, "lw": 1.8, "ls": motion.dashes}
        axes.plot(times - (scene.end - length), quantity(scene, times), gid=scene.verdict, **look)
    axes.set_xlim(0.0, length)
    axes.set_ylim(min(0.0, axes.dataLim.y0), 1.08 * axes.dataLim.y1)
    axes.set_xlabel(style.time_label(motions[0].scene.units))


def _handles(motions: Sequence[_Motion]) -> list[Line2D]:
    return [
        Line2D([], [], color=motion.colour, lw=1.8, ls=motion.dashes, label=motion.title)
        for motion in motions
    ]
