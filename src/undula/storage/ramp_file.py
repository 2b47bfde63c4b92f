"""Result files of quasi-static ramps, which are drawn and continued."""

import json
import platform
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import Field, dataclass, fields
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from undula.analysis.observables.shapes import Range
from undula.analysis.ramps.ramp import Ramp, Step
from undula.errors import InputError
from undula.models.model import Model
from undula.models.scales import Scales
from undula.storage.differences import difference
from undula.storage.physical_attributes import coordinate_attributes, with_physical_attributes
from undula.storage.result_kinds import Kind
from undula.storage.run_file import read_result, write_result

STEPS = Kind("steps 1", "undula step")

_LIBRARIES = ("undula", "numpy", "numba")
_ATTRIBUTES = ("input", "options", "versions", "parameter")
_BOUNDS = tuple(field.name for field in fields(Range))
_SHAPED = {
    "nodes": ("step", "node", "axis"),
    "shape_times": ("step", "shape"),
    "shapes": ("step", "shape", "node", "axis"),
}
_QUANTITIES = {
    "frequency": "frequency",
    "rotation_frequency": "frequency",
    "shape_frequency": "frequency",
    "bending_energy": "energy",
    "tip_radius": "length",
    "tip_height": "length",
    "time": "time",
    "nodes": "length",
    "shape_times": "time",
    "shapes": "length",
}


@dataclass(frozen=True)
class Series:
    """A ramp with its input.

    Attributes
    ----------
    input
        The complete input in plain JSON types.
    load
        Model and load in a few words, without the varied parameter.
    model
        The model that the input describes.
    ramp
        The values of the parameter in order, with kick and seed.
    scales
        SI values of the dimensionless units, None without ``[units]`` in the input.
    """

    input: Mapping[str, Any]
    load: str
    model: Model
    ramp: Ramp
    scales: Scales | None = None


def write_ramp(path: Path, series: Series, steps: Sequence[Step]) -> None:
    """Write the steps of a ramp so far in place of an earlier file, whole or not at all.

    Parameters
    ----------
    path
        The file; missing folders are made.
    series
        The ramp with its input.
    steps
        The steps so far, at least one.

    Raises
    ------
    InputError
        The folder cannot be written or is full. An earlier file then stays as it is.
    """
    write_result(path, dataset_of_steps(series, steps), STEPS, overwrite=True)


def load_ramp(path: Path | str) -> xr.Dataset:
    """Read a stored quasi-static ramp.

    Parameters
    ----------
    path
        A file written by ``undula step``.

    Returns
    -------
    xarray.Dataset
        The steps over the dims step, shape, node and axis, in memory; docs/output.md lists its
        variables.

    Raises
    ------
    InputError
        The file is missing, unreadable, cut short or not written by ``undula step``; or other
        software has stored it without some of its variables.

    Warns
    -----
    StoredWarning
        The file carries no checksum, as one that other software has stored.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> import undula as un
    >>> from undula.analysis.ramps.ramp import Ramp, ramp_steps
    >>> from undula.analysis.run_settings import Schedule
    >>> from undula.storage.ramp_file import Series, write_ramp
    >>> model, values = un.Filament(4, un.TipLoad(1.0)), Ramp("load.force", (1.0, 2.0))
    >>> steps = list(ramp_steps(model, values, un.straight(model), Schedule(until=0.1, samples=20)))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "steps.nc"
    ...     write_ramp(file, Series({}, "tip force", model, values), steps)
    ...     stored = un.load(file)
    >>> stored["value"].values
    array([1., 2.])
    """
    stored = read_result(Path(path), STEPS)
    missing = [name for name in _variables() if name not in stored]
    missing += [name for name in _ATTRIBUTES if name not in stored.attrs]
    if missing:
        raise InputError(
            f"{path} lacks {', '.join(missing)}; give a file as {STEPS.command} wrote it"
        )
    return stored


