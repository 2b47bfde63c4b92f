"""Extrapolation to the limit of many links, from a few numbers of links and the known order.

A quantity of a body that links stand for depends on their number N as q + c / N^2 + d / N^4 + ...
Romberg's scheme removes the first two terms with N, 2 N and 4 N links, and the third with 8 N where
that is needed. The error is estimated by the change in the last step of the scheme, which is about
the error of the value before that step and thus an upper estimate.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np
import pandas as pd

from undula.analysis.record import Fact, Record
from undula.analysis.states.not_found import NotFound
from undula.arrays import Array
from undula.errors import InputError
from undula.models.model import Model

#: Numbers of links relative to the model's own; the last one only if the error is too large before.
REFINEMENTS = (1, 2, 4, 8)
# Largest relative error of a quantity at which refinement ends, and the fewest refinements.
_TOLERANCE, _FEWEST = 5e-6, 3

# Number of links from which on the error is estimated by a solution on fewer links; below it, by
# one on more links.
_MANY_LINKS = 36

S = TypeVar("S")


def links_are_body(model: Model) -> bool:
    """Return whether the links of a model are its body, so that they have no limit."""
    return model.with_links(2 * model.links) is None


def error_of_links(
    model: Model, value: float, again: Callable[[Model], float | None]
) -> float | None:
    """Return the error of a quantity against the body that links stand for, from other links.

    The other body has two thirds as many links, or twice as many if they are few. The error falls
    as the inverse square of their number, for flapping from some 24 links on.

    Parameters
    ----------
    model : Model
        Model of the filament or chain, with the links of the value.
    value : float
        The quantity on the links of the model.
    again : callable
        Returns the quantity for the same body on other links; None if it is not found.

    Returns
    -------
    float or None
        0 where the links are the body, None if the quantity is not found again.
    """
    links = model.links
    other_links = 2 * links // 3 if links >= _MANY_LINKS else 2 * links
    other = model.with_links(other_links)
    if other is None:
        return 0.0
    other_value = again(other)
    if other_value is None:
        return None
    return abs(other_value - value) / abs((links / other_links) ** 2 - 1.0)


@dataclass(frozen=True, repr=False)
class Converged(Record, Generic[S]):
    """Quantities of a state in the limit of many links.

    Attributes
    ----------
    finest : object
        The state with the most links.
    links : tuple of int
        The numbers of links that were used.
    values, errors : mapping of str to float
        Each quantity extrapolated, and its estimated error, by name.
    """

    finest: S
    links: tuple[int, ...]
    values: Mapping[str, float]
    errors: Mapping[str, float]

    def facts(self) -> dict[str, Fact]:
        """Return the quantities with their errors by name."""
        return {name: Fact(value, "", self.errors[name]) for name, value in self.values.items()}

    def to_dataframe(self) -> pd.DataFrame:
        """Return a row for each quantity: value and error."""
        return pd.DataFrame({"value": dict(self.values), "error": dict(self.errors)})

    def __str__(self) -> str:
        """Return the first quantity with its error, and the numbers of links, in one line."""
        name, value = next(iter(self.values.items()))
        links = ", ".join(map(str, self.links))
        return f"{name} {value:.10g} ± {self.errors[name]:.1g} in the limit of {links} links"


def converge(
    model: Model,
    solve: Callable[[Model, S | None], S | NotFound],
    quantities: Callable[[S], Mapping[str, float]],
) -> Converged[S] | NotFound:
    """Return quantities of a solution in the limit of many links.

    Parameters
    ----------
    model : Model
        The model with the fewest links.
    solve : callable
        From a model, and the solution for fewer links or None, to the solution or `NotFound`.
    quantities : callable
        From a solution to the quantities of interest, by name.

    Returns
    -------
    Converged or NotFound
        The latter as soon as a solution is not found.

    Raises
    ------
    InputError
        The links of the model are its body, so that there is no limit.
    """
    solutions: list[S] = []
    limits: dict[str, tuple[float, float]] = {}
    for refinement in REFINEMENTS:
        finer = model.with_links(refinement * model.links)
        if finer is None:
            raise InputError(
                "the links of this model are its body: there is nothing to converge to; leave"
                " converge out"
            )
        solution = solve(finer, solutions[-1] if solutions else None)
        if isinstance(solution, NotFound):
            return solution
        solutions.append(solution)
        rows = [quantities(solution) for solution in solutions]
        limits = {name: extrapolated([row[name] for row in rows]) for name in rows[0]}
        if len(solutions) >= _FEWEST and _are_accurate(limits):
            break
    return Converged(
        finest=solutions[-1],
        links=tuple(refinement * model.links for refinement in REFINEMENTS[: len(solutions)]),
        values={name: value for name, (value, _) in limits.items()},
        errors={name: error for name, (_, error) in limits.items()},
    )


def _are_accurate(limits: Mapping[str, tuple[float, float]]) -> bool:
    # Growth rates pass through 0, where no relative error is small.
    return all(
        error <= _TOLERANCE * abs(value)
        for name, (value, error) in limits.items()
        if not name.startswith("leading_rate")
    )


def extrapolated(values: Sequence[float]) -> tuple[float, float]:
    """Return the limit of values at N, 2 N, 4 N, ... links, and its estimated error."""
    column: Array = np.asarray(values, dtype=float)
    previous = column
    for order in range(2, 2 * len(values), 2):
        previous, column = column, column[1:] + np.diff(column) / (2.0**order - 1.0)
    return float(column[-1]), float(abs(column[-1] - previous[-1]))
