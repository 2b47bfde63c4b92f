"""The limit of many links: extrapolation, its order, and the error that is stated."""

from dataclasses import dataclass
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from refusal import complaint
from undula.analysis.solvers.quantities import quantities_of
from undula.analysis.solvers.spinning import find_spinning
from undula.analysis.solvers.state_kinds import extrapolate, with_error
from undula.analysis.states.extrapolation import Converged, converge, extrapolated
from undula.analysis.states.not_found import NotFound, SearchStatus
from undula.analysis.states.records import Spinning
from undula.models.filament import Filament
from undula.models.loads.analytic import LinearLoad, Load, TipLoad

COEFFICIENTS = st.floats(-10.0, 10.0)


@given(q=COEFFICIENTS, c=COEFFICIENTS, d=COEFFICIENTS, links=st.integers(1, 20))
def test_two_terms_are_taken_off_exactly_by_three_values(
    q: float, c: float, d: float, links: int
) -> None:
    many = links * np.array([1.0, 2.0, 4.0])
    found, error = extrapolated(q + c / many**2 + d / many**4)
    # Round-off of values up to 30, times the weights of the scheme.
    assert found == pytest.approx(q, abs=1e-13)
    # What is stated is the error of the answer from two values: -d / 4 / (2 N)^4.
    assert error == pytest.approx(abs(d) / 4.0 / (2.0 * links) ** 4, abs=1e-13)


@given(q=COEFFICIENTS, c=COEFFICIENTS, d=COEFFICIENTS, e=COEFFICIENTS)
def test_each_further_value_takes_off_one_term(q: float, c: float, d: float, e: float) -> None:
    many = 3.0 * 2.0 ** np.arange(4)
    values = q + c / many**2 + d / many**4 + e / many**6
    assert extrapolated(values)[0] == pytest.approx(q, abs=1e-13)
    assert extrapolated(values[:1]) == (values[0], 0.0)


@pytest.mark.parametrize("values", [2, 3, 4])
def test_the_order_of_the_limit_grows_by_two_with_each_value(values: int) -> None:
    # A smooth function of 1 / N^2 with all its terms.
    links = np.array([4.0, 8.0, 16.0, 32.0])
    errors = []
    for n in links:
        many = n * 2.0 ** np.arange(values)
        errors.append(abs(extrapolated(1.0 / (1.0 + 3.0 / many**2))[0] - 1.0))
    # The next term is a few per cent at the fewest links.
    seen = np.array(errors) > 1e-14
    order = -np.polyfit(np.log(links[seen]), np.log(np.array(errors)[seen]), 1)[0]
    assert order == pytest.approx(2.0 * values, abs=0.15 * values)


@dataclass(frozen=True)
class Body:
    """A body of so many links, that can be made of any number of them, or of no other."""

    links: int
    fixed: bool = False

    def with_links(self, links: int) -> "Body | None":
        return None if self.fixed else Body(links)


def numbers(links: int) -> dict[str, float]:
    return {"plain": 3.0 + 7.0 / links**2 - 4.0 / links**4, "even": -2.0 + 0.5 / links**2}


def rough_numbers(links: int) -> dict[str, float]:
    return {"plain": 3.0 + 7.0 / links**2 - 4.0 / links**4 + 1e7 / links**6}


def test_answers_for_fewer_links_are_passed_on_and_all_quantities_extrapolated() -> None:
    asked: list[tuple[int, int | None]] = []

    def solve(model: Body, coarser: int | None) -> int:
        asked.append((model.links, coarser))
        return model.links

    found = converge(Body(10), solve, numbers)  # type: ignore[arg-type, type-var]
    assert isinstance(found, Converged)
    assert asked[0] == (10, None)
    assert all(here[1] == before[0] for before, here in pairwise(asked))
    assert found.links == tuple(links for links, _ in asked) == (10, 20, 40)
    assert found.finest == 40
    assert found.values == pytest.approx({"plain": 3.0, "even": -2.0}, rel=1e-13)
    assert found.errors["even"] < 1e-15


