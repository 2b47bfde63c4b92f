"""Arguments of the wrong kind, each answered with the right one."""

import reprlib
from typing import Any

from undula.analysis.states.state import State
from undula.errors import InputError


def require_model(model: Any, verb: str) -> None:
    """Refuse what is no model.

    Parameters
    ----------
    model : object
        The argument.
    verb : str
        Name of the function that it was given to.

    Raises
    ------
    InputError
        It is no model.
    """
    if not _is_model(model):
        raise InputError(
            f"{verb} begins with a model, but {_named(model)} was given; give one such as"
            " undula.Filament(20, undula.TipLoad(75.0))"
        )


def require_state(state: Any, verb: str) -> None:
    """Refuse what is no solved state; arguments are those of `require_model`.

    Raises
    ------
    InputError
        It is no state.
    """
    if isinstance(state, State):
        return
    if _is_model(state):
        cure = 'solve for one first, as undula.find(model, "spinning")'
    else:
        cure = "give what undula.find returns"
    raise InputError(f"{verb} begins with a state, but {_named(state)} was given; {cure}")


def _is_model(value: Any) -> bool:
    """Return whether a value has what solvers and steppers ask of any model, a user's own too."""
    return all(hasattr(value, name) for name in ("equations", "links", "load", "straight"))


def _named(value: Any) -> str:
    if _is_model(value):
        return f"a {type(value).__name__}"
    return f"{type(value).__name__} {reprlib.repr(value)}"
