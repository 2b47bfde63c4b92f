"""Common style of all figures: colours, type sizes, and names of quantities with their units.

The line colours are the palette of Okabe & Ito (2008), which remains distinct with the common kinds
of colour blindness and in grey print. Shapes in the course of time are coloured with viridis, from
pale to dark.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.text import Text
from numpy.typing import NDArray

from undula.models.scales import Scales
from undula.models.units import FILAMENT_UNITS
from undula.views.common.physical_labels import equal_to, labelled, physical_units_of

#: Names of units by quantity, as `undula.models.units.Units.names` returns them.
UnitNames = Mapping[str, str]
FILAMENT: UnitNames = FILAMENT_UNITS.names()

# Lines and text, and those of secondary importance.
INK = "#222222"
QUIET = "#6b6b6b"
SHADOW = "#b9b9b9"
# Backgrounds: the ground below a filament; the settled, the shown and the unstable interval.
GROUND = "#f3f3f1"
SETTLED = "#eff2f5"
FOCUS = "#dbe5ee"
UNSTABLE = "#f9e6d8"
# Coordinates, energy and powers.
X_COLOUR = "#0072B2"
Y_COLOUR = "#D55E00"
Z_COLOUR = "#009E73"
ENERGY_COLOUR = "#8a3d78"
ACTIVE_COLOUR = "#E69F00"
DISSIPATION_COLOUR = "#222222"

SHORT_TIME_LABEL = r"time $t$  $[T]$"
RATE_UNIT = r"cycles per $T$"
PHASE_LABEL = "phase in the last period  [periods]"
ARC_LABEL = r"arc length $s$  $[L]$"
DISPLACEMENT_LABEL = "displacement, arbitrary scale"
CYCLE_LABEL = "phase  [cycles]"

_PARAMETER_LABELS = {
    "load.slope": r"slope $\alpha$",
    "load.exponent": r"exponent $p$",
    "model.drag_ratio": r"drag ratio $\gamma$",
    "model.base_spring": r"base spring $K_0$  $[K]$",
}
_PALE, _DARK = 0.08, 0.97
# Type sizes of a title and of the longest title [points].
_TITLE, _SMALLEST = 11.5, 7.0
_SETTINGS = {
    "font.family": ["DejaVu Sans"],
    "font.size": 9.0,
    "axes.labelsize": 9.0,
    "axes.titlesize": 9.0,
    "axes.titlecolor": QUIET,
    "axes.edgecolor": QUIET,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.xmargin": 0.0,
    "axes.formatter.limits": (-3, 4),
    "axes.formatter.use_mathtext": True,
    "axes.formatter.useoffset": False,
    "xtick.color": QUIET,
    "ytick.color": QUIET,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "legend.fontsize": 8.5,
    "legend.frameon": False,
    "legend.handlelength": 1.3,
    "legend.columnspacing": 1.0,
    "legend.handletextpad": 0.5,
    "lines.linewidth": 1.4,
    "lines.solid_capstyle": "round",
    "mathtext.fontset": "dejavusans",
    "text.color": INK,
    "figure.facecolor": "white",
    "figure.dpi": 150.0,
}


@contextmanager
def figure_style(physical: Scales | xr.Dataset | None = None) -> Iterator[None]:
    """Set the style of all figures within a context.

    In the context matplotlib has its default settings with those of this package, independent of
    the user's settings, which are restored afterwards.

    Parameters
    ----------
    physical
        Scales, or a stored result that has some, whose physical units the labels state; None for
        labels without physical units.
    """
    settings: Any = {**_plain_defaults(), **_SETTINGS}
    with mpl.rc_context(settings), labelled(physical_units_of(physical)):
        yield


def shape_colours(count: int) -> NDArray[np.float64]:
    """Return one colour per shape, from pale (earliest) to dark (latest).

    Parameters
    ----------
    count : int
        Number of shapes, at least 1.

    Returns
    -------
    ndarray of shape (count, 4)
        Red, green, blue and opacity, each in [0, 1].
    """
    places = np.linspace(_PALE, _DARK, count) if count > 1 else np.array([_DARK])
    return np.asarray(mpl.colormaps["viridis_r"](places), dtype=np.float64)


def force_label(units: UnitNames) -> str:
    """Return the name of the force with its unit."""
    return rf"force $F$  $[{_symbols(units['force'])}{equal_to('force')}]$"


def tip_label() -> str:
    """Return the name of the tip's coordinates with their unit."""
    return "tip position\n" rf"$x,\ y,\ z$  $[L{equal_to('length')}]$"


