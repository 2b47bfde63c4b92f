"""The exception for mistakes in the input, which the user can correct."""

import math
from numbers import Real
from typing import Any


class InputError(ValueError):
    """A mistake in the input, with a message that names the value and the cure.

    The command line shows the message as it is, without a traceback.

    Examples
    --------
    >>> import undula as un
    >>> try:
    ...     un.PointLoad(75.0, position=1.5)
    ... except un.InputError as error:
    ...     print(error)
    PointLoad: position = 1.5 has to be a number in (0, 1]
    """


def is_number(value: Any) -> bool:
    """Return True for a finite real number.

    Parameters
    ----------
    value : object
        Any value; booleans and texts are not numbers.

    Returns
    -------
    bool
        False for any other value, infinity and NaN included.
    """
    if not isinstance(value, Real) or isinstance(value, bool):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:
        return False  # an integer beyond the range of floats
