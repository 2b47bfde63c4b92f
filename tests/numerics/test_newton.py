"""Newton's method on small problems with known solutions."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Self

import numpy as np
import pytest

from undula.arrays import Array
from undula.numerics.continuation.newton import Convergence, newton
from undula.numerics.continuation.problem import DenseLinear, Evaluation


@dataclass(frozen=True)
class Small:
    """A problem given by its residual and its derivative."""

    function: Callable[[Array, float], Array]
    derivative: Callable[[Array], Array]
    weights: Array

    def evaluate(self, u: Array, p: float) -> Evaluation:
        residual = self.function(u, p)
        return Evaluation(residual, DenseLinear(self.derivative(u)), np.ones(u.size))

    def with_reference(self, u: Array) -> Self:  # noqa: ARG002
        return self


#: A circle of radius p cut by the parabola y = x^2.
CROSSING = Small(
    lambda u, p: np.array([u[0] ** 2 + u[1] ** 2 - p**2, u[1] - u[0] ** 2]),
    lambda u: np.array([[2.0 * u[0], 2.0 * u[1]], [-2.0 * u[0], 1.0]]),
    np.array([0.5, 0.5]),
)


def scalar(function: Callable[[float], float], derivative: Callable[[float], float]) -> Small:
    return Small(
        lambda u, p: np.array([function(u[0]) - p]),
        lambda u: np.array([[derivative(u[0])]]),
        np.ones(1),
    )


def test_convergence_is_quadratic_and_ends_at_round_off() -> None:
    found = newton(CROSSING, np.array([1.3, 1.0]), 2.0)
    assert found.has_converged
    height = 0.5 * (np.sqrt(17.0) - 1.0)
    np.testing.assert_allclose(found.u, [np.sqrt(height), height], rtol=1e-15)
    steps = np.array(found.steps)
    # A step is about the curvature over the slope, below 1 here, times the square of the last.
    assert len(steps) >= 4
    assert np.all(steps[1:] < steps[:-1] ** 2 + 1e-15)
    assert found.residual < 1e-14


def test_a_step_that_overshoots_is_cut_until_the_residual_falls() -> None:
    # Undamped, the method diverges from |u| > 1.39.
    arctangent = scalar(np.arctan, lambda u: 1.0 / (1.0 + u * u))
    found = newton(arctangent, np.array([3.0]), 0.0)
    assert found.has_converged
    assert abs(found.u[0]) < 1e-15


def test_no_step_is_longer_than_what_the_problem_calls_large() -> None:
    found = newton(scalar(lambda u: u, lambda _: 1.0), np.array([10.0]), 0.0)
    assert found.has_converged
    assert max(found.steps) == 1.0
    assert found.u[0] == 0.0


@pytest.mark.parametrize(
    ("function", "derivative", "outcome"),
    [
        # |u^2 + 1| has its minimum between two places that steps lead to.
        (lambda u: u * u + 1.0, lambda u: 2.0 * u, Convergence.STALLED),
        (lambda _: 1.0, lambda _: 0.0, Convergence.SINGULAR),
        (lambda _: np.nan, lambda _: 1.0, Convergence.NOT_FINITE),
        # A derivative a thousand times too large makes steps that much too small.
        (lambda u: u, lambda _: 1e3, Convergence.NOT_CONVERGED),
    ],
)
def test_a_failure_says_what_to_do(
    function: Callable[[float], float],
    derivative: Callable[[float], float],
    outcome: Convergence,
) -> None:
    found = newton(scalar(function, derivative), np.array([0.3]), 0.0)
    assert found.outcome is outcome
    assert not found.has_converged
    assert "begin" in found.outcome.value


def test_a_region_without_values_is_kept_out_of() -> None:
    # ln u - p has no value at u <= 0, where the first full step leads.
    with np.errstate(invalid="ignore", divide="ignore"):
        found = newton(scalar(np.log, lambda u: 1.0 / u), np.array([2.9]), 0.0)
    assert found.has_converged
    assert found.u[0] == pytest.approx(1.0, abs=1e-15)
