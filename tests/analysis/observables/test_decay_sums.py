"""Compiled passes over a decay against numpy and dense linear algebra."""

import numpy as np
import pytest

from undula import Filament, TipLoad, integrate, kicked
from undula.analysis.observables.decay_sums import deflect, fit_step, follow, pair
from undula.analysis.observables.linear_mode import leading_vector, linear_motion
from undula.analysis.observables.planarity import in_plane, plane_angle
from undula.analysis.observables.shapes import arc_weights
from undula.arrays import Array, Shapes
from undula.models.initial_states import leading_mode


def decaying(seed: int, samples: int = 80) -> tuple[Array, Shapes]:
    """Two modes, and a third that dies out first, of a rod of nine links near a plane."""
    random, time = np.random.default_rng(seed), np.linspace(0.0, 1.0, samples)
    pair_, swing = random.normal(size=(2, 10)), random.uniform(5.0, 25.0)
    third = 0.1 * np.exp(-9.0 * time)[:, None] * random.normal(size=10)
    sides = np.stack([np.cos(swing * time), np.sin(swing * time)], axis=1) @ pair_
    sides = (np.exp(-3.0 * time)[:, None] * sides + third) * np.linspace(0.0, 1.0, 10)
    nodes = np.zeros((samples, 10, 3))
    nodes[..., 0], nodes[..., 1] = 0.8e-3 * sides, 0.6e-3 * sides + 1e-5 * third
    nodes[..., 2] = np.linspace(0.0, 1.0, 10)
    return time, nodes


def naive_motion(time: Array, nodes: Shapes, share: float) -> tuple[float, float, float, int]:
    """Rate, its error, frequency and crossings, from singular vectors and eigenvalues."""
    deflection, _ = in_plane(nodes, plane_angle(nodes))
    mean = deflection @ arc_weights(nodes.shape[1])
    crossings = np.count_nonzero(np.sign(mean[1:]) != np.sign(mean[:-1]))
    lag = max(1, int(share * len(time) / (crossings + 1)))
    few = deflection[:, :0:-1]  # as many nodes as are looked at
    paired = np.concatenate([few[:-lag], few[lag:]], axis=1)
    size = np.linalg.norm(paired, axis=1, keepdims=True)
    path = paired @ np.linalg.svd(paired / size)[2][:2].T
    step = np.linalg.lstsq(path[:-lag] / size[:-lag], path[lag:] / size[:-lag], rcond=None)[0]
    values, vectors = np.linalg.eig(step)
    amplitude = path @ vectors[:, np.argmax(np.abs(values))]
    logs, phases = np.log(np.abs(amplitude)), np.unwrap(np.angle(amplitude))
    clock, half = time[: len(logs)], len(logs) // 2
    rate, first, last = (
        np.polyfit(clock[part], logs[part], 1)[0]
        for part in (slice(None), slice(half), slice(half, None))
    )
    turning = abs(np.polyfit(clock, phases, 1)[0]) / (2.0 * np.pi)
    return rate, max(abs(first - rate), abs(last - rate)), turning, crossings


@pytest.mark.parametrize("seed", range(6))
def test_the_mode_of_a_decay_is_that_of_dense_linear_algebra(seed: int) -> None:
    time, nodes = decaying(seed)
    found = linear_motion(time, nodes)
    assert found is not None
    expected = naive_motion(time, nodes, 0.2)
    told = (found.rate, found.rate_error, found.frequency, found.crossings)
    # Squares of singular values are not exact beyond the half of all digits for the smaller one.
    assert told == pytest.approx(expected, rel=1e-8)


def test_few_nodes_tell_the_rate_of_a_long_wave_as_well_as_all_of_them() -> None:
    filament = Filament(segments=40, load=TipLoad(30.0))
    run = integrate(filament, kicked(filament, 1e-2), until=0.15, rtol=1e-9)
    late = run.motion.late(0.08)
    found, leading = linear_motion(late.time, late.nodes), leading_mode(filament)[0]
    assert found is not None
    # What is left of faster modes at the window's beginning: some 1e-5 of the slowest.
    assert found.rate == pytest.approx(leading.real, rel=1e-4)
    assert 2.0 * np.pi * found.frequency == pytest.approx(abs(leading.imag), rel=1e-4)


