"""Answers in the limit of many links, from a few numbers of links and the known order.

A quantity of a body that links stand for depends on their number N as q + c / N^2 + d / N^4 + ...
From N, 2 N and 4 N the first two terms are taken off (Romberg's scheme), from 8 N as well the third
where that is needed. What the last one changed is the stated error, which is that of the answer
before it, and so on the safe side.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from undula.analysis.states.records import NotFound
from undula.arrays import Array
from undula.errors import InputError
from undula.models.model import Model

#: Numbers of links relative to the model's own; the last one only if the answer is not good yet.
REFINEMENTS = (1, 2, 4, 8)
# An answer is good if each quantity has this relative error, from so many numbers of links.
_GOOD, _FEWEST = 5e-6, 3

# From so many links on fewer of them tell the error as well.
_MANY = 36

S = TypeVar("S")


def links_are_body(model: Model) -> bool:
    """Tell whether the links of a model are its body, so that they have no limit."""
    return model.with_links(2 * model.links) is None


def error_of_links(
    model: Model, value: float, again: Callable[[Model], float | None]
) -> float | None:
    """Return the error of a number against the body that links stand for, from others.

    They are two thirds as many, or twice as many if they are few; the error falls as the square of
    their number, which flapping shows from some 24 on.

    Parameters
    ----------
    model : Model
    value : float
        The number on the links of the model.
    again : callable
        From the same body of other links to the number, None if it is not found.

    Returns
    -------
    float or None
        0 where the links are the body, None if the number is not found again.
    """
    links = model.links
    other_links = 2 * links // 3 if links >= _MANY else 2 * links
    other = model.with_links(other_links)
    if other is None:
        return 0.0
    found = again(other)
    return None if found is None else abs(found - value) / abs((links / other_links) ** 2 - 1.0)


@dataclass(frozen=True)
class Converged(Generic[S]):
    """Quantities of a state in the limit of many links.

    Attributes
    ----------
    finest : object
        The state with the most links.
    links : tuple of int
        The numbers of links that were used.
    values, errors : mapping of str to float
        Each quantity extrapolated, and its estimated error.
    """

    finest: S
    links: tuple[int, ...]
    values: Mapping[str, float]
    errors: Mapping[str, float]


def converge(
    model: Model,
    solve: Callable[[Model, S | None], S | NotFound],
    quantities: Callable[[S], Mapping[str, float]],
) -> Converged[S] | NotFound:
    """Solve a question with more and more links, and extrapolate what it gives.

    Parameters
    ----------
    model : Model
        The model with the fewest links.
    solve : callable
        From a model, and the answer for fewer links, to the answer or to none.
    quantities : callable
        From an answer to the numbers of interest.

    Raises
    ------
    InputError
        The links of the model are its body, so that there is no limit.
    """
    answers: list[S] = []
    limits: dict[str, tuple[float, float]] = {}
    for refinement in REFINEMENTS:
        finer = model.with_links(refinement * model.links)
        if finer is None:
            raise InputError(
                "the links of this model are its body: there is nothing to converge to; leave"
                " converge out"
            )
        found = solve(finer, answers[-1] if answers else None)
        if isinstance(found, NotFound):
            return found
        answers.append(found)
        rows = [quantities(answer) for answer in answers]
        limits = {name: extrapolated([row[name] for row in rows]) for name in rows[0]}
        if len(answers) >= _FEWEST and _are_good(limits):
            break
    return Converged(
        finest=answers[-1],
        links=tuple(refinement * model.links for refinement in REFINEMENTS[: len(answers)]),
        values={name: value for name, (value, _) in limits.items()},
        errors={name: error for name, (_, error) in limits.items()},
    )


def _are_good(limits: Mapping[str, tuple[float, float]]) -> bool:
    # Growth rates pass through 0, where nothing is good to a share of itself.
    return all(
        error <= _GOOD * abs(value)
        for name, (value, error) in limits.items()
        if not name.startswith("leading_rate")
    )


def extrapolated(values: Sequence[float]) -> tuple[float, float]:
    """Return the limit of values at N, 2 N, 4 N, ... with its estimated error."""
    column: Array = np.asarray(values, dtype=float)
    before = column
    for order in range(2, 2 * len(values), 2):
        before, column = column, column[1:] + np.diff(column) / (2.0**order - 1.0)
    return float(column[-1]), float(abs(column[-1] - before[-1]))
