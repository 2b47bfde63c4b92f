"""The option --sensitivities: derivatives by all parameters, in plain JSON types and as text."""

from typing import Any

from undula.analysis.sensitivity.sensitivities import sensitivities
from undula.terminal.output import Answer


def with_sensitivities(answer: Answer, solved: Any) -> Answer:
    """Return an answer with the derivatives of its numbers.

    Parameters
    ----------
    answer
        The answer on a state or a threshold.
    solved
        The state or the threshold.
    """
    slopes = sensitivities(solved)
    names = list(next(iter(slopes.values()), {}))
    width = max(map(len, slopes), default=0)
    head = f"  derivatives of {', '.join(name.replace('_', ' ') for name in names)} by"
    lines = [
        f"    {parameter:<{width}}  {'  '.join(f'{row[name]:>12.6g}' for name in row)}"
        for parameter, row in slopes.items()
    ]
    rows = {parameter: dict(row) for parameter, row in slopes.items()}
    return Answer(answer.answer | {"sensitivities": rows}, "\n".join([answer.text, head, *lines]))
