"""Ranges of a parameter that inverse questions are searched in."""

from collections.abc import Sequence

from undula.analysis.parameters import FORCE, changed, value_of
from undula.analysis.solvers.state_kinds import kind_by_name
from undula.errors import InputError, is_number
from undula.models.model import Model

# Force up to which states are followed by default, in multiples of the Hopf force; for states at
# rest, which have none, in multiples of that of the tip load [B/L^2].
_FARTHEST, _ONSET_AT_REST = 8.0, 38.0
# Largest ratio of an end of the default range to the model's own value.
_LARGEST_RATIO = 4.0
# Number of halvings after which the largest allowed value is known to round-off.
_HALVINGS = 60
#: Kinds of states that begin at a Hopf point of the straight state.
BEGIN_AT_ONSET = ("spinning", "flapping")


def range_of(
    model: Model, kind: str, parameter: str, between: Sequence[float] | None
) -> tuple[float, float]:
    """Return the range in which a parameter is searched.

    Parameters
    ----------
    model : Model
        The model.
    kind : str
        Kind of state, or name of a threshold.
    parameter : str
        Name of the parameter.
    between : (float, float) or None
        The range that was asked for. The default of the force is from 0 to 8 times the onset, that
        of another parameter from a quarter of its own value to 4 times that, as far as is allowed.

    Returns
    -------
    (float, float)

    Raises
    ------
    InputError
        The range is not two rising numbers that are allowed, or has no default as the model's own
        value is 0.
    """
    own = value_of(model, parameter)
    if between is not None:
        return _checked(model, parameter, between)
    if parameter == FORCE:
        return 0.0, _FARTHEST * _onset(model, kind)
    if own == 0.0:
        raise InputError(
            f"{parameter} is 0, from which no range follows; give its ends as between, LOW and HIGH"
        )
    low, high = sorted((own / _LARGEST_RATIO, own * _LARGEST_RATIO))
    return _allowed(model, parameter, low, own), _allowed(model, parameter, high, own)


def _checked(model: Model, parameter: str, between: Sequence[float]) -> tuple[float, float]:
    try:
        low, high = between
    except (TypeError, ValueError):
        raise InputError(f"between = {between!r} has to be two numbers, as (40, 300)") from None
    for end in (low, high):
        if not is_number(end):
            raise InputError(f"between = {between!r} has to be two finite numbers, as (40, 300)")
    if not low < high:
        raise InputError(
            f"between = ({low:.6g}, {high:.6g}) does not rise; give the lower end first, and a"
            " higher one"
        )
    for end in (low, high):
        changed(model, parameter, end)  # refuses a value out of range
    return float(low), float(high)


def _onset(model: Model, kind: str) -> float:
    beginning = kind_by_name(kind).start(model) if kind in BEGIN_AT_ONSET else None
    return _ONSET_AT_REST if beginning is None else float(beginning[1].p)


def _allowed(model: Model, parameter: str, value: float, own: float) -> float:
    """Return a value, or the one closest to it that the model allows."""
    try:
        changed(model, parameter, value)
    except InputError:
        allowed, refused = own, value
    else:
        return value
    for _ in range(_HALVINGS):
        middle = 0.5 * (allowed + refused)
        try:
            changed(model, parameter, middle)
        except InputError:
            refused = middle
        else:
            allowed = middle
    return allowed
