"""Outcomes of the time loop, as values with advice."""

from enum import Enum


class Status(Enum):
    """Reason why the time loop returned."""

    DONE = 0
    PAUSED = 1
    STEP_TOO_SHORT = 2
    NOT_FINITE = 3

    @property
    def advice(self) -> str:
        """Outcome and cure, in one sentence."""
        return _ADVICE[self]


_ADVICE = {
    Status.DONE: "every asked time was reached",
    Status.PAUSED: "the integration paused and can go on",
    Status.STEP_TOO_SHORT: (
        "no step succeeded, however short: links may have folded onto each other;"
        " use more segments or a smaller force"
    ),
    Status.NOT_FINITE: (
        "the state is no longer finite: use smaller tolerances, more segments or a smaller force"
    ),
}
