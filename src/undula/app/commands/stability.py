"""`undula stability`: stability of the straight state, in plain JSON types and drawn.

Plotting is imported only for a figure, since the answer itself takes milliseconds.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from undula.analysis.linear.curves import CriticalCurve, GrowthCurve
from undula.analysis.linear.results import Onset, Spectrum
from undula.analysis.linear.spectrum import spectrum
from undula.analysis.linear.stability import critical_curve, growth_curve, onset
from undula.analysis.parameters import changed
from undula.app.commands import stability_text as text
from undula.inputs.build import build_model
from undula.inputs.input import StabilityInput
from undula.models.model import Model
from undula.models.units import Units
from undula.terminal.output import Answer
from undula.terminal.physical import with_physical
from undula.terminal.progress import counted
from undula.terminal.units_text import force_in

Values = tuple[float, ...]

#: Number of forces in the figure of a single case, and its last force over the largest of
#: threshold, given force and 1.
_SHOWN, _BEYOND = 241, 1.3


@dataclass(frozen=True)
class StabilityRequest:
    """A stability analysis of the straight state.

    Attributes
    ----------
    wanted : StabilityInput
        Model and method.
    forces : tuple of float or None
        Forces at which the leading eigenvalue is computed.
    along : (str, tuple of float) or None
        A parameter and its values.
    """

    wanted: StabilityInput
    forces: Values | None
    along: tuple[str, Values] | None


def analyse(request: StabilityRequest) -> tuple[Answer, Callable[[], Any]]:
    """Return the answer of a stability analysis, and a function that draws its figure.

    Raises
    ------
    InputError
        A value is out of its range.
    """
    if request.forces is not None:
        analysed, draw = _growth(request, request.forces)
    elif request.along is not None:
        analysed, draw = _thresholds_along(request, *request.along)
    else:
        analysed, draw = _onset(request)
    answer = {"status": "done", "load": _title(request)} | analysed.answer
    return Answer(with_physical(answer, "stability", request.wanted.scales), analysed.text), draw


def _onset(request: StabilityRequest) -> tuple[Answer, Callable[[], Any]]:
    model, options = _model(request)
    straight_onset, at_force = onset(model, **options), spectrum(model, **options)
    title, units = _title(request), model.units

    def draw() -> Any:
        from undula.views import stability_portrait

        far = _BEYOND * max(straight_onset.force or 0.0, at_force.force, 1.0)
        growth = growth_curve(model, np.linspace(0.0, far, _SHOWN), **options)
        return stability_portrait(
            straight_onset,
            growth,
            at_force,
            title=title,
            units=units.names(),
            scales=request.wanted.scales,
        )

    answer = onset_answer(straight_onset, at_force, units)
    scales = request.wanted.scales
    return Answer(answer, text.onset_text(title, straight_onset, at_force, units, scales)), draw


def _growth(request: StabilityRequest, forces: Values) -> tuple[Answer, Callable[[], Any]]:
    model, options = _model(request)
    name, values = request.along or (None, None)
    with counted("growth rates") as progress:
        growth = growth_curve(
            model, forces, parameter=name, values=values, progress=progress, **options
        )
    title, units = _title(request), model.units

    def draw() -> Any:
        from undula.views import growth_figure

        scales = request.wanted.scales
        return growth_figure(growth, title=title, units=units.names(), scales=scales)

    lines = text.growth_text(title, growth, units, request.wanted.scales)
    return Answer(growth_answer(growth, units), lines), draw


def _thresholds_along(
    request: StabilityRequest, name: str, values: Values
) -> tuple[Answer, Callable[[], Any]]:
    model, options = _model(request)
    with counted("thresholds") as progress:
        curve = critical_curve(model, name, values, progress=progress, **options)
    title = _title(request)
    # The further units of a chain depend on its number of links.
    units = [changed(model, name, value).units for value in values]

    def draw() -> Any:
        from undula.views import threshold_figure

        names, scales = model.units.names(), request.wanted.scales
        return threshold_figure(curve, title=title, units=names, scales=scales)

    lines = text.thresholds_text(title, curve, units, request.wanted.scales)
    return Answer(thresholds_answer(curve, units), lines), draw


def onset_answer(onset: Onset, at_force: Spectrum, units: Units) -> dict[str, Any]:
    """Return an onset, with the spectrum at the given force, in plain JSON types."""
    later = [
        {
            "force": crossing.force,
            **force_in(units, crossing.force),
            "frequency": crossing.frequency,
            "growth_slope": crossing.growth_slope,
            "error": crossing.error,
            "frequency_error": crossing.frequency_error,
        }
        for crossing in onset.later
    ]
    leading = zip(at_force.rates, at_force.frequencies, at_force.errors, strict=True)
    return {
        "units": units.names(),
        "method": onset.method,
        "paper_time": onset.paper_time,
        **_thresholds(onset, units),
        "later": later,
        "force": at_force.force,
        **force_in(units, at_force.force),
        "spectrum": [
            {"rate": float(rate), "frequency": float(frequency), "error": float(error)}
            for rate, frequency, error in leading
        ],
    }


def growth_answer(growth: GrowthCurve, units: Units) -> dict[str, Any]:
    """Return leading rates and frequencies, one entry for each force (and value)."""
    points = []
    for place in np.ndindex(growth.rates.shape):
        of_parameter = {}
        if growth.parameter is not None and growth.values is not None:
            of_parameter = {growth.parameter: float(growth.values[place[0]])}
        point = {
            "force": float(growth.forces[place[-1]]),
            "rate": float(growth.rates[place]),
            "frequency": float(growth.frequencies[place]),
            "error": float(growth.errors[place]),
        }
        points.append(of_parameter | point)
    return {
        "units": units.names(),
        "method": growth.method,
        "paper_time": growth.paper_time,
        "points": points,
    }


def thresholds_answer(curve: CriticalCurve, units: Sequence[Units]) -> dict[str, Any]:
    """Return the thresholds along a parameter, one entry for each value."""
    return {
        "units": units[0].names(),
        "method": curve.method,
        "paper_time": curve.onsets[0].paper_time,
        "parameter": curve.parameter,
        "thresholds": [
            {curve.parameter: float(value)} | _thresholds(onset, own_units)
            for value, onset, own_units in zip(curve.values, curve.onsets, units, strict=True)
        ],
    }


def _thresholds(onset: Onset, units: Units) -> dict[str, Any]:
    hopf = onset.hopf
    return {
        "oscillatory_force": onset.oscillatory_force,
        **force_in(units, onset.oscillatory_force, "oscillatory_"),
        "oscillatory_error": onset.oscillatory_error,
        "hopf_force": onset.force,
        **force_in(units, onset.force, "hopf_"),
        "hopf_frequency": hopf.frequency if hopf else None,
        "hopf_growth_slope": hopf.growth_slope if hopf else None,
        "error": hopf.error if hopf else None,
        "frequency_error": hopf.frequency_error if hopf else None,
        "searched_to": onset.searched_to,
        "reason": None if hopf else str(onset),
    }


def _model(request: StabilityRequest) -> tuple[Model, dict[str, Any]]:
    table = request.wanted.stability
    return build_model(request.wanted), {"method": table.method, "paper_time": table.paper_time}


def _title(request: StabilityRequest) -> str:
    """Return the load in words, without the parameters that the answer varies."""
    along = [request.along[0]] if request.along else []
    varied = ["load.force", *along] if request.forces or along else []
    return request.wanted.describe(varied)
