"""What a run asks of the straight state and of its start, against what is written out naively."""

import numpy as np
import pytest

from undula import Chain, Filament, InputError, TipLoad, kicked
from undula.analysis.linear.leading_rate import leading_rate
from undula.models.given_shapes import pieces
from undula.models.model import Model

MODELS = [
    *(Filament(n, TipLoad(force)) for n in (4, 7, 20, 40) for force in (0.0, 30.0, 45.0, 200.0)),
    Filament(9, TipLoad(30.0), confined=True),
    Filament(9, TipLoad(45.0), inextensibility="weak"),
    Filament(9, TipLoad(45.0), keep_directors=True),
    Chain(3, TipLoad(3.0)),
    Chain(3, TipLoad(4.0), confined=True, spring="unwrapped"),
]


@pytest.mark.parametrize("model", MODELS, ids=str)
def test_leading_rate_is_that_of_the_whole_spectrum(model: Model) -> None:
    stiffness, drag = model.linearised()
    values = np.linalg.eigvals(-np.linalg.inv(drag) @ stiffness)
    assert leading_rate(model) == pytest.approx(values.real.max(), rel=1e-8, abs=1e-8)


@pytest.mark.parametrize("model", MODELS, ids=str)
def test_vectors_of_the_straight_state_and_of_a_start_are_those_asked_for_one_by_one(
    model: Model,
) -> None:
    straight = model.straight_unknowns()
    np.testing.assert_array_equal(straight, model.unknowns(model.straight()))
    straight[:] = np.nan  # whoever has it may write to it
    np.testing.assert_array_equal(model.straight_unknowns(), model.unknowns(model.straight()))
    x = kicked(model, 0.3)
    unknowns, rates = model.unknowns_and_rates(x)
    np.testing.assert_array_equal(unknowns, model.unknowns(x))
    np.testing.assert_array_equal(rates, model.rates(x))


@pytest.mark.parametrize("model", MODELS, ids=str)
def test_lengths_and_the_distance_of_tangents_are_those_of_norms(model: Model) -> None:
    x = kicked(model, 0.3)
    before = x.copy()
    nodes = model.nodes(x)
    along = np.diff(nodes, axis=0)
    np.testing.assert_array_equal(pieces(nodes)[0], along)
    np.testing.assert_allclose(pieces(nodes)[1], np.linalg.norm(along, axis=1), rtol=1e-15)
    away = np.diff(nodes - model.nodes(model.straight()), axis=0)
    assert model.tangent_distance(x) == pytest.approx(np.linalg.norm(away) * np.sqrt(model.links))
    if not model.extensible:
        links = along / np.linalg.norm(along, axis=1, keepdims=True) / model.links
        np.testing.assert_allclose(
            model.nodes(model.admissible(x))[1:], np.cumsum(links, axis=0), atol=1e-15
        )
    np.testing.assert_array_equal(x, before)


def test_kick_of_a_seed_is_drawn_from_that_seed_each_time() -> None:
    model = Filament(12, TipLoad(30.0))
    first, other = kicked(model, seed=3), kicked(model, seed=4)
    np.testing.assert_array_equal(kicked(model, seed=3), first)
    np.testing.assert_array_equal(kicked(model, seed=np.int64(4)), other)
    modes = np.arange(1, 5)
    sizes = np.random.default_rng(3).normal(size=(4, 2)) / modes[:, None]
    s = (np.arange(12) + 0.5) / 12
    inclination = np.sin(np.pi * (modes - 0.5) * s[:, None]) @ sizes
    inclination *= 1e-2 / np.linalg.norm(inclination, axis=1).max()
    links = np.diff(model.nodes(first), axis=0) * 12
    turned = np.linalg.norm(links[:, :2], axis=1)
    np.testing.assert_allclose(turned, np.sin(np.linalg.norm(inclination, axis=1)), rtol=1e-9)
    with pytest.raises(InputError, match="whole number"):
        kicked(model, seed=True)
