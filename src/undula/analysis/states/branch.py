"""Records of a branch of states along a parameter and of its bifurcations."""

from dataclasses import dataclass
from typing import Generic, Literal, TypeVar

from undula.analysis.states.state import State
from undula.arrays import Array

S = TypeVar("S", bound=State)


@dataclass(frozen=True)
class Bifurcation(Generic[S]):
    """A point of a branch at which a disturbance changes from decay to growth, or back.

    Attributes
    ----------
    kind : str
        "fold", "torus", "symmetry breaking", "period doubling", "Hopf" or "branch point".
    value, error : float
        The parameter there, and the error of its location on the discrete model.
    state : State
        The state there.
    frequency : float
        Of the state [cycles per T].
    second_frequency : float or None
        Of the critical disturbance, in the state's own frame [cycles per T]; None if it is real.
    unstable_before, unstable_after : int
        Numbers of disturbances that grow before and after, in the direction of following.
    """

    kind: str
    value: float
    error: float
    state: S
    frequency: float
    second_frequency: float | None
    unstable_before: int
    unstable_after: int

    @property
    def loses(self) -> bool:
        """True if the state is stable before and not after."""
        return self.unstable_before == 0 < self.unstable_after

    @property
    def gains(self) -> bool:
        """True if the state is stable after and not before."""
        return self.unstable_after == 0 < self.unstable_before

    @property
    def stability(self) -> Literal["lost", "gained", "unchanged"]:
        """Change of the state's stability, in the direction of following."""
        return "lost" if self.loses else "gained" if self.gains else "unchanged"


@dataclass(frozen=True)
class Branch(Generic[S]):
    """States along a parameter, in the order in which they were followed.

    Attributes
    ----------
    parameter : str
        Name of the parameter.
    values : ndarray of shape (m,)
        Its values.
    states : tuple of State
        The states, m of them.
    bifurcations : tuple of Bifurcation
        Bifurcations between the states.
    complete : bool
        True if the branch reached the value that was asked for.
    onset : float or None
        The value at the Hopf point of the straight state, if the branch was followed from there:
        its first state lies a little off that point.
    """

    parameter: str
    values: Array
    states: tuple[S, ...]
    bifurcations: tuple[Bifurcation[S], ...]
    complete: bool
    onset: float | None = None

    @property
    def criticality(self) -> Literal["subcritical", "supercritical"] | None:
        """Direction in which the branch leaves the onset; None if it was not followed from there.

        A subcritical branch exists below the onset first, a supercritical one beyond it only.
        """
        if self.onset is None or len(self.values) < 2:
            return None
        return "subcritical" if self.values[1] < self.values[0] else "supercritical"
