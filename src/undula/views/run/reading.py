"""Scenes of stored runs: checks, and the time scales on which the motion can be drawn."""

import json
from collections.abc import Mapping

import numpy as np
import xarray as xr

from undula.analysis.runs.dataset import dataset_of
from undula.analysis.runs.run import Run
from undula.errors import InputError
from undula.views.common import style
from undula.views.run.scene import Floats, Scene, turning_points

#: Variables of a stored run that figures need.
NEEDED = ("nodes", "bending_energy", "active_power", "dissipation", "rotation_angle")
_CLOSE = "close_"


def run_dataset(run: xr.Dataset | Run) -> xr.Dataset:
    """Return a run as a dataset, stored or as `undula.integrate` returns it.

    Raises
    ------
    InputError
        It is no run.
    """
    if isinstance(run, Run):
        return dataset_of(run)
    if not isinstance(run, xr.Dataset):
        raise InputError(
            f"{type(run).__name__} is no run; give what undula.integrate or undula.load returns"
        )
    return run


def read_scene(run: xr.Dataset) -> Scene:
    """Return the scene of a run.

    Parameters
    ----------
    run : xarray.Dataset
        A run with dims time, node and axis, the variables in `NEEDED` and the attribute "summary".
        Variables such as "close_nodes" with the dim close_time show its last part at finer
        intervals.

    Returns
    -------
    Scene
        The checked run.

    Raises
    ------
    InputError
        A variable or the summary is missing, or the run has fewer than two samples.
    """
    missing = [name for name in NEEDED if name not in run]
    if missing or "summary" not in run.attrs:
        raise InputError(
            f"the run lacks {', '.join(missing) or 'its summary'}: give a result of `undula run`"
        )
    summary: Mapping[str, object] = json.loads(run.attrs["summary"])
    times = _floats(run["time"])
    if len(times) < 2:
        raise InputError(f"the run has {len(times)} sample(s), a view needs at least 2: run longer")
    duration = float(times[-1] - times[0])
    return _scene(run, "", summary, duration, _close_up(run, summary, duration))


def units_of(summary: Mapping[str, object]) -> style.UnitNames:
    """Return the names of a run's units; those of a filament if the summary has none."""
    named = summary.get("units")
    return named if isinstance(named, Mapping) else style.FILAMENT


def _close_up(run: xr.Dataset, summary: Mapping[str, object], duration: float) -> Scene | None:
    """Return the close-up of a run; None without one, and for a run that ends at rest."""
    stored = run.sizes.get(f"{_CLOSE}time", 0) >= 2
    if not stored or str(summary.get("verdict", "")).startswith("straight"):
        return None
    return _scene(run, _CLOSE, summary, duration, None)


def _scene(
    run: xr.Dataset,
    prefix: str,
    summary: Mapping[str, object],
    duration: float,
    close: Scene | None,
) -> Scene:
    """Return the scene of the variables with a prefix, of a run of total length `duration` [T]."""
    times = _floats(run[f"{prefix}time"])
    nodes = _floats(run[f"{prefix}nodes"].transpose(f"{prefix}time", "node", "axis"))
    verdict, frequency = str(summary.get("verdict", "")), _rate(summary.get("frequency"))
    turn = _smoothing_turn(nodes[:, -1], _floats(run[f"{prefix}rotation_angle"]))
    period = _period(verdict, frequency, duration)
    cycle = _cycle(nodes[:, -1], turn, times, period, _rate(summary.get("shape_frequency")))
    return Scene(
        times,
        nodes,
        turn,
        _floats(run[f"{prefix}bending_energy"]),
        _floats(run[f"{prefix}active_power"]),
        _floats(run[f"{prefix}dissipation"]),
        units=units_of(summary),
        load=str(summary.get("load", "")),
        verdict=verdict,
        frequency=frequency,
        period=period,
        cycle=cycle,
        settled_from=_number(summary.get("settled_from")),
        close=close,
    )


def _floats(values: xr.DataArray) -> Floats:
    return np.asarray(values.values, dtype=np.float64)


def _number(value: object) -> float | None:
    return float(value) if isinstance(value, int | float) and np.isfinite(value) else None


def _rate(value: object) -> float | None:
    """Return a rate without its sign, None for zero and for a value that is not a number."""
    number = _number(value)
    return abs(number) if number else None


def _period(verdict: str, frequency: float | None, duration: float) -> float | None:
    """Return the period of a lasting motion; a decaying one has a rate but does not recur."""
    if frequency is None or verdict.startswith("straight") or frequency * duration < 1:
        return None
    return 1 / frequency


def _smoothing_turn(tip: Floats, angle: Floats) -> Floats:
    """Return the angle of the frame in which the motion changes least between samples."""
    plane = tip[:, 0] + 1j * tip[:, 1]
    if len(tip) < 4 or not np.all(np.isfinite(angle)):
        return np.zeros(len(tip))
    laboratory = np.abs(np.diff(plane, 2)).mean()
    turned = np.abs(np.diff(plane * np.exp(-1j * angle), 2)).mean()
    # The allowance prefers the stored angle where one sample per turn hides the rotation.
    return angle if turned <= laboratory + 1e-6 else np.zeros(len(tip))


def _cycle(
    tip: Floats, turn: Floats, times: Floats, period: float | None, shape_rate: float | None
) -> float | None:
    """Return the time of one swing in the frame of `turn`, from the summary or by counting."""
    turns = abs(turn[-1] - turn[0]) > 1
    if period is not None:
        rate = shape_rate if turns else 1 / period
        return 1 / rate if rate else None
    plane = (tip[:, 0] + 1j * tip[:, 1]) * np.exp(-1j * turn)
    swings = max(turning_points(plane.real), turning_points(plane.imag)) / 2
    return float(times[-1] - times[0]) / swings if swings else None
