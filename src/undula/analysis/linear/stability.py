"""Linear stability of the straight state: spectra and thresholds, also along a parameter.

Theory and sources: docs/theory/stability.md.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from undula.analysis.linear.checked_values import checked_forces, checked_values, models_along
from undula.analysis.linear.curves import CriticalCurve, GrowthCurve
from undula.analysis.linear.onset import find_onset
from undula.analysis.linear.pencils import linearised
from undula.analysis.linear.results import Crossing, Method, Onset
from undula.analysis.linear.spectrum import leading_eigenvalues, slowness_factor
from undula.arrays import Array
from undula.errors import InputError
from undula.models.model import Model

#: Callback with the number of points done and the number of all points.
Progress = Callable[[int, int], None]


def onset(
    model: Model, *, method: Method | None = None, later: int = 2, paper_time: bool = False
) -> Onset:
    """Return the loss of stability of the straight state as the force grows from 0.

    Parameters
    ----------
    model : Model
        Its force does not enter.
    method : {"spectral", "modes", "discrete"}, optional
        Discretisation: piecewise polynomials, the paper's assumed modes, or the links of the model.
        By default "spectral", or "discrete" for a model without a continuous limit.
    later : int
        Number of crossings to compute after the first, at least 0.
    paper_time : bool
        True for rates and frequencies of the paper's printed equation, which multiplies the time
        derivative by the drag ratio: they are smaller by that factor.

    Returns
    -------
    Onset
        Forces [B/L^2] and frequencies [cycles/T], each with its error.

    Raises
    ------
    InputError
        An argument is out of its range, or the model does not have the method.

    Examples
    --------
    >>> import undula as un
    >>> critical = un.onset(un.Filament(20, load=un.PointLoad(0.0)), later=0)
    >>> round(critical.force, 4), round(critical.frequency, 4)
    (37.6954, 30.4398)
    """
    if isinstance(later, bool) or not isinstance(later, int) or later < 0:
        raise InputError(f"later = {later!r} has to be a whole number, at least 0")
    slowness = slowness_factor(model, paper_time)
    computed = find_onset(linearised(model, method), later)
    slowed = [_slowed(crossing, slowness) for crossing in computed.later]
    hopf = computed.hopf and _slowed(computed.hopf, slowness)
    return replace(computed, hopf=hopf, later=tuple(slowed), paper_time=paper_time)


def growth_curve(
    model: Model,
    forces: Sequence[float] | Array,
    *,
    parameter: str | None = None,
    values: Sequence[float] | Array | None = None,
    method: Method | None = None,
    paper_time: bool = False,
    progress: Progress | None = None,
) -> GrowthCurve:
    """Return the leading eigenvalue against the force, and against a parameter if one is given.

    Parameters
    ----------
    model : Model
        Model of the filament or chain.
    forces : sequence of float
        Total follower forces [B/L^2], at least 0.
    parameter : str, optional
        Name of a second parameter, such as "load.slope".
    values : sequence of float, optional
        Values of the second parameter, in its unit.
    method, paper_time
        As in `onset`.
    progress : callable, optional
        Called with the number of values done and the number of all values.

    Returns
    -------
    GrowthCurve
        Rates [1/T] and frequencies [cycles/T] of shape (m,), or (k, m) with a second parameter.

    Raises
    ------
    InputError
        An argument is out of its range, or the model does not have the method or the parameter.

    Examples
    --------
    >>> import undula as un
    >>> curve = un.growth_curve(un.Filament(20, load=un.PointLoad(0.0)), [10.0, 30.0])
    >>> curve.rates.round(3)
    array([-26.789, -54.618])
    """
    if (parameter is None) != (values is None):
        raise InputError("a parameter and its values go together; give both or none")
    forces = checked_forces(forces)
    sampled = None if values is None else checked_values(values)
    models = [model]
    if parameter is not None and sampled is not None:
        models = models_along(model, parameter, sampled)
    method = method or method_for_all(models)
    rows = []
    for done, variant in enumerate(models, start=1):
        rows.append(
            leading_eigenvalues(variant, forces, method) / slowness_factor(variant, paper_time)
        )
        if progress:
            progress(done, len(models))
    leading = np.stack(rows) if sampled is not None else rows[0]
    return GrowthCurve(
        forces=forces,
        rates=leading[..., 0],
        frequencies=leading[..., 1] / (2.0 * np.pi),
        errors=leading[..., 2],
        method=method,
        parameter=parameter,
        values=sampled,
        paper_time=paper_time,
    )


def critical_curve(
    model: Model,
    parameter: str,
    values: Sequence[float] | Array,
    *,
    method: Method | None = None,
    paper_time: bool = False,
    progress: Progress | None = None,
) -> CriticalCurve:
    """Return the thresholds of the straight state against a parameter.

    All are computed by one method: "discrete" if one of the models has no continuous limit.

    Parameters
    ----------
    model : Model
        Model of the filament or chain.
    parameter : str
        Name of the parameter, such as "load.slope" or "model.segments".
    values : sequence of float
        Values of the parameter, in its unit.
    method, paper_time
        As in `onset`.
    progress : callable, optional
        Called with the number of values done and the number of all values.

    Returns
    -------
    CriticalCurve
        The onset at each value.

    Raises
    ------
    InputError
        An argument is out of its range, or the model does not have the method or the parameter.

    Examples
    --------
    >>> import undula as un
    >>> model = un.Filament(20, load=un.LinearLoad(0.0, slope=0.0))
    >>> un.critical_curve(model, "load.slope", [-1.0, 1.0]).forces.round(4)
    array([181.1085,  50.4716])
    """
    sampled = checked_values(values)
    models = models_along(model, parameter, sampled)
    method = method or method_for_all(models)
    onsets = []
    for done, variant in enumerate(models, start=1):
        onsets.append(onset(variant, method=method, later=0, paper_time=paper_time))
        if progress:
            progress(done, len(models))
    return CriticalCurve(parameter, sampled, tuple(onsets))


def method_for_all(models: Sequence[Model]) -> Method:
    """Return the method that all of several models have.

    Parameters
    ----------
    models : sequence of Model
        Models of the filaments or chains.

    Returns
    -------
    {"spectral", "discrete"}
        "discrete" if one of them has no continuous limit.
    """
    return "discrete" if any(model.continuum_load is None for model in models) else "spectral"


def _slowed(crossing: Crossing, slowness: float) -> Crossing:
    return replace(
        crossing,
        frequency=crossing.frequency / slowness,
        frequency_error=crossing.frequency_error / slowness,
        growth_slope=crossing.growth_slope / slowness,
    )
