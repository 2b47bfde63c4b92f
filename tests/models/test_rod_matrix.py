"""Claims on the matrices of an implicit step: exact where they say so, near enough where not."""

from typing import Any

import numpy as np
import pytest

import naive
from cases import (
    RIGID_FORMS,
    Form,
    every_drag_ratio,
    every_form,
    every_load,
    filament,
    random_state,
)
from uncached import uncached
from undula.arrays import Array, State
from undula.models import initial_states as starts
from undula.models.filament import Filament
from undula.models.loads.analytic import Load
from undula.models.rod.newton_matrix import exact_derivative
from undula.numerics.integration.matrices import (
    factor,
    planar_factor,
    planar_solve,
    solve,
    structure_of,
)
from undula.numerics.integration.system import generator, matrix, planar_matrix, residual
from undula.numerics.linalg.banded import to_dense

every_rigid_form = pytest.mark.parametrize("form", RIGID_FORMS, ids=str)


@uncached
def write_residual(system: Any, y: Any, w: Any, c: Any, out: Any) -> None:
    residual(system, y, w, c, out)


@uncached
def write_matrix(system: Any, y: Any, w: Any, c: Any, turn: Any, band: Any) -> None:
    matrix(system, y, w, c, turn, band)


@uncached
def write_planar_matrix(system: Any, y: Any, w: Any, azimuth: Any, c: Any, band: Any) -> None:
    planar_matrix(system, y, w, azimuth, c, band)


@uncached
def solve_whole(system: Any, y: Any, w: Any, c: Any, turn: Any, band: Any, x: Any) -> Any:
    matrix(system, y, w, c, turn, band)
    regular = factor(system, band)
    solve(system, band, x)
    return regular


@uncached
def solve_planar(system: Any, y: Any, w: Any, azimuth: Any, c: Any, band: Any, x: Any) -> Any:
    planar_matrix(system, y, w, azimuth, c, band)
    regular = planar_factor(system, band)
    planar_solve(system, band, x)
    return regular


@uncached
def write_generator(system: Any, y: Any, out: Any) -> None:
    generator(system, y, out)


def derivative(model: Filament, y: Array, w: Array, c: float, turn: float = 0.0) -> Array:
    """Return the exact derivative of the residual as a dense matrix."""
    band = np.zeros((y.size, 6 * (model.dimension + 1) - 1))
    exact_derivative(model.system, y, w, c, turn, band)
    return to_dense(band)


def newton(model: Filament, y: Array, w: Array, c: float, turn: float = 0.0) -> Array:
    """Return the matrix of Newton's method as a dense matrix."""
    band = np.zeros((y.size, 2 * model.system.half_bandwidth + 1))
    write_matrix(model.system, y, w, c, turn, band)
    return in_natural_order(model, band)


def in_natural_order(model: Filament, band: Array) -> Array:
    """Return a band as a dense matrix whose rows and columns go from the clamp to the tip."""
    stored = to_dense(band)
    structure = structure_of(type(model.system))
    if not structure.backwards:
        return stored
    natural = np.arange(len(band)).reshape(-1, structure.block)[::-1].ravel()
    return stored[np.ix_(natural, natural)]


def differenced(model: Filament, y: Array, w: Array, c: float, turn: float) -> Array:
    """Return the derivative of the residual along dw = dy (1 + turn S) by differences."""

    def along(change: Array) -> Array:
        turned, out = np.zeros(y.size), np.empty(y.size)
        write_generator(model.system, change, turned)
        write_residual(model.system, y + change, w + change + turn * turned, c, out)
        return out

    return naive.differences(along, np.zeros(y.size), 3e-5)


@every_load
@every_form
@every_drag_ratio
def test_the_exact_derivative_is_that_of_the_residual(
    load: Load, form: Form, drag_ratio: float
) -> None:
    model = filament(form, load, segments=6, drag_ratio=drag_ratio)
    y = model.unknowns(random_state(model, bend=1.5))
    w = np.random.default_rng(5).normal(size=y.size) * model.position_mask
    c, turn = 1e-3, 0.7
    numerical = differenced(model, y, w, c, turn)
    scale = np.abs(numerical).max(axis=1, keepdims=True)
    # Fourth power of a step of 2e-4 of a link, and round-off over it; row by row, as rows of
    # constraints are smaller than those of forces.
    assert (np.abs(derivative(model, y, w, c, turn) - numerical) <= 1e-8 * scale).all()


def bent(model: Filament, amplitude: float) -> tuple[Array, Array, float]:
    """Return the unknowns of a bent state and the step of an implicit method there."""
    return step_at(model, starts.kicked(model, amplitude))


def step_at(model: Filament, x: State) -> tuple[Array, Array, float]:
    y, c = model.unknowns(x), 1e-6
    velocity = np.zeros((model.segments, model.dimension + 1))
    velocity[:, :-1] = model.rhs(x).reshape(model.segments, -1)
    return y, c * velocity.ravel(), c