def dataset_of_steps(series: Series, steps: Sequence[Step]) -> xr.Dataset:
    """Return the steps of a ramp as a dataset over the dims step, shape, node and axis.

    Parameters
    ----------
    series
        The ramp with its input.
    steps
        The steps so far, at least one.
    """
    units = series.model.units.names()
    variables: dict[str, Any] = {}
    for field in fields(Step):
        for name, values in _columns(field, steps):
            attributes = (
                {"units": units[_QUANTITIES[field.name]]} if field.name in _QUANTITIES else {}
            )
            variables[name] = (_SHAPED.get(name, "step"), values, attributes)
    links = steps[0].nodes.shape[0] - 1
    coordinates = {
        "arclength": ("node", np.linspace(0.0, 1.0, links + 1), {"units": "L"}),
        "axis": ("axis", np.array(["x", "y", "z"])),
    }
    dataset = xr.Dataset(variables, coords=coordinates, attrs=_attributes(series))
    in_parameter = coordinate_attributes(series.scales, series.ramp.parameter, units)
    dataset["value"].attrs.update(in_parameter)
    return with_physical_attributes(dataset, series.scales, units)


def stored_steps(stored: xr.Dataset) -> list[Step]:
    """Return the steps in a stored ramp, bit for bit as they were written."""
    count = stored.sizes["step"]
    columns = {field.name: _read_column(field, stored) for field in fields(Step)}
    return [Step(**{name: column[k] for name, column in columns.items()}) for k in range(count)]


def refuse_another_series(path: Path, stored: xr.Dataset, series: Series) -> None:
    """Refuse to continue the steps of another ramp.

    Parameters
    ----------
    path
        The file, for the sentence.
    stored
        Its content.
    series
        The wanted ramp.

    Raises
    ------
    InputError
        The input, an option or the version differs; the sentence names the first difference.
    """
    present, wanted = stored.attrs, _attributes(series)
    writer, reader = (
        json.loads(attributes["versions"])["undula"] for attributes in (present, wanted)
    )
    if writer != reader:
        raise InputError(
            f"{path} was written by undula {writer} and cannot be gone on with by undula {reader};"
            " go on with that version, or start afresh with --overwrite"
        )
    for name in ("input", "options"):
        differs = difference(json.loads(present[name]), json.loads(wanted[name]))
        if differs is not None:
            raise InputError(
                f"{path} holds steps of another series, with {differs}; give another --out, or"
                " start afresh with --overwrite"
            )


def _attributes(series: Series) -> dict[str, str]:
    versions = {name: version(name) for name in _LIBRARIES}
    versions = {"python": platform.python_version()} | versions
    return {
        "input": json.dumps(series.input),
        "options": json.dumps(_options(series.ramp)),
        "versions": json.dumps(versions),
        "parameter": series.ramp.parameter,
        "load": series.load,
        "units": json.dumps(series.model.units.names()),
        "undula_format": STEPS.format,
    }


def _options(ramp: Ramp) -> dict[str, Any]:
    """Return the values of a ramp in plain JSON types, under the names of the options."""
    first, last, count = ramp.values[0], ramp.values[-1], len(ramp.values)
    # Without the single values, since an attribute has to be short.
    along = f"{ramp.parameter} from {first!r} to {last!r}, {count} values"
    return {"along": along, "down": ramp.back, "kick": ramp.kick, "seed": ramp.seed}


def _columns(field: Field[Any], steps: Sequence[Step]) -> Iterator[tuple[str, Any]]:
    """Yield the variables that hold a field of all steps: three for a range, or one."""
    column = [getattr(step, field.name) for step in steps]
    if field.type is Range:
        for bound in _BOUNDS:
            yield f"{field.name}_{bound}", np.array([getattr(values, bound) for values in column])
    else:
        yield field.name, np.array(column)


def _variables() -> Iterator[str]:
    """Yield the names of all variables."""
    for field in fields(Step):
        bounds = _BOUNDS if field.type is Range else ()
        yield from (f"{field.name}_{bound}" for bound in bounds) if bounds else (field.name,)


def _read_column(field: Field[Any], stored: xr.Dataset) -> Sequence[Any]:
    if field.type is Range:
        bounds = (stored[f"{field.name}_{bound}"].values.tolist() for bound in _BOUNDS)
        return [Range(*values) for values in zip(*bounds, strict=True)]
    values = stored[field.name].values
    return list(values) if field.name in _SHAPED else list(values.tolist())
