"""Linear algebra on one thread: on small matrices more of them wait for each other."""

from collections.abc import Callable
from functools import cache, wraps
from typing import Any, ParamSpec, TypeVar

from threadpoolctl import ThreadpoolController

P = ParamSpec("P")
R = TypeVar("R")


@cache
def _controller() -> Any:
    """Return the control of the libraries that are loaded; to look for them takes milliseconds."""
    import scipy.linalg  # noqa: F401  (which loads a library of its own)

    return ThreadpoolController()


def on_one_thread(function: Callable[P, R]) -> Callable[P, R]:
    """Return a function whose linear algebra runs on one thread, whatever the caller has set.

    Matrices here have at most a few hundred rows. With more threads a call is slower on an idle
    machine, and up to a hundred times slower on a busy one.

    Parameters
    ----------
    function : callable
        Any function.
    """

    @wraps(function)
    def limited(*args: P.args, **kwargs: P.kwargs) -> R:
        with _controller().limit(limits=1, user_api="blas"):
            return function(*args, **kwargs)

    return limited
