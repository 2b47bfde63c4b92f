"""Diagram of a sweep over one axis: frequency, energy and stability boundaries."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from undula.arrays import Array
from undula.errors import InputError
from undula.schema.sweep_axes import verdicts_of
from undula.views.common import style
from undula.views.common.labels import Label, label_above
from undula.views.common.verdict_styles import look_of, ordered
from undula.views.sweep.axes import Border, place_legend, set_scale
from undula.views.sweep.points import FORCE, Note, axis_label, diagram_axes, units_of

_LEFT, _RIGHT, _BOTTOM = 0.095, 0.975, 0.085
# Top of the panels without names of boundaries, in fractions of the figure.
_TOP = 0.875


def draw_line(
    figure: Figure,
    store: xr.Dataset,
    boundaries: Sequence[Border],
    contradicting: Sequence[Note],
) -> None:
    """Draw frequency and energy of a sweep over one axis into a figure.

    Parameters
    ----------
    figure
        The figure.
    store
        The stored sweep.
    boundaries
        Stability boundaries, as for `phase_diagram`.
    contradicting
        Contradicting points, as for `phase_diagram`.

    Raises
    ------
    InputError
        Boundaries are given, and the axis is not the force.
    """
    name = diagram_axes(store)[0]
    if boundaries and name != FORCE:
        raise InputError(f"borders are values of {FORCE}; leave them out for a sweep over {name}")
    units, values = units_of(store), np.asarray(store[name].values, dtype=float)
    words = verdicts_of(store).transpose(name, ..., "try").values.reshape(values.size, -1)
    place_legend(figure, [_handles(words, ringed=bool(contradicting))], _LEFT, 0.945)
    panels = [figure.add_axes((_LEFT, _BOTTOM, _RIGHT - _LEFT, 0.3)) for _ in range(2)]
    lower, upper = panels
    for axes in panels:
        set_scale(axes, "x", values)
    lines = [(border, float(forces[0])) for border, _, forces in boundaries]
    top = label_above(figure, _labels(lower, lines), _LEFT, _RIGHT) if lines else _TOP
    middle = _BOTTOM + 0.5 * (top - _BOTTOM)
    lower.set_position((_LEFT, _BOTTOM, _RIGHT - _LEFT, middle - 0.02 - _BOTTOM))
    upper.set_position((_LEFT, middle + 0.02, _RIGHT - _LEFT, top - middle - 0.02))
    for axes in panels:
        for border, force in lines:
            axes.axvline(force, color=style.QUIET, lw=0.8, ls="--", zorder=1, gid=border)
    _draw(upper, values, words, _over(store, name, "frequency"), None)
    low, high = (_over(store, name, f"energy_{end}") for end in ("min", "max"))
    _draw(lower, values, words, low, high)
    ringed = [place[name] for place, _ in contradicting]
    _ring(upper, values, _over(store, name, "frequency"), ringed)
    upper.tick_params(labelbottom=False)
    upper.set_ylabel(style.frequency_label(paper_time=False))
    lower.set_ylabel(style.energy_label(units) + ", least to greatest")
    lower.set_xlabel(axis_label(name, units))
    figure.align_ylabels(panels)


def _over(store: xr.Dataset, name: str, quantity: str) -> Array:
    """Return a quantity over the axis and the replicates, (m, k); NaN if it is not stored."""
    if quantity not in store:
        return np.full((store.sizes[name], int(store["status"].size / store.sizes[name])), np.nan)
    stored = store[quantity].transpose(name, ..., "try").values
    return np.asarray(np.abs(stored.astype(float)).reshape(store.sizes[name], -1))


def _draw(
    axes: Axes, values: Array, words: NDArray[np.str_], low: Array, high: Array | None
) -> None:
    """Draw a symbol for each run, or a bar from `low` to `high` with symbols at both ends."""
    for verdict in ordered(words[words != ""].tolist()):
        look, runs = look_of(verdict), words == verdict
        xs = np.broadcast_to(values[:, None], words.shape)[runs]
        marker: Any = {"color": look.colour, "ls": "none", "ms": 5.0, "mew": 1.0, "zorder": 3}
        if verdict == "straight":
            marker["mfc"] = "none"
        if high is not None:
            axes.vlines(xs, low[runs], high[runs], color=look.colour, lw=1.6, alpha=0.6, zorder=2)
            axes.plot(xs, high[runs], look.marker, **marker)
        axes.plot(xs, low[runs], look.marker, gid=verdict, **marker)
    ends = [bound[np.isfinite(bound)] for bound in (low, high) if bound is not None]
    top = float(max(end.max(initial=0.0) for end in ends)) or 1.0
    # Half a symbol fits at both ends.
    axes.set_ylim(-0.03 * top, 1.06 * top)


def _ring(axes: Axes, values: Array, heights: Array, places: Sequence[float]) -> None:
    """Draw rings around the runs at given places of the axis."""
    ringed = np.flatnonzero(np.isin(values, places))
    xs = np.broadcast_to(values[ringed, None], heights[ringed].shape)
    ring: Any = {"mfc": "none", "mec": style.Y_COLOUR, "mew": 1.4, "ls": "none", "ms": 11}
    axes.plot(xs.ravel(), heights[ringed].ravel(), "o", gid="contradicting", **ring)


def _labels(axes: Axes, lines: Sequence[tuple[str, float]]) -> list[Label]:
    """Return labels of the boundaries that lie on the axis."""
    low, high = axes.get_xlim()
    labels = []
    for name, force in lines:
        if low <= force <= high:
            inside = axes.transAxes.inverted().transform(axes.transData.transform((force, 0.0)))[0]
            place = _LEFT + float(inside) * (_RIGHT - _LEFT)
            labels.append(Label(place, f"{name}\n{force:.5g}", style.QUIET))
    return labels


def _handles(words: NDArray[np.str_], *, ringed: bool) -> list[Artist]:
    """Return the legend handles of the verdicts, and of the rings if there are any."""
    handles: list[Artist] = []
    for verdict in ordered(words[words != ""].tolist()):
        look = look_of(verdict)
        face = "none" if verdict == "straight" else look.colour
        kind: Any = {"ls": "none", "marker": look.marker, "color": look.colour, "mfc": face}
        handles.append(Line2D([], [], ms=5.5, label=verdict, **kind))
    if ringed:
        ring: Any = {"ls": "none", "mfc": "none", "mec": style.Y_COLOUR, "mew": 1.4}
        label = "contradicts the solved states"
        handles.append(Line2D([], [], marker="o", ms=10, label=label, **ring))
    return handles
