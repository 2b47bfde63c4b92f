"""Observables on shapes and motions whose answers are known on paper."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from undula.analysis.observables.alignment import aligned_distance
from undula.analysis.observables.planarity import in_plane, planarity, plane_angle
from undula.analysis.observables.shapes import (
    azimuth,
    displacement,
    envelope,
    mean_position,
    tip_height,
    tip_position,
    tip_radius,
)
from undula.arrays import Array

ANGLES = st.floats(-np.pi, np.pi)
SEEDS = st.integers(0, 2**32 - 1)


def turned(nodes: Array, angle: float) -> Array:
    """Nodes turned about z, by the matrix and not by complex numbers."""
    c, s = np.cos(angle), np.sin(angle)
    return nodes @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])


def random_shape(seed: int, samples: int = 1) -> Array:
    nodes = np.random.default_rng(seed).normal(scale=0.3, size=(samples, 9, 3))
    nodes[:, 0] = 0.0
    return nodes


def straight(links: int) -> Array:
    nodes = np.zeros((links + 1, 3))
    nodes[:, 2] = np.linspace(0.0, 1.0, links + 1)
    return nodes


def arc(radius: float, links: int) -> Array:
    """A circular arc of length 1 in the x-z plane, clamped along z."""
    turn = np.linspace(0.0, 1.0, links + 1) / radius
    return radius * np.stack([1.0 - np.cos(turn), np.zeros(links + 1), np.sin(turn)], axis=1)


def test_the_straight_filament_is_where_it_should_be() -> None:
    nodes = straight(10)
    assert displacement(nodes) == 0.0
    assert tip_radius(nodes) == 0.0
    assert tip_height(nodes) == 1.0
    np.testing.assert_array_equal(tip_position(nodes), [0.0, 0.0, 1.0])
    # Round-off of eleven terms.
    np.testing.assert_allclose(mean_position(nodes), [0.0, 0.0, 0.5], atol=1e-15)


def test_a_quarter_circle_has_its_tip_at_equal_height_and_radius() -> None:
    nodes = arc(2.0 / np.pi, 40)
    # Round-off.
    assert tip_radius(nodes) == pytest.approx(2.0 / np.pi, rel=1e-14)
    assert tip_height(nodes) == pytest.approx(2.0 / np.pi, rel=1e-14)


def test_the_mean_position_tends_to_that_of_the_arc_with_order_two() -> None:
    radius = 2.0 / np.pi
    exact = radius * (1.0 - radius)
    errors = [abs(mean_position(arc(radius, n))[0] - exact) for n in (10, 20, 40, 80)]
    slope = -np.polyfit(np.log([10, 20, 40, 80]), np.log(errors), 1)[0]
    # The trapezoid rule's order is 2; the fit over these sizes is good to a hundredth.
    assert slope == pytest.approx(2.0, abs=0.02)


def test_the_displacement_is_the_rms_distance_over_the_arc_length() -> None:
    nodes = straight(400)
    nodes[:, 1] = 0.3 * nodes[:, 2]
    # RMS of 0.3 s over [0, 1]; the trapezoid rule is off by 1/(12 N^2) of the slope change.
    assert displacement(nodes) == pytest.approx(0.3 / np.sqrt(3.0), rel=1e-5)


def test_observables_of_a_trajectory_are_those_of_its_samples() -> None:
    nodes = random_shape(3, samples=4)
    for observe in (displacement, tip_radius, tip_height, tip_position, mean_position):
        np.testing.assert_array_equal(observe(nodes)[2], observe(nodes[2]))


def test_the_winding_angle_counts_whole_turns_with_their_sense() -> None:
    time = np.linspace(0.0, 1.0, 200)
    shape = arc(1.0, 10)
    for turns in (7.3, -7.3):
        nodes = np.stack([turned(shape, 2.0 * np.pi * turns * t) for t in time])
        angle = azimuth(nodes)
        # Round-off of forty radians.
        assert angle[-1] - angle[0] == pytest.approx(2.0 * np.pi * turns, rel=1e-12)


def test_the_envelope_reads_extremes_between_the_samples() -> None:
    time = np.linspace(0.0, 2.0, 2 * 37, endpoint=False)
    found = envelope(2.0 + np.cos(2.0 * np.pi * time + 0.4))
    # Parabolas err by the fourth power of a step of 0.17 rad over 24 at most: 3.5e-5.
    assert found.max == pytest.approx(3.0, abs=3.5e-5)
    assert found.min == pytest.approx(1.0, abs=3.5e-5)
    # Whole periods: the mean is exact to round-off.
    assert found.mean == pytest.approx(2.0, abs=1e-14)


@pytest.mark.parametrize("values", [[1.5], [1.5, 0.5], [0.0, 0.0, 0.0]])
def test_the_envelope_of_too_few_or_constant_samples_is_their_own(values: list[float]) -> None:
    found = envelope(np.array(values))
    assert (found.min, found.max) == (min(values), max(values))


def test_the_envelope_of_a_ramp_ends_at_its_ends() -> None:
    found = envelope(np.linspace(0.0, 1.0, 11) ** 2)
    assert (found.min, found.max) == (0.0, 1.0)


@given(seed=SEEDS, angle=ANGLES)
def test_planarity_does_not_change_when_the_motion_is_turned(seed: int, angle: float) -> None:
    nodes = random_shape(seed, samples=5)
    # Round-off of sums of 45 terms.
    assert planarity(turned(nodes, angle)) == pytest.approx(planarity(nodes), abs=1e-13)


@given(seed=SEEDS, angle=ANGLES)
def test_a_motion_in_a_plane_has_planarity_zero_and_shows_its_plane(
    seed: int, angle: float
) -> None:
    nodes = random_shape(seed, samples=5)
    nodes[..., 1] = 0.0
    nodes = turned(nodes, angle)
    # Distances, not a difference of eigenvalues: zero to round-off, not to its root.
    assert planarity(nodes) < 1e-14
    difference = plane_angle(nodes) - angle
    # An angle of a plane is known up to half turns.
    assert np.sin(difference) == pytest.approx(0.0, abs=1e-14)


def test_planarity_of_an_ellipse_is_its_minor_share() -> None:
    phase = 2.0 * np.pi * np.arange(60) / 60
    shape = np.linspace(0.0, 1.0, 9)
    nodes = np.zeros((60, 9, 3))
    nodes[..., 0] = 0.4 * np.cos(phase)[:, None] * shape
    nodes[..., 1] = 0.3 * np.sin(phase)[:, None] * shape
    # Axes 4 and 3: 3/5. A whole number of samples a turn makes it exact to round-off.
    assert planarity(nodes) == pytest.approx(0.6, abs=1e-14)


def test_planarity_agrees_with_the_eigenvalues_of_the_covariance() -> None:
    nodes = random_shape(11, samples=6)
    weights = np.full(9, 1.0)
    weights[[0, -1]] = 0.5
    sides = nodes[..., :2]
    small, large = np.linalg.eigvalsh(np.einsum("k,mka,mkb->ab", weights, sides, sides))
    # Round-off.
    assert planarity(nodes) == pytest.approx(np.sqrt(small / (small + large)), rel=1e-12)
    _, across = in_plane(nodes, plane_angle(nodes))
    assert np.sum(weights * across**2) == pytest.approx(small, rel=1e-12)


def test_a_filament_that_never_leaves_the_axis_is_planar() -> None:
    assert planarity(straight(5)[None]) == 0.0


@given(seed=SEEDS, angle=ANGLES)
def test_a_turned_copy_is_at_aligned_distance_zero(seed: int, angle: float) -> None:
    shape = random_shape(seed)[0]
    found = aligned_distance(shape, turned(shape, angle))
    # Round-off of positions of order one.
    assert found.distance < 1e-14
    assert np.exp(1j * (found.angle + angle)) == pytest.approx(1.0, abs=1e-13)


@given(seed=SEEDS, angle_a=ANGLES, angle_b=ANGLES)
def test_the_aligned_distance_does_not_change_when_either_shape_is_turned(
    seed: int, angle_a: float, angle_b: float
) -> None:
    a, b = random_shape(seed, samples=2)
    found = aligned_distance(turned(a, angle_a), turned(b, angle_b)).distance
    # Round-off.
    assert found == pytest.approx(aligned_distance(a, b).distance, rel=1e-12)


@given(seed=SEEDS)
def test_no_turn_brings_two_shapes_nearer_than_the_aligned_distance(seed: int) -> None:
    a, b = random_shape(seed, samples=2)
    weights = np.full(9, 1.0 / 8.0)
    weights[[0, -1]] *= 0.5
    trials = [turned(b, angle) for angle in np.linspace(0.0, 2.0 * np.pi, 181)]
    distances = [np.sqrt(weights @ np.sum((a - trial) ** 2, axis=1)) for trial in trials]
    found = aligned_distance(a, b).distance
    # Turns two degrees apart: the best is within one degree, and within 2e-4 of the least square.
    assert found <= min(distances) + 1e-14
    assert found == pytest.approx(min(distances), abs=1e-3)


def test_heights_count_in_the_aligned_distance_and_do_not_turn() -> None:
    raised = straight(8)
    raised[:, 2] += 0.25
    # Round-off.
    assert aligned_distance(straight(8), raised).distance == pytest.approx(0.25, rel=1e-14)


def test_a_trajectory_is_aligned_with_one_shape_sample_by_sample() -> None:
    nodes = random_shape(5, samples=4)
    found = aligned_distance(nodes, nodes[1])
    assert found.distance.shape == (4,)
    assert found.distance[3] == aligned_distance(nodes[3], nodes[1]).distance