def test_deflections_are_those_in_the_plane() -> None:
    _, nodes = decaying(1)
    along, weights = np.empty(nodes.shape[:2]), arc_weights(10)
    crossings, moved = deflect(nodes, 0.7, weights, along)
    expected, _ = in_plane(nodes, 0.7)
    np.testing.assert_allclose(along, expected, rtol=1e-12, atol=1e-18)
    signs = np.sign(expected @ weights)
    assert (crossings, moved) == (np.count_nonzero(signs[1:] != signs[:-1]), True)
    nodes[5, :, :2] = 0.0
    assert deflect(nodes, 0.7, weights, along)[1] is False


def test_pairs_hold_each_sample_and_a_later_one_and_have_size_one() -> None:
    along = np.random.default_rng(2).normal(size=(9, 4))
    even, sizes = np.empty((6, 8)), np.empty(6)
    pair(along, 3, even, sizes)
    paired = np.concatenate([along[:-3], along[3:]], axis=1)
    np.testing.assert_allclose(sizes, np.linalg.norm(paired, axis=1), rtol=1e-14)
    np.testing.assert_allclose(even * sizes[:, None], paired, rtol=1e-14)


def test_the_step_is_that_of_least_squares() -> None:
    random = np.random.default_rng(3)
    path, sizes, step = random.normal(size=(40, 2)), random.uniform(1.0, 2.0, 40), np.empty((2, 2))
    fit_step(path, sizes, 5, step)
    later = path[5:] * (sizes[5:] / sizes[:-5])[:, None]
    expected = np.linalg.lstsq(path[:-5], later, rcond=None)[0]
    np.testing.assert_allclose(step, expected, rtol=1e-12)


def test_the_step_of_samples_on_a_line_is_along_it() -> None:
    path, step = np.zeros((20, 2)), np.empty((2, 2))
    path[:, 0] = 1.0
    fit_step(path, 0.5 ** np.arange(20.0), 1, step)
    np.testing.assert_allclose(step, [[0.5, 0.0], [0.0, 0.0]], atol=1e-15)


def test_an_amplitude_is_followed_through_its_turns() -> None:
    angle = np.linspace(0.3, 40.0, 90)
    path, sizes = np.stack([np.cos(angle), np.sin(angle)], axis=1), np.exp(-angle)
    logs, phases = np.empty(90), np.empty(90)
    follow(path, sizes, np.array([1.0, 0.0, 1.0]), logs, phases)
    np.testing.assert_allclose(logs, -angle, atol=1e-13)
    np.testing.assert_allclose(phases, angle, atol=1e-13)
    follow(path, sizes, np.array([2.0, 1.0, 0.0]), logs, phases)
    expected = np.log(np.abs(sizes * (2.0 * path[:, 0] + path[:, 1])))
    # Near a zero of the amplitude its logarithm loses digits.
    np.testing.assert_allclose(logs, expected, atol=1e-11)
    assert not phases.any()


@pytest.mark.parametrize("seed", range(20))
def test_theleading_vector_belongs_to_the_largest_eigenvalue(seed: int) -> None:
    step = np.random.default_rng(seed).normal(size=(2, 2))
    first, second, turning = leading_vector(*step.ravel())
    vector = np.array([first, second + 1j * turning])
    value = (vector.conj() @ step @ vector) / (vector.conj() @ vector)
    np.testing.assert_allclose(step @ vector, value * vector, atol=1e-13)
    assert abs(value) == pytest.approx(np.abs(np.linalg.eigvals(step)).max(), rel=1e-12)


def test_a_step_that_is_the_same_in_all_directions_has_some_vector() -> None:
    assert leading_vector(0.5, 0.0, 0.0, 0.5) == (1.0, 0.0, 0.0)
