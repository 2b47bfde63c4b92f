"""Shapes of a mode of the straight filament over one cycle."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure

from undula.analysis.linear.results import Spectrum
from undula.arrays import Array
from undula.views.common import style

# Number of shapes over a cycle, and of modes that are drawn with one that does not oscillate.
_SHAPES = 16
_OTHER_MODES = 2


def leading_shapes(spectrum: Spectrum) -> Array:
    """Return the shapes of the leading mode over one cycle, in the order of time.

    Parameters
    ----------
    spectrum : Spectrum
        Eigenvalues and modes; the growth of the mode is left out.

    Returns
    -------
    ndarray of shape (k, m)
        Displacements Re[y(s) exp(i phase)] at evenly spaced phases from 0 on; a single shape for an
        eigenvalue that is real within its error.
    """
    frequency = spectrum.values[0].imag
    if not abs(frequency) > np.nan_to_num(spectrum.errors[0]):
        return np.asarray(spectrum.modes[:1].real)
    # The phases of an eigenvalue with negative imaginary part run backwards.
    phases = np.sign(frequency) * 2 * np.pi * np.arange(_SHAPES)[:, None] / _SHAPES
    return np.asarray(np.real(spectrum.modes[0] * np.exp(1j * phases)))


def draw_mode(figure: Figure, spectrum: Spectrum) -> None:
    """Draw the leading mode into the right third of a figure, with the filament upright.

    Parameters
    ----------
    figure
        The figure.
    spectrum
        Eigenvalues and modes.
    """
    axes = figure.add_axes((0.69, 0.235, 0.285, 0.585))
    shapes = leading_shapes(spectrum)
    axes.set(xlim=(-1.1, 1.1), ylim=(0, 1.03), xticks=[])
    axes.axvline(0.0, color=style.SHADOW, lw=0.8, zorder=0)
    axes.set_xlabel(style.DISPLACEMENT_LABEL, labelpad=5)
    axes.set_ylabel(style.ARC_LABEL)
    for shape, colour in zip(shapes, style.shape_colours(len(shapes)), strict=True):
        width = 1.3 if len(shapes) > 1 else 2.4
        axes.plot(shape, spectrum.s, color=colour, lw=width, gid="shape", clip_on=False)
    axes.plot([0], [0], "s", ms=6, color=style.INK, clip_on=False, zorder=7)
    name = rf"leading mode at $F$ = {spectrum.force:.4g}"
    if len(shapes) > 1:
        axes.set_title(f"{name}\none cycle, growth left out", loc="left")
        _draw_phase_key(figure)
    else:
        others = _draw_others(axes, spectrum)
        more = "; grey: the next in line" if others else ""
        axes.set_title(f"{name}\ndoes not oscillate{more}", loc="left")


def _draw_others(axes: Axes, spectrum: Spectrum) -> int:
    """Draw the next modes faintly, one for each complex pair; return their number."""
    upper_half = [k for k in range(1, len(spectrum.values)) if spectrum.values[k].imag >= 0]
    for k, dashes in zip(upper_half[:_OTHER_MODES], ("-", "--"), strict=False):
        look: Any = {"color": style.SHADOW, "lw": 1.2, "gid": "other mode", "zorder": 1}
        axes.plot(spectrum.modes[k].real, spectrum.s, dashes, **look)
    return len(upper_half[:_OTHER_MODES])


def _draw_phase_key(figure: Figure) -> None:
    colours: Any = ScalarMappable(cmap=ListedColormap(style.shape_colours(_SHAPES)))
    bar = figure.colorbar(
        colours, cax=figure.add_axes((0.735, 0.115, 0.195, 0.016)), location="bottom"
    )
    bar.outline.set_visible(False)
    bar.set_label(style.CYCLE_LABEL, labelpad=2)
    bar.set_ticks([0, 0.5, 1])
