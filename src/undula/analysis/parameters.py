"""Parameters of a model by name, such as "load.slope" or "model.drag_ratio"."""

import dataclasses
from typing import Any

from undula.errors import InputError, is_number
from undula.models.model import Model

#: The parameter that most questions are about.
FORCE = "load.force"
#: Components of pairs of numbers, with the field and the index of each.
_COMPONENTS = {
    f"model.natural_curvature.{name}": ("natural_curvature", index)
    for index, name in enumerate(("k1", "k2"))
}


def changed(model: Model, parameter: str, value: float) -> Model:
    """Return the model with another value of a parameter.

    Parameters
    ----------
    model : Model
    parameter : str
        "load." and a number of its load, or "model." and one of its own.
    value : float

    Raises
    ------
    InputError
        There is no such parameter, or the value is out of its range.
    """
    place, _, name = parameter.partition(".")
    if parameter in _COMPONENTS and parameter in _numbers(model):
        return _with_component(model, *_COMPONENTS[parameter], value)
    owner: Any = model.load if place == "load" else model if place == "model" else None
    field = getattr(owner, "__dataclass_fields__", {}).get(name)
    if field is None or not field.init or not is_number(getattr(owner, name)):
        known = " or ".join(_numbers(model))
        raise InputError(f"{parameter} is no number of this model; take {known}")
    if field.type not in (int, "int"):
        return model.with_(**{name: float(value)})
    if value != round(value):
        raise InputError(f"{parameter} = {value!r} has to be a whole number")
    return model.with_(**{name: int(value)})


def value_of(model: Model, parameter: str) -> float:
    """Return the value of a parameter that a state can be followed along.

    Raises
    ------
    InputError
        There is no such parameter, or it is a whole number, which has nothing in between.
    """
    known = [name for name, kind in _numbers(model).items() if kind not in (int, "int")]
    if parameter not in known:
        raise InputError(f"nothing can be followed along {parameter}; take {' or '.join(known)}")
    if parameter in _COMPONENTS:
        name, index = _COMPONENTS[parameter]
        return float(getattr(model, name)[index])
    place, name = parameter.split(".")
    return float(getattr(model.load if place == "load" else model, name))


def neighbours(model: Model, parameter: str, value: float) -> tuple[Model, Model, float]:
    """Return the models a little below and above a value, and the difference of their values.

    They serve to differentiate by the parameter; at an end of its range one of them lies on it.
    """
    # A hundred-thousandth: differences of smooth functions are then good to ten digits.
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
    """Return the declared types of a model's numbers and of its load's, by name."""
    numbers = {
        f"{place}.{field.name}": field.type
        for place, owner in (("load", model.load), ("model", model))
        for field in dataclasses.fields(owner)
        if field.init and is_number(getattr(owner, field.name))
    }
    pairs = {
        parameter: float
        for parameter, (name, _) in _COMPONENTS.items()
        if isinstance(getattr(model, name, None), tuple)
    }
    return numbers | pairs


def _with_component(model: Any, name: str, index: int, value: float) -> Model:
    pair = list(getattr(model, name))
    pair[index] = float(value)
    return model.with_(**{name: tuple(pair)})  # type: ignore[no-any-return]
