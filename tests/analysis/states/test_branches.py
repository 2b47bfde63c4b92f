"""Branches of states that are known: what is located on them, how it is named and counted."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Self

import numpy as np
import pytest

from refusal import complaint
from undula.analysis.linear.stability import onset
from undula.analysis.linear.straight_branch import follow_straight
from undula.analysis.observables.shapes import Range
from undula.analysis.states.branch import Bifurcation, Branch
from undula.analysis.states.follow_branch import Family, follow_branch
from undula.arrays import Array, ComplexArray
from undula.models.filament import Filament
from undula.models.loads.analytic import PointLoad, TipLoad
from undula.numerics.continuation.arclength import Steps
from undula.numerics.continuation.problem import DenseLinear, Evaluation

#: A rate of change f(x; p), of real polynomials, so that it takes complex arguments.
Field = Callable[[Array, float], Array]


def slopes(field: Field, x: Array, p: float) -> tuple[Array, Array]:
    """Return the derivatives of a field by x and by p, by complex steps, which have no error."""
    step = 1e-30
    by_x = [field(x + 1j * step * unit, p).imag / step for unit in np.eye(x.size)]
    return np.array(by_x).T, field(x.astype(complex), p + 1j * step).imag / step  # type: ignore[arg-type]


@dataclass(frozen=True)
class Known:
    """A state with its exponents."""

    u: Array
    exponents: ComplexArray
    frequency: float = 0.0
    energy: Range = Range(0.0, 0.0, 0.0)  # noqa: RUF009

    @property
    def stable(self) -> bool:
        return bool(self.exponents[0].real < 0.0)


def known(u: Array, values: ComplexArray, frequency: float = 0.0) -> Known:
    return Known(u, values[np.lexsort((-values.imag, -values.real))], frequency)


@dataclass(frozen=True)
class Resting:
    """An equilibrium of `size` unknowns, f(x; p) = 0."""

    field: Field
    size: int = 1

    @property
    def weights(self) -> Array:
        return np.ones(self.size)

    def evaluate(self, u: Array, p: float) -> Evaluation:
        matrix, by_parameter = slopes(self.field, u, p)
        return Evaluation(self.field(u, p), DenseLinear(matrix), by_parameter)

    def with_reference(self, u: Array) -> Self:  # noqa: ARG002
        return self

    def judged(self, u: Array, p: float) -> Known:
        return known(u, np.linalg.eigvals(slopes(self.field, u, p)[0]).astype(complex))


@dataclass(frozen=True)
class Turning:
    """f(x; p) = Omega S x, where S turns all pairs of unknowns; the phase is fixed by `reference`.

    Unknowns are (x, Omega).
    """

    field: Field
    reference: Array

    @property
    def weights(self) -> Array:
        return np.ones(self.reference.size + 1)

    @property
    def _turn(self) -> Array:
        return np.kron(np.eye(self.reference.size // 2), np.array([[0.0, -1.0], [1.0, 0.0]]))

    def _matrix(self, u: Array, p: float) -> Array:
        return slopes(self.field, u[:-1], p)[0] - u[-1] * self._turn

    def evaluate(self, u: Array, p: float) -> Evaluation:
        x, phase = u[:-1], self._turn @ self.reference
        turned = self._turn @ x
        matrix = np.block([[self._matrix(u, p), -turned[:, None]], [phase, np.zeros(1)]])
        residual = np.append(self.field(x, p) - u[-1] * turned, phase @ x)
        return Evaluation(
            residual, DenseLinear(matrix), np.append(slopes(self.field, x, p)[1], 0.0)
        )

    def with_reference(self, u: Array) -> "Turning":
        return Turning(self.field, u[:-1])

    def judged(self, u: Array, p: float) -> Known:
        values = np.linalg.eigvals(self._matrix(u, p)).astype(complex)
        values = np.delete(values, np.argmin(np.abs(values)))
        return known(u, values, abs(u[-1]) / (2.0 * np.pi))


def named(state: Known, index: int) -> str:
    return "torus" if state.exponents[index].imag != 0.0 else "symmetry breaking"


def followed(
    problem: Resting | Turning, u: Array, p: float, to: float, scale: float = 1.0, **steps: float
) -> Branch[Known]:
    family = Family("p", problem, lambda each, at, value: each.judged(at, value), named, scale)
    return follow_branch(family, np.asarray(u, dtype=float), p, to, Steps(scale=scale, **steps))


def told(found: Bifurcation[Known]) -> tuple[str, int, int]:
    return found.kind, found.unstable_before, found.unstable_after


# Located to 1e-9 of the scale of the parameter, which is about 1 throughout.
LOCATED = 1e-8

# ---------------------------------------------------------------- a rotating wave

GROWTH, TURNING, TWIST = 1.5, 3.0, 0.8
PULL, SWING, MIXING = 2.0, 7.0, 0.6


def wave(x: Array, p: float) -> Array:
    """Return z' = (G p + i W) z - (1 - i b) |z|^2 z and w' = (-2 + |z|^2 + i V) w + m |w|^2 z.

    They run as |z|^2 = G p, w = 0 at the rate W + b G p. Beside the turned one there is the
    exponent -2 G p, and w has -2 + G p +- i (V - rate) as seen from the turning frame.
    """
    z, w = x[:2], x[2:]
    square, other = z @ z, w @ w
    across = np.array([-z[1], z[0]])
    turned = np.array([-w[1], w[0]])
    of_z = (GROWTH * p - square) * z + (TURNING + TWIST * square) * across
    of_w = (square - PULL) * w + SWING * turned + MIXING * other * z
    return np.concatenate([of_z, of_w])


LOSS = PULL / GROWTH


def on_the_wave(p: float, angle: float = 0.3) -> Array:
    """Return the solution at p with its rate."""
    size, rate = np.sqrt(GROWTH * p), TURNING + TWIST * GROWTH * p
    return np.array([size * np.cos(angle), size * np.sin(angle), 0.0, 0.0, rate])


def turning_wave(p: float) -> Turning:
    return Turning(wave, on_the_wave(p)[:-1])


def test_a_rotating_wave_has_its_rate_and_exponents_all_along() -> None:
    branch = followed(turning_wave(0.5), on_the_wave(0.5), 0.5, 2.5)
    assert branch.complete
    assert branch.values[[0, -1]] == pytest.approx([0.5, 2.5], abs=0.0)
    for p, state in zip(branch.values, branch.states, strict=True):
        rate = TURNING + TWIST * GROWTH * p
        # Newton's method and the eigenvalues of a matrix of order 1 end at round-off.
        assert state.frequency == pytest.approx(rate / (2.0 * np.pi), rel=1e-12)
        pair = GROWTH * p - PULL + 1j * (SWING - rate) * np.array([1.0, -1.0])
        expected = known(state.u, np.append(pair, -2.0 * GROWTH * p)).exponents
        np.testing.assert_allclose(np.sort(state.exponents), np.sort(expected), atol=1e-10)
        assert state.stable == (p < LOSS)


@pytest.mark.parametrize(("start", "to"), [(0.5, 2.5), (2.5, 0.5)])
@pytest.mark.parametrize("scale", [0.1, 1.0, 4.0])
def test_a_torus_is_found_where_it_is_in_both_directions(
    start: float, to: float, scale: float
) -> None:
    branch = followed(turning_wave(start), on_the_wave(start), start, to, scale)
    assert branch.complete
    (torus,) = branch.bifurcations
    assert told(torus) == (("torus", 0, 2) if to > start else ("torus", 2, 0))
    assert (torus.loses, torus.gains) == (to > start, to < start)
    assert torus.value == pytest.approx(LOSS, abs=LOCATED)
    assert abs(torus.value - LOSS) <= 2.0 * torus.error
    rate = TURNING + TWIST * PULL
    assert torus.frequency == pytest.approx(rate / (2.0 * np.pi), abs=LOCATED)
    assert torus.second_frequency == pytest.approx((SWING - rate) / (2.0 * np.pi), abs=LOCATED)


def test_a_branch_may_end_behind_what_was_looked_for() -> None:
    problem = turning_wave(0.5)
    family = Family("p", problem, lambda each, u, p: each.judged(u, p), named, 1.0)
    reached: list[float] = []
    branch = follow_branch(
        family, on_the_wave(0.5), 0.5, 100.0, Steps(), reached.append, lambda one: one.loses
    )
    assert len(branch.bifurcations) == 1
    assert not branch.complete
    assert LOSS < branch.values[-1] < LOSS + 1.0
    np.testing.assert_array_equal(reached, branch.values[1:])


# ---------------------------------------------------------------- folds and pitchforks


def bent(x: Array, p: float) -> Array:
    """p = x^2 with the exponent -2 x, beside a decaying unknown."""
    return np.array([p - x[0] ** 2, -3.0 * x[1] + x[0]])


@pytest.mark.parametrize(("side", "counts"), [(1.0, (0, 1)), (-1.0, (1, 0))])
@pytest.mark.parametrize("scale", [0.1, 1.0])
def test_at_a_fold_one_real_exponent_changes_its_sign(
    side: float, counts: tuple[int, int], scale: float
) -> None:
    branch = followed(Resting(bent, 2), np.array([side, side / 3.0]), 1.0, -1.0, scale)
    assert not branch.complete
    assert branch.values[-1] == 1.0
    (fold,) = branch.bifurcations
    assert told(fold) == ("fold", *counts)
    assert fold.value == pytest.approx(0.0, abs=LOCATED)
    assert fold.second_frequency is None
    for state, p in zip(branch.states, branch.values, strict=True):
        assert state.u[0] ** 2 == pytest.approx(p, abs=1e-12)
        assert np.abs(state.exponents + 2.0 * state.u[0]).min() < 1e-10


def test_both_folds_of_an_s_are_found_and_the_middle_is_unstable() -> None:
    problem = Resting(lambda x, p: p + x - x**3)
    branch = followed(problem, [-1.5], -(1.5**3) + 1.5, 2.0)
    assert branch.complete
    assert [told(each) for each in branch.bifurcations] == [("fold", 0, 1), ("fold", 1, 0)]
    height = 2.0 / np.sqrt(27.0)
    found = [each.value for each in branch.bifurcations]
    np.testing.assert_allclose(found, [height, -height], atol=LOCATED)
    for state in branch.states:
        assert state.stable == (abs(state.u[0]) > 1.0 / np.sqrt(3.0))


@pytest.mark.parametrize(("start", "to"), [(-1.3, 0.9), (0.9, -1.3), (-1.0, 1.0)])
def test_a_pitchfork_is_found_on_the_symmetric_branch(start: float, to: float) -> None:
    branch = followed(Resting(lambda x, p: p * x - x**3), [0.0], start, to)
    assert branch.complete
    (pitchfork,) = branch.bifurcations
    expected = (0, 1) if to > start else (1, 0)
    assert told(pitchfork) == ("symmetry breaking", *expected)
    assert pitchfork.value == pytest.approx(0.0, abs=LOCATED)
    assert pitchfork.second_frequency is None


# ---------------------------------------------------------------- several in one step

#: Where exponents change sign, and how fast each pair swings, 0 for one that is real.
CROWDS = [
    [(0.1, 0.0), (0.13, 2.0)],
    [(0.1, 2.0), (0.13, 0.0)],
    [(0.1, 2.0), (0.13, 5.0), (0.2, 0.0)],
    [(0.1, 0.0), (0.12, 0.0), (0.13, 0.0)],
    [(0.1, 5.0), (0.10001, 2.0)],
]


def crowd(places: list[tuple[float, float]], *, falling: bool = False) -> Field:
    """Return x' = A(p) x with exponents p - p_k +- i w_k, or p_k - p."""
    sign = -1.0 if falling else 1.0

    def field(x: Array, p: float) -> Array:
        rates, at = [], 0
        for place, swing in places:
            own = x[at : at + (2 if swing else 1)]
            turned = swing * np.array([-own[1], own[0]]) if swing else 0.0
            rates.append(sign * (p - place) * own + turned)
            at += own.size
        return np.concatenate(rates)

    return field


