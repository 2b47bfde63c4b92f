"""Figures of runs and ramps."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from undula.analysis.observables.shapes import tip_radius
from undula.analysis.runs.dataset import dataset_of
from undula.analysis.runs.run import Run
from undula.views.run.portrait import portrait


def run_figure(run: Run, ax: Axes | None) -> Figure | Axes:
    """Draw a run: its portrait, or into given axes the distance of its tip from the axis."""
    if ax is None:
        return portrait(dataset_of(run))
    ax.plot(run.motion.time, tip_radius(run.motion.nodes), lw=0.8)
    ax.set_xlabel("time [T]")
    ax.set_ylabel("tip radius [L]")
    return ax


def ramp_figure(ramp: Any, ax: Axes | None) -> Figure | Axes:
    """Draw a ramp: the mean bending energy over the parameter, by direction."""
    if ax is None:
        figure = Figure(figsize=(6.0, 4.0), layout="constrained")
        ramp_figure(ramp, figure.add_subplot())
        return figure
    for direction, marker in (("up", "^"), ("down", "v")):
        steps = [step for step in ramp if step.direction == direction]
        if steps:
            energies = np.array([step.bending_energy.mean for step in steps])
            ax.plot([step.value for step in steps], energies, f"{marker}-", ms=4, label=direction)
    ax.set_xlabel(ramp.parameter)
    ax.set_ylabel("mean bending energy [B/L]")
    ax.legend()
    return ax
