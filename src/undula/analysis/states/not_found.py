"""The outcome of a search that found no state: status, finding and advice."""

from dataclasses import dataclass
from enum import Enum

from undula.analysis.record import Fact, Record


class SearchStatus(Enum):
    """Reasons for which a search finds nothing; the value is a sentence."""

    NO_ONSET = "the straight state is stable at all forces, so that no branch begins at it"
    BELOW_ONSET = "the force is below the one at which such states begin"
    NO_GUESS = "the run that was to give a guess shows no such motion"
    NOT_CONVERGED = "Newton's method did not converge from the guess"
    NOT_CONFIRMED = "a solution was found that shorter steps do not confirm"
    ANOTHER_MOTION = "a solution was found, of another motion than that of the run"
    NOT_REACHED = "the branch could not be followed to the value of the parameter"
    ABSENT = "all of the range was searched and holds none"


@dataclass(frozen=True, repr=False)
class NotFound(Record):
    """Outcome of a search that found nothing; false in a condition.

    Attributes
    ----------
    status : SearchStatus
        The reason, for programs.
    finding : str
        The attempt and how far it led.
    advice : str or None
        The next thing to try; None if there is nothing.
    residual : float or None
        The residual at which the search ended, None if it had nothing to begin from.
    """

    status: SearchStatus
    finding: str
    advice: str | None = None
    residual: float | None = None

    @property
    def reason(self) -> str:
        """The attempt, how far it led and the next thing to try, in one sentence."""
        return self.finding if self.advice is None else f"{self.finding}; {self.advice}"

    def facts(self) -> dict[str, Fact]:
        """Return status, finding, advice and residual by name."""
        return {
            "status": Fact(self.status.name.lower().replace("_", " ")),
            "finding": Fact(self.finding),
            "advice": Fact(self.advice or ""),
            "residual": Fact(self.residual),
        }

    def __str__(self) -> str:
        """Return the reason in one line."""
        return f"not found: {self.reason}"

    def __bool__(self) -> bool:
        """Return False: there is no state."""
        return False
