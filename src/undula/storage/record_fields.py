"""Fields of records in plain JSON types, with their arrays apart, and records made of them again.

An object is a list of its kind and its content, so that no value of a user is taken for one. Only
named classes are made: a file cannot choose what is called.
"""

from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from importlib import import_module
from types import MappingProxyType
from typing import Any

import numpy as np

from undula.errors import InputError

#: Classes that a file may hold, by their modules.
_MODULES: Mapping[str, tuple[str, ...]] = {
    "undula.models.filament": ("Filament",),
    "undula.models.chain": ("Chain",),
    "undula.models.natural_curvature": ("CurvatureTable",),
    "undula.models.loads.analytic": ("LinearLoad", "PointLoad", "TipLoad"),
    "undula.models.loads.beads": ("BeadLoad",),
    "undula.models.loads.power": ("PowerLoad",),
    "undula.models.loads.user_density": ("TableLoad",),
    "undula.analysis.observables.shapes": ("Range",),
    "undula.analysis.states.records": ("Spinning", "Flapping", "Equilibrium"),
    "undula.analysis.states.periodic_record": ("Periodic",),
    "undula.analysis.states.not_found": ("NotFound", "SearchStatus"),
    "undula.analysis.states.branch": ("Branch", "Bifurcation"),
    "undula.analysis.states.extrapolation": ("Converged",),
    "undula.analysis.linear.results": ("Onset", "Crossing", "Spectrum"),
    "undula.analysis.linear.curves": ("GrowthCurve", "CriticalCurve"),
    "undula.analysis.solvers.inverse.solutions": ("Solution", "Solutions"),
    "undula.analysis.solvers.threshold_record": ("Threshold", "ThresholdCurve"),
    "undula.analysis.solvers.threshold_search": ("Missed",),
    "undula.analysis.sensitivity.sensitivities": ("Sensitivities",),
    "undula.analysis.regimes.lyapunov": ("Lyapunov",),
}
#: Module of each class.
CLASSES: Mapping[str, str] = {name: module for module, names in _MODULES.items() for name in names}


def encoded(value: Any, arrays: list[Any]) -> Any:
    """Return a value in plain JSON types; its arrays are appended to a list.

    Raises
    ------
    InputError
        A part is neither data nor of a class that a file may hold.
    """
    if value is None or isinstance(value, bool | str):
        return value
    if isinstance(value, int | float | np.integer | np.floating | np.bool_):
        return value.item() if isinstance(value, np.generic) else value
    if isinstance(value, complex | np.complexfloating):
        return ["complex", value.real, value.imag]
    if isinstance(value, np.ndarray):
        arrays.append(value)
        return ["array", len(arrays) - 1]
    if isinstance(value, Enum) and type(value).__name__ in CLASSES:
        return ["member", type(value).__name__, value.name]
    if isinstance(value, tuple | list):
        return ["tuple", *(encoded(part, arrays) for part in value)]
    name = type(value).__name__
    if is_dataclass(value) and CLASSES.get(name) == type(value).__module__:
        own = [(f.name, getattr(value, f.name)) for f in fields(value) if f.init]
        return ["record", name, {key: encoded(part, arrays) for key, part in own}]
    if isinstance(value, Mapping):
        return ["mapping", {str(key): encoded(part, arrays) for key, part in value.items()}]
    raise InputError(
        f"a {name} cannot be stored in a file; give the model a table in place of a function, such"
        " as TableLoad or CurvatureTable"
    )


def decoded(value: Any, array: Callable[[int], Any]) -> Any:
    """Return the value of plain JSON types, with its arrays by their numbers.

    Raises
    ------
    KeyError, TypeError, ValueError
        The value was not made by `encoded`, or by another version.
    """
    if not isinstance(value, list):
        return value
    kind, *content = value
    if kind == "complex":
        return complex(*content)
    if kind == "array":
        return array(content[0])
    if kind == "tuple":
        return tuple(decoded(part, array) for part in content)
    if kind == "mapping":
        parts = {key: decoded(part, array) for key, part in content[0].items()}
        return MappingProxyType(parts)
    if kind == "member":
        return _class(content[0])[content[1]]
    if kind == "record":
        own = {key: decoded(part, array) for key, part in content[1].items()}
        return _class(content[0])(**own)
    raise ValueError(f"{kind!r} is no kind of field")


def _class(name: str) -> Any:
    return getattr(import_module(CLASSES[name]), name)
