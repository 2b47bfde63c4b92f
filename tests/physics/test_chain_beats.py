"""Beats of chains, against scipy in the angles of the links; where they end and where they last."""

import numpy as np
import pytest

import undula as un
from cases import mostly_slow
from planar_chain import beat, rate_out_of_plane
from undula.analysis.states.branch import Branch
from undula.analysis.states.not_found import NotFound
from undula.arrays import Array
from undula.models.chain import Chain
from undula.models.loads.analytic import TipLoad


def plain(links: int, force: float = 1.0) -> Chain:
    return Chain(links, TipLoad(force))


def flapping(model: Chain) -> un.Flapping:
    found = un.find(model, "flapping")
    assert isinstance(found, un.Flapping)
    return found


@pytest.mark.parametrize(
    ("links", "force"),
    mostly_slow([(2, 8.0), (2, 11.0), (3, 8.0), (3, 20.0)], lambda beat: beat == (2, 8.0)),
)
def test_beats_are_those_of_the_angles_by_scipy(links: int, force: float) -> None:
    state, expected = flapping(plain(links, force)), beat(links, force)
    # What scipy's tolerance of 1e-11 leaves, besides the stated error.
    assert abs(state.frequency - expected.frequency) < 2.0 * state.time_error + 1e-10
    # A range over 64 instants of a bend that is sharp for a moment.
    assert state.bending_energy.min == pytest.approx(expected.low, rel=1e-3)
    assert state.bending_energy.max == pytest.approx(expected.high, rel=1e-3)
    out_of_plane = rate_out_of_plane(links, force, expected)
    # Out of the plane a joint stiffens by psi / sin psi, 10 at 11 K/L, for a moment that few of the
    # steps of half a beat see.
    assert state.leading_rate_out_of_plane == pytest.approx(out_of_plane, rel=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize(("links", "force", "rate"), [(2, 12.0, 44.2), (3, 24.0, 47.5)])
def test_nearly_folded_beats_have_the_rates_of_the_note(
    links: int, force: float, rate: float
) -> None:
    # docs/notes/chains.md, to half a unit of the last digit.
    assert rate_out_of_plane(links, force, beat(links, force)) == pytest.approx(rate, abs=0.05)


@pytest.mark.slow
def test_the_joint_at_the_base_of_two_links_folds_at_a_force_beyond_twice_the_onset() -> None:
    # docs/notes/chains.md: there the beat meets the kink of the spring.
    turns = [beat(2, force).turns[0] for force in (12.1163, 12.1165)]
    assert turns[0] < np.pi < turns[1]


def followed_to_its_end(links: int, to: float) -> Branch[un.Flapping]:
    branch = un.follow_from_onset(plain(links), "flapping", to)
    assert isinstance(branch, Branch)
    return branch


@pytest.mark.slow
@pytest.mark.parametrize(
    ("links", "folded"),
    [(2, 12.11638), (3, 24.29071), (4, 35.17762), (5, 45.42)],
)
def test_beats_of_two_to_five_links_are_unstable_out_of_their_plane_up_to_where_a_joint_folds(
    links: int, folded: float
) -> None:
    branch = followed_to_its_end(links, 1.1 * folded)
    assert not branch.complete
    # The spring is rounded off a hundredth of a radian before; steps may end sooner by their size.
    assert 0.98 * folded < branch.values[-1] < folded
    for state in branch.states:
        assert state.leading_rate_out_of_plane is not None
        assert state.leading_rate_out_of_plane > 0.0
    assert not any(one.gains for one in branch.bifurcations)
    # It is the joint below the last two links that folds.
    turns = _largest_turns(branch.states[-1])
    assert np.argmax(turns) == links - 2
    assert np.pi - 0.2 < turns.max() < np.pi


def _largest_turns(state: un.Flapping) -> Array:
    links = np.diff(state.nodes, axis=1) * state.model.links
    clamped = np.concatenate([np.broadcast_to([0.0, 0.0, 1.0], links[:, :1].shape), links], axis=1)
    cosines = (clamped[:, 1:] * clamped[:, :-1]).sum(axis=-1)
    return np.arccos(np.clip(cosines, -1.0, 1.0)).max(axis=0)


#: Both ends of the window of docs/notes/chains.md [K/L].
GAINED, LOST_AGAIN = 25.43308, 44.92109


@pytest.mark.slow
def test_six_links_flap_stably_in_a_window() -> None:
    gained = un.threshold(plain(6), "flapping-gained")
    # The digits of the note.
    assert gained.value == pytest.approx(GAINED, rel=2e-7)
    assert gained.bifurcation == "symmetry breaking"
    for force, stable in ((24.0, False), (30.0, True), (40.0, True), (46.0, False)):
        assert flapping(plain(6, force)).stable == stable


@pytest.mark.slow
@pytest.mark.parametrize(("links", "overlap"), [(6, False), (7, True), (10, True)])
def test_from_seven_links_on_both_motions_are_stable_in_between(links: int, overlap: bool) -> None:
    gained = un.threshold(plain(links), "flapping-gained").value
    lost = un.threshold(plain(links), "spinning-lost").value
    assert gained is not None
    assert lost is not None
    # They differ by a hundredth and more.
    assert (gained < lost) == overlap


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "force", "sign"),
    [("flapping-gained", GAINED, -1.0), ("flapping-lost", LOST_AGAIN, 1.0)],
)
def test_the_window_ends_where_disturbances_by_scipy_change_their_sign(
    kind: str, force: float, sign: float
) -> None:
    found = un.threshold(plain(6), kind)
    assert found.value == pytest.approx(force, rel=2e-7)
    forces = [part * force for part in (0.99, 1.0, 1.01)]
    below, at, above = (rate_out_of_plane(6, one, beat(6, one)) for one in forces)
    slope = (above - below) / (0.02 * force)
    assert np.sign(slope) == sign
    # Scipy's beats have settled to some 1e-7 of themselves.
    assert abs(at) < abs(slope) * 2e-6 * force


