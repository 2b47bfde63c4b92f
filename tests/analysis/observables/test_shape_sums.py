"""Compiled sums over shapes against numpy, written as the formulas are."""

import numpy as np
import pytest

from undula.analysis.observables.alignment import (
    Compare,
    aligned_distance,
    fixed_distance,
    largest_distance,
)
from undula.analysis.observables.planarity import planarity, plane_angle
from undula.analysis.observables.rotation import lowest_direction
from undula.analysis.observables.shape_sums import gather, largest_bend, link_squares
from undula.analysis.observables.shapes import arc_weights, displacement, mean_position, transverse
from undula.arrays import Array

# Sums of some hundred numbers of order one, in another order.
CLOSE = {"rtol": 1e-12, "atol": 1e-14}


def shapes(count: int, seed: int = 1) -> Array:
    """Rods of nine links in a random walk that goes upwards."""
    steps = np.random.default_rng(seed).normal([0.0, 0.0, 0.5], 0.6, size=(count, 9, 3))
    nodes = np.zeros((count, 10, 3))
    nodes[:, 1:] = np.cumsum(steps / np.linalg.norm(steps, axis=2, keepdims=True) / 9, axis=1)
    return nodes


def naive_alignment(a: Array, b: Array) -> tuple[Array, Array]:
    weights, first, second = arc_weights(a.shape[-2]), transverse(a), transverse(b)
    angle = np.angle(np.sum(weights * first * second.conj(), axis=-1))
    sideways = np.abs(first - np.exp(1j * angle)[..., None] * second) ** 2
    square = np.sum(weights * (sideways + (a[..., 2] - b[..., 2]) ** 2), axis=-1)
    return np.sqrt(square), angle


@pytest.mark.parametrize(
    ("first", "second"),
    [
        (shapes(7), shapes(7, 2)),
        (shapes(7), shapes(1, 2)[0]),
        (shapes(1)[0], shapes(7, 2)),
        (shapes(1)[0], shapes(1, 2)[0]),
        (shapes(6).reshape(2, 3, 10, 3), shapes(3, 2)),
        (shapes(8)[::2], shapes(1, 2)),
    ],
)
def test_shapes_are_aligned_pair_by_pair(first: Array, second: Array) -> None:
    found = aligned_distance(first, second)
    distance, angle = naive_alignment(first, second)
    assert found.distance.shape == found.angle.shape == distance.shape
    np.testing.assert_allclose(found.distance, distance, **CLOSE)
    np.testing.assert_allclose(found.angle, angle, **CLOSE)
    assert (found.distance <= fixed_distance(first, second).distance + 1e-14).all()


@pytest.mark.parametrize("compare", [aligned_distance, fixed_distance])
def test_the_largest_distance_is_that_of_the_farthest_shape(compare: Compare) -> None:
    several, one = shapes(30), shapes(1, 2)[0]
    expected = compare(several, one).distance.max()
    assert largest_distance(several, one, compare) == pytest.approx(expected, rel=1e-12)


def test_shapes_that_differ_by_turns_have_no_distance() -> None:
    one = shapes(1)[0]
    angles = np.linspace(0.0, 6.0, 7)
    cosine, sine, zero = np.cos(angles), np.sin(angles), np.zeros(7)
    axes = np.array([[cosine, -sine, zero], [sine, cosine, zero], [zero, zero, zero + 1.0]])
    turned = np.einsum("abi,kb->ika", axes, one)
    # Distances of round-off alone, as coordinates are of order one.
    assert largest_distance(turned, one, aligned_distance) < 1e-15
    assert largest_distance(turned, one, fixed_distance) > 0.1
    upright = np.linspace(0.0, 1.0, 10)[:, None] * [0.0, 0.0, 1.0]
    assert largest_distance(upright[None], upright, aligned_distance) == 0.0


def test_numbers_are_gathered_from_their_places() -> None:
    rows, places = np.random.default_rng(5).normal(size=(4, 11)), np.arange(12).reshape(4, 3)[::-1]
    nodes = np.empty((4, 4, 3))
    gather(rows, places - 1, nodes)
    padded = np.concatenate([np.zeros((4, 1)), rows], axis=1)
    np.testing.assert_array_equal(nodes, padded[:, places])


def test_mean_positions_are_those_of_the_formula() -> None:
    nodes = shapes(6).reshape(2, 3, 10, 3)
    expected = np.sum(arc_weights(10)[:, None] * nodes, axis=-2)
    np.testing.assert_allclose(mean_position(nodes), expected, **CLOSE)


def test_displacements_are_those_of_the_formula() -> None:
    nodes = shapes(6).reshape(2, 3, 10, 3)
    away = nodes - np.linspace(0.0, 1.0, 10)[:, None] * [0.0, 0.0, 1.0]
    square = np.sum(arc_weights(10)[:, None] * away**2, axis=(-2, -1))
    np.testing.assert_allclose(displacement(nodes), np.sqrt(square), **CLOSE)


def test_the_best_plane_is_that_of_the_covariance() -> None:
    nodes = shapes(40) * [1.0, 0.4, 1.0]
    x, y = nodes[..., 0], nodes[..., 1]
    weights = np.broadcast_to(arc_weights(10), x.shape)
    matrix = np.array([[np.sum(weights * a * b) for a in (x, y)] for b in (x, y)])
    values, vectors = np.linalg.eigh(matrix)
    assert planarity(nodes) == pytest.approx(np.sqrt(values[0] / values.sum()), rel=1e-12)
    assert np.tan(plane_angle(nodes)) == pytest.approx(vectors[1, 1] / vectors[0, 1], rel=1e-10)


def test_links_have_the_lengths_bends_and_directions_of_their_ends() -> None:
    nodes = shapes(5)
    nodes[3, 4:] += [0.0, 0.0, 0.02]
    links = np.diff(nodes, axis=1)
    length = np.linalg.norm(links, axis=2)
    along = links / length[..., None]
    before = np.concatenate([np.broadcast_to([0.0, 0.0, 1.0], (5, 1, 3)), along[:, :-1]], axis=1)
    angle = np.arccos(np.sum(along * before, axis=2)).max()
    least, largest = link_squares(nodes)
    assert (least, largest) == pytest.approx((length.min() ** 2, length.max() ** 2), rel=1e-14)
    assert 2.0 * np.arctan(np.sqrt(largest_bend(nodes))) == pytest.approx(angle, rel=1e-10)
    np.testing.assert_allclose(lowest_direction(nodes), along[..., 2].min(axis=0), **CLOSE)


def test_a_joint_that_is_folded_has_the_angle_pi() -> None:
    nodes = np.array([[[0.0, 0.0, 0.0], [0.0, 0.0, 0.5], [0.0, 0.0, 0.0]]])
    assert 2.0 * np.arctan(np.sqrt(largest_bend(nodes))) == np.pi
