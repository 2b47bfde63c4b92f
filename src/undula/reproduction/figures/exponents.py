"""Lyapunov exponents of several runs."""

import json
from collections.abc import Mapping
from itertools import cycle
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from undula.errors import InputError
from undula.views.common import style
from undula.views.common.panels import legend_above, quiet_line

#: Number of exponents that are drawn of each run.
_MOST_EXPONENTS = 8
_COLOURS = (
    style.X_COLOUR,
    style.Y_COLOUR,
    style.Z_COLOUR,
    style.ENERGY_COLOUR,
    style.ACTIVE_COLOUR,
)
_MARKERS = ("o", "s", "^", "D", "v")
#: Width of a group, the exponents of all runs by one number, as a share of their distance.
_GROUP_WIDTH = 0.6
#: Ratio of the greatest exponent to the median above which the axis is logarithmic.
_LOGARITHMIC_ABOVE = 30.0


def lyapunov(*runs: xr.Dataset) -> Figure:
    """Draw the leading Lyapunov exponents of runs with their errors.

    Parameters
    ----------
    *runs : xarray.Dataset
        Stored runs with Lyapunov exponents, at least one.

    Returns
    -------
    matplotlib.figure.Figure
        9 by 4.2 inches, not registered with pyplot. The exponents of all runs are side by side, by
        their number from the largest on, after the rate at which pairs of runs separate.

    Raises
    ------
    InputError
        There is no run, or one has no exponents.
    """
    if not runs:
        raise InputError("there are no runs to be drawn; give at least one")
    summaries = [json.loads(run.attrs["summary"]) for run in runs]
    with style.figure_style():
        figure = Figure(figsize=(9.0, 4.2))
        axes = figure.add_axes((0.095, 0.135, 0.88, 0.74))
        places = _GROUP_WIDTH * (np.arange(len(runs)) - 0.5 * (len(runs) - 1)) / max(len(runs), 3)
        handles, drawn, pairs = [], [], False
        looks = zip(cycle(_COLOURS), cycle(_MARKERS), summaries, places, strict=False)
        for colour, marker, summary, shift in looks:
            stored = _stored(summary)
            values, errors = (
                np.array(stored[key][:_MOST_EXPONENTS], float) for key in ("exponents", "errors")
            )
            name = f"{summary['load']}: {summary['verdict']}"
            look: Any = {"fmt": marker, "color": colour, "ms": 5.5, "lw": 1.3, "capsize": 2.5}
            numbers = np.arange(1, values.size + 1) + shift
            axes.errorbar(numbers, values, errors, gid=name, **look)
            pair = stored.get("finite_separation")
            if pair and pair.get("rate") is not None:
                pairs = True
                error = pair.get("error") or 0.0
                axes.errorbar([shift], [pair["rate"]], [error], mfc="white", gid="pairs", **look)
            handles.append(Line2D([], [], ls="", marker=marker, color=colour, ms=5.5, label=name))
            drawn.append(values)
        quiet_line(axes)
        _scale(axes, np.concatenate(drawn))
        _number_axis(axes, max(values.size for values in drawn), pairs=pairs)
        top = legend_above(figure, handles, 0.095)
        axes.set_position((0.095, 0.135, 0.88, top - 0.165))
    return figure


def _number_axis(axes: Any, count: int, *, pairs: bool) -> None:
    """Set the axis of the exponents' numbers, the rate of pairs of runs first."""
    for edge in np.arange(1 if pairs else 2, count + 1) - 0.5:
        axes.axvline(edge, color=style.SHADOW, lw=0.5, zorder=0)
    axes.set_xlim(-0.5 if pairs else 0.5, count + 0.5)
    numbers = list(range(0 if pairs else 1, count + 1))
    axes.set_xticks(numbers, ["pairs\nof runs" if k == 0 else f"{k}" for k in numbers])
    axes.set_xlabel("number of the exponent")
    axes.set_ylabel(r"Lyapunov exponent $\lambda$  $[1/T]$")


def _stored(summary: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return the exponents of a run."""
    stored = summary.get("lyapunov")
    if not stored:
        why = summary.get("without_lyapunov") or "they were not asked for"
        raise InputError(
            f"the run at F = {summary.get('force')} has no Lyapunov exponents ({why}); run it with"
            " --lyapunov"
        )
    return dict(stored)


def _scale(axes: Any, values: Any) -> None:
    """Set a logarithmic scale, linear around zero, if few exponents are much larger than others."""
    sizes = np.abs(values[values != 0.0])
    if sizes.size and sizes.max() > _LOGARITHMIC_ABOVE * np.median(sizes):
        axes.set_yscale("symlog", linthresh=float(np.median(sizes)))