def test_more_links_are_asked_for_where_the_answer_is_not_good_yet() -> None:
    def solve(model: Body, coarser: int | None) -> int:  # noqa: ARG001
        return model.links

    found = converge(Body(10), solve, rough_numbers)  # type: ignore[arg-type, type-var]
    assert isinstance(found, Converged)
    assert found.links == (10, 20, 40, 80)
    # The third term is taken off by the fourth value, but for the round-off of 10.
    assert found.values["plain"] == pytest.approx(3.0, rel=1e-13)


def test_a_search_that_finds_nothing_is_passed_on() -> None:
    nothing = NotFound(SearchStatus.ABSENT, "there is nothing")

    def solve(model: Body, coarser: int | None) -> int | NotFound:  # noqa: ARG001
        return nothing if model.links > 10 else model.links

    assert converge(Body(10), solve, numbers) is nothing  # type: ignore[arg-type, type-var]


def test_a_body_that_is_its_links_has_no_limit() -> None:
    def solve(model: Body, coarser: int | None) -> int:  # noqa: ARG001
        return model.links

    fixed = Body(10, fixed=True)
    told = complaint(lambda: converge(fixed, solve, numbers))  # type: ignore[arg-type, type-var]
    assert "leave converge out" in told


# ---------------------------------------------------------------- spinning states

LOADS: list[Load] = [TipLoad(40.0), TipLoad(75.0), TipLoad(150.0), LinearLoad(110.0, 0.0)]
every_load = pytest.mark.parametrize("load", LOADS, ids=repr)


@cache
def solved(load: Load, segments: int) -> Spinning:
    found = find_spinning(Filament(segments, load))
    assert isinstance(found, Spinning)
    return found


@cache
def limit(load: Load, segments: int) -> Converged[Spinning]:
    found = extrapolate(Filament(segments, load), "spinning")
    assert isinstance(found, Converged)
    return found


# Under a tip load of 150 the first term of the energy, -0.1 / N^2, is so small that the next one
# is of its size with 20 links.
@pytest.mark.parametrize(
    ("load", "name"),
    [
        *((load, "frequency") for load in LOADS),
        *((load, "bending_energy") for load in LOADS if load != TipLoad(150.0)),
    ],
)
def test_the_error_of_a_state_falls_as_the_square_of_the_number_of_links(
    load: Load, name: str
) -> None:
    links = np.array([20, 40, 80, 160])
    values = np.array([quantities_of(solved(load, int(segments)))[name] for segments in links])
    differences = np.abs(np.diff(values))
    order = -np.polyfit(np.log(links[:-1]), np.log(differences), 1)[0]
    assert order == pytest.approx(2.0, abs=0.15)


@every_load
@pytest.mark.parametrize("segments", [10, 16])
def test_the_stated_error_covers_the_difference_to_a_finer_extrapolation(
    load: Load, segments: int
) -> None:
    coarse, fine = limit(load, segments), limit(load, 40)
    assert coarse.values.keys() == fine.values.keys() >= {"frequency", "bending_energy"}
    for name, value in coarse.values.items():
        difference = abs(value - fine.values[name])
        # Round-off of exponents comes on top.
        assert difference <= coarse.errors[name] + fine.errors[name] + 1e-9 * abs(value), name
        # Nor is it so wide that it says nothing.
        assert coarse.errors[name] < 0.02 * abs(value), name


@every_load
@pytest.mark.parametrize("segments", [9, 20, 40])
def test_the_error_of_a_single_state_is_near_its_distance_from_the_limit(
    load: Load, segments: int
) -> None:
    state = with_error(solved(load, segments))
    assert state.error is not None
    away = abs(state.frequency - limit(load, 40).values["frequency"])
    # Terms beyond the first of the expansion, at two thirds of the links.
    assert state.error == pytest.approx(away, rel=0.4 if segments >= 20 else 1.0)


def test_nothing_converges_where_there_is_no_state() -> None:
    assert isinstance(extrapolate(Filament(8, TipLoad(20.0)), "spinning"), NotFound)


def test_another_kind_of_state_is_refused() -> None:
    assert "'resting'" in complaint(lambda: extrapolate(Filament(8, TipLoad(75.0)), "resting"))
