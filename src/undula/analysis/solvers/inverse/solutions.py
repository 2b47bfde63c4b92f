"""Answers of an inverse question as records: each solution, and all of them as a sequence."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, overload

import numpy as np
import pandas as pd
import xarray as xr

from undula.analysis.record import Fact, Record
from undula.analysis.solvers.state_kinds import Solved
from undula.analysis.solvers.threshold_record import Threshold

# Largest number of characters of a record in one line.
_LONGEST_LINE = 200


@dataclass(frozen=True, repr=False, eq=False)
class Solution(Record):
    """A value of a parameter at which a quantity of a state or of a threshold has its target.

    Attributes
    ----------
    parameter : str
        Name of the parameter.
    value : float
        Its value, in its unit, on the links of the model.
    error : float or None
        Estimated error of the value against the body that the links stand for, of links and solver
        together; None if it could not be estimated.
    solver_error : float
        Estimated error of the value on these links.
    quantity : str
        Name of the quantity.
    target : float
        The value that it was to have.
    slope : float
        Derivative of the quantity by the parameter along the branch, in their units.
    links : int or None
        Number of links on which it was solved for; None for a threshold of the continuum.
    state : Spinning, Flapping, Equilibrium, Periodic or None
        The state there, of a threshold the one at the bifurcation; None for the straight state.
    threshold : Threshold or None
        The threshold there, if the question was for one.

    Examples
    --------
    >>> import undula as un
    >>> model = un.Filament(8, un.TipLoad(75.0))
    >>> question = {"tip_radius": 0.4, "by": "load.force", "between": (40, 60)}
    >>> solution = un.solve_for(model, "spinning", **question)[0]
    >>> solution.state.kind, round(solution.state.tip_radius.mean, 8)
    ('spinning', 0.4)
    """

    parameter: str
    value: float
    error: float | None
    solver_error: float
    quantity: str
    target: float
    slope: float
    links: int | None
    state: Solved | None
    threshold: Threshold | None = None

    def __str__(self) -> str:
        """Return the value with its error, and the state there, in one line."""
        error = "" if self.error is None else f" ± {self.error:.1g}"
        links = ""
        if self.links is not None and self.error != self.solver_error:
            links = f" ({self.links} links, solved to {self.solver_error:.1g})"
        return _line(f"{self.parameter} = {self.value:.10g}{error}{links}: {self.motion}")

    def facts(self) -> dict[str, Fact]:
        """Return parameter, value, errors, target and slope by name."""
        return {
            "parameter": Fact(self.parameter),
            "value": Fact(self.value, "", self.error),
            "solver_error": Fact(self.solver_error),
            "quantity": Fact(self.quantity),
            "target": Fact(self.target),
            "slope": Fact(self.slope),
            "links": Fact("continuum" if self.links is None else self.links),
        }

    @property
    def motion(self) -> str:
        """State or threshold with its quantity, and its stability unless that is the target."""
        wanted = f"{self.quantity} {self.target:.8g}"
        if self.threshold is not None:
            return f"{self.threshold.kind} with {wanted}"
        assert self.state is not None  # a solution is either a threshold or a state
        if self.quantity.startswith("leading_rate"):
            return f"{self.state.kind} with {wanted}"
        return f"{self.state.kind} with {wanted}, {'stable' if self.state.stable else 'unstable'}"


@dataclass(frozen=True, repr=False, eq=False)
class Solutions(Record, Sequence[Solution]):
    """All solutions of an inverse question in a range, by rising value; false without any.

    Attributes
    ----------
    kind : str
        Kind of state, or name of a threshold.
    quantity : str
        Name of the quantity.
    target : float
        The value that it was to have.
    parameter : str
        Name of the parameter.
    between : (float, float)
        Range of the parameter that was searched.
    quantity_range : (float, float) or None
        Least and largest value of the quantity there; None without a state.
    found : tuple of Solution
        The solutions.
    reason : str or None
        Reason for which the target is not met; None if it is.
    not_searched : str or None
        The part of the range that could not be searched, and why; None without such a part.

    Examples
    --------
    >>> import undula as un
    >>> model = un.Filament(8, un.TipLoad(75.0))
    >>> question = {"frequency": 80.0, "by": "load.force", "between": (40, 100)}
    >>> forces = un.solve_for(model, "spinning", **question)
    >>> len(forces), bool(forces), forces[0].state.stable
    (1, True, True)
    """

    kind: str
    quantity: str
    target: float
    parameter: str
    between: tuple[float, float]
    quantity_range: tuple[float, float] | None
    found: tuple[Solution, ...]
    reason: str | None
    not_searched: str | None

    def __len__(self) -> int:
        """Return the number of solutions."""
        return len(self.found)

    def __iter__(self) -> Iterator[Solution]:
        """Return an iterator over the solutions."""
        return iter(self.found)

    @overload
    def __getitem__(self, index: int) -> Solution: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Solution, ...]: ...
    def __getitem__(self, index: Any) -> Any:
        """Return a solution by its position, or a tuple of several."""
        return self.found[index]

    def __str__(self) -> str:
        """Return the solutions, or the reason for which the target is not met, in one line."""
        wanted = f"{self.kind} with {self.quantity} {self.target:.8g}"
        if self.reason is not None:
            return _line(f"no {wanted}: {self.reason}")
        errors = [
            f"{solution.value:.8g}" + ("" if solution.error is None else f" ± {solution.error:.1g}")
            for solution in self.found
        ]
        return _line(f"{wanted} at {self.parameter} = {', '.join(errors)}")

    def facts(self) -> dict[str, Fact]:
        """Return the question, the range, and each solution by name."""
        numbered = {
            f"solution {number}": Fact(solution.value, "", solution.error)
            for number, solution in enumerate(self.found, start=1)
        }
        least, most = self.quantity_range or (None, None)
        return {
            "kind": Fact(self.kind),
            "quantity": Fact(self.quantity),
            "target": Fact(self.target),
            "parameter": Fact(self.parameter),
            "least": Fact(least),
            "largest": Fact(most),
            **numbered,
            "reason": Fact(self.reason or ""),
        }

    def to_xarray(self) -> xr.Dataset:
        """Return values, errors and slopes of the solutions as a dataset, by their number."""
        errors = [np.nan if solution.error is None else solution.error for solution in self.found]
        columns = {
            "value": [solution.value for solution in self.found],
            "error": errors,
            "solver_error": [solution.solver_error for solution in self.found],
            "slope": [solution.slope for solution in self.found],
        }
        about = {"parameter": self.parameter, "quantity": self.quantity, "target": self.target}
        return xr.Dataset(
            {name: ("solution", np.array(column)) for name, column in columns.items()}, attrs=about
        )

    def to_dataframe(self) -> pd.DataFrame:
        """Return a row for each solution."""
        return self.to_xarray().to_dataframe().reset_index()


def _line(text: str) -> str:
    """Return a text, cut to the largest number of characters."""
    return text if len(text) <= _LONGEST_LINE else f"{text[: _LONGEST_LINE - 3]}..."
