"""Continuation on curves that are known: folds, ends, domains, and how well points are solved."""

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import islice, pairwise
from typing import Self

import numpy as np
import pytest

from undula.arrays import Array
from undula.errors import InputError
from undula.numerics.continuation.arclength import (
    Point,
    Steps,
    advance,
    solve_at,
    trace,
    with_tangent,
)
from undula.numerics.continuation.locate import locate
from undula.numerics.continuation.problem import DenseLinear, Evaluation

EVERYWHERE = (-np.inf, np.inf)


@dataclass(frozen=True)
class Curve:
    """A curve f(u, p) = 0, given with its gradient, beside an unknown that is to be u^2.

    It is defined for u within `domain`; residuals at each evaluation are noted.
    """

    function: Callable[[float, float], float]
    gradient: Callable[[float, float], tuple[float, float]]
    domain: tuple[float, float] = EVERYWHERE
    noted: list[float] = field(default_factory=list)
    weights = np.array([1.0, 0.0])

    def evaluate(self, u: Array, p: float) -> Evaluation:
        if not self.domain[0] <= u[0] <= self.domain[1]:
            raise InputError(f"u = {u[0]} is not within {self.domain}")
        by_u, by_p = self.gradient(u[0], p)
        residual = np.array([self.function(u[0], p), u[1] - u[0] ** 2])
        self.noted.append(float(np.linalg.norm(residual)))
        matrix = np.array([[by_u, 0.0], [-2.0 * u[0], 1.0]])
        return Evaluation(residual, DenseLinear(matrix), np.array([by_p, 0.0]))

    def with_reference(self, u: Array) -> Self:  # noqa: ARG002
        return self

    def at(self, u: float, p: float, upwards: float = 1.0, scale: float = 1.0) -> Point:
        """Return the point (u, p), headed to larger or smaller p."""
        flat = Point(np.array([u, u * u]), p, np.zeros(2), upwards)
        return with_tangent(self, flat, scale)


def fold(domain: tuple[float, float] = EVERYWHERE) -> Curve:
    """p = u^2, with a fold at 0."""
    return Curve(lambda u, p: p - u * u, lambda u, _: (-2.0 * u, 1.0), domain)


def cubic() -> Curve:
    """p = u^3 - u, with folds at u = -1/sqrt(3) and 1/sqrt(3)."""
    return Curve(lambda u, p: u**3 - u - p, lambda u, _: (3.0 * u * u - 1.0, -1.0))


def circle() -> Curve:
    return Curve(lambda u, p: u * u + p * p - 1.0, lambda u, p: (2.0 * u, 2.0 * p))


def pitchfork() -> Curve:
    """u = 0, and p = u^2."""
    return Curve(lambda u, p: p * u - u**3, lambda u, p: (p - 3.0 * u * u, u))


def cube(u: float) -> float:
    return u**3 - u


def followed(curve: Curve, start: Point, ends: tuple[float, float], **steps: float) -> list[Point]:
    points = [start, *islice(trace(curve, start, Steps(**steps), ends), 500)]
    for point in points:
        # Newton's method ends at round-off.
        assert abs(curve.function(point.u[0], point.p)) < 1e-13
        assert point.u[1] == pytest.approx(point.u[0] ** 2, abs=1e-13)
    return points


def folds(curve: Curve, points: list[Point], scale: float = 1.0) -> list[Point]:
    pairs = [pair for pair in pairwise(points) if pair[0].tangent_p * pair[1].tangent_p < 0.0]
    found = [locate(curve, *pair, lambda point: point.tangent_p, scale, 1e-9) for pair in pairs]
    assert None not in found
    return [point for point in found if point is not None]


def test_a_fold_is_passed_and_located() -> None:
    curve = fold()
    points = followed(curve, curve.at(1.0, 1.0, -1.0), (-1.0, 1.0))
    assert points[-1].p == 1.0
    assert points[-1].u[0] == pytest.approx(-1.0, abs=1e-13)
    (turn,) = folds(curve, points)
    assert turn.p == pytest.approx(0.0, abs=1e-9)
    # The place on the branch is located to 1e-9, and the tangent is that of the last step but one.
    assert turn.u[0] == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("scale", [0.1, 1.0, 30.0])
@pytest.mark.parametrize("first", [1e-3, 0.05, 0.4])
def test_both_folds_of_a_cubic_are_passed_whatever_the_steps(scale: float, first: float) -> None:
    curve = cubic()
    start = curve.at(-1.5, cube(-1.5), scale=scale)
    points = followed(curve, start, (-5.0, 2.0), first=first, scale=scale)
    assert points[-1].p == 2.0
    assert np.all(np.diff([point.u[0] for point in points]) > 0.0)
    turns = folds(curve, points, scale)
    height = 2.0 / np.sqrt(27.0)
    np.testing.assert_allclose([turn.p for turn in turns], [height, -height], atol=1e-9)


