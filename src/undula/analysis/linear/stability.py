"""Linear stability of the straight state: spectra, thresholds, and both along a parameter.

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

#: Called with the number of points done and the number of all.
Progress = Callable[[int, int], None]

# A finer resolution is tried unless an eigenvalue is settled to this share of its size, or round-
# off, which grows with the largest eigenvalue of interest, is reached.
_SETTLED = 1e-12


def onset(
    model: Model, *, method: Method | None = None, later: int = 2, paper_time: bool = False
) -> Onset:
    """Return how the straight state loses stability as the force grows from 0.

    Parameters
    ----------
    model : Model
        Its own force does not matter.
    method : {"spectral", "modes", "discrete"}, optional
        On polynomials, on the paper's assumed modes, or for the links as they are. By default
        "spectral", or "discrete" for a model that stands for no continuous filament.
    later : int
        How many crossings after the first to look for, at least 0.
    paper_time : bool
        Whether to give rates and frequencies as the paper's printed equation does, which carries
        the drag ratio before the time derivative: smaller by that factor.

    Returns
    -------
    Onset
        Forces in B/L^2 and frequencies in cycles per T, each with its error.

    Raises
    ------
    InputError
        An argument is out of its range, or the model does not know the method.
    """
    if isinstance(later, bool) or not isinstance(later, int) or later < 0:
        raise InputError(f"later = {later!r} has to be a whole number, at least 0")
    slowness = _slowness(model, paper_time)
    onset = find_onset(linearised(model, method), later)
    slowed = [_slowed(crossing, slowness) for crossing in onset.later]
    hopf = onset.hopf and _slowed(onset.hopf, slowness)
    return replace(onset, hopf=hopf, later=tuple(slowed), paper_time=paper_time)


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
        Total follower force [B/L^2], at least 0; by default the model's own.
    count : int
        How many eigenvalues, at least 1; a complex pair is not split.
    method, paper_time
        As in `onset`.

    Raises
    ------
    InputError
        An argument is out of its range, or the model does not know the method.
    """
    if isinstance(count, bool) or not isinstance(count, int) or count < 1:
        raise InputError(f"count = {count!r} has to be a whole number, at least 1")
    if force is not None:
        model = model.with_(force=force)
    force = float(model.load.force)
    linearisation = _resolved(linearised(model, method), force)
    pencil, slowness = linearisation.pencil, _slowness(model, paper_time)
    values, vectors = eigenpairs(_stiffness(pencil, force), pencil.mass)
    # The upper one of a pair comes first: after an odd one its partner follows.
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
    parameter, values : str and sequence of float, optional
        Name of a parameter, such as "load.slope", and its values.
    method, paper_time
        As in `onset`.
    progress : callable, optional
        Called with the number of values done and of all.

    Raises
    ------
    InputError
        An argument is out of its range, or the model does not know the method or the parameter.
    """
    if (parameter is None) != (values is None):
        raise InputError("a parameter and its values go together; give both or none")
    forces = checked_forces(forces)
    given = None if values is None else checked_values(values)
    models = [model]
    if parameter is not None and given is not None:
        models = models_along(model, parameter, given)
    method = method or method_for_all(models)
    rows = []
    for done, each in enumerate(models, start=1):
        rows.append(_leading(each, forces, method) / _slowness(each, paper_time))
        if progress:
            progress(done, len(models))
    leading = np.stack(rows) if given is not None else rows[0]
    return GrowthCurve(
        forces=forces,
        rates=leading[..., 0],
        frequencies=leading[..., 1] / (2.0 * np.pi),
        errors=leading[..., 2],
        method=method,
        parameter=parameter,
        values=given,
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

    All are by one method: "discrete" if one of the models has no continuum.

    Parameters
    ----------
    model : Model
    parameter : str
        Its name, such as "load.slope" or "model.segments".
    values : sequence of float
    method, paper_time
        As in `onset`.
    progress : callable, optional
        Called with the number of values done and of all.

    Raises
    ------
    InputError
        An argument is out of its range, or the model does not know the method or the parameter.
    """
    given = checked_values(values)
    models = models_along(model, parameter, given)
    method = method or method_for_all(models)
    onsets = []
    for done, each in enumerate(models, start=1):
        onsets.append(onset(each, method=method, later=0, paper_time=paper_time))
        if progress:
            progress(done, len(models))
    return CriticalCurve(parameter, given, tuple(onsets))


def method_for_all(models: Sequence[Model]) -> Method:
    """Return the method by which the onsets of several models can be compared."""
    return "discrete" if any(model.continuum_load is None for model in models) else "spectral"


def _resolved(linearisation: Linearisation, force: float) -> Linearisation:
    """Return the linearisation, refined until its leading eigenvalue is settled."""
    while True:
        pencil = linearisation.pencil
        first = eigenvalues(_stiffness(pencil, force), pencil.mass)[:1]
        finer = linearisation.finer()
        settled = _errors(linearisation, force, first)[0] <= _SETTLED * abs(first[0])
        if finer is None or settled:
            return linearisation
        linearisation = finer


def _errors(linearisation: Linearisation, force: float, values: ComplexArray) -> Array:
    """Return the errors of eigenvalues under a force, from those of the companion."""
    # What the eigenvalue solver itself may lose.
    round_off = 10.0 * np.finfo(float).eps * np.abs(values)
    compared = linearisation.companion()
    if compared is None:
        return np.asarray(round_off)
    other, factor = compared
    others = eigenvalues(other.pencil.stiffness(force), other.pencil.mass)
    nearest = np.abs(others[None, :] - values[:, None]).min(axis=1)
    return np.asarray(factor * nearest + round_off)


def _stiffness(pencil: Pencil, force: float) -> Array:
    """Return the stiffness under a force that the links can bear."""
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
        first = eigenvalues(_stiffness(pencil, force), pencil.mass)[:1]
        error = _errors(linearisation, force, first)[0]
        rows.append((first[0].real, abs(first[0].imag), error))
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
    """Return by how much the paper's rates are smaller, if they are asked for."""
    if not paper_time:
        return 1.0
    drag_ratio = getattr(model, "drag_ratio", None)
    if drag_ratio is None:
        raise InputError("paper_time has no meaning for a model without a drag ratio; leave it out")
    return float(drag_ratio)
