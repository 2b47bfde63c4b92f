"""Keys of the input that the axes of a sweep vary: numbers, and components of a pair of numbers."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, get_args

from undula.errors import InputError
from undula.inputs.input import RunInput
from undula.inputs.messages import nearest

Tables = Mapping[str, Mapping[str, Any]]

# Components of a pair of numbers: table, key and index by their name.
_COMPONENTS = {
    f"model.natural_curvature.{name}": ("model", "natural_curvature", index)
    for index, name in enumerate(("k1", "k2"))
}


@dataclass(frozen=True)
class Axis:
    """A key of the input and the values that it takes.

    Attributes
    ----------
    key
        Table and name, such as ``load.force``, or the name of a component, such as
        ``model.natural_curvature.k1``.
    values
        The values in their order.
    """

    key: str
    values: tuple[int | float, ...]


def axis_of(key: str, values: Sequence[int | float]) -> Axis:
    """Return an axis with its values in the type of its key.

    Parameters
    ----------
    key
        The key.
    values
        The values in their order.

    Raises
    ------
    InputError
        A run has no such key.
    """
    types = {
        f"{table}.{name}": field.annotation
        for table, of in RunInput.model_fields.items()
        for name, field in getattr(of.annotation, "model_fields", {}).items()
    }
    types |= dict.fromkeys(_COMPONENTS, float)
    if key not in types:
        near = nearest(key, types)
        cure = f"did you mean {near}?" if near else "take one such as load.force"
        raise InputError(f"study.axes varies {key}, which is no key of a run; {cure}")
    if int in (types[key], *get_args(types[key])):
        whole = all(value == round(value) for value in values)
        return Axis(key, tuple(int(value) for value in values) if whole else tuple(values))
    return Axis(key, tuple(float(value) for value in values))


def set_value(tables: dict[str, dict[str, Any]], key: str, value: float) -> None:
    """Set the value of an axis in the tables of an input, which are changed in place.

    Parameters
    ----------
    tables
        Keys and values by table.
    key
        Key of the axis.
    value
        Its value.

    Raises
    ------
    InputError
        The key is a component, and the tables hold something else than a pair.
    """
    if key not in _COMPONENTS:
        table, name = key.split(".")
        tables[table][name] = value
        return
    table, name, index = _COMPONENTS[key]
    pair = tables[table].get(name, [0.0, 0.0])
    if not (isinstance(pair, list | tuple) and len(pair) == 2):
        raise InputError(
            f"study.axes varies {key}, and {table}.{name} is no pair of numbers; give two numbers,"
            " or leave out this axis"
        )
    tables[table][name] = [value if place == index else part for place, part in enumerate(pair)]


def unvaried(tables: Tables, axes: Sequence[Axis]) -> dict[str, dict[str, Any]]:
    """Return an input without the values that axes vary; varied components of a pair are 0.

    Parameters
    ----------
    tables
        Keys and values by table.
    axes
        The axes.
    """
    keys = {axis.key for axis in axes}
    rest = {
        name: {key: value for key, value in table.items() if f"{name}.{key}" not in keys}
        for name, table in tables.items()
    }
    for key in keys & _COMPONENTS.keys():
        if _COMPONENTS[key][1] in rest[_COMPONENTS[key][0]]:
            set_value(rest, key, 0.0)
    return rest
