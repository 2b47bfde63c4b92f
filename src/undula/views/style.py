"""One look for every figure: colours, type sizes, and names of quantities with their units.

The line colours are the palette of Okabe & Ito (2008), which stays apart under the common kinds
of colour blindness and in grey print. Shapes in time run through viridis from its pale to its
dark end, so that later always means darker.
"""

from contextlib import AbstractContextManager
from typing import Any

import matplotlib as mpl
import numpy as np
from numpy.typing import NDArray

INK = "#222222"
QUIET = "#6b6b6b"
SHADOW = "#b9b9b9"
GROUND = "#f3f3f1"
SETTLED = "#eff2f5"
FOCUS = "#dbe5ee"
X_COLOUR = "#0072B2"
Y_COLOUR = "#D55E00"
Z_COLOUR = "#009E73"
ENERGY_COLOUR = "#8a3d78"
ACTIVE_COLOUR = "#E69F00"
DISSIPATION_COLOUR = "#222222"

TIME_LABEL = r"time $t$  $[T=\zeta_\perp L^4/B]$"
SHORT_TIME_LABEL = r"time $t$  $[T]$"
TIP_LABEL = "tip position\n" r"$x,\ y,\ z$  $[L]$"
ENERGY_LABEL = "bending energy\n" r"$E$  $[B/L]$"
POWER_LABEL = "power\n" r"$P$  $[B/(LT)]$"
RATE_UNIT = r"cycles per $T$"
PHASE_LABEL = "phase in the last period  [periods]"

_PALE, _DARK = 0.08, 0.97
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


def figure_style() -> AbstractContextManager[None]:
    """Give the look of all figures for the length of a `with` block.

    Returns
    -------
    context manager
        Inside it matplotlib's settings are its defaults with this package's look on top;
        outside it they are as they were, whatever the user's own settings say.
    """
    settings: Any = {**_plain_defaults(), **_SETTINGS}
    return mpl.rc_context(settings)


def shape_colours(count: int) -> NDArray[np.float64]:
    """Give one colour per shape, from pale (earliest) to dark (latest).

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


def _plain_defaults() -> dict[str, object]:
    """Matplotlib's own defaults without the backend, which is the user's choice alone."""
    kept = ("backend", "interactive", "toolbar", "timezone", "webagg", "savefig.directory")
    return {k: v for k, v in mpl.rcParamsDefault.items() if not k.startswith(kept)}