@pytest.mark.parametrize("places", CROWDS)
@pytest.mark.parametrize("backwards", [False, True])
@pytest.mark.parametrize("falling", [False, True])
def test_all_that_happens_in_one_step_is_found_in_its_order(
    places: list[tuple[float, float]], backwards: bool, falling: bool
) -> None:
    total = sum(2 if swing else 1 for _, swing in places)
    start, to = (1.0, -1.0) if backwards else (-1.0, 1.0)
    problem = Resting(crowd(places, falling=falling), total)
    branch = followed(problem, np.zeros(total), start, to, first=5.0, most=5.0)
    assert branch.values.size == 2
    # Those that grow at the beginning are those that decay at the end.
    count, growing = (total, -1) if backwards != falling else (0, 1)
    expected = []
    for place, swing in places[:: -1 if backwards else 1]:
        after = count + growing * (2 if swing else 1)
        kind = "torus" if swing else "symmetry breaking"
        expected.append((kind, count, after, place, swing / (2.0 * np.pi) or None))
        count = after
    assert len(branch.bifurcations) == len(expected)
    for found, (kind, before, after, place, frequency) in zip(
        branch.bifurcations, expected, strict=True
    ):
        assert told(found) == (kind, before, after)
        assert found.value == pytest.approx(place, abs=LOCATED)
        assert found.second_frequency == pytest.approx(frequency, abs=LOCATED)


