"""A run as a labelled dataset, the content of a result file and the input of views."""

import json
import platform
from collections.abc import Mapping
from dataclasses import asdict, is_dataclass
from importlib.metadata import version
from typing import Any

import numpy as np
import xarray as xr

from undula.analysis.observables.trajectory import Motion
from undula.analysis.runs.run import Run
from undula.models.description import describe_model
from undula.models.units import FILAMENT_UNITS, Units
from undula.schema.formats import RUN_FORMAT

# Unit of time in files of filaments, kept from the first format on.
_TIME = {FILAMENT_UNITS.time: "L^4 zeta_perp / B"}
_LIBRARIES = ("undula", "numpy", "numba")


def dataset_of(
    run: Run, *, inputs: Mapping[str, Any] | None = None, load: str | None = None
) -> xr.Dataset:
    """Return a run as a dataset with the dimensions time, node and axis.

    Parameters
    ----------
    run : Run
        Result of a run.
    inputs : mapping, optional
        The complete input of the run; by default the fields of its model and schedule.
    load : str, optional
        Model and load in words, for figures; by default a description of the model.

    Returns
    -------
    xarray.Dataset
        Variables and attributes of docs/output.md. A close-up of the last periods has a dimension
        of its own, close_time.

    Examples
    --------
    >>> import undula as un
    >>> model = un.Filament(4, load=un.TipLoad(0.0))
    >>> run = un.integrate(model, un.planar(model, 0.1), until=0.001, samples=3)
    >>> un.dataset_of(run)["nodes"].dims
    ('time', 'node', 'axis')
    """
    units = run.model.units
    variables = _variables(run.motion, units, "")
    if run.close_up is not None:
        variables |= _variables(run.close_up, units, "close_")
    links = run.motion.nodes.shape[1] - 1
    complete = inputs or {"model": _fields(run.model), "time": _fields(run.schedule)}
    summary = run.summary() | {"load": load or describe_model(run.model)}
    return xr.Dataset(
        variables,
        coords={
            "arclength": ("node", np.linspace(0.0, 1.0, links + 1), {"units": "L"}),
            "axis": ("axis", np.array(["x", "y", "z"])),
        },
        attrs={
            "input": json.dumps(complete),
            "seed": int(complete.get("start", {}).get("seed", -1)),
            "versions": json.dumps(
                {"python": platform.python_version()} | {name: version(name) for name in _LIBRARIES}
            ),
            "verdict": run.verdict.name,
            "health": json.dumps(asdict(run.health)),
            "summary": json.dumps(summary),
            "undula_format": RUN_FORMAT,
        },
    )


def _variables(motion: Motion, units: Units, prefix: str) -> dict[str, Any]:
    time = f"{prefix}time"
    energetics = motion.energetics

    def series(values: Any, unit: str, meaning: str) -> Any:
        return (time, np.asarray(values), {"units": unit, "long_name": meaning})

    return {
        time: series(motion.time, _TIME.get(units.time, units.time), "time"),
        f"{prefix}nodes": (
            (time, "node", "axis"),
            motion.nodes,
            {"units": "L", "long_name": "position of the nodes"},
        ),
        f"{prefix}rotation_angle": series(motion.rotation_angle, "rad", "angle turned about z"),
        f"{prefix}bending_energy": series(
            energetics.bending_energy, units.energy, "bending energy"
        ),
        f"{prefix}stretching_energy": series(
            energetics.stretching_energy, units.energy, "stretching energy"
        ),
        f"{prefix}active_power": series(
            energetics.active_power, units.power, "power put in by the load"
        ),
        f"{prefix}dissipation": series(
            energetics.dissipation, units.power, "power dissipated by drag"
        ),
        f"{prefix}work": series(motion.work, units.energy, "energy put in since the start"),
        f"{prefix}loss": series(motion.loss, units.energy, "energy dissipated since the start"),
    }


def _fields(record: Any) -> Any:
    """Return a frozen record in plain JSON types, with the name of its type."""
    if not is_dataclass(record) or isinstance(record, type):
        return str(record)
    return {"kind": type(record).__name__} | asdict(record)
