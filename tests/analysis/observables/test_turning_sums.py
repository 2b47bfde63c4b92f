"""How links turn from sample to sample, against rotation vectors one by one."""

import numpy as np

from undula.analysis.observables.link_sums import link_turns


def test_turns_are_those_of_rotation_vectors() -> None:
    nodes = np.cumsum(np.random.default_rng(2).normal(size=(7, 5, 3)), axis=1)
    chosen = np.array([1, 3])
    angle, turned = np.empty((2, 6)), np.empty((2, 6, 2))
    link_turns(nodes, chosen, angle, turned)
    for i, link in enumerate(chosen):
        ways = nodes[:, link + 1] - nodes[:, link]
        ways /= np.linalg.norm(ways, axis=1)[:, None]
        for j in range(6):
            axis = np.cross(ways[j], ways[j + 1])
            expected = np.arccos(ways[j] @ ways[j + 1])
            # The inverse cosine loses digits where links hardly turn: these turn by a tenth.
            np.testing.assert_allclose(angle[i, j], expected, rtol=1e-12)
            vector = expected * axis / np.linalg.norm(axis)
            np.testing.assert_allclose(turned[i, j], vector[:2], rtol=1e-10, atol=1e-14)


def test_a_link_that_does_not_move_does_not_turn() -> None:
    nodes = np.broadcast_to(np.arange(12.0).reshape(4, 3) ** 2, (3, 4, 3)).copy()
    angle, turned = np.empty((1, 2)), np.empty((1, 2, 2))
    link_turns(nodes, np.array([1]), angle, turned)
    np.testing.assert_allclose(angle, 0.0, atol=1e-7)  # the root of round-off
    np.testing.assert_allclose(turned, 0.0, atol=1e-7)
