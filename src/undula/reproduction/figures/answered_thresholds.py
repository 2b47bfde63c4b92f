"""Thresholds along a parameter, from answers of `undula threshold`."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from undula.arrays import Array
from undula.errors import InputError
from undula.reproduction.figures.same_units import same_units
from undula.views.linear.threshold_curves import threshold_curves

_NAMES = {
    "onset": "straight lost",
    "spinning-lost": "spinning lost",
    "flapping-gained": "flapping gained",
    "flapping-lost": "flapping lost",
}


def threshold_lines(*answers: Mapping[str, Any]) -> Figure:
    """Draw several thresholds along one parameter, each with its error.

    Parameters
    ----------
    *answers : mapping
        Of `undula threshold NAME --along`, at least one.

    Returns
    -------
    matplotlib.figure.Figure
        As `threshold_curves` draws it.

    Raises
    ------
    InputError
        There is no answer, one is not along a parameter, or they differ in parameter or units.
    """
    parameters = [answer.get("parameter") for answer in answers]
    if len(set(parameters)) != 1 or parameters[0] is None:
        given = ", ".join(map(str, parameters)) or "nothing"
        raise InputError(
            f"the thresholds are along {given}; give answers of `undula threshold --along` with one"
            " parameter"
        )
    units = same_units(*(answer["units"] for answer in answers))
    curves = [_curve(answer, parameters[0]) for answer in answers]
    return threshold_curves(curves, parameter=parameters[0], title="", units=units)


def _curve(answer: Mapping[str, Any], parameter: str) -> tuple[str, Array, Array, Array]:
    rows = answer["thresholds"]
    values, forces, errors = (
        np.array([np.nan if row.get(key) is None else float(row[key]) for row in rows])
        for key in (parameter, "value", "error")
    )
    return _NAMES.get(answer["threshold"], answer["threshold"]), values, forces, errors
