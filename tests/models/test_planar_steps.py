"""Claims on steps of motions that lie in a plane, which are taken with an emptier matrix."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from cases import Form, filament
from uncached import uncached
from undula.analysis.run_settings import Schedule
from undula.analysis.runs.simulation import Simulation
from undula.arrays import Array, State
from undula.models import initial_states as starts
from undula.models.filament import Filament
from undula.models.loads.analytic import TipLoad
from undula.numerics.integration.stepper_state import PLANAR, STEPS
from undula.numerics.integration.system import error_norm, plane

#: Beats in a plane are stable in space.
FLAPPING = Filament(12, TipLoad(200.0))


@uncached
def nearest_plane(system: Any, y: Any, w: Any) -> Any:
    return plane(system, y, w)


@uncached
def norm_of(system: Any, vector: Any, mask: Any) -> Any:
    return error_norm(system, vector, mask)


@pytest.mark.parametrize("azimuth", [-1.2, 0.0, 0.7, 1.5])
def test_the_nearest_plane_of_a_flat_state_is_its_own(azimuth: float) -> None:
    model = filament()
    y = model.unknowns(starts.planar(model, 1.2, angle=azimuth))
    found, off = nearest_plane(model.system, y, 0.3 * y)
    assert found == pytest.approx(azimuth, abs=1e-14)
    # Round-off of positions up to 1 over a link, twelve times.
    assert off < 1e-14


@pytest.mark.parametrize("part", ["state", "change"])
def test_how_far_a_state_or_its_change_is_off_its_plane_is_the_size_of_that(part: str) -> None:
    model = filament()
    flat = model.unknowns(starts.planar(model, 1.2))
    across = np.zeros((model.segments, 4))
    across[:, 1] = 1e-3 * np.random.default_rng(4).normal(size=model.segments)
    y, w = flat, np.zeros(flat.size)
    if part == "state":
        y = y + across.ravel()
    else:
        w = w + across.ravel()
    azimuth, off = nearest_plane(model.system, y, w)
    size = norm_of(model.system, across.ravel(), model.position_mask)
    if part == "change":
        assert off == pytest.approx(size, rel=1e-14)
    # The plane turns to where the least is left.
    assert off <= size
    turned = model.unknowns(model.rotate(model.positions(y), -azimuth))
    assert nearest_plane(model.system, turned, w)[0] == pytest.approx(0.0, abs=1e-14)


def test_the_straight_state_is_in_a_plane_and_one_that_is_no_number_is_not() -> None:
    model = filament()
    y = model.unknowns(model.straight())
    assert nearest_plane(model.system, y, 0.0 * y) == (0.0, 0.0)
    y[4] = np.nan
    assert np.isnan(nearest_plane(model.system, y, 0.0 * y)[1])


def test_a_system_that_does_not_say_where_its_planes_are_is_never_in_one() -> None:
    for form in (Form("exact", True), Form("weak", False)):
        model = filament(form)
        y = model.unknowns(model.straight())
        assert nearest_plane(model.system, y, 0.0 * y)[1] == np.inf


def run_from(model: Filament, x: State, *, until: float = 0.02, rtol: float = 1e-6) -> Simulation:
    run = Simulation.begin(model, x, Schedule(until=until, samples=101, rtol=rtol))
    while run.advance():
        pass
    return run


def shapes(run: Simulation) -> Array:
    """Return the positions of all samples (m, N, d)."""
    model: Any = run.model
    return run.model.positions(run.states[:, :-3]).reshape(-1, model.segments, model.dimension)


@pytest.fixture(scope="module")
def flat() -> Simulation:
    """Return a motion in the plane of azimuth 0."""
    return run_from(FLAPPING, starts.planar(FLAPPING, 0.5))


@pytest.mark.parametrize("azimuth", [0.7, 1.5, -2.5])
def test_a_motion_is_the_same_in_every_plane(flat: Simulation, azimuth: float) -> None:
    run = run_from(FLAPPING, starts.planar(FLAPPING, 0.5, angle=azimuth))
    assert flat.memory.count[PLANAR] == run.memory.count[PLANAR] == 1
    assert run.memory.count[STEPS] == flat.memory.count[STEPS]
    cosine, sine = np.cos(azimuth), np.sin(azimuth)
    found, expected = shapes(run), shapes(flat)
    along = cosine * found[..., 0] + sine * found[..., 1]
    # Round-off of 1000 steps.
    np.testing.assert_allclose(along, expected[..., 0], atol=1e-11)
    np.testing.assert_allclose(found[..., 2], expected[..., 2], atol=1e-11)
    assert np.abs(cosine * found[..., 1] - sine * found[..., 0]).max() < 1e-13


def test_a_motion_in_a_plane_is_that_of_the_filament_confined_to_it(flat: Simulation) -> None:
    confined = replace(FLAPPING, confined=True)
    run = run_from(confined, starts.planar(confined, 0.5))
    assert run.memory.count[PLANAR] == 0
    assert run.memory.count[STEPS] == flat.memory.count[STEPS]
    # The same matrix with other round-off, in as many steps.
    np.testing.assert_allclose(shapes(flat)[..., [0, 2]], shapes(run), atol=1e-11)
    assert not shapes(flat)[..., 1].any()


def beside(off: float) -> State:
    """Return a bent state that is off its plane by about so much."""
    x = starts.planar(FLAPPING, 0.5).reshape(-1, 3)
    x[:, 1] = off * x[:, 2] ** 3
    return FLAPPING.admissible(x.ravel())


@pytest.mark.parametrize(("off", "planar"), [(1e-8, 1), (1e-4, 0)])
def test_what_is_off_a_plane_by_less_than_a_step_may_err_is_in_it(off: float, planar: int) -> None:
    run = run_from(FLAPPING, beside(off), until=1e-3, rtol=1e-6)
    assert run.memory.count[PLANAR] == planar


def test_a_motion_that_nears_a_plane_goes_on_in_it() -> None:
    run = run_from(FLAPPING, beside(1e-4), until=0.5)
    off = [
        nearest_plane(FLAPPING.system, state, 0.0 * state)[1] for state in run.states[[0, -1], :-3]
    ]
    # It takes to the plane nearest to its start by much more than where it is told to be in it.
    assert off[0] > 1e-5
    assert off[1] < 1e-8
    assert run.memory.count[PLANAR] == 1


def test_a_motion_that_passes_through_a_plane_is_not_in_it() -> None:
    model = filament()
    y = model.unknowns(starts.planar(model, 0.5))
    assert nearest_plane(model.system, y, 0.0 * y)[1] < 1e-14
    moving = np.zeros((model.segments, 4))
    moving[:, 1] = 1e-3
    assert nearest_plane(model.system, y, moving.ravel())[1] > 1e-4
