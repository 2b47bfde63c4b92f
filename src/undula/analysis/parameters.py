"""Parameters of a model by name, such as "load.slope" or "model.drag_ratio"."""

import dataclasses
from typing import Any

from undula.errors import InputError, is_number
from undula.models.model import Model


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
    known = _numbers(model)
    if parameter not in known:
        raise InputError(f"{parameter} is no number of this model; take {' or '.join(known)}")
    if not isinstance(known[parameter], int):
        return model.with_(**{parameter.split(".")[1]: float(value)})
    if value != round(value):
        raise InputError(f"{parameter} = {value!r} has to be a whole number")
    return model.with_(**{parameter.split(".")[1]: int(value)})


def _numbers(model: Any) -> dict[str, float]:
    """Return the numbers of a model and of its load by name."""
    return {
        f"{place}.{field.name}": getattr(owner, field.name)
        for place, owner in (("load", model.load), ("model", model))
        for field in dataclasses.fields(owner)
        if field.init and is_number(getattr(owner, field.name))
    }
