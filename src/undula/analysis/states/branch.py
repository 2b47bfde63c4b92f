"""Records of a branch of states along a parameter and of its bifurcations."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar, Generic, Literal, SupportsIndex, TypeVar, overload

import numpy as np
import pandas as pd
import xarray as xr

from undula.analysis.record import Fact, Record
from undula.analysis.states.state import State
from undula.arrays import Array

S = TypeVar("S", bound=State)


@dataclass(frozen=True, repr=False)
class Bifurcation(Record, Generic[S]):
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
    def name(self) -> str:
        """Kind of the state and its change of stability, as "spinning-lost"."""
        return f"{self.state.kind}-{self.stability}"

    def facts(self) -> dict[str, Fact]:
        """Return kind, value and frequencies by name."""
        return {
            "kind": Fact(self.kind),
            "stability": Fact(self.stability),
            "value": Fact(self.value, "", self.error, self.state.model.links),
            "frequency": Fact(self.frequency, "cycles per T"),
            "second_frequency": Fact(self.second_frequency, "cycles per T"),
        }

    def __str__(self) -> str:
        """Return kind, value with its error on these links, and change of stability."""
        return (
            f"{self.kind} at {self.value:.10g} ({self.state.model.links} links, located to"
            f" {self.error:.1g}), stability {self.stability}, {self.frequency:.8g} cycles per T"
        )

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


class Bifurcations(tuple[Bifurcation[S], ...]):
    """Bifurcations in the order of following, by number or by name.

    A name is the kind of bifurcation, as "torus", or the kind of the state with its change of
    stability, as "spinning-lost"; it stands for the first of that name.
    """

    __slots__ = ()

    @overload
    def __getitem__(self, key: SupportsIndex) -> Bifurcation[S]: ...
    @overload
    def __getitem__(self, key: slice) -> tuple[Bifurcation[S], ...]: ...
    @overload
    def __getitem__(self, key: str) -> Bifurcation[S]: ...
    def __getitem__(self, key: Any) -> Any:
        """Return a bifurcation by its number or name, or several by a slice."""
        if not isinstance(key, str):
            return super().__getitem__(key)
        for bifurcation in self:
            if key in (bifurcation.kind, bifurcation.name):
                return bifurcation
        names = ", ".join(f"{point.name} ({point.kind})" for point in self) or "none"
        raise KeyError(f"{key}; on this branch there are: {names}")


@dataclass(frozen=True, repr=False)
class Branch(Record, Generic[S]):
    """States along a parameter, in the order in which they were followed; a sequence of them.

    Attributes
    ----------
    parameter : str
        Name of the parameter.
    values : ndarray of shape (m,)
        Its values.
    states : tuple of State
        The states, m of them.
    bifurcations : Bifurcations
        Bifurcations between the states, by number or name.
    complete : bool
        True if the branch reached the value that was asked for.
    onset : float or None
        The value at the Hopf point of the straight state, if the branch was followed from there:
        its first state lies a little off that point.
    """

    parameter: str
    values: Array
    states: tuple[S, ...]
    bifurcations: "Bifurcations[S]"
    complete: bool
    onset: float | None = None

    _figure: ClassVar[str] = "undula.views.records.states:branch_figure"

    def __post_init__(self) -> None:
        """Make the bifurcations known by their names."""
        object.__setattr__(self, "bifurcations", Bifurcations(self.bifurcations))

    def __len__(self) -> int:
        """Return the number of states."""
        return len(self.states)

    def __getitem__(self, index: int) -> S:
        """Return a state by its number."""
        return self.states[index]

    def __iter__(self) -> Iterator[S]:
        """Return the states in their order."""
        return iter(self.states)

    def facts(self) -> dict[str, Fact]:
        """Return ends, number of states and bifurcations by name."""
        return {
            "kind": Fact(self.states[0].kind),
            "parameter": Fact(self.parameter),
            "from": Fact(float(self.values[0])),
            "to": Fact(float(self.values[-1])),
            "states": Fact(len(self)),
            "complete": Fact(self.complete),
            **{
                f"{point.name} ({point.kind})": Fact(
                    point.value, "", point.error, point.state.model.links
                )
                for point in self.bifurcations
            },
        }

    def to_dataframe(self) -> pd.DataFrame:
        """Return a row for each state: the parameter and all numbers of the state."""
        rows = [{name: fact.value for name, fact in state.facts().items()} for state in self]
        table = pd.DataFrame(rows)
        if self.parameter not in table:
            table.insert(0, self.parameter, self.values)
        return table

    def to_xarray(self) -> xr.Dataset:
        """Return the numbers of all states along the parameter, as a dataset."""
        units = {name: fact.unit for name, fact in self.states[0].facts().items()}
        table = self.to_dataframe().drop(columns=self.parameter)
        columns = {
            str(name): ("point", np.asarray(column), {"units": units.get(str(name), "")})
            for name, column in table.items()
        }
        along = {"value": ("point", self.values, {"long_name": self.parameter})}
        return xr.Dataset(columns, coords=along)

    def __str__(self) -> str:
        """Return ends and bifurcations in one line."""
        ends = f"{self.values[0]:.6g} to {self.values[-1]:.6g}"
        stop = "" if self.complete else ", stopped early"
        points = [f"{p.kind} at {p.value:.8g} (to {p.error:.1g})" for p in self.bifurcations[:2]]
        more = len(self.bifurcations) - 2
        points += [f"{more} more"] if more > 0 else []
        found = "; ".join(points) if points else "no bifurcation"
        return (
            f"{self.states[0].kind} along {self.parameter} from {ends}, {len(self)} states of"
            f" {self.states[0].model.links} links{stop}:"
            f" {found}"
        )

    @property
    def criticality(self) -> Literal["subcritical", "supercritical"] | None:
        """Direction in which the branch leaves the onset; None if it was not followed from there.

        A subcritical branch exists below the onset first, a supercritical one beyond it only.
        """
        if self.onset is None or len(self.values) < 2:
            return None
        return "subcritical" if self.values[1] < self.values[0] else "supercritical"
