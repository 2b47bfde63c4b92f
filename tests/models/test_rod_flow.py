"""The equations of a linked rod as solvers of states take them."""

from collections.abc import Callable

import numpy as np
import pytest

import naive
from cases import Form, every_drag_ratio, every_form, every_free_form, every_load, filament
from cases import random_state as random_shape
from undula.arrays import Array
from undula.models.filament import Filament
from undula.models.loads.analytic import Load
from undula.numerics.linalg.banded import to_dense

every_seed = pytest.mark.parametrize("seed", range(3))


def random_flow(model: Filament, seed: int) -> tuple[Array, Array]:
    """Return unknowns at a random admissible state, and velocities that have nothing to do with it.

    Multipliers are off those that belong to the state.
    """
    random = np.random.default_rng(seed + 100)
    y = model.unknowns(model.admissible(random_shape(model, seed, bend=1.2)))
    moves = model.equations.differential
    y[~moves] += random.normal(size=np.count_nonzero(~moves))
    return y, np.where(moves, random.normal(size=y.size), 0.0)


def assert_derivative(found: Array, function: Callable[[Array], Array], y: Array) -> None:
    numerical = naive.differences(function, y, 3e-5)
    scale = np.abs(numerical).max(axis=1, keepdims=True)
    # Fourth power of a step of 2e-4 of a link, and round-off over it; row by row, as rows of
    # constraints are smaller than those of forces.
    assert (np.abs(found - numerical) <= 1e-8 * scale).all()


@every_load
@every_form
@every_drag_ratio
def test_the_matrix_is_the_derivative_of_the_residual_at_fixed_velocity(
    load: Load, form: Form, drag_ratio: float
) -> None:
    model = filament(form, load, segments=6, drag_ratio=drag_ratio)
    equations, (y, w) = model.equations, random_flow(model, seed=1)
    matrix, _ = equations.parts(y, w, 0.0)
    assert_derivative(to_dense(matrix), lambda at: equations.residual(at, w), y)


@every_form
@every_seed
def test_the_matrix_of_a_turning_rod_is_that_of_a_velocity_that_turns(
    form: Form, seed: int
) -> None:
    model, turn = filament(form, segments=6), -3.7
    equations, (y, w) = model.equations, random_flow(model, seed)
    matrix, _ = equations.parts(y, w, turn)

    def turned(at: Array) -> Array:
        return equations.residual(at, w + turn * equations.turning(at - y)[0])

    assert_derivative(to_dense(matrix), turned, y)


@every_form
@every_drag_ratio
def test_the_drag_is_what_the_residual_has_of_the_velocity(form: Form, drag_ratio: float) -> None:
    model = filament(form, segments=6, drag_ratio=drag_ratio)
    equations, (y, w) = model.equations, random_flow(model, seed=2)
    drag = to_dense(equations.parts(y, w, 1.3)[1])
    # The residual is linear in the velocity; forces of some hundreds cancel in the difference.
    difference = equations.residual(y, w) - equations.residual(y, np.zeros(y.size))
    np.testing.assert_allclose(drag @ w, difference, atol=1e-11)
    moves = equations.differential
    assert not drag[~moves].any()
    inner = drag[np.ix_(moves, moves)]
    np.testing.assert_allclose(inner, inner.T, atol=1e-16)
    # Weights from h / 2 at the tip, less along the tangent.
    smallest = 0.5 / model.segments / drag_ratio
    assert np.linalg.eigvalsh(inner).min() >= smallest * (1.0 - 1e-12)


@every_form
@every_drag_ratio
def test_the_motion_of_the_model_leaves_no_residual(form: Form, drag_ratio: float) -> None:
    model = filament(form, drag_ratio=drag_ratio)
    x = model.admissible(random_shape(model, 4))
    y, w = model.unknowns(x), np.zeros((model.links, model.dimension + 1))
    w[:, :-1] = model.rhs(x).reshape(model.links, -1)
    left = model.equations.residual(y, w.ravel())
    drag = to_dense(model.equations.parts(y, w.ravel(), 0.0)[1]) @ w.ravel()
    # Round-off of tensions of the stiffness over a link, beside drag of their size.
    assert np.abs(left).max() < 1e-9 * np.abs(drag).max()


@every_form
@every_seed
def test_displacements_are_orthonormal_and_keep_the_constraints(form: Form, seed: int) -> None:
    model = filament(form, segments=9)
    equations, (y, w) = model.equations, random_flow(model, seed)
    basis, moves = equations.displacements(y), equations.differential
    rigid = form.inextensibility == "exact"
    directions = model.dimension - 1 if rigid else model.dimension
    assert basis.shape == (y.size, model.links * directions)
    np.testing.assert_allclose(basis.T @ basis, np.eye(basis.shape[1]), atol=1e-14)
    # Nothing but what orthonormalising rounds.
    np.testing.assert_allclose(basis[~moves], 0.0, atol=1e-14)
    if rigid:
        stretching = to_dense(equations.parts(y, w, 0.0)[0])[~moves]
        # Round-off of a sum over the links, over their length.
        assert np.abs(stretching @ basis).max() < 1e-13


@pytest.mark.parametrize("confined", [False, True])
def test_displacements_of_the_straight_rod_are_all_across_the_axis(confined: bool) -> None:
    model = filament(Form("exact", confined))
    basis = model.equations.displacements(model.unknowns(model.straight()))
    by_node = basis.reshape(model.links, model.dimension + 1, -1)
    np.testing.assert_allclose(by_node[:, -2:], 0.0, atol=1e-15)


@every_free_form
@every_seed
def test_turning_is_the_derivative_of_a_rotation_and_its_drag(form: Form, seed: int) -> None:
    model = filament(form)
    y, w = random_flow(model, seed)
    moves = model.equations.differential
    velocity, dragged = model.equations.turning(y)
    assert not velocity[~moves].any()
    angle, x = 1e-4, model.positions(y)
    numerical = (model.rotate(x, angle) - model.rotate(x, -angle)) / (2.0 * angle)
    # A sixth of the square of the angle.
    np.testing.assert_allclose(velocity[moves], numerical, atol=1e-8)
    np.testing.assert_allclose(velocity[moves], model.rotation_generator(x), rtol=1e-15)
    drag = to_dense(model.equations.parts(y, w, 0.0)[1])
    np.testing.assert_allclose(dragged, drag @ velocity, atol=1e-16)


@pytest.mark.parametrize("kept", ["exact", "weak"])
def test_a_confined_rod_does_not_turn(kept: str) -> None:
    model = filament(Form(kept, confined=True))  # type: ignore[arg-type]
    velocity, dragged = model.equations.turning(random_flow(model, 0)[0])
    assert not velocity.any()
    assert not dragged.any()


@every_free_form
def test_the_matrix_turns_with_the_rod(form: Form) -> None:
    model, angle = filament(form, segments=6), 0.9
    moves = model.equations.differential
    y, w = random_flow(model, 1)

    def turned(vector: Array) -> Array:
        result = vector.copy()
        result[moves] = model.rotate(vector[moves], angle)
        return result

    one, other = model.equations.parts(y, w, 0.4), model.equations.parts(turned(y), turned(w), 0.4)
    change = np.random.default_rng(2).normal(size=y.size)
    for before, after in zip(one, other, strict=True):
        expected = turned(to_dense(before) @ change)
        scale = np.abs(expected).max()
        np.testing.assert_allclose(to_dense(after) @ turned(change), expected, atol=1e-13 * scale)
