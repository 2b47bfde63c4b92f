"""Dots and stability boundaries of a page in the form of its plotting library."""

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from undula.arrays import Array
from undula.views.common import style
from undula.views.common.verdict_styles import look_of, ordered
from undula.views.sweep.axes import Border, scale_of
from undula.views.sweep.points import (
    AT_REST,
    Dot,
    Note,
    axis_label,
    colour_span,
    dots_of,
    note_at,
    units_of,
)

#: Names of the horizontal and the vertical axis; None for a sweep over one axis.
Names = tuple[str, str | None]
_DASHES = {
    "onset": "solid",
    "spinning-lost": "8px,3px",
    "flapping-gained": "8px,3px,2px,3px",
    "flapping-lost": "2px,2px",
    "spinning-fold": "8px,3px,2px,3px,2px,3px",
    "flapping-fold": "1px,5px",
}
_OTHER_DASHES = "4px,2px"
_FONT = {"family": "system-ui, sans-serif", "color": style.INK, "size": 13}
_NO_COLOUR = "#9aa5ad"
_SYMBOLS = {
    r"\alpha": "α",
    r"\gamma": "γ",
    r"\zeta": "ζ",
    r"_\perp": "⊥",
    r"\mathrm": "",
    "^{-1}": "⁻¹",
    r"\mu ": "µ",
    r"\,": " ",
    "_a": "ₐ",
    "_0": "₀",
    "^2": "²",
    "^4": "⁴",
}


def plain(text: str) -> str:
    """Return a label of figures in one line, with formulas in plain letters."""
    return re.sub(r"\$(.*?)\$", lambda match: _letters(match[1]), text).replace("\n", "  ")


def layout(store: xr.Dataset, names: Names, dots: Sequence[Dot]) -> dict[str, Any]:
    """Return the axes, the colours and the legend of a page.

    Parameters
    ----------
    store
        The stored sweep.
    names
        Names of the horizontal and the vertical axis.
    dots
        Dots of the sweep.
    """
    x, y = names
    units = units_of(store)
    y_label = style.frequency_label(paper_time=False) if y is None else axis_label(y, units)
    return {
        "xaxis": _axis(axis_label(x, units), store[x].values),
        "yaxis": _axis(y_label, np.zeros(1) if y is None else store[y].values),
        "coloraxis": _colours(dots) if y is not None else {},
        "legend": {"orientation": "h", "x": 0, "y": 1.02, "yanchor": "bottom"},
        "margin": {"l": 70, "r": 20, "t": 70, "b": 60},
        "modebar": {"orientation": "v"},
        "hovermode": "closest",
        "hoverlabel": {"align": "left"},
        "font": _FONT,
        "plot_bgcolor": "white",
    }


def border_traces(store: xr.Dataset, names: Names, boundaries: Sequence[Border]) -> list[Any]:
    """Return boundaries as lines: curves over two axes, vertical lines over one axis.

    Parameters
    ----------
    store
        The stored sweep.
    names
        Names of the horizontal and the vertical axis.
    boundaries
        Stability boundaries, as for `phase_diagram`.
    """
    traces = []
    for name, values, forces in boundaries:
        finite = np.isfinite(forces)
        if not finite.any():
            continue
        order = np.argsort(values)
        xs, ys = np.asarray(values)[order].tolist(), _numbers(np.asarray(forces)[order])
        if not np.isfinite(values).all():
            ends = store[names[0]].values
            xs, ys = [float(ends.min()), float(ends.max())], [float(forces[0])] * 2
        label = "%{y:.6g}"
        if names[1] is None:
            xs, ys = [float(forces[0])] * 2, [0.0, _highest(dots_of(store))]
            label = f"{forces[0]:.6g}"
        traces.append(
            {
                "type": "scatter",
                # A single force between gaps is drawn as a marker.
                "mode": "lines" if len(xs) == 2 or finite.sum() > 1 else "lines+markers",
                "name": name,
                "x": xs,
                "y": ys,
                "line": {"color": style.INK, "dash": _DASHES.get(name, _OTHER_DASHES)},
                "hovertemplate": f"{name} {label}<extra></extra>",
            }
        )
    return traces


def dot_traces(
    store: xr.Dataset, names: Names, dots: Sequence[Dot], contradicting: Sequence[Note]
) -> list[Any]:
    """Return the dots of each verdict, those without a verdict, and rings around contradictions.

    Parameters
    ----------
    store
        The stored sweep.
    names
        Names of the horizontal and the vertical axis.
    dots
        Dots of the sweep.
    contradicting
        Contradicting points, as for `phase_diagram`.
    """
    traces = []
    numbered = list(enumerate(dots))
    for verdict in ordered(dot.verdict for dot in dots if dot.verdict):
        group = [(number, dot) for number, dot in numbered if dot.verdict == verdict]
        traces.append(_trace(store, names, verdict, group, _marker(verdict, names, group)))
        traces[-1] |= {"legendgroup": verdict, "showlegend": False}
        traces.append(_in_legend(verdict, names))
    for name, failed, symbol, colour in (
        ("failed", True, "x-thin-open", style.Y_COLOUR),
        ("not done", False, "cross-thin-open", style.SHADOW),
    ):
        group = [(k, dot) for k, dot in numbered if not dot.verdict and dot.failed == failed]
        if group:
            marker = {"symbol": symbol, "color": colour, "size": 7}
            traces.append(_trace(store, names, name, group, marker))
    ringed = [(k, dot) for k, dot in numbered if note_at(dot, names, contradicting) is not None]
    if ringed:
        line = {"color": style.Y_COLOUR, "width": 2}
        marker = {"symbol": "circle-open", "size": 20, "color": style.Y_COLOUR, "line": line}
        rings = _trace(store, names, "contradicts the solved states", ringed, marker)
        traces.append(rings | {"hoverinfo": "skip", "hovertemplate": None, "customdata": None})
    return traces