@pytest.mark.parametrize("place", [-0.05, -0.01, 0.01, 0.05])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_fold_and_a_torus_beside_it_are_told_apart(place: float, side: float) -> None:
    # x = sqrt(p) has the exponent -2 x and loses a pair at x = place, going down.
    def field(x: Array, p: float) -> Array:
        turned = 4.0 * np.array([-x[2], x[1]])
        return np.append(p - x[0] ** 2, (place - x[0]) * x[1:] + turned)

    branch = followed(Resting(field, 3), [side, 0.0, 0.0], 1.0, -1.0, first=0.9, most=0.9)
    between = [state.u[0] for state in branch.states if abs(state.u[0]) < abs(place)]
    assert between == []
    fold_first = side * place < 0.0
    lost = [("fold", 0, 1), ("torus", 1, 3)] if fold_first else [("torus", 0, 2), ("fold", 2, 3)]
    gained = [("fold", 3, 2), ("torus", 2, 0)] if fold_first else [("torus", 3, 1), ("fold", 1, 0)]
    found = branch.bifurcations
    assert [told(each) for each in found] == (lost if side > 0.0 else gained)
    for each in found:
        x = each.state.u[0]
        # The fold is located along the branch, which is level there.
        assert x == pytest.approx(0.0 if each.kind == "fold" else place, abs=1e-6)
        assert each.value == pytest.approx(x * x, abs=LOCATED)