@pytest.mark.parametrize("beyond", [1e-1, 1e-2, 1e-3, 1e-5])
def test_an_end_just_beyond_a_fold_does_not_make_it_jump_to_another_branch(beyond: float) -> None:
    curve = cubic()
    end = 2.0 / np.sqrt(27.0) + beyond
    points = followed(curve, curve.at(-1.5, cube(-1.5)), (-5.0, end))
    lengths = np.hypot(*np.diff([(point.u[0], point.p) for point in points], axis=0).T)
    # A step is at most 1/2, and no chord is longer than the step over the cosine of the turn.
    assert lengths.max() < 1.0
    assert len(folds(curve, points)) == 2


@pytest.mark.parametrize("before", [1e-1, 1e-2, 1e-3, 1e-6])
def test_a_branch_ends_at_an_end_just_before_a_fold(before: float) -> None:
    curve = fold()
    points = followed(curve, curve.at(1.0, 1.0, -1.0), (before, 2.0))
    assert points[-1].p == before
    assert points[-1].u[0] == pytest.approx(np.sqrt(before), abs=1e-9)


def test_a_closed_curve_is_gone_round_and_round() -> None:
    curve = circle()
    points = followed(curve, curve.at(1.0, 0.0), (-2.0, 2.0))
    turned = np.unwrap([np.arctan2(point.p, point.u[0]) for point in points])
    assert len(points) == 501
    assert np.all(np.diff(turned) > 0.0)
    for turn in folds(curve, points[:60]):
        assert abs(turn.p) == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("ends", [(-0.5, 0.3), (-0.999, 0.999), (0.0, 0.9999999)])
def test_the_last_point_lies_exactly_on_the_end(ends: tuple[float, float]) -> None:
    curve = circle()
    for upwards, end in ((-1.0, ends[0]), (1.0, ends[1])):
        points = followed(curve, curve.at(1.0, 0.0, upwards), ends)
        if end == 0.0:
            continue
        assert points[-1].p == end
        assert all(ends[0] < point.p < ends[1] for point in points[1:-1])
        assert points[-1].u[0] == pytest.approx(np.sqrt(1.0 - end * end), rel=1e-6)


@pytest.mark.parametrize("end", [1.1, 1.5, 3.0, 17.123])
def test_an_end_that_the_branch_bends_beyond_is_met_exactly(end: float) -> None:
    # p = 1 + u^4 turns ever more towards p: a step may end beyond what its tangent foretells.
    curve = Curve(lambda u, p: p - 1.0 - u**4, lambda u, _: (-4.0 * u**3, 1.0))
    points = followed(curve, curve.at(0.3, 1.0 + 0.3**4), (0.0, end), first=0.5, most=2.0)
    assert points[-1].p == end
    assert points[-1].u[0] == pytest.approx((end - 1.0) ** 0.25, rel=1e-12)


def test_a_symmetric_branch_goes_straight_on_through_a_pitchfork() -> None:
    curve = pitchfork()
    points = followed(curve, curve.at(0.0, -1.03), (-2.0, 1.0))
    assert points[-1].p == 1.0
    assert all(point.u[0] == 0.0 for point in points)


@pytest.mark.parametrize("first", [0.25, 0.5, 1.0])
def test_a_step_onto_a_pitchfork_itself_is_a_failure_that_is_got_over(first: float) -> None:
    curve = pitchfork()
    points = followed(curve, curve.at(0.0, -1.0), (-2.0, 1.0), first=first, most=first)
    assert points[-1].p == 1.0


def test_a_zero_at_a_branch_point_is_located_beside_it() -> None:
    curve = pitchfork()
    one, other = curve.at(0.0, -1.0), curve.at(0.0, 1.0)
    found = locate(curve, one, other, lambda point: point.p, 1.0, 1e-9)
    assert found is not None
    assert abs(found.p) <= 2e-9


def test_the_bent_branch_of_a_pitchfork_is_followed_round_its_turn() -> None:
    curve = pitchfork()
    points = followed(curve, curve.at(1.0, 1.0, -1.0), (-1.0, 1.0))
    assert points[-1].u[0] == pytest.approx(-1.0, abs=1e-12)
    assert all(point.p == pytest.approx(point.u[0] ** 2, abs=1e-12) for point in points)