def _trace(
    store: xr.Dataset,
    names: Names,
    name: str,
    group: Sequence[tuple[int, Dot]],
    marker: Mapping[str, Any],
) -> dict[str, Any]:
    places = [_place(store, names, dot) for _, dot in group]
    return {
        "type": "scatter",
        "mode": "markers",
        "name": name,
        "x": [place[0] for place in places],
        "y": [place[1] for place in places],
        "customdata": [number for number, _ in group],
        "text": [_words(dot) for _, dot in group],
        "hovertemplate": f"<b>{name}</b><br>%{{text}}<extra></extra>",
        "marker": dict(marker),
    }


def _in_legend(verdict: str, names: Names) -> dict[str, Any]:
    """Return the legend entry of a verdict: its symbol without a colour of frequency."""
    marker = _marker(verdict, names, [])
    if names[1] is not None and verdict not in AT_REST:
        marker["color"] = _NO_COLOUR
    point: dict[str, Any] = {"x": [None], "y": [None], "marker": marker, "legendgroup": verdict}
    return point | {"type": "scatter", "mode": "markers", "name": verdict}


def _marker(verdict: str, names: Names, group: Sequence[tuple[int, Dot]]) -> dict[str, Any]:
    look = look_of(verdict)
    marker: dict[str, Any] = {"symbol": look.symbol, "size": 12, "color": look.colour}
    if verdict in AT_REST:
        return marker | {"size": 8}
    marker["line"] = {"color": style.INK, "width": 0.7}
    if names[1] is None:
        return marker
    rates = _numbers(np.array([dot.frequency for _, dot in group]))
    logs = [math.log10(rate) if rate else None for rate in rates]
    if not any(logs):
        return marker | {"color": "white"}
    return marker | {"color": logs, "coloraxis": "coloraxis"}


def _place(store: xr.Dataset, names: Names, dot: Dot) -> tuple[float, float]:
    """Return the place of a dot, shifted where its point has several dots."""
    x, y = names
    if y is None:
        return dot.x, dot.frequency if np.isfinite(dot.frequency) else 0.0
    shift = 0.28 * (dot.place - 0.5 * (dot.places - 1))
    values = np.unique(np.asarray(store[x].values, dtype=float))
    if dot.places == 1 or values.size < 2:
        return dot.x, dot.y
    if scale_of(values) == "log":
        return float(dot.x * np.exp(shift * np.diff(np.log(values)).min())), dot.y
    return float(dot.x + shift * np.diff(values).min()), dot.y


def _words(dot: Dot) -> str:
    """Return the lines that are shown while the pointer is on a dot."""
    rate = f"{dot.frequency:.5g} cycles per T" if np.isfinite(dot.frequency) else ""
    several = f"{dot.tries} of {dot.of} tries" if dot.of > 1 else ""
    return "<br>".join(words for words in (rate, several) if words)


def _colours(dots: Sequence[Dot]) -> dict[str, Any]:
    """Return the colour scale of frequencies: logarithmic, with plain numbers."""
    span = colour_span(dots)
    if span is None:
        return {"showscale": False}
    marks = _round_numbers(*span)
    bar = {
        "title": {"text": "frequency [cycles per T]", "side": "right"},
        "tickvals": [math.log10(mark) for mark in marks],
        "ticktext": [f"{mark:.4g}" for mark in marks],
        "thickness": 14,
        "outlinewidth": 0,
    }
    low, high = (math.log10(end) for end in span)
    return {"colorscale": "Viridis", "cmin": low, "cmax": high, "colorbar": bar}


def _round_numbers(low: float, high: float) -> list[float]:
    """Return 1, 2 and 5 times the powers of ten between two numbers."""
    decades = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    marks = [step * 10.0**decade for decade in decades for step in (1.0, 2.0, 5.0)]
    return [mark for mark in marks if low * (1.0 - 1e-9) <= mark <= high * (1.0 + 1e-9)]


def _axis(label: str, values: Any) -> dict[str, Any]:
    look = {"title": {"text": plain(label)}, "showline": True, "linecolor": style.QUIET}
    look |= {"ticks": "outside", "gridcolor": "#eeeeee", "zeroline": False}
    places = np.asarray(values, dtype=float)
    if scale_of(places) == "log":
        marks = _round_numbers(float(places.min()), float(places.max()))
        words = [f"{mark:g}" for mark in marks]
        return look | {"type": "log", "tickvals": marks, "ticktext": words}
    return look | {"type": "linear", "exponentformat": "none"}


def _highest(dots: Sequence[Dot]) -> float:
    rates = [dot.frequency for dot in dots if np.isfinite(dot.frequency)]
    return max(rates, default=1.0)


def _numbers(values: Array) -> list[float | None]:
    """Return numbers for JSON, with None in place of NaN and infinity."""
    return [float(value) if np.isfinite(value) else None for value in values]


def _letters(formula: str) -> str:
    for mark, letter in _SYMBOLS.items():
        formula = formula.replace(mark, letter)
    return re.sub(r"[\\{}]", "", formula)
