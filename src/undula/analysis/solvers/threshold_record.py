"""A threshold as a record: a force at which stability changes, or why there is no such force."""

from dataclasses import dataclass
from typing import Any

from undula.analysis.solvers.threshold_search import Missed
from undula.analysis.states.branch import Bifurcation
from undula.analysis.states.not_found import NotFound


@dataclass(frozen=True)
class Threshold:
    """A force at which stability changes.

    Attributes
    ----------
    kind : {"onset", "spinning-lost", "flapping-gained", "flapping-lost"}
        The change of stability.
    value : float or None
        The force [B/L^2]: of the continuous body if `links` are several or empty, else on these
        links. None if the threshold was not found.
    error : float or None
        Estimated error of the value against the body that the links stand for, of links and solver
        together [B/L^2]; None if it could not be estimated.
    frequency : float or None
        Of the state there [cycles per T].
    second_frequency : float or None
        Of the disturbance that changes from decay to growth or back [cycles per T].
    bifurcation : str or None
        The kind of bifurcation.
    reason : str or None
        Why there is no value.
    at : Bifurcation or None
        The bifurcation itself, on the finest links.
    links : tuple of int
        Numbers of links on which the threshold was solved for; empty for the continuum.
    solver_error : float or None
        Estimated error of the value on these links [B/L^2].
    searched_to : float or None
        The force at which the search ended without a threshold, if a farther search might find one.
    """

    kind: str
    value: float | None
    error: float | None = None
    frequency: float | None = None
    second_frequency: float | None = None
    bifurcation: str | None = None
    reason: str | None = None
    at: Bifurcation[Any] | None = None
    links: tuple[int, ...] = ()
    solver_error: float | None = None
    searched_to: float | None = None

    def __str__(self) -> str:
        """Return the threshold in one line."""
        if self.value is None:
            farther = "" if self.searched_to is None else "; a larger up_to looks farther"
            return f"no {self.kind}: {self.reason}{farther}"
        error = "" if self.error is None else f" +- {self.error:.1g}"
        links = ""
        if len(self.links) == 1 and self.error != self.solver_error:
            links = f" ({self.links[0]} links, solved to {self.solver_error:.1g})"
        return (
            f"{self.kind} at force {self.value:.10g}{error}{links}, {self.bifurcation},"
            f" {self.frequency:.8g} cycles per T"
        )


def without_value(kind: str, failure: NotFound) -> Threshold:
    """Return the record of a threshold that was not found."""
    searched_to = failure.searched_to if isinstance(failure, Missed) else None
    return Threshold(kind, None, reason=failure.reason, searched_to=searched_to)
