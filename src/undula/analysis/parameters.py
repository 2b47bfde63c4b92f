"""Parameters of a model by name, such as "load.slope", "model.drag_ratio" or "load.density[2]"."""

import dataclasses
import re
from typing import Any

from undula.errors import InputError, is_number
from undula.models.model import Model

#: Name of the total follower force, the default parameter of most questions.
FORCE = "load.force"
#: Parameters that are one component of a pair of numbers: field and index by name.
_COMPONENTS = {
    f"model.natural_curvature.{name}": ("natural_curvature", index)
    for index, name in enumerate(("k1", "k2"))
}
#: Tables whose values are parameters, by the prefix of their names: field and field of the table.
_TABLES = {
    "load.density": ("density", None),
    "model.natural_curvature.k1": ("natural_curvature", "k1"),
    "model.natural_curvature.k2": ("natural_curvature", "k2"),
}
_ENTRY = re.compile(r"(?P<table>[a-z_0-9.]+)\[(?P<index>\d+)\]")


def changed(model: Model, parameter: str, value: float) -> Model:
    """Return the model with another value of a parameter.

    Parameters
    ----------
    model : Model
        Model of the filament or chain.
    parameter : str
        "load." and a number of the load, or "model." and a number of the model; a value of a table
        has its place, counted from 0, in brackets.
    value : float
        New value, in the unit of the parameter; a whole number where the parameter is one.

    Returns
    -------
    Model
        A copy with the new value.

    Raises
    ------
    InputError
        The model has no such parameter, or the value is out of its range.
    """
    owner_name, _, name = parameter.partition(".")
    if parameter in _COMPONENTS and parameter in _numbers(model):
        return _with_component(model, *_COMPONENTS[parameter], value)
    if parameter in table_entries(model):
        return _with_entry(model, parameter, value)
    owner: Any = {"load": model.load, "model": model}.get(owner_name)
    field = getattr(owner, "__dataclass_fields__", {}).get(name)
    if field is None or not field.init or not is_number(getattr(owner, name)):
        names = " or ".join(_numbers(model))
        raise InputError(f"{parameter} is no number of this model; take {names}")
    if field.type not in (int, "int"):
        return model.with_(**{name: float(value)})
    if value != round(value):
        raise InputError(f"{parameter} = {value!r} has to be a whole number")
    return model.with_(**{name: int(value)})


def value_of(model: Model, parameter: str) -> float:
    """Return the value of a continuous parameter, along which a branch can be followed.

    Parameters
    ----------
    model : Model
        Model of the filament or chain.
    parameter : str
        Name as in `changed`.

    Returns
    -------
    float
        The value, in the unit of the parameter.

    Raises
    ------
    InputError
        The model has no such parameter, or it is a whole number.
    """
    entries = table_entries(model)
    if parameter in entries:
        return entries[parameter]
    names = continuous_parameters(model)
    if parameter not in names:
        raise InputError(f"nothing can be followed along {parameter}; take {' or '.join(names)}")
    if parameter in _COMPONENTS:
        name, index = _COMPONENTS[parameter]
        return float(getattr(model, name)[index])
    owner_name, name = parameter.split(".")
    return float(getattr(model.load if owner_name == "load" else model, name))


def continuous_parameters(model: Model) -> list[str]:
    """Return the names of the numbers of a model that are not whole, without values of tables."""
    return [name for name, kind in _numbers(model).items() if kind not in (int, "int")]


def table_entries(model: Model) -> dict[str, float]:
    """Return the values of the tables of a model by their names, such as "load.density[2]"."""
    entries: dict[str, float] = {}
    for prefix in _TABLES:
        values = _table_values(model, prefix)
        entries |= {f"{prefix}[{place}]": value for place, value in enumerate(values)}
    return entries


def neighbours(model: Model, parameter: str, value: float) -> tuple[Model, Model, float]:
    """Return the models just below and above a value, for a difference quotient.

    Parameters
    ----------
    model : Model
        Model of the filament or chain.
    parameter : str
        Name as in `changed`.
    value : float
        Value inside the range of the parameter; at an end of the range the difference is one-sided.

    Returns
    -------
    below, above : Model
    difference : float
        Difference of their values, about 2e-5 of the larger of 1 and the value.
    """
    # Central differences of smooth functions with this step are good to ten digits.
    step = 1e-5 * max(1.0, abs(value))
    sides = []
    for side in (value - step, value + step):
        try:
            sides.append((changed(model, parameter, side), side))
        except InputError:
            sides.append((changed(model, parameter, value), value))
    (below, low), (above, high) = sides
    return below, above, high - low


def _numbers(model: Any) -> dict[str, Any]:
    """Return the declared types of the numbers of a load and a model, by parameter name."""
    numbers = {
        f"{owner_name}.{field.name}": field.type
        for owner_name, owner in (("load", model.load), ("model", model))
        for field in dataclasses.fields(owner)
        if field.init and is_number(getattr(owner, field.name))
    }
    pairs = {
        parameter: float
        for parameter, (name, _) in _COMPONENTS.items()
        if isinstance(getattr(model, name, None), tuple)
    }
    return numbers | pairs


def _table_values(model: Any, prefix: str) -> tuple[float, ...]:
    """Return the values of a table, none if the model does not have it."""
    field, column = _TABLES[prefix]
    table = getattr(model.load if prefix.startswith("load.") else model, field, None)
    values = table if column is None else getattr(table, column, None)
    return values if isinstance(values, tuple) else ()


def _with_entry(model: Any, parameter: str, value: float) -> Model:
    match = _ENTRY.fullmatch(parameter)
    assert match is not None  # as the names of entries have an index
    prefix, place = match["table"], int(match["index"])
    field, column = _TABLES[prefix]
    values = list(_table_values(model, prefix))
    values[place] = float(value)
    if column is None:
        return model.with_(**{field: tuple(values)})  # type: ignore[no-any-return]
    table = dataclasses.replace(getattr(model, field), **{column: tuple(values)})
    return model.with_(**{field: table})  # type: ignore[no-any-return]


def _with_component(model: Any, name: str, index: int, value: float) -> Model:
    pair = list(getattr(model, name))
    pair[index] = float(value)
    return model.with_(**{name: tuple(pair)})  # type: ignore[no-any-return]