@pytest.mark.parametrize(("links", "force"), [(2, 8.0), (2, 11.0), (3, 20.0)])
def test_a_confined_run_beats_at_the_frequency_solved_for(links: int, force: float) -> None:
    model = plain(links, force).with_(confined=True)
    run = un.integrate(model, un.planar(model, 0.3), until="settled", limit=200.0)
    assert run.verdict.name == "planar flapping"
    assert run.frequency is not None
    state = flapping(model)
    # Tolerances of 1e-6 in each of some hundred steps of a beat, in part systematic.
    assert run.frequency.value == pytest.approx(state.frequency, rel=1e-5)


# ------------------------------------------------------------------ windmills


def turns_of_links(run: un.Run, axis: Array) -> Array:
    """Return how often each link turns about an axis across the clamp's [turns per T]."""
    late = run.motion.late(0.5 * run.motion.time[-1])
    links = np.diff(late.nodes, axis=1)
    across = np.array([-axis[1], axis[0], 0.0])
    angles = np.unwrap(np.arctan2(links @ across, links[..., 2]), axis=0)
    return np.asarray(np.abs(angles[-1] - angles[0])) / (
        2.0 * np.pi * (late.time[-1] - late.time[0])
    )


@pytest.mark.parametrize(("links", "force"), [(2, 13.0), (3, 30.0), (4, 40.0), (5, 50.0)])
def test_beyond_the_fold_the_last_two_links_of_a_confined_chain_windmill(
    links: int, force: float
) -> None:
    model = plain(links, force).with_(confined=True)
    run = un.integrate(model, un.planar(model, 0.3), until=20.0)
    turns = turns_of_links(run, np.array([0.0, 1.0, 0.0]))
    # Over 10 T the others come back to where they were within half a turn, or within one.
    assert (turns[-2:] > 1.0).all()
    assert (turns[:-2] < 0.1).all()
    assert turns[-1] == pytest.approx(turns[-2], abs=0.1)


@pytest.mark.parametrize(("links", "force", "upper"), [(3, 100.0, 3), (4, 100.0, 3), (5, 45.0, 2)])
def test_beyond_spinning_the_upper_links_windmill_about_a_level_axis(
    links: int, force: float, upper: int
) -> None:
    model = plain(links, force)
    run = un.integrate(model, un.kicked(model, 0.1), until=60.0, samples=20_000)
    last = np.diff(run.motion.nodes, axis=1)[-10_000:, -1]
    level = np.linalg.eigh(np.cov(last.T))[1][:, 0]
    # The axis about which the last link turns, from where it is least.
    assert abs(level[2]) < 0.05
    turns = turns_of_links(run, level)
    assert (turns[-upper:] > 5.0).all()
    assert (turns[:-upper] < 0.1).all()


def test_beyond_the_fold_no_beat_is_made_up() -> None:
    # From 20 K/L on two links windmill, of which half a turn may close on something in 32 steps.
    found = [un.find(Chain(2, TipLoad(force)), "flapping") for force in (20.0, 21.0)]
    assert all(isinstance(one, NotFound) for one in found)
    assert all("does not beat (windmilling)" in one.reason for one in found)