@pytest.mark.parametrize("length", [-0.4, -1e-3, 1e-3, 0.1, 0.4])
@pytest.mark.parametrize("scale", [0.1, 1.0, 10.0])
def test_a_point_is_as_far_along_the_tangent_as_it_was_asked_to_be(
    length: float, scale: float
) -> None:
    curve = cubic()
    start = curve.at(-1.0, 0.0, scale=scale)
    norm = start.tangent[0] ** 2 + (start.tangent_p / scale) ** 2
    assert norm == pytest.approx(1.0, rel=1e-14)
    reached = advance(curve, start, length, scale)
    assert reached is not None
    along = start.tangent[0] * (reached.u[0] - start.u[0])
    along += start.tangent_p * (reached.p - start.p) / scale**2
    assert along == pytest.approx(length, rel=1e-12)
    # The tangent is that of the curve, du : dp = 1 : 3 u^2 - 1, and keeps its direction.
    slope = reached.tangent_p / reached.tangent[0]
    assert slope == pytest.approx(3.0 * reached.u[0] ** 2 - 1.0, rel=1e-6)
    assert reached.tangent[0] > 0.0


@pytest.mark.parametrize(
    ("curve", "u", "p"),
    [(fold(), 1.0, 1.0), (cubic(), -1.0, 0.0), (circle(), 0.6, 0.8)],
    ids=["fold", "cubic", "circle"],
)
def test_convergence_is_quadratic(curve: Curve, u: float, p: float) -> None:
    start = curve.at(u, p)
    curve.noted.clear()
    reached = advance(curve, start, 0.4, 1.0)
    assert reached is not None
    curve.evaluate(reached.u, reached.p)
    left = np.array(curve.noted)
    # Curvatures are below 10, and residuals end at round-off.
    assert len(left) >= 4
    assert np.all(left[1:] < 10.0 * left[:-1] ** 2 + 1e-15)
    assert reached.iterations <= 6


def test_a_domain_is_not_left_and_leaving_it_is_no_exception() -> None:
    curve = fold(domain=(0.3, np.inf))
    points = followed(curve, curve.at(1.0, 1.0, -1.0), (0.0, 2.0))
    # The last step tried was shorter than 1e-6.
    assert 0.3 <= points[-1].u[0] < 0.3 + 1e-5
    assert points[-1].p > 0.0
    assert solve_at(curve, np.array([0.5, 0.25]), 0.04) is None
    assert solve_at(curve, np.array([0.1, 0.01]), 0.04) is None
    assert advance(curve, curve.at(1.0, 1.0, -1.0), 5.0, 1.0) is None


def test_an_end_outside_the_domain_is_not_reached() -> None:
    curve = Curve(lambda u, p: u - p, lambda _u, _p: (1.0, -1.0), (-1.0, 1.0))
    points = followed(curve, curve.at(0.0, 0.0), (0.0, 3.0))
    assert 1.0 - 1e-5 < points[-1].p <= 1.0


def test_what_is_singular_has_no_solution() -> None:
    assert solve_at(fold(), np.zeros(2), 1.0) is None
    assert solve_at(fold(), np.array([0.3, 0.0]), -1.0) is None


@pytest.mark.parametrize("place", [-0.31, 0.0, 0.2, 0.77])
def test_a_zero_of_a_test_function_is_located(place: float) -> None:
    curve = cubic()
    one, other = curve.at(place - 0.2, cube(place - 0.2)), curve.at(place + 0.2, cube(place + 0.2))
    found = locate(curve, one, other, lambda point: np.sinh(point.u[0] - place), 1.0, 1e-9)
    assert found is not None
    # The zero is located in arclength, of which u takes a part.
    assert found.u[0] == pytest.approx(place, abs=1e-9)
    assert found.p == pytest.approx(cube(found.u[0]), abs=1e-13)


def test_a_test_function_is_asked_for_once_at_each_point() -> None:
    curve = cubic()
    one, other = curve.at(-0.2, cube(-0.2)), curve.at(0.2, cube(0.2))
    asked: list[float] = []

    def fickle(point: Point) -> float:
        asked.append(point.u[0])
        # As of an exponent that round-off has spoilt: another sign when asked again.
        return float(point.u[0]) * (-1.0) ** (asked.count(point.u[0]) - 1)

    found = locate(curve, one, other, fickle, 1.0, 1e-9)
    assert found is not None
    assert found.u[0] == pytest.approx(0.0, abs=1e-9)
    assert len(asked) == len(set(asked))


def test_a_test_function_without_a_value_has_no_zero() -> None:
    curve = cubic()
    one, other = curve.at(-0.2, cube(-0.2)), curve.at(0.2, cube(0.2))
    assert locate(curve, one, other, lambda _: np.nan, 1.0, 1e-9) is None


def test_the_step_grows_where_it_is_easy_and_never_beyond_the_most() -> None:
    line = Curve(lambda u, p: u - p, lambda _u, _p: (1.0, -1.0))
    points = followed(line, line.at(0.0, 0.0), (0.0, 10.0), first=1e-3, most=0.7)
    lengths = np.sqrt(2.0) * np.diff([point.p for point in points])
    assert lengths[0] == pytest.approx(1e-3, rel=1e-9)
    assert lengths.max() == pytest.approx(0.7, rel=1e-9)
    assert np.all(np.diff(lengths[:-1]) > -1e-12)
