"""Portrait of a run: shapes in space, and tip, energy and power over time.

After the figure "Three-dimensional buckling" of Ling, Guo & Kanso (2018), with the power added.
"""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.figure import Figure

from undula.analysis.runs.run import Run
from undula.errors import InputError
from undula.views.common import style
from undula.views.common.physical_labels import in_physical
from undula.views.run.quantities import energy_row, power_row, tip_row
from undula.views.run.reading import read_scene, run_dataset
from undula.views.run.resample import curve_times, nodes_at, tip_at
from undula.views.run.scene import Floats, Scene
from undula.views.run.space import draw_shapes, draw_tip_path, space_axes
from undula.views.run.traces import draw_traces

_PATH_POINTS = 800


def portrait(run: xr.Dataset | Run, *, title: str | None = None, shapes: int = 28) -> Figure:
    """Draw the shapes of a run over its last period, and its history.

    Parameters
    ----------
    run : xarray.Dataset or Run
        A run, stored or as `undula.integrate` returns it.
    title : str, optional
        Title of the figure; by default load, verdict and frequency.
    shapes : int
        Number of shapes, at least 2. A run without a period, or with samples too sparse for
        interpolation, is shown by at most this many of its own samples.

    Returns
    -------
    matplotlib.figure.Figure
        10 by 5.5 inches, not registered with pyplot.

    Raises
    ------
    InputError
        `shapes` is below 2, or the run has too few samples or lacks a variable.

    Examples
    --------
    >>> import undula
    >>> from undula.views import portrait
    >>> stored = undula.load("results/spinning/run.nc")
    >>> portrait(stored).savefig("spinning.png")
    """
    if shapes < 2:
        raise InputError(f"shapes = {shapes}: ask for at least 2")
    dataset = run_dataset(run)
    scene = read_scene(dataset)
    with style.figure_style(dataset):
        figure = Figure(figsize=(10.0, 5.5))
        style.write_title(figure, headline(scene) if title is None else title, (0.022, 0.955))
        _draw_space(figure, scene.detail, shape_times(scene.detail, shapes))
        rows = (tip_row, energy_row, power_row)
        draw_traces(figure, scene, rows, left=0.545, right=0.975, top=0.885)
    return figure


def headline(scene: Scene) -> str:
    """Return load, verdict and frequency of a run in one line."""
    parts = [scene.load, scene.verdict]
    if scene.frequency is not None:
        physical = in_physical("frequency", scene.frequency)
        parts.append(f"{scene.frequency:.4g} {style.RATE_UNIT}{physical}")
    return "   ·   ".join(part for part in parts if part)


def shape_times(scene: Scene, count: int) -> Floats:
    """Return the times of the shapes: evenly over the last period, or over the shown part.

    Parameters
    ----------
    scene
        The run.
    count
        Largest number of shapes.
    """
    if scene.period is not None and scene.interpolable:
        # Phase 0 is left out, since it coincides with phase 1.
        return scene.end - scene.period * np.linspace(0, 1, count, endpoint=False)[::-1]
    return curve_times(scene, *scene.shown, count)


def _draw_space(figure: Figure, scene: Scene, times: Floats) -> None:
    drawn = nodes_at(scene, times)
    axes = space_axes(figure, (0.025, 0.24, 0.385, 0.65), drawn)
    path = curve_times(scene, *scene.shown, _PATH_POINTS)
    draw_tip_path(axes, tip_at(scene, path), joined=scene.interpolable)
    draw_shapes(axes, drawn)
    _draw_colour_key(figure, scene, times)


def _draw_colour_key(figure: Figure, scene: Scene, times: Floats) -> None:
    """Draw the colour bar of the shapes, with a note on sparse samples."""
    phased = scene.period is not None and scene.interpolable
    span = Normalize(0, 1) if phased else Normalize(times[0], times[-1])
    colours: Any = ScalarMappable(span, ListedColormap(style.shape_colours(len(times))))
    bar = figure.colorbar(
        colours, cax=figure.add_axes((0.11, 0.125, 0.22, 0.016)), location="bottom"
    )
    bar.outline.set_visible(False)
    bar.set_label(style.PHASE_LABEL if phased else f"shapes: {style.SHORT_TIME_LABEL}", labelpad=2)
    bar.ax.locator_params(nbins=3)
    if not scene.interpolable:
        note = f"{scene.samples_per_cycle:.2g} stored samples a cycle: too few to join"
        figure.text(
            0.22, 0.02, f"{note}, drawn as stored", ha="center", color=style.QUIET, fontsize=8
        )
