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
    return isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value)
