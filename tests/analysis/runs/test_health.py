"""What a run tells about the angles of its joints: the largest, and whether one folded."""

import dataclasses

import numpy as np
import pytest

import undula as un
from cases import Form, every_form, filament, random_state
from undula.analysis.observables.trajectory import Motion
from undula.analysis.runs.accuracy import folded
from undula.app.commands.run_text import run_text
from undula.arrays import Array
from undula.models.model import Energetics
from undula.models.rod.joint import FOLDED


def chain(force: float, **choices: bool) -> un.Chain:
    return un.Chain(2, un.TipLoad(force), **choices)


def elbow(angles: list[float], azimuths: list[float] | float = 0.0, turned: Array | float = 0.0):
    """Return a motion of two links, the first straight up and the second at these angles to it.

    The second lies at some azimuths about the first; the whole has turned by `turned` besides.
    """
    angle, azimuth = np.array(angles), np.broadcast_to(azimuths, len(angles))
    nodes = np.zeros((angle.size, 3, 3))
    nodes[:, 1:, 2] = 0.5
    across = 0.5 * np.sin(angle)
    nodes[:, 2, 0], nodes[:, 2, 1] = across * np.cos(azimuth), across * np.sin(azimuth)
    nodes[:, 2, 2] += 0.5 * np.cos(angle)
    nothing = np.zeros(angle.size)
    turned = np.broadcast_to(turned, angle.size)
    return Motion(nothing, nodes, turned, nothing, nothing, Energetics(*[nothing] * 4))


def joints(motion: Motion) -> Array:
    model = chain(1.0)
    straight = model.unknowns(model.straight()).reshape(-1, 4)
    rows = np.tile(straight, (len(motion.nodes), 1, 1))
    rows[:, :, :3] = motion.nodes[:, 1:]
    return model.joint_angles(rows.reshape(len(rows), -1))


@every_form
def test_joint_angles_are_those_between_neighbouring_tangents(form: Form) -> None:
    model = filament(form)
    rows = np.stack([model.unknowns(random_state(model, seed, bend=3.0)) for seed in range(3)])
    tangents = np.diff(model.nodes(model.positions(rows)), axis=1)
    tangents /= np.linalg.norm(tangents, axis=2, keepdims=True)
    clamped = np.concatenate([np.tile([0.0, 0.0, 1.0], (3, 1, 1)), tangents], axis=1)
    cosines = (clamped[:, 1:] * clamped[:, :-1]).sum(axis=2)
    # The angle of a cosine that is rounded: 1e-16 over the sine, which is above 1e-3 here.
    np.testing.assert_allclose(model.joint_angles(rows), np.arccos(cosines), atol=1e-12)


@pytest.mark.parametrize(
    ("angles", "expected"),
    [
        ([1.0, 2.0, 3.0, 3.0, 1.0], False),
        ([1.0, -1.0], False),
        ([1.5, -1.6], False),
        ([1.6, -1.6], True),
        ([3.0, 3.3], True),
        ([0.0, np.pi - 0.9 * FOLDED, 0.0], True),
        ([0.0, np.pi - 1.1 * FOLDED, 0.0], False),
    ],
)
def test_a_joint_folds_where_the_shortest_way_leads_over_pi(
    angles: list[float], expected: bool
) -> None:
    motion = elbow(angles)
    assert folded(motion, joints(motion)) is expected
    leaning = dataclasses.replace(motion, nodes=tilted(motion.nodes))
    # The first link turns as well: the joint is what counts.
    assert folded(leaning, joints(motion)) is expected


def tilted(nodes: Array) -> Array:
    """Return planar shapes turned in their plane by angles that differ from sample to sample."""
    turned = nodes.copy()
    for k, shape in enumerate(turned):
        cosine, sine = np.cos(0.8 * k), np.sin(0.8 * k)
        shape[:, [0, 2]] = shape[:, [0, 2]] @ np.array([[cosine, -sine], [sine, cosine]])
    return turned


@pytest.mark.parametrize("round_at", [2.0, 3.0])
def test_a_joint_that_swings_round_the_inner_link_does_not_fold(round_at: float) -> None:
    motion = elbow([round_at] * 4, [0.0, 1.0, 2.0, 3.0])
    assert not folded(motion, joints(motion))


def test_turning_of_the_whole_is_no_folding_however_rare_the_samples() -> None:
    turns = np.array([0.0, np.pi, 4.0 * np.pi, 6.9 * np.pi])
    motion = elbow([2.5] * 4, list(turns), turned=turns)
    assert not folded(motion, joints(motion))
    # Without that knowledge half a turn is a way over pi.
    still = dataclasses.replace(motion, rotation_angle=np.zeros(4))
    assert folded(still, joints(still))


@pytest.mark.parametrize("samples", [4000, 300])
def test_a_chain_that_windmills_folds_and_says_so(samples: int) -> None:
    model = chain(20.0, confined=True)
    run = un.integrate(model, un.planar(model, 0.3), until=15.0, samples=samples)
    assert run.health.folded is True
    assert np.pi - 2.0 * FOLDED < run.health.largest_joint_angle <= np.pi
    assert "a joint folded (angle up to pi)" in told(run)


def test_a_beat_at_less_force_does_not_fold() -> None:
    model = chain(8.0, confined=True)
    run = un.integrate(model, un.planar(model, 0.3), until=15.0)
    assert run.health.folded is False
    # The beat's largest angle, its own solution tells.
    state = un.find(model, "flapping")
    angles = state.planar.joint_angles(state.unknowns)
    assert run.health.largest_joint_angle == pytest.approx(np.abs(angles).max(), rel=1e-2)
    assert "folded" not in told(run)


def test_a_filament_that_spins_does_not_fold() -> None:
    model = un.Filament(20, un.TipLoad(75.0))
    run = un.integrate(model, un.kicked(model, 0.3), until=0.3)
    assert run.health.folded is False
    # Twenty links bend by less than a right angle over the whole length.
    assert 0.0 < run.health.largest_joint_angle < 0.5
    assert run.summary()["largest_joint_angle"] == run.health.largest_joint_angle


def told(run: un.Run) -> str:
    names = {"load": "", "seconds": 1.0, "output": "", "figure": None, "movie": None}
    return run_text({"units": run.model.units.names()} | run.summary() | names)