def energy_label(units: UnitNames) -> str:
    """Return the name of the bending energy with its unit."""
    return "bending energy\n" rf"$E$  $[{_symbols(units['energy'])}{_below('energy')}]$"


def power_label(units: UnitNames) -> str:
    """Return the name of the power with its unit, that of the energy per T."""
    above, _, below = _symbols(units["energy"]).partition("/")
    unit = f"{above}/{f'({below}T)' if below else 'T'}"
    return "power\n" rf"$P$  $[{unit}{_below('power')}]$"


def time_label(units: UnitNames) -> str:
    """Return the name of the time with the meaning of T."""
    return rf"time $t$  $[T={_symbols(units['time'])}{equal_to('time')}]$"


def growth_rate_label(*, paper_time: bool) -> str:
    """Return the name of the growth rate with its unit."""
    physical = "" if paper_time else equal_to("rate")
    unit = r"\gamma/T" if paper_time else f"1/T{physical}"
    return rf"growth rate $\mathrm{{Re}}\,\sigma${_gap(physical)}$[{unit}]$"


def frequency_label(*, paper_time: bool) -> str:
    """Return the name of the frequency with its unit."""
    physical = "" if paper_time else equal_to("frequency")
    return f"frequency{_gap(physical)}{frequency_in_brackets(paper_time=paper_time)}"


def frequency_in_brackets(*, paper_time: bool) -> str:
    """Return the unit of frequencies in square brackets, with its physical value."""
    physical = "" if paper_time else equal_to("frequency")
    return f"[{frequency_unit(paper_time=paper_time)}{f' ${physical}$' if physical else ''}]"


def frequency_unit(*, paper_time: bool) -> str:
    """Return the unit of frequencies."""
    # In a time unit shorter by the factor gamma, the same rate is smaller by this factor.
    return r"cycles per $T/\gamma$" if paper_time else RATE_UNIT


def parameter_label(name: str) -> str:
    """Return symbol and unit of a parameter such as "load.slope"; other names unchanged."""
    if name == "load.position":
        return rf"position $s_a$  $[L{equal_to('length')}]$"
    return _PARAMETER_LABELS.get(name, name)


def headed_figure(title: str, *, paper_time: bool) -> Figure:
    """Return a figure of 10 by 5.5 inches with a title, and a note on the paper's time unit.

    Parameters
    ----------
    title
        Title of the figure.
    paper_time
        True for the time unit of the paper's printed equation.
    """
    figure = Figure(figsize=(10.0, 5.5))
    right = 0.978
    if paper_time:
        note = r"time unit of the printed equation, $T/\gamma$"
        drawn = figure.text(right, 0.955, note, ha="right", color=QUIET)
        right = float(drawn.get_window_extent().x0 / figure.bbox.width) - 0.02
    write_title(figure, title, (0.022, 0.955), right=right)
    return figure


def write_title(
    figure: Figure, title: str, place: tuple[float, float], *, right: float = 0.978
) -> None:
    """Write the title of a figure; a long title is smaller, and a very long one is cut off.

    Parameters
    ----------
    figure : Figure
        The figure.
    title : str
        The title, in one line.
    place : tuple of float
        Lower left corner in fractions of the figure.
    right : float
        Right end in fractions of the figure's width.
    """
    text = figure.text(*place, title, fontsize=_TITLE, gid="title")
    room = (right - place[0]) * figure.bbox.width
    text.set_fontsize(min(_TITLE, max(_SMALLEST, _TITLE * room / max(_width(text), 1.0))))
    while _width(text) > room and len(title) > 1:
        title = title[: min(len(title) - 1, int(len(title) * room / _width(text)))]
        text.set_text(title.rstrip() + " …")


def _width(text: Text) -> float:
    return float(text.get_window_extent().width)


def _gap(physical: str) -> str:
    """Return the gap between a name and its unit: a new line before a physical value."""
    return "\n" if physical else "  "


def _below(quantity: str) -> str:
    """Return the physical value of one unit as `equal_to` does, in a line of its own."""
    physical = equal_to(quantity)
    return f"$\n${physical}" if physical else ""


def _symbols(unit: str) -> str:
    """Return the name of a unit as a formula."""
    return unit.replace("zeta", r"\zeta").replace("_perp", r"_\perp")


def _plain_defaults() -> dict[str, object]:
    """Return the defaults of matplotlib without the backend, which the user chooses."""
    user_settings = ("backend", "interactive", "toolbar", "timezone", "webagg", "savefig.directory")
    return {k: v for k, v in mpl.rcParamsDefault.items() if not k.startswith(user_settings)}