def test_values_and_states_belong_together() -> None:
    branch = followed(turning_wave(0.5), on_the_wave(0.5), 0.5, 2.5)
    assert branch.parameter == "p"
    assert len(branch.states) == branch.values.size
    for p, state in zip(branch.values, branch.states, strict=True):
        assert state.u[:4] @ state.u[:4] == pytest.approx(GROWTH * p, rel=1e-12)


# ---------------------------------------------------------------- the straight state


@pytest.mark.parametrize(("start", "to"), [(20.0, 60.0), (60.0, 20.0)])
def test_the_straight_state_along_the_force_is_lost_at_the_critical_force(
    start: float, to: float
) -> None:
    model = Filament(20, TipLoad(75.0))
    branch = follow_straight(model, "load.force", start, to)
    straight_onset = onset(model).hopf
    assert straight_onset is not None
    ((force, frequency),) = branch.hopf
    # Both find the same zero of a rate that is known to round-off of the fastest decay.
    assert force == pytest.approx(straight_onset.force, rel=1e-10)
    assert frequency == pytest.approx(straight_onset.frequency, rel=1e-10)
    assert branch.values[[0, -1]] == pytest.approx([start, to], abs=0.0)
    np.testing.assert_array_equal(branch.rates > 0.0, branch.values > straight_onset.force)
    assert branch.rates.shape == branch.frequencies.shape == branch.values.shape


@pytest.mark.slow
def test_along_the_position_of_a_load_both_sides_of_the_curve_of_thresholds_are_found() -> None:
    # The Hopf force of a point load is least at about 0.78, and 37.7 at the tip.
    model = Filament(20, PointLoad(37.0, 0.8))
    branch = follow_straight(model, "load.position", 0.6, 1.0)
    (one, frequency), (other, _) = branch.hopf
    assert 0.6 < one < 0.78 < other < 1.0
    for position, each in branch.hopf:
        straight_onset = onset(model.with_(position=position)).hopf
        assert straight_onset is not None
        assert straight_onset.force == pytest.approx(37.0, rel=1e-9)
        assert straight_onset.frequency == pytest.approx(each, rel=1e-9)
    between = (branch.values > one) & (branch.values < other)
    np.testing.assert_array_equal(branch.rates > 0.0, between)
    at = np.interp(one, branch.values, branch.frequencies)
    assert at == pytest.approx(frequency, rel=1e-3)


def test_where_nothing_crosses_nothing_is_found() -> None:
    assert follow_straight(Filament(20, TipLoad(75.0)), "load.force", 21.0, 37.0).hopf == ()


def test_a_parameter_that_is_none_is_refused() -> None:
    model = Filament(20, TipLoad(75.0))
    assert "model.length" in complaint(lambda: follow_straight(model, "model.length", 1.0, 2.0))
    assert "segments" in complaint(lambda: follow_straight(model, "model.segments", 10.0, 20.0))
