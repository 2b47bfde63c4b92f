"""Units that several answers have in common."""

from undula.errors import InputError
from undula.views.common import style


def same_units(*answers: style.UnitNames) -> style.UnitNames:
    """Return the units of answers.

    Raises
    ------
    InputError
        They are not all the same.
    """
    for other in answers[1:]:
        if other != answers[0]:
            raise InputError(
                f"the answers are in {answers[0]['force']} and in {other['force']}; give answers of"
                " one model"
            )
    return answers[0]
