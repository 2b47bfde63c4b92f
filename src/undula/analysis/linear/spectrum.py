"""Leading eigenvalues and modes of the straight state under one force."""

import numpy as np

from undula.analysis.linear.pencils import Linearisation, linearised
from undula.analysis.linear.results import Method, Spectrum
from undula.arrays import Array, ComplexArray
from undula.errors import InputError
from undula.models.model import Model
from undula.numerics.linalg.pencil import Pencil, eigenpairs, eigenvalues

# Relative error of the leading eigenvalue below which the resolution is not refined further.
_RELATIVE_TOLERANCE = 1e-12


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
        Model of the filament or chain.
    force : float, optional
        Total follower force [B/L^2], at least 0; by default the force of the model.
    count : int
        Number of eigenvalues, at least 1; one more where this would split a complex pair.
    method, paper_time
        As in `undula.analysis.linear.stability.onset`.

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
    pencil, slowness = linearisation.pencil, slowness_factor(model, paper_time)
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


def leading_eigenvalue(pencil: Pencil, force: float) -> complex:
    """Return the leading eigenvalue under a force.

    Parameters
    ----------
    pencil : Pencil
        Pencil K(F) + sigma M.
    force : float
        Total follower force [B/L^2].

    Returns
    -------
    complex
        [1/T]; of a pair, the member with positive imaginary part.
    """
    return complex(eigenvalues(pencil.stiffness(force), pencil.mass)[0])


def leading_eigenvalues(model: Model, forces: Array, method: Method | None) -> Array:
    """Return the leading eigenvalue under several forces.

    Parameters
    ----------
    model : Model
        Model of the filament or chain.
    forces : ndarray of shape (m,)
        Total follower forces [B/L^2], at least 0.
    method : {"spectral", "modes", "discrete"} or None
        As in `undula.analysis.linear.stability.onset`.

    Returns
    -------
    ndarray of shape (m, 3)
        Rate, angular frequency and error [1/T].
    """
    linearisation = _resolved(linearised(model, method), float(forces.max()))
    pencil = linearisation.pencil
    rows = []
    for force in forces:
        leading = eigenvalues(_stiffness(pencil, force), pencil.mass)[:1]
        error = _errors(linearisation, force, leading)[0]
        rows.append((leading[0].real, abs(leading[0].imag), error))
    return np.array(rows)


def slowness_factor(model: Model, paper_time: bool) -> float:
    """Return the factor by which rates are smaller in the paper's time.

    Parameters
    ----------
    model : Model
        Model of the filament or chain.
    paper_time : bool
        True for the time of the paper's printed equation.

    Returns
    -------
    float
        The drag ratio, or 1 in the time of the model.

    Raises
    ------
    InputError
        The model has no drag ratio.
    """
    if not paper_time:
        return 1.0
    drag_ratio = getattr(model, "drag_ratio", None)
    if drag_ratio is None:
        raise InputError("paper_time has no meaning for a model without a drag ratio; leave it out")
    return float(drag_ratio)


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


def _normalised(modes: ComplexArray) -> ComplexArray:
    """Return modes with a largest modulus of 1, real and positive at the tip."""
    tips = modes[:, -1:]
    turned = modes * np.exp(-1j * np.angle(tips))
    return np.asarray(turned / np.abs(modes).max(axis=1, keepdims=True))
