"""Rotation of stored runs about the axis."""

import json
from collections.abc import Mapping
from string import ascii_lowercase
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from undula.analysis.observables.shapes import tip_height
from undula.arrays import Array
from undula.errors import is_number
from undula.views.run.reading import read_scene
from undula.views.run.scene import Scene
from undula.views.run.winding import TipAngleSeries, winding_figure

#: Number of beats of the tip's height over which curves are drawn, and shapes.
_CURVES, _SHAPES = 24.0, 5.3
#: Range of the tip's height below which its rises are not taken as the beat [L].
_LEVEL = 1e-3


def windings(*runs: xr.Dataset) -> Figure:
    """Draw runs side by side: shapes, the angle of the tip about the axis and its height.

    Parameters
    ----------
    *runs : xarray.Dataset
        Stored runs, at least one, as `undula.load_result` returns them.

    Returns
    -------
    matplotlib.figure.Figure
        As `winding_figure` draws it: the last beats of each run.

    Raises
    ------
    InputError
        There is no run, or one has too few samples or lacks a variable.
    """
    return winding_figure(
        [_azimuth_series(run, which) for run, which in zip(runs, ascii_lowercase, strict=False)]
    )


def _azimuth_series(run: xr.Dataset, which: str) -> TipAngleSeries:
    scene, summary = read_scene(run), json.loads(run.attrs["summary"])
    shown = _finest(scene)
    rate = _rate(shown, summary)
    beat = shown.duration if rate is None else 1.0 / rate
    last = shown.times >= shown.end - _CURVES * beat
    title = f"({which})  $F$ = {float(summary['force']):g}: {scene.verdict}"
    length = min(_SHAPES * beat, shown.duration)
    return TipAngleSeries(title, shown.times[last], shown.nodes[last], length)


def _finest(scene: Scene) -> Scene:
    """Return the run itself if it resolves single cycles, otherwise its finely sampled end."""
    return scene if scene.interpolable else scene.detail


def _rate(scene: Scene, summary: Mapping[str, Any]) -> float | None:
    """Return the rises of the tip per T, or the frequency if the tip keeps its height."""
    second_half = scene.times >= 0.5 * (scene.start + scene.end)
    times, heights = scene.times[second_half], tip_height(scene.nodes[second_half])
    if float(np.ptp(heights)) >= _LEVEL:
        return _strongest(times, heights)
    frequency = summary.get("frequency")
    return abs(float(frequency)) if is_number(frequency) and frequency else None


def _strongest(times: Array, values: Array) -> float:
    """Return the frequency of the strongest line of evenly sampled values [cycles per T]."""
    strength = np.abs(np.fft.rfft((values - values.mean()) * np.hanning(values.size)))
    rates = np.fft.rfftfreq(values.size, float(times[1] - times[0]))
    # The first line, of zero frequency, is not a beat.
    return float(rates[1 + np.argmax(strength[1:])])
