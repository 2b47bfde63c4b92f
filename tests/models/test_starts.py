"""Claims on starts: lengths, amplitudes, seeds, symmetries, modes, stored shapes, refusals."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cases import Form, every_form, every_free_form, every_load, filament, random_state
from refusal import complaint
from undula.arrays import Array, Nodes, State
from undula.models import initial_states as starts
from undula.models.loads.analytic import Load, TipLoad

BENT: list[Callable[..., State]] = [starts.kicked, starts.planar, starts.helix, starts.mode]
FLAT: list[Callable[..., State]] = [starts.kicked, starts.planar, starts.mode]
CURVES: list[Callable[..., State]] = [starts.kicked, starts.planar, starts.helix]
amplitudes = st.floats(1e-8, math.pi)
SEGMENTS = [20, 40, 80, 160]
FREE = Form("exact", confined=False)
CONFINED = Form("exact", confined=True)


def name_of(start: Callable[..., State]) -> str:
    return start.__name__


def inclination(nodes: Nodes) -> Array:
    """Return the angle of each link to the axis."""
    links = np.diff(nodes, axis=0)
    return np.arctan2(np.hypot(links[:, 0], links[:, 1]), links[:, 2])


def order(errors: list[float]) -> float:
    return float(-np.polyfit(np.log(SEGMENTS[: len(errors)]), np.log(errors), 1)[0])


# ------------------------------------------------------------------ all of them


@given(amplitude=amplitudes)
@pytest.mark.parametrize("start", BENT, ids=name_of)
def test_links_have_their_length_and_the_largest_inclination_is_the_amplitude(
    start: Callable[..., State], amplitude: float
) -> None:
    model = filament(FREE)
    nodes = model.nodes(start(model, amplitude))
    lengths = np.linalg.norm(np.diff(nodes, axis=0), axis=1)
    # Nodes of order 1, rounded, over a link of 1/12: 1e-15 of a link's direction and length.
    assert np.abs(lengths * model.segments - 1.0).max() < 1e-14
    assert inclination(nodes).max() == pytest.approx(amplitude, abs=1e-14)


@pytest.mark.parametrize("start", FLAT, ids=name_of)
def test_a_confined_start_has_its_length_and_its_amplitude_in_its_plane(
    start: Callable[..., State],
) -> None:
    model = filament(CONFINED)
    nodes = model.nodes(start(model, 0.7))
    lengths = np.linalg.norm(np.diff(nodes, axis=0), axis=1)
    assert np.abs(lengths * model.segments - 1.0).max() < 1e-14  # as above
    assert inclination(nodes).max() == pytest.approx(0.7, abs=1e-14)
    assert (nodes[:, 1] == 0.0).all()


@pytest.mark.parametrize("start", CURVES, ids=name_of)
def test_a_start_is_the_same_curve_at_any_number_of_links(start: Callable[..., State]) -> None:
    fine = filament(segments=1280)
    curve = fine.nodes(start(fine, 1.0))
    errors = []
    for segments in SEGMENTS:
        model = filament(segments=segments)
        nodes = model.nodes(start(model, 1.0))
        errors.append(np.abs(nodes - curve[:: 1280 // segments]).max())
    # Chords of a curve: second order; the reference adds 2 per cent at most.
    assert 1.9 < order(errors) < 2.1


@every_form
def test_the_straight_start_stands_on_the_axis(form: Form) -> None:
    model = filament(form)
    nodes = model.nodes(starts.straight(model))
    assert (nodes[:, :2] == 0.0).all()
    assert (np.diff(nodes[:, 2]) > 0.0).all()


def test_the_straight_start_of_rigid_links_is_a_length_high() -> None:
    model = filament()
    heights = model.nodes(starts.straight(model))[:, 2]
    # Rounded once.
    np.testing.assert_allclose(heights, np.linspace(0.0, 1.0, model.segments + 1), rtol=1e-15)


# ------------------------------------------------------------------ one by one


def test_the_same_seed_gives_the_same_kick_and_another_seed_another() -> None:
    model = filament()
    assert (starts.kicked(model, seed=7) == starts.kicked(model, seed=7)).all()
    assert np.abs(starts.kicked(model, seed=7) - starts.kicked(model, seed=8)).max() > 1e-4


@given(st.integers(0, 2**32 - 1))
def test_a_kick_is_not_planar(seed: int) -> None:
    model = filament()
    across = model.nodes(starts.kicked(model, 1e-2, seed=seed))[:, :2]
    singular = np.linalg.svd(across, compute_uv=False)
    # Two random combinations of four shapes are never the same to nine digits.
    assert singular[1] > 1e-9 * singular[0]


@given(amplitude=st.floats(1e-8, 1.0), angle=st.floats(-7.0, 7.0))
@pytest.mark.parametrize("start", [starts.planar, starts.mode], ids=name_of)
def test_a_planar_start_lies_in_its_plane_on_its_side(
    start: Callable[..., State], amplitude: float, angle: float
) -> None:
    model = filament(segments=6)
    x, y, _ = model.nodes(start(model, amplitude, angle=angle)).T
    # Round-off of positions of order 1.
    assert np.abs(y * np.cos(angle) - x * np.sin(angle)).max() < 1e-15
    assert x[-1] * np.cos(angle) + y[-1] * np.sin(angle) > 0.0


def test_the_hand_of_a_helix_is_changed_by_reflection() -> None:
    model = filament()
    right, left = (
        model.nodes(starts.helix(model, 0.5, right_handed=hand)) for hand in (True, False)
    )
    assert (right * [1.0, -1.0, 1.0] == left).all()


@pytest.mark.parametrize(("right_handed", "sign"), [(True, 1.0), (False, -1.0)])
def test_a_right_handed_helix_has_positive_torsion(right_handed: bool, sign: float) -> None:
    model = filament(segments=40)
    links = np.diff(model.nodes(starts.helix(model, 0.5, right_handed=right_handed)), axis=0)
    volumes = (np.cross(links[:-2], links[1:-1]) * links[2:]).sum(axis=1)
    assert (sign * volumes > 0.0).all()


# ------------------------------------------------------------------ the mode


@every_form
@every_load
def test_the_leading_mode_is_an_eigenvector_and_none_grows_faster(form: Form, load: Load) -> None:
    model = filament(form, load)
    jacobian = model.jacobian(model.straight())
    value, vector = starts.leading_mode(model)
    full = np.zeros(model.size, dtype=complex)
    full[:: model.dimension] = vector
    # Round-off of the Jacobian, whose entries are a thousand times the eigenvalue; a million times
    # with the stiffness of extensible links.
    residual = jacobian @ full - value * full
    assert np.abs(residual).max() < 1e-13 * np.abs(jacobian).max() * np.abs(full).max()
    sideways = np.linalg.eigvals(jacobian[:: model.dimension, :: model.dimension])
    assert value.real == pytest.approx(sideways.real.max(), rel=1e-9)


@pytest.mark.parametrize("force", [10.0, 30.0, 75.0])
def test_a_small_mode_moves_as_the_linear_equation_says(force: float) -> None:
    model = filament(load=TipLoad(force))
    value, vector = starts.leading_mode(model)
    shape = vector / vector[-1]
    errors = []
    for amplitude in (0.1, 0.01):
        x = starts.mode(model, amplitude)
        size = x[-3] / shape[-1].real
        assert np.abs(x[::3] - size * shape.real).max() < amplitude**3
        rate = size * (value * shape).real
        errors.append(np.abs(model.rhs(x)[::3] - rate).max() / np.abs(rate).max())
    # By symmetry the nonlinear part is of third order, relatively of second.
    assert errors[0] < 0.1
    assert errors[1] < 0.02 * errors[0]


# ------------------------------------------------------------------ stored shapes


@every_form
def test_a_stored_state_of_as_many_links_is_kept_exactly(form: Form) -> None:
    model = filament(form)
    # In the plane x-z a turn to that plane is none, but on the other side it is one by pi.
    x = random_state(model)
    x = x if model.nodes(x)[np.argmax(np.abs(model.nodes(x)[:, 0])), 0] > 0.0 else model.reflect(x)
    assert (starts.from_state(model, model.nodes(x)) == x).all()


@pytest.mark.parametrize("factor", [0.5, 2, 4])
@pytest.mark.parametrize("start", CURVES, ids=name_of)
def test_a_stored_state_is_carried_to_other_links_with_second_order(
    start: Callable[..., State], factor: float
) -> None:
    errors = []
    for segments in SEGMENTS[:3]:
        stored, model = filament(segments=segments), filament(segments=int(factor * segments))
        carried = starts.from_state(model, stored.nodes(start(stored, 1.0)))
        errors.append(np.abs(carried - start(model, 1.0)).max())
    # Linear interpolation is of second order, and better where middles of links coincide.
    assert order(errors) > 1.85


@pytest.mark.parametrize("factor", [0.5, 2, 4])
@pytest.mark.parametrize("start", [starts.kicked, starts.planar], ids=name_of)
def test_the_energy_of_a_stored_state_is_carried_over_with_second_order(
    start: Callable[..., State], factor: float
) -> None:
    errors = []
    for segments in SEGMENTS[1:]:
        stored, model = filament(segments=segments), filament(segments=int(factor * segments))
        carried = starts.from_state(model, stored.nodes(start(stored, 1.0)))
        errors.append(abs(model.energy(carried) / model.energy(start(model, 1.0)) - 1.0))
    # As above. A kink at the clamp or at the tip would make it first order.
    assert order(errors) > 1.85


def test_a_stored_state_can_be_made_larger() -> None:
    model, stored = filament(segments=24), filament(segments=12)
    one = starts.from_state(model, stored.nodes(starts.kicked(stored, 0.2)))
    two = starts.from_state(model, stored.nodes(starts.kicked(stored, 0.2)), 2.0)
    # Round-off of nodes over links of 1/24.
    np.testing.assert_allclose(
        inclination(model.nodes(two)), 2.0 * inclination(model.nodes(one)), atol=1e-13
    )


@given(st.floats(-7.0, 7.0))
def test_a_confined_model_takes_a_planar_state_from_any_plane(angle: float) -> None:
    free, confined = filament(FREE), filament(CONFINED)
    carried = starts.from_state(confined, free.nodes(starts.planar(free, 0.8, angle=angle)))
    # Round-off of a rotation.
    np.testing.assert_allclose(carried, starts.planar(confined, 0.8), atol=1e-15)


# ------------------------------------------------------------------ what is refused


def test_a_confined_model_refuses_a_helix() -> None:
    assert "helix" in complaint(lambda: starts.helix(filament(CONFINED)))


@pytest.mark.parametrize("start", [starts.planar, starts.mode], ids=name_of)
def test_a_confined_model_refuses_an_angle(start: Callable[..., State]) -> None:
    assert "angle" in complaint(lambda: start(filament(CONFINED), 0.1, angle=0.3))


@pytest.mark.parametrize("segments", [12, 24])
def test_a_confined_model_refuses_a_state_that_is_not_planar(segments: int) -> None:
    free = filament(FREE)
    nodes = free.nodes(starts.helix(free, 0.3))
    confined = filament(CONFINED, segments=segments)
    assert "not planar" in complaint(lambda: starts.from_state(confined, nodes))


@every_free_form
@pytest.mark.parametrize("amplitude", [0.0, -0.1, 3.2, math.nan, math.inf])
@pytest.mark.parametrize("start", BENT, ids=name_of)
def test_an_amplitude_that_is_no_inclination_is_refused_by_name(
    start: Callable[..., State], amplitude: float, form: Form
) -> None:
    assert f"amplitude = {amplitude}" in complaint(lambda: start(filament(form), amplitude))


@pytest.mark.parametrize("shape", [(13, 2), (1, 3), (39,)])
def test_nodes_that_make_no_shape_are_refused(shape: tuple[int, ...]) -> None:
    nodes = np.zeros(shape)
    assert f"{shape}" in complaint(lambda: starts.from_state(filament(), nodes))


def test_nodes_of_a_shape_that_are_not_finite_are_refused() -> None:
    nodes = filament(segments=9).nodes(filament(segments=9).straight())
    nodes[3, 1] = math.nan
    assert "finite" in complaint(lambda: starts.from_state(filament(), nodes))
