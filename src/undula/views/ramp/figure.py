"""The figure of series of steps: energies along the parameter, and shapes on the way.

After the figure on bead-spring chains of Ling, Guo & Kanso (2018).
"""

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from undula.views.common import style
from undula.views.common.labels import label_above
from undula.views.common.legends import fitting_legend
from undula.views.ramp.energies import (
    ALONE,
    draw_energies,
    draw_thresholds,
    marker,
    threshold_labels,
)
from undula.views.ramp.gallery import (
    LINE,
    Cell,
    chosen_steps,
    common_view,
    draw_cell,
    words_below,
)
from undula.views.ramp.series import StepSeries, read_series, verdict_colours

# Inches: least width of a column, height of the figure, what stands below a panel, and the gap
# below the words of a cell.
_COLUMN, _HEIGHT, _LABEL, _GAP = 3.3, 7.0, 0.6, 0.16
# Parts of the figure: its foot, and the names of the series between legend and thresholds.
_FOOT, _NAMES = 0.012, 0.884


def ramp_diagram(
    datasets: Sequence[xr.Dataset],
    *,
    thresholds: Sequence[Mapping[str, float]] = (),
    title: str | None = None,
) -> Figure:
    """Draw series of steps: their bending energy against the parameter, and shapes on the way.

    Parameters
    ----------
    datasets : sequence of xarray.Dataset
        At least one, as `load_ramp` gives them, all along one parameter; each is a column.
    thresholds : sequence of mapping of str to float
        For each series, in their order, names and values of solved thresholds; those beyond the
        values of the steps are left out.
    title : str, optional
        Replaces the line above, which tells model and load of a single series.

    Returns
    -------
    matplotlib.figure.Figure
        10 by 7 inches, wider for more than three series; not known to pyplot.

    Raises
    ------
    InputError
        There is no series, one lacks a variable, or they are along different parameters.
    """
    series = read_series(datasets)
    known = _known(series, thresholds)
    colours = verdict_colours([verdict for one in series for verdict in one.verdicts])
    with style.figure_style():
        figure = Figure(figsize=(max(10.0, _COLUMN * len(series)), _HEIGHT))
        alone = series[0].load if len(series) == 1 else ""
        style.write_title(figure, alone if title is None else title, (_in(figure, 0.22), 0.955))
        _name_all(figure, series, colours, thresholds=any(known))
        top = _draw_galleries(figure, series, colours)
        _draw_panels(figure, series, known, colours, bottom=top + _LABEL / _HEIGHT)
    return figure


def _known(
    series: Sequence[StepSeries], thresholds: Sequence[Mapping[str, float]]
) -> list[dict[str, float]]:
    """Return the thresholds of each series that lie on its axis."""
    given = [*thresholds, *({} for _ in series)]
    return [
        {name: value for name, value in some.items() if one.span[0] <= value <= one.span[1]}
        for one, some in zip(series, given, strict=False)
    ]


def _in(figure: Figure, inches: float) -> float:
    """Return a width in inches as a part of the figure."""
    return inches / figure.get_figwidth()


def _columns(figure: Figure, count: int) -> list[tuple[float, float]]:
    """Return the left and right edges of the columns."""
    edges = np.linspace(_in(figure, 0.25), 1.0 - _in(figure, 0.15), count + 1).tolist()
    return list(pairwise(edges))


def _draw_galleries(
    figure: Figure, series: Sequence[StepSeries], colours: Mapping[str, str]
) -> float:
    """Draw shapes of some steps of each series; return where the galleries end above."""
    rows, across = (1, 7) if len(series) == 1 else (2, 4) if len(series) == 2 else (2, 3)
    columns = _columns(figure, len(series))
    pitch = (columns[0][1] - columns[0][0]) / across
    inches = pitch * figure.get_figwidth()
    cells = [_cells(one, rows * across, colours, inches) for one in series]
    # Every regime is shown, also where there are more of them than places.
    rows = max(rows, *(-(-len(some) // across) for some in cells))
    every = [cell for some in cells for cell in some]
    view, words = common_view(every), _GAP + LINE * max(len(cell.words) for cell in every)
    # Half of the height is for the galleries, at most.
    wide = min(0.94 * inches, (0.5 * _HEIGHT / rows - words) / view.aspect)
    height = (wide * view.aspect + words) / _HEIGHT
    for (left, _), some in zip(columns, cells, strict=True):
        for place, cell in enumerate(some):
            row, column = divmod(place, across)
            middle = left + (column + 0.5) * pitch
            foot = _FOOT + (rows - row - 1) * height + words / _HEIGHT
            width = _in(figure, wide)
            draw_cell(figure, cell, view, (middle - 0.5 * width, foot, width))
    return _FOOT + rows * height


def _cells(series: StepSeries, count: int, colours: Mapping[str, str], inches: float) -> list[Cell]:
    verdicts, back = series.verdicts, series.up != series.up[0]
    cells = []
    for k in chosen_steps(series.values, verdicts, back, count):
        way = (" up" if series.up[k] else " down") if series.there_and_back else ""
        words = words_below(f"{series.values[k]:.6g}{way}", verdicts[k], inches)
        cells.append(Cell(series.shapes[k], words, colours[verdicts[k]]))
    return cells


def _draw_panels(
    figure: Figure,
    series: Sequence[StepSeries],
    known: Sequence[Mapping[str, float]],
    colours: Mapping[str, str],
    *,
    bottom: float,
) -> None:
    """Draw the energies of each series, with the names of the thresholds above."""
    edges = [
        (left + _in(figure, 0.6), right - _in(figure, 0.1))
        for left, right in _columns(figure, len(series))
    ]
    each = list(zip(series, known, edges, strict=True))
    labels = [threshold_labels(one, some, *ends) for one, some, ends in each]
    tops = [label_above(figure, some, *ends) for some, ends in zip(labels, edges, strict=True)]
    for named, top in zip(labels, tops, strict=True):
        for label in named:
            # Leaders go on where the panel of another column ends lower.
            line = [label.place, label.place], [min(tops), top]
            figure.add_artist(Line2D(*line, color=label.colour, lw=0.8))
    for one, some, (left, right) in each:
        axes = figure.add_axes((left, bottom, right - left, min(tops) - bottom))
        draw_energies(figure, axes, one, colours)
        draw_thresholds(axes, some)
        if one is series[0] or one.units != series[0].units:
            axes.set_ylabel(style.energy_label(one.units))
        if len(series) > 1:
            figure.text(left, _NAMES, one.load)


def _name_all(
    figure: Figure, series: Sequence[StepSeries], colours: Mapping[str, str], *, thresholds: bool
) -> None:
    handles: list[Artist] = [
        Line2D([], [], label=verdict, **marker(colour, up=True, size=ALONE))
        for verdict, colour in colours.items()
    ]
    if any(one.there_and_back for one in series):
        handles += [
            Line2D([], [], label=name, **marker(style.QUIET, up=name == "up", size=1.0))
            for name in ("up", "down")
        ]
    if thresholds:
        handles.append(Line2D([], [], color=style.INK, lw=0.8, ls="--", label="solved threshold"))
    fitting_legend(figure, handles, (_in(figure, 0.14), 0.945), handletextpad=0.3)
