"""Search for a threshold by its name, at one value or along a second parameter."""

from collections.abc import Callable, Sequence
from typing import overload

from undula.analysis.arguments import require_model
from undula.analysis.linear.results import Method
from undula.analysis.one_thread import on_one_thread
from undula.analysis.solvers.threshold_record import Threshold, ThresholdCurve
from undula.analysis.solvers.thresholds import single_threshold, threshold_curve
from undula.models.model import Model


@overload
def threshold(
    model: Model,
    kind: str,
    *,
    converged: bool = False,
    near: Threshold | None = None,
    up_to: float | None = None,
    method: Method | None = None,
    along: None = None,
    progress: Callable[[int, float], None] | None = None,
) -> Threshold: ...
@overload
def threshold(
    model: Model,
    kind: str,
    *,
    converged: bool = False,
    near: Threshold | None = None,
    up_to: float | None = None,
    method: Method | None = None,
    along: tuple[str, Sequence[float]],
    progress: Callable[[int, float], None] | None = None,
) -> ThresholdCurve: ...
@on_one_thread
def threshold(
    model: Model,
    kind: str,
    *,
    converged: bool = False,
    near: Threshold | None = None,
    up_to: float | None = None,
    method: Method | None = None,
    along: tuple[str, Sequence[float]] | None = None,
    progress: Callable[[int, float], None] | None = None,
) -> Threshold | ThresholdCurve:
    """Return the force at which a state gains or loses stability.

    Parameters
    ----------
    model : Model
        Its own force does not matter.
    kind : {"onset", "spinning-lost", "flapping-gained", "flapping-lost"}
        "onset": the straight state, or the equilibrium of a curved filament, loses stability. The
        others: spinning or planar flapping loses or gains it.
    converged : bool
        True for the limit of many links, by extrapolation.
    near : Threshold, optional
        The same threshold of a similar model, next to which it is searched for first.
    up_to : float, optional
        The force at which the search ends [B/L^2], above 0; by default 20 times that of the onset.
    method : {"spectral", "modes", "discrete"}, optional
        Discretisation for the onset of a straight state, as in `onset`.
    along : (str, sequence of float), optional
        A second parameter and its values, for a curve of thresholds.
    progress : callable, optional
        Called with the number of links and each force that was reached.

    Returns
    -------
    Threshold, or ThresholdCurve with `along`
        Without a value, but with a reason, if the search ends without it.

    Raises
    ------
    InputError
        The kind is not one of these, the model cannot have such a state or has no limit of many
        links, or `up_to` is out of range.

    Examples
    --------
    The straight filament under a tip load is lost at the force of De Canio, Lauga & Goldstein,
    J. R. Soc. Interface 14 (2017) 20170491:

    >>> import undula as un
    >>> onset = un.threshold(un.Filament(40, un.TipLoad(75.0)), "onset")
    >>> round(onset.value, 4), onset.bifurcation
    (37.6954, 'Hopf')
    """
    require_model(model, "threshold")
    if along is None:
        return single_threshold(
            model,
            kind,
            converged=converged,
            near=near,
            up_to=up_to,
            method=method,
            progress=progress,
        )
    parameter, values = along
    return threshold_curve(model, kind, parameter, values, converged=converged, up_to=up_to)
