"""Numbers with their errors, for people: what stands behind ± is one thing.

± is the error against the body that the numbers stand for, a filament or a chain of links, of links
and solver together. Where only the error on the links as they are is known, the number has no ±
but says on how many links it holds and how exactly it was solved for there.
"""

import math
from collections.abc import Mapping
from typing import Any

#: What an `error` is against, as answers tell it in `error_of`: the body that the numbers stand
#: for, or the links as they are, of a body that has more of them.
BODY, LINKS = "body", "links"
#: How to come from the links as they are to the body.
CURE = "--converge gives the filament's"


def with_error(value: float, error: float | None) -> str:
    """Return a number to the digits that its error leaves, and the error with one digit.

    Parameters
    ----------
    value
    error
        Against the body that the numbers stand for, of links and solver together.
    """
    if error is None or not math.isfinite(error) or error <= 0.0:
        return f"{value:.6g}"
    spread = f"{error:.1g}" if error < 1.0 else f"{error:.0f}"
    # A value within its error is told as the nought that it may be.
    return f"{digits(value, error)} ± {spread}" if abs(value) > error else f"0 ± {spread}"


def on_links(value: float, error: float | None, links: int, unit: str = "", cure: str = "") -> str:
    """Return a number that holds for links as they are, without ±.

    Parameters
    ----------
    value
    error
        How exactly it was solved for on these links.
    links
        How many these are.
    unit
        What follows the number.
    cure
        What gives more of the body that the links stand for.
    """
    told = digits(value, error) if error and math.isfinite(error) else f"{value:.6g}"
    exactly = f", solved to {error:.1g}" if error and math.isfinite(error) else ""
    more = f"; {cure}" if cure else ""
    return f"{told}{f' {unit}' if unit else ''} ({links} links{exactly}{more})"


def told_of(
    value: float, error: float | None, answer: Mapping[str, Any], unit: str, cure: str = ""
) -> str:
    """Return a number with its error against what the answer says that its errors are of."""
    if answer["error_of"] == LINKS:
        return on_links(value, error, answer["links"], unit, cure)
    return f"{with_error(value, error)} {unit}"


def digits(value: float, error: float) -> str:
    """Return a number to the digits that an error above 0 leaves."""
    # Twelve decimals are more than any answer is good for.
    decimals = min(12, max(0, -math.floor(math.log10(error))))
    return f"{value:.{decimals}f}"
