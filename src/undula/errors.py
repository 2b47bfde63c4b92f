"""The one exception for mistakes that a user can put right."""

import math
from numbers import Real
from typing import Any


class InputError(ValueError):
    """A mistake in the input, told in one sentence that names the culprit and the cure.

    Whatever faces the user shows the text of this exception as it is, without a traceback.
    """


def is_number(value: Any) -> bool:
    """Tell whether a value is a finite real number, which true, false and texts are not."""
    if not isinstance(value, Real) or isinstance(value, bool):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:
        return False  # a whole number beyond what a float holds
