"""Linear stability of the straight state: spectra and thresholds, also along a parameter.

Theory and sources: docs/theory/stability.md.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from undula.analysis.linear.checked_values import checked_forces, checked_values, models_along
from undula.analysis.linear.onset import find_onset
from undula.analysis.linear.pencils import Linearisation, linearised
from undula.analysis.linear.results import (
    CriticalCurve,
    Crossing,
    GrowthCurve,
    Method,
    Onset,
    Spectrum,
)
from undula.arrays import Array, ComplexArray
from undula.errors import InputError
from undula.models.model import Model
from undula.numerics.linalg.pencil import Pencil, eigenpairs, eigenvalues

#: Callback with the number of points done and the number of all points.
Progress = Callable[[int, int], None]

# Relative error of the leading eigenvalue below which the resolution is not refined further.
_RELATIVE_TOLERANCE = 1e-12


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
    slowness = _slowness(model, paper_time)
    computed = find_onset(linearised(model, method), later)
    slowed = [_slowed(crossing, slowness) for crossing in computed.later]
    hopf = computed.hopf and _slowed(computed.hopf, slowness)
    return replace(computed, hopf=hopf, later=tuple(slowed), paper_time=paper_time)


def spectrum(
    model: Model,
    force: float | None = None,
    *,
    count: int = 4,
    method: Method | None = None,
    paper_time: bool = False,
) -> Spectrum:
    """Return the leading eigenvalues and modes of the straight state under one force.

    Parameters
    ----------
    model : Model
    force : float, optional
        Total follower force [B/L^2], at least 0; by default the force of the model.
    count : int
        Number of eigenvalues, at least 1; one more where this would split a complex pair.
    method, paper_time
        As in `onset`.

    Returns
    -------
    Spectrum
        Eigenvalues [1/T] with their errors, and modes.

    Raises
    ------
    InputError
        An argument is out of its range, or the model does not have the method.

    Examples
    --------
    >>> import undula as un
    >>> leading = un.spectrum(un.Filament(20, load=un.PointLoad(25.0)), count=1)
    >>> leading.rates.round(4), leading.frequencies.round(4)
    (array([-88.5648, -88.5648]), array([16.6186, 16.6186]))
    """
    if isinstance(count, bool) or not isinstance(count, int) or count < 1:
        raise InputError(f"count = {count!r} has to be a whole number, at least 1")
    if force is not None:
        model = model.with_(force=force)
    force = float(model.load.force)
    linearisation = _resolved(linearised(model, method), force)
    pencil, slowness = linearisation.pencil, _slowness(model, paper_time)
    values, vectors = eigenpairs(_stiffness(pencil, force), pencil.mass)
    # The member of a pair with positive imaginary part is first, so its partner is the next one.
    count += 1 if values[:count][-1].imag > 0.0 else 0
    s, modes = linearisation.shape(vectors[:, :count])
    return Spectrum(
        force=force,
        values=values[:count] / slowness,
        errors=_errors(linearisation, force, values[:count]) / slowness,
        s=s,
        modes=_normalised(modes),
        method=linearisation.method,
        paper_time=paper_time,
    )


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
        rows.append(_leading(variant, forces, method) / _slowness(variant, paper_time))
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

    Returns
    -------
    {"spectral", "discrete"}
        "discrete" if one of them has no continuous limit.
    """
    return "discrete" if any(model.continuum_load is None for model in models) else "spectral"


def _resolved(linearisation: Linearisation, force: float) -> Linearisation:
    """Return the linearisation, refined until its leading eigenvalue has converged."""
    while True:
        pencil = linearisation.pencil
        leading = eigenvalues(_stiffness(pencil, force), pencil.mass)[:1]
        finer = linearisation.finer()
        settled = _errors(linearisation, force, leading)[0] <= _RELATIVE_TOLERANCE * abs(leading[0])
        if finer is None or settled:
            return linearisation
        linearisation = finer


def _errors(linearisation: Linearisation, force: float, values: ComplexArray) -> Array:
    """Return the errors of eigenvalues under a force by comparison with the companion."""
    # Error of the eigenvalue solver.
    round_off = 10.0 * np.finfo(float).eps * np.abs(values)
    compared = linearisation.companion()
    if compared is None:
        return np.asarray(round_off)
    other, factor = compared
    others = eigenvalues(other.pencil.stiffness(force), other.pencil.mass)
    nearest = np.abs(others[None, :] - values[:, None]).min(axis=1)
    return np.asarray(factor * nearest + round_off)


def _stiffness(pencil: Pencil, force: float) -> Array:
    """Return the stiffness under a force, refusing one that turns extensible links inside out."""
    stiffness = pencil.stiffness(force)
    if not np.isfinite(stiffness).all():
        raise InputError(
            f"force = {force!r} pushes extensible links beyond their length; give a smaller force,"
            " or a larger tensile_stiffness"
        )
    return stiffness


def _leading(model: Model, forces: Array, method: Method | None) -> Array:
    """Return rate, angular frequency and error of the leading eigenvalue, shape (m, 3)."""
    linearisation = _resolved(linearised(model, method), float(forces.max()))
    pencil = linearisation.pencil
    rows = []
    for force in forces:
        leading = eigenvalues(_stiffness(pencil, force), pencil.mass)[:1]
        error = _errors(linearisation, force, leading)[0]
        rows.append((leading[0].real, abs(leading[0].imag), error))
    return np.array(rows)


def _normalised(modes: ComplexArray) -> ComplexArray:
    """Return modes with a largest modulus of 1, real and positive at the tip."""
    tips = modes[:, -1:]
    turned = modes * np.exp(-1j * np.angle(tips))
    return np.asarray(turned / np.abs(modes).max(axis=1, keepdims=True))


def _slowed(crossing: Crossing, slowness: float) -> Crossing:
    return replace(
        crossing,
        frequency=crossing.frequency / slowness,
        frequency_error=crossing.frequency_error / slowness,
        growth_slope=crossing.growth_slope / slowness,
    )


def _slowness(model: Model, paper_time: bool) -> float:
    """Return the factor by which rates in the paper's time are smaller, else 1."""
    if not paper_time:
        return 1.0
    drag_ratio = getattr(model, "drag_ratio", None)
    if drag_ratio is None:
        raise InputError("paper_time has no meaning for a model without a drag ratio; leave it out")
    return float(drag_ratio)
