"""Claims on the bead-spring chain: its slow twin, its energy, its symmetries, and the filament."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import undula as un
from chains import OPTIONS, chain, energy, random_state, tangents_of, virtual_work
from refusal import complaint
from undula.arrays import Array
from undula.models.chain import Chain
from undula.models.filament import Filament
from undula.models.loads.analytic import DensityLoad, LinearLoad, PointLoad, TipLoad
from undula.models.loads.beads import BeadLoad

every_option = pytest.mark.parametrize("option", OPTIONS)
every_number = pytest.mark.parametrize("links", range(1, 13))
either = pytest.mark.parametrize("confined", [False, True], ids=["free", "confined"])
turns = st.floats(-7.0, 7.0)
seeds = st.integers(0, 2**32 - 1)


def close(a: Array, b: Array, tolerance: float) -> bool:
    """Whether a is b to a tolerance relative to the largest entry of b."""
    return float(np.abs(a - b).max()) <= tolerance * float(np.abs(b).max())


# ------------------------------------------------------------------ the slow twin


@every_option
@every_number
@either
def test_beads_move_as_the_principle_of_virtual_work_says(
    option: str, links: int, confined: bool
) -> None:
    model = chain(links, option, confined=confined)
    for seed in range(3):
        x = random_state(model, seed)
        # Joints of 2.5 rad: K psi / sin psi, of size 4, and drag matrices of condition 1e3.
        assert close(model.rhs(x), virtual_work(model, x).velocity, 1e-10)
        assert model.energy(x) == pytest.approx(energy(model, tangents_of(model, x)), rel=1e-13)


@every_option
@every_number
@either
def test_energy_gained_and_dissipated_is_what_the_force_puts_in(
    option: str, links: int, confined: bool
) -> None:
    model = chain(links, option, confined=confined)
    for seed in range(3):
        x = random_state(model, seed)
        work = virtual_work(model, x)
        velocity = model.rhs(x)
        gained = -work.elastic @ work.rates_of(velocity)
        active, dissipated = model.power(x)
        # Each of the three is a sum over at most 12 beads of terms good to 1e-13.
        assert abs(gained + dissipated - active) < 1e-10 * (abs(active) + dissipated)
        assert active == pytest.approx(
            work.active @ work.rates_of(velocity), abs=1e-10 * dissipated
        )


@every_option
@either
def test_the_jacobian_is_the_derivative_of_the_velocity(option: str, confined: bool) -> None:
    model = chain(5, option, confined=confined)
    x, step = random_state(model, 1, bend=2.0), 1e-5
    numerical = [
        (model.rhs(x + unit) - model.rhs(x - unit)) / (2.0 * step)
        for unit in np.eye(model.size) * step
    ]
    # The square of the step over that of a link, 2.5e-9, times third derivatives of joints.
    assert close(model.jacobian(x), np.array(numerical).T, 1e-7)


@every_option
@every_number
def test_a_straight_chain_is_at_rest(option: str, links: int) -> None:
    model = chain(links, option)
    # Differences of the force's parts, 9 in all.
    assert np.abs(model.rhs(model.straight())).max() < 1e-13


# ------------------------------------------------------------------ symmetry


@given(option=st.sampled_from(sorted(OPTIONS)), angle=turns, seed=seeds, links=st.integers(1, 12))
@settings(max_examples=60)
def test_turning_or_reflecting_a_chain_does_so_with_its_velocity(
    option: str, angle: float, seed: int, links: int
) -> None:
    model = chain(links, option)
    x = random_state(model, seed)
    turned, reflected = model.rotate(x, angle), model.reflect(x)
    # Round-off of a tridiagonal system whose tensions grow with folded joints.
    assert close(model.rhs(turned), model.rotate(model.rhs(x), angle), 1e-11)
    assert close(model.rhs(reflected), model.reflect(model.rhs(x)), 1e-12)
    for moved in (turned, reflected):
        assert model.energy(moved) == pytest.approx(model.energy(x), rel=1e-12, abs=0.0)
        assert close(np.array(model.power(moved)), np.array(model.power(x)), 1e-11)


@every_option
@every_number
def test_a_confined_chain_moves_like_a_free_one_in_a_plane(option: str, links: int) -> None:
    flat, free = chain(links, option, confined=True), chain(links, option)
    x = random_state(flat, 5)
    in_space = free.from_nodes(flat.nodes(x))
    velocity = free.rhs(in_space).reshape(-1, 3)
    # The same sums, compiled for other dimensions.
    assert close(velocity[:, [0, 2]].ravel(), flat.rhs(x), 1e-11)
    assert (velocity[:, 1] == 0.0).all()
    assert free.energy(in_space) == pytest.approx(flat.energy(x), rel=1e-14)


# ------------------------------------------------------------------ one link


@every_option
@pytest.mark.parametrize("force", [0.0, 9.0, 1e4])
def test_one_link_returns_to_straight_whatever_pushes_it(option: str, force: float) -> None:
    model = chain(1, option).with_(force=force)
    weight = np.ravel(model.bead_drag)[0]
    for angle in (0.1, 1.5, 3.0):
        x = np.array([np.sin(angle), 0.0, np.cos(angle)])
        across = np.array([np.cos(angle), 0.0, -np.sin(angle)])
        # A force along the link goes into its tension: round-off of the latter is left.
        expected = -model.base_spring / weight * angle * across
        np.testing.assert_allclose(model.rhs(x), expected, atol=1e-13 + 1e-15 * force)


@pytest.mark.parametrize("force", [1.0, 300.0])
def test_a_run_of_one_link_falls_exponentially_to_straight(force: float) -> None:
    model = Chain(1, TipLoad(force), base_spring=2.0, bead_drag=0.5)
    run = un.integrate(model, un.planar(model, 1.0, angle=0.7), until=1.0)
    tip = run.motion.nodes[-1, -1]
    # psi' = -4 psi, in the plane in which it began; the run's tolerance of 1e-6 in each step.
    assert np.arctan2(np.hypot(tip[0], tip[1]), tip[2]) == pytest.approx(math.exp(-4.0), rel=1e-4)
    assert np.arctan2(tip[1], tip[0]) == pytest.approx(0.7, abs=1e-9)


# ------------------------------------------------------------------ the filament


def twins(load: DensityLoad, links: int, *, confined: bool = False) -> tuple[Filament, Chain]:
    """Return a filament, and the chain that it is: K = B / l, zeta = zeta_perp l, half its ends."""
    filament = Filament(links, load, drag_ratio=2.0, confined=confined)
    ends = (*[1.0] * (links - 1), 0.5)
    other = Chain(links, load, drag_ratio=2.0, base_spring=2.0, bead_drag=ends, confined=confined)
    return filament, other.with_(force=load.force / links)


every_twin = pytest.mark.parametrize(
    "load", [TipLoad(75.0), PointLoad(60.0, 0.37), LinearLoad(90.0, 0.5)], ids=repr
)


@every_twin
@pytest.mark.parametrize("links", [4, 7, 12, 40])
@either
def test_a_chain_with_the_filaments_tables_is_the_filament(
    load: DensityLoad, links: int, confined: bool
) -> None:
    filament, other = twins(load, links, confined=confined)
    x = random_state(filament, 3, bend=1.0)
    # Factors of N are rounded here and there, and stiff forces enlarge what that leaves.
    assert close(links**2 * other.rhs(x), filament.rhs(x), 1e-11)
    assert close(links**2 * other.jacobian(x), filament.jacobian(x), 1e-10)
    assert links * other.energy(x) == pytest.approx(filament.energy(x), rel=1e-13)
    powers = links**3 * np.array(other.power(x))
    assert close(powers, np.array(filament.power(x)), 1e-12)


@every_twin
def test_it_has_the_filaments_spectrum_and_onset(load: DensityLoad) -> None:
    filament, other = twins(load, 12)
    found = un.spectrum(filament, count=6, method="discrete").values
    np.testing.assert_allclose(144.0 * un.spectrum(other, count=6).values, found, rtol=1e-10)
    onset, of_links = un.onset(filament, method="discrete"), un.onset(other)
    assert of_links.force is not None
    assert of_links.frequency is not None
    # Stiffness grows as the fourth power of the links: 2e4 times round-off.
    assert 12.0 * of_links.force == pytest.approx(onset.force, rel=1e-10)
    assert 144.0 * of_links.frequency == pytest.approx(onset.frequency, rel=1e-10)


def test_it_spins_like_the_filament() -> None:
    filament, other = twins(TipLoad(75.0), 12)
    state, of_links = un.find(filament, "spinning"), un.find(other, "spinning")
    assert isinstance(state, un.Spinning)
    assert isinstance(of_links, un.Spinning)
    # Newton's method ends at round-off on either side.
    assert 144.0 * of_links.frequency == pytest.approx(state.frequency, rel=1e-10)
    assert 12.0 * of_links.bending_energy.mean == pytest.approx(
        state.bending_energy.mean, rel=1e-10
    )
    assert 144.0 * of_links.leading_rate == pytest.approx(state.leading_rate, rel=1e-8)


def test_forces_are_told_per_link_and_as_the_filaments_too() -> None:
    units = chain(3).units
    assert (units.force, units.energy, units.duration) == ("K/L", "K", 9.0)
    assert units.force_in(6.0) == {"K/l": 2.0, "B/L^2": 18.0}


# ------------------------------------------------------------------ what is refused

BAD = (
    [("links", value) for value in (0, 1001, -3, 3.0, True, math.nan, "3", None)]
    + [("load", value) for value in (None, 8.0, "tip")]
    + [("drag_ratio", value) for value in (0.5, 0.0, math.nan, math.inf)]
    + [("base_spring", value) for value in (0.0, -1.0, math.nan, math.inf, "1")]
    + [("bead_drag", value) for value in (0.0, -1.0, math.nan, "1", None, (1.0, 0.0, 1.0))]
    + [("confined", value) for value in (1, None)]
)


@pytest.mark.parametrize(("name", "value"), BAD)
def test_a_value_that_makes_no_chain_is_refused_by_name(name: str, value: Any) -> None:
    arguments: dict[str, Any] = {"links": 3, "load": TipLoad(8.0), name: value}
    assert complaint(lambda: Chain(**arguments)).startswith(f"{name} = {value!r} ")


@pytest.mark.parametrize("given", [(), (1.0, 1.0), [1.0] * 4])
def test_a_list_of_drags_that_is_not_one_for_each_bead_is_refused(given: Any) -> None:
    assert complaint(lambda: Chain(3, TipLoad(8.0), bead_drag=given)) == (
        f"bead_drag lists {len(given)} beads, and a chain of 3 links has 3; give one number for"
        " each, or one for all"
    )


@pytest.mark.parametrize("beads", [(), (0,), (1, 1), (2, -1), (1.0,), (True,), "most", None])
def test_what_is_no_list_of_beads_is_refused(beads: Any) -> None:
    sentence = complaint(lambda: BeadLoad(8.0, beads))
    assert sentence.startswith(f"BeadLoad: beads = {beads!r} has to be 'all' or different whole")
    assert "BeadLoad: force = -1.0" in complaint(lambda: BeadLoad(-1.0))


def test_a_bead_that_the_chain_has_not_is_refused() -> None:
    load = BeadLoad(8.0, (2, 7))
    sentence = "BeadLoad: beads = (2, 7) asks for bead 7 of a chain of 3 links; give numbers from"
    assert complaint(lambda: Chain(3, load)).startswith(sentence)
    assert complaint(lambda: Chain(7, load).with_(links=3)).startswith(sentence)
    assert Chain(7, load).load == BeadLoad(8.0, [7, 2])


def test_a_filament_has_no_beads_to_push() -> None:
    assert "no load that a filament can bear" in complaint(lambda: Filament(10, BeadLoad(8.0)))
