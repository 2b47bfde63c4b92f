"""Former names of keywords, which are accepted with a warning until the next release."""

import warnings
from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar, cast

F = TypeVar("F", bound=Callable[..., Any])


def renamed_keyword(old: str, new: str) -> Callable[[F], F]:
    """Return a decorator that lets a function take a keyword by its former name, with a warning.

    Parameters
    ----------
    old, new
        The former name and the present one.
    """

    def decorate(function: F) -> F:
        @wraps(function)
        def accepting(*arguments: Any, **keywords: Any) -> Any:
            if old not in keywords:
                return function(*arguments, **keywords)
            message = f"{old} of {function.__name__} is now {new}; the old name goes with the"
            warnings.warn(f"{message} next release", DeprecationWarning, stacklevel=2)
            # Both names at once raise TypeError.
            return function(*arguments, **{new: keywords.pop(old)}, **keywords)

        return cast("F", accepting)

    return decorate
