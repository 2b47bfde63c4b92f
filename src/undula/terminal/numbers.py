"""Numbers with their errors for people, with one meaning of ±.

± precedes the error against the body that the links represent, a filament or a chain, from links
and solver together. Where only the error of the solver on the given links is known, the number has
no ± but states the number of links and this error.
"""

import math
from collections.abc import Mapping
from typing import Any

#: Values of `error_of` in answers: an `error` is against the body that the links represent, or
#: against the exact solution for the given links.
BODY, LINKS = "body", "links"
#: Advice on the result for the body in place of the given links.
CURE = "--converge gives the filament's"


def with_error(value: float, error: float | None) -> str:
    """Return a number to the digits that its error leaves, and the error with one digit.

    Parameters
    ----------
    value
        The number.
    error
        Error against the body that the links represent, from links and solver together; None if it
        is unknown.
    """
    if error is None or not math.isfinite(error) or error <= 0.0:
        return f"{value:.6g}"
    spread = f"{error:.1g}" if error < 1.0 else f"{error:.0f}"
    # A value within its error is shown as 0.
    return f"{digits(value, error)} ± {spread}" if abs(value) > error else f"0 ± {spread}"


def on_links(value: float, error: float | None, links: int, unit: str = "", cure: str = "") -> str:
    """Return a number that holds for the given links, without ±.

    Parameters
    ----------
    value
        The number.
    error
        Error of the solver on these links; None if it is unknown.
    links
        Number of links.
    unit
        Unit of the number.
    cure
        Advice on the result for the body that the links represent.
    """
    number = digits(value, error) if error and math.isfinite(error) else f"{value:.6g}"
    solved = f", solved to {error:.1g}" if error and math.isfinite(error) else ""
    more = f"; {cure}" if cure else ""
    return f"{number}{f' {unit}' if unit else ''} ({links} links{solved}{more})"


def with_error_of(
    value: float, error: float | None, answer: Mapping[str, Any], unit: str, cure: str = ""
) -> str:
    """Return a number of an answer, with its error as the key "error_of" of the answer states.

    Parameters are those of `on_links`, with an answer in place of the number of links.
    """
    if answer["error_of"] == LINKS:
        return on_links(value, error, answer["links"], unit, cure)
    return f"{with_error(value, error)} {unit}"


def digits(value: float, error: float) -> str:
    """Return a number to the digits that an error above 0 leaves.

    Parameters
    ----------
    value
        The number.
    error
        Its error, above 0.
    """
    # No answer is accurate to more than twelve decimals.
    decimals = min(12, max(0, -math.floor(math.log10(error))))
    return f"{value:.{decimals}f}"
