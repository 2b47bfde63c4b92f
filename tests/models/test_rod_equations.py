"""Claims on the motion of the linked rod: its slow twin, derivative, energy and symmetries."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import naive
from cases import (
    ALL_LOADS,
    RIGID_FORMS,
    Form,
    every_drag_ratio,
    every_form,
    every_free_form,
    every_load,
    filament,
    random_state,
)
from uncached import uncached
from undula.arrays import Array
from undula.models import initial_states as starts
from undula.models.filament import Filament
from undula.models.loads.analytic import Load
from undula.numerics.integration.system import error_norm

BENDS = [0.3, 1.0, 2.0]
every_bend = pytest.mark.parametrize("bend", BENDS)
every_rigid_form = pytest.mark.parametrize("form", RIGID_FORMS, ids=str)
turns = st.floats(-7.0, 7.0)
seeds = st.integers(0, 2**32 - 1)


def largest(values: Any) -> float:
    return float(np.abs(values).max())


def close(a: Array, b: Array, tolerance: float) -> bool:
    """Whether a is b to a tolerance relative to the largest entry of b."""
    return largest(a - b) <= tolerance * largest(b)


# ------------------------------------------------------------------ the slow twin


@every_load
@every_form
@every_drag_ratio
@every_bend
def test_the_velocity_is_that_of_the_slow_twin(
    load: Load, form: Form, drag_ratio: float, bend: float
) -> None:
    model = filament(form, load, drag_ratio=drag_ratio)
    x = random_state(model, bend=bend)
    # Forces cancel to about 1e-3 of their parts, and so does what round-off leaves of them.
    assert close(model.rhs(x), naive.motion(model, x)[0], 1e-12)


@every_form
@every_bend
def test_the_energy_is_that_of_the_slow_twin(form: Form, bend: float) -> None:
    model = filament(form)
    x = random_state(model, bend=bend)
    # Stretching energy is the square of a difference of lengths: 1e-16 over 1e-2, twice.
    assert model.energy(x) == pytest.approx(float(naive.energy(model, x)), rel=1e-13, abs=0.0)


@every_form
@every_load
def test_the_straight_state_is_an_equilibrium(form: Form, load: Load) -> None:
    model = filament(form, load)
    # The weak form's tension is a strain of 1e-16 times 4e4, a velocity 24 times a difference of
    # them; velocities of bent states are 1e4 and more.
    assert largest(model.rhs(model.straight())) < 1e-7


# ------------------------------------------------------------------ the derivative


@every_load
@every_form
@every_drag_ratio
@every_bend
def test_the_jacobian_is_the_derivative_of_the_velocity_in_every_direction(
    load: Load, form: Form, drag_ratio: float, bend: float
) -> None:
    model = filament(form, load, drag_ratio=drag_ratio)
    x = random_state(model, seed=1, bend=bend)
    # A step of 3e-4 of a link: its fourth power and the round-off over it are both below 1e-10.
    # Rigid links too: the velocity is defined, and smooth, where lengths are wrong.
    numerical = naive.differences(model.rhs, x, 3e-5)
    assert close(model.jacobian(x), numerical, 1e-9)


@every_rigid_form
@every_load
def test_rigid_links_do_not_stretch_to_first_order_in_time(form: Form, load: Load) -> None:
    model = filament(form, load)
    x = random_state(model, seed=2)
    velocity = model.rhs(x)
    # Round-off of a difference of two velocities.
    assert largest(naive.stretching(model, x) @ velocity) < 1e-12 * largest(velocity)


# ------------------------------------------------------------------ energy


@every_load
@every_form
@every_drag_ratio
@every_bend
def test_energy_gained_and_dissipated_is_what_the_load_puts_in(
    load: Load, form: Form, drag_ratio: float, bend: float
) -> None:
    model = filament(form, load, drag_ratio=drag_ratio)
    x = random_state(model, seed=3, bend=bend)
    gained = naive.slope(model, x, model.rhs(x))
    active, dissipated = model.power(x)
    # The three terms are sums over 12 nodes of terms good to 1e-14.
    assert abs(gained + dissipated - active) < 1e-12 * (abs(active) + dissipated)


@every_form
@every_load
def test_active_power_and_dissipation_are_those_of_the_slow_twin(form: Form, load: Load) -> None:
    model = filament(form, load, drag_ratio=3.0)
    x = random_state(model, seed=4)
    velocity = naive.motion(model, x)[0]
    active, dissipated = model.power(x)
    # Round-off of the velocity, see above.
    scale = 1e-12 * dissipated
    assert active == pytest.approx(naive.active_force(model, x) @ velocity, abs=scale)
    assert dissipated == pytest.approx(velocity @ naive.drag(model, x) @ velocity, abs=scale)


@every_form
@every_drag_ratio
def test_drag_takes_energy_whatever_the_motion(form: Form, drag_ratio: float) -> None:
    model = filament(form, drag_ratio=drag_ratio)
    for seed in range(20):
        assert model.power(random_state(model, seed))[1] > 0.0


# ------------------------------------------------------------------ symmetry


@given(load=st.sampled_from(ALL_LOADS), angle=turns, seed=seeds)
@every_free_form
@settings(max_examples=40)
def test_turning_a_state_turns_its_velocity_and_leaves_its_energy(
    form: Form, load: Load, angle: float, seed: int
) -> None:
    model = filament(form, load)
    x = random_state(model, seed, bend=1.5)
    turned = model.rotate(x, angle)
    # The claim of the package.
    assert close(model.rhs(turned), model.rotate(model.rhs(x), angle), 1e-12)
    assert model.energy(turned) == pytest.approx(model.energy(x), rel=1e-12, abs=0.0)
    assert close(np.array(model.power(turned)), np.array(model.power(x)), 1e-12)


@given(load=st.sampled_from(ALL_LOADS), seed=seeds)
@every_form
@settings(max_examples=40)
def test_reflecting_a_state_reflects_its_velocity_and_leaves_its_energy(
    form: Form, load: Load, seed: int
) -> None:
    model = filament(form, load)
    x = random_state(model, seed, bend=1.5)
    reflected = model.reflect(x)
    # Signs change, nothing else; sums of products may be ordered differently.
    assert close(model.rhs(reflected), model.reflect(model.rhs(x)), 1e-13)
    assert model.energy(reflected) == pytest.approx(model.energy(x), rel=1e-14, abs=0.0)
    assert close(np.array(model.power(reflected)), np.array(model.power(x)), 1e-13)


@every_free_form
def test_the_generator_is_the_derivative_of_a_rotation(form: Form) -> None:
    model = filament(form)
    x = random_state(model)
    step = 1e-4
    numerical = (model.rotate(x, step) - model.rotate(x, -step)) / (2.0 * step)
    # The step's square over 6, and round-off over the step.
    assert close(model.rotation_generator(x), numerical, 1e-8)


@every_load
@every_free_form
def test_a_planar_state_in_space_moves_like_the_confined_one(load: Load, form: Form) -> None:
    flat = filament(form._replace(confined=True), load)
    x = random_state(flat, bend=1.5)
    free = filament(form, load)
    velocity = free.rhs(free.from_nodes(flat.nodes(x))).reshape(-1, 3)
    # The same sums, compiled for other dimensions.
    assert close(velocity[:, [0, 2]].ravel(), flat.rhs(x), 1e-11)


@every_load
@every_free_form
def test_a_state_in_the_plane_has_no_velocity_out_of_it_not_even_round_off(
    load: Load, form: Form
) -> None:
    model = filament(form, load)
    x = model.from_nodes(flat_shape(model)).reshape(-1, 3)
    assert (model.rhs(x.ravel()).reshape(-1, 3)[:, 1] == 0.0).all()


@every_load
@every_free_form
def test_moves_within_the_plane_cause_no_motion_out_of_it_not_even_round_off(
    load: Load, form: Form
) -> None:
    model = filament(form, load)
    x = model.from_nodes(flat_shape(model))
    size = (model.segments, 3, model.segments, 3)
    jacobian = model.jacobian(x).reshape(size)
    assert (jacobian[:, 1, :, [0, 2]] == 0.0).all()


@uncached
def norm_of(system: Any, vector: Any, mask: Any) -> Any:
    return error_norm(system, vector, mask)


@every_form
def test_the_size_of_a_change_is_that_of_the_tangents(form: Form) -> None:
    model = filament(form)
    change = np.random.default_rng(8).normal(size=model.position_mask.size)
    links = np.diff(model.positions(change).reshape(model.segments, -1), axis=0, prepend=0.0)
    expected = np.sqrt(np.sum((links * model.segments) ** 2) / model.segments)
    assert norm_of(model.system, change, model.position_mask) == pytest.approx(expected, rel=1e-14)


def flat_shape(model: Filament) -> Array:
    """Return the nodes of a strongly bent shape in the plane y = 0."""
    return model.nodes(starts.planar(model, 2.0))
