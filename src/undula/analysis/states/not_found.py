"""The outcome of a search without a state: a status, what was done, and what to try next."""

from dataclasses import dataclass
from enum import Enum


class SearchStatus(Enum):
    """Why a search found nothing; the value says it in words."""

    NO_ONSET = "the straight state is stable at all forces, so that no branch begins at it"
    BELOW_ONSET = "the force is below the one at which such states begin"
    NO_GUESS = "the run that was to give a guess shows no such motion"
    NOT_CONVERGED = "Newton's method did not converge from the guess"
    NOT_CONFIRMED = "a solution was found that shorter steps do not confirm"
    ANOTHER_MOTION = "a solution was found, of another motion than that of the run"
    NOT_REACHED = "the branch could not be followed to the value of the parameter"
    ABSENT = "all of the range was searched and holds none"


@dataclass(frozen=True)
class NotFound:
    """Outcome of a search that found nothing; false in a condition.

    Attributes
    ----------
    status : SearchStatus
        Why nothing was found, for programs.
    finding : str
        What was tried and how far it led.
    advice : str or None
        What to try next; None if there is nothing to try.
    residual : float or None
        The residual at which the search ended, None if it had nothing to begin from.
    """

    status: SearchStatus
    finding: str
    advice: str | None = None
    residual: float | None = None

    @property
    def reason(self) -> str:
        """What was tried, how far it led, and what to try next, in one sentence."""
        return self.finding if self.advice is None else f"{self.finding}; {self.advice}"

    def __bool__(self) -> bool:
        """Return False: there is no state."""
        return False