@every_rigid_form
@every_load
def test_newtons_matrix_is_exact_at_the_straight_state(form: Form, load: Load) -> None:
    model = filament(form, load)
    step = step_at(model, model.straight())
    exact = derivative(model, *step, turn=0.3)
    # Round-off of entries up to 1 / link.
    assert np.abs(newton(model, *step, turn=0.3) - exact).max() < 1e-14 * np.abs(exact).max()


@every_rigid_form
def test_newtons_matrix_errs_by_the_square_of_the_angles(form: Form) -> None:
    model = filament(form)
    angles = [0.2, 0.1, 0.05, 0.025]
    errors = []
    for angle in angles:  # moves that change lengths included, as Newton's first ones do
        step = bent(model, angle)
        errors.append(np.abs(newton(model, *step) - derivative(model, *step)).max())
    order = np.polyfit(np.log(angles), np.log(errors), 1)[0]
    # The next term is of the fourth power: 4 per cent at the largest angle.
    assert 1.85 < order < 2.15


@pytest.mark.parametrize("confined", [False, True])
def test_newtons_matrix_of_extensible_links_is_the_exact_derivative(confined: bool) -> None:
    model = filament(Form("weak", confined))
    step = step_at(model, random_state(model))
    exact = derivative(model, *step)
    # One source compiled twice, free to order its sums.
    assert np.abs(newton(model, *step) - exact).max() < 1e-14 * np.abs(exact).max()


@every_rigid_form
def test_newtons_matrix_is_narrower_than_the_exact_derivative(form: Form) -> None:
    model = filament(form)
    numbers = model.dimension + 1
    assert model.system.half_bandwidth == 2 * numbers < 3 * numbers - 1


def flat_step(model: Filament, azimuth: float) -> tuple[Array, Array, float]:
    """Return a step at a strongly bent state in a plane."""
    return step_at(model, starts.planar(model, 1.2, angle=azimuth))


def planar_newton(model: Filament, y: Array, w: Array, c: float, azimuth: float) -> Array:
    """Return the matrix for states in a plane as a dense matrix."""
    band = np.zeros((y.size, 2 * model.system.half_bandwidth + 1))
    write_planar_matrix(model.system, y, w, azimuth, c, band)
    return in_natural_order(model, band)


@every_load
@every_drag_ratio
@pytest.mark.parametrize("azimuth", [0.0, 0.7, 2.5])
def test_in_a_plane_the_planar_matrix_is_the_whole_one_in_its_orientation(
    azimuth: float, load: Load, drag_ratio: float
) -> None:
    model = filament(load=load, drag_ratio=drag_ratio)
    whole = newton(model, *flat_step(model, 0.0))
    planar = planar_newton(model, *flat_step(model, azimuth), azimuth)
    # Round-off of the state's turned positions over a link's length squared.
    assert np.abs(planar - whole).max() < 1e-12 * np.abs(whole).max()


def test_off_the_plane_the_planar_matrix_errs_in_proportion() -> None:
    model = filament()
    errors, off = [], [1e-2, 1e-3, 1e-4]
    for each in off:
        x = starts.planar(model, 1.2).reshape(-1, 3)
        x[:, 1] = each * x[:, 2] ** 2
        step = step_at(model, model.admissible(x.ravel()))
        errors.append(np.abs(planar_newton(model, *step, 0.0) - newton(model, *step)).max())
    # The next term is of second order, a hundredth at the largest distance.
    assert np.polyfit(np.log(off), np.log(errors), 1)[0] == pytest.approx(1.0, abs=0.02)


@every_rigid_form
@pytest.mark.parametrize("links", [1, 2, 3, 12])
def test_all_that_is_eliminated_is_written_anew(form: Form, links: int) -> None:
    model = filament(form, segments=12)
    numbers = links * (model.dimension + 1)
    y, w, c = flat_step(model, 0.0)
    y, w = y[:numbers], w[:numbers]
    tables = (each[:links] if isinstance(each, np.ndarray) else each for each in model.system)
    system = type(model.system)(*tables)
    right = np.random.default_rng(3).normal(size=numbers)

    def solved(old: float, *, planar: bool) -> Array:
        band, x = np.full((numbers, 2 * system.half_bandwidth + 1), old), right.copy()
        if planar:
            assert solve_planar(system, y, w, 0.0, c, band, x)
        else:
            assert solve_whole(system, y, w, c, 0.0, band, x)
        return x

    whole = solved(0.0, planar=False)
    np.testing.assert_array_equal(solved(np.nan, planar=False), whole)
    if model.dimension == 3:
        planar = solved(0.0, planar=True)
        np.testing.assert_array_equal(solved(np.nan, planar=True), planar)
        # The same numbers are eliminated: round-off grows with the condition, 1e5 with 12 links.
        np.testing.assert_allclose(planar, whole, rtol=0.0, atol=1e-10 * np.abs(whole).max())
