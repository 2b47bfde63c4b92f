"""Claims on the filament: the contract, its tables, its threshold, its two forms, refusals."""

import inspect
import math
from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq, fsolve

import naive
from cases import Form, every_form, every_load, filament, random_state
from refusal import complaint
from undula.models import initial_states as starts
from undula.models.filament import Filament
from undula.models.loads.analytic import Load, TipLoad
from undula.models.model import Model

MEMBERS = [name for name in vars(Model) if not name.startswith("_")]
SEGMENTS = [20, 40, 80, 160]
#: The force at which the straight filament under a tip load starts to swing, see below.
ONSET = 37.6954308
STIFFNESSES = [1e4, 1e5, 1e6, 1e7]


class TextbookEnds(Filament):
    """A filament whose end cells are as long as the others: first order, for comparison."""

    @cached_property
    def system(self) -> Any:
        n = self.segments
        return super().system._replace(joint=np.full(n, float(n)), weight=np.full(n, 1.0 / n))


# ------------------------------------------------------------------ the contract


@pytest.mark.parametrize("name", MEMBERS)
def test_a_filament_answers_what_a_model_has_to_answer(name: str) -> None:
    model: Model = filament()  # for the type checker
    asked, answer = inspect.getattr_static(Model, name), inspect.getattr_static(model, name)
    if not isinstance(asked, property):
        assert (
            inspect.signature(answer).parameters.keys()
            == inspect.signature(asked).parameters.keys()
        )
    else:
        assert not callable(getattr(model, name))


@every_form
def test_sizes_are_those_of_the_free_nodes(form: Form) -> None:
    model = filament(form, segments=7)
    x = random_state(model)
    assert model.dimension == (2 if form.confined else 3)
    assert model.size == 7 * model.dimension == x.size
    assert model.rhs(x).shape == model.rotation_generator(x).shape == (model.size,)
    assert model.jacobian(x).shape == (model.size, model.size)
    assert model.position_mask.sum() == model.size


@every_form
def test_nodes_and_states_say_the_same(form: Form) -> None:
    model = filament(form)
    states = np.stack([random_state(model, seed) for seed in range(3)])
    nodes = model.nodes(states)
    assert nodes.shape == (3, model.segments + 1, 3)
    assert (nodes[:, 0] == 0.0).all()
    assert all((model.from_nodes(n) == x).all() for n, x in zip(nodes, states, strict=True))


@every_form
def test_the_integrators_vector_holds_the_state_as_it_is(form: Form) -> None:
    model = filament(form)
    x = random_state(model)
    unknowns = model.unknowns(x)
    assert (model.positions(unknowns) == x).all()
    assert (model.positions(np.stack([unknowns, unknowns])) == x).all()
    assert (unknowns[model.position_mask == 1.0] == x).all()


def test_a_confined_filament_does_not_turn() -> None:
    model = filament(Form("exact", confined=True))
    x = random_state(model)
    assert "plane" in complaint(lambda: model.rotate(x, 1.0))
    assert (model.rotation_generator(x) == 0.0).all()


@every_form
@every_load
def test_other_values_make_another_filament(form: Form, load: Load) -> None:
    model = filament(form, load)
    other = model.with_(force=12.5, segments=9, drag_ratio=3.0)
    assert (other.load.force, other.segments, other.drag_ratio) == (12.5, 9, 3.0)
    assert other.with_(force=load.force, segments=12, drag_ratio=2.0) == model


# ------------------------------------------------------------------ tables


def test_the_cells_at_both_ends_are_half_as_long() -> None:
    system = filament(segments=10).system
    assert system.joint.tolist() == [20.0] + [10.0] * 9
    # Tenths, rounded once.
    np.testing.assert_allclose(system.weight, [0.1] * 9 + [0.05], rtol=1e-15)


# ------------------------------------------------------------------ the threshold


def continuum_onset() -> tuple[float, float]:
    """Return force and angular frequency at which y'''' + F y'' + i w y = 0 has a solution.

    With y = y' = 0 at the clamp, y'' = y''' = 0 at the tip: a determinant vanishes.
    """

    def determinant(unknown: Any) -> list[float]:
        force, frequency = unknown
        q = np.roots([1.0, 0.0, force, 0.0, 1j * frequency])
        rows = np.array([np.ones(4), q, q**2 * np.exp(q), q**3 * np.exp(q)])
        # Over the Vandermonde determinant, so that the order of the roots does not matter.
        value = np.linalg.det(rows) / np.linalg.det(np.vander(q, increasing=True))
        return [value.real, value.imag]

    force, frequency = fsolve(determinant, [37.0, 190.0], xtol=1e-12)
    return float(force), float(frequency)


def onset(make: Callable[..., Filament], segments: int) -> float:
    """Return the tip force at which the leading mode of the straight state starts to grow."""

    def growth(force: float) -> float:
        return starts.leading_mode(make(segments, TipLoad(force), confined=True))[0].real

    return float(brentq(growth, 30.0, 45.0, xtol=1e-6))


def test_the_onset_of_the_continuum_is_the_value_taken_for_it() -> None:
    # Half a unit of its last digit.
    assert continuum_onset()[0] == pytest.approx(ONSET, abs=5e-8)


def test_the_onset_converges_to_that_of_the_continuum_with_second_order() -> None:
    errors = [ONSET - onset(Filament, segments) for segments in SEGMENTS]
    # The claim of the package.
    assert 1.85 < -np.polyfit(np.log(SEGMENTS), np.log(errors), 1)[0] < 2.15
    assert errors[-1] < 7e-3


def test_ends_like_all_other_cells_are_of_first_order_only() -> None:
    errors = [ONSET - onset(TextbookEnds, segments) for segments in SEGMENTS[:3]]
    # The values of the theory page, to their last digit.
    np.testing.assert_allclose(ONSET - np.array(errors), [33.94, 35.81, 36.75], atol=0.005)
    assert 0.9 < -np.polyfit(np.log(SEGMENTS[:3]), np.log(errors), 1)[0] < 1.1


@every_form
def test_the_onset_frequency_is_that_of_the_linear_equation_without_drag_ratio(form: Form) -> None:
    rates = [
        starts.leading_mode(filament(form, TipLoad(ONSET), segments=40, drag_ratio=ratio))[0]
        for ratio in (1.0, 2.0)
    ]
    # The discretisation's error at 40 segments is 0.4 per cent; the weak form's strain adds less.
    assert [rate.imag for rate in rates] == pytest.approx([continuum_onset()[1]] * 2, rel=6e-3)


# ------------------------------------------------------------------ rigid and extensible links


@every_load
@pytest.mark.parametrize("confined", [False, True])
def test_the_weak_form_tends_to_the_exact_one_as_one_over_the_stiffness(
    load: Load, confined: bool
) -> None:
    rigid = filament(Form("exact", confined), load)
    x = random_state(rigid, seed=2, bend=0.5)
    velocity, tension = naive.motion(rigid, x)
    links = naive.links_of(rigid, x)
    errors = []
    for stiffness in STIFFNESSES:
        weak = Filament(12, load, 2.0, "weak", stiffness, confined)
        # Links stretched by the tension that rigid ones would have.
        stretched = np.cumsum(links * (1.0 + tension / stiffness)[:, None], axis=0).ravel()
        errors.append(np.abs(weak.rhs(stretched) - velocity).max())
    # The softest of them strains by 4 per cent, which bends the line by as much of one decade.
    assert -1.03 < np.polyfit(np.log(STIFFNESSES), np.log(errors), 1)[0] < -0.97


def test_the_leading_rate_of_the_weak_form_tends_to_that_of_the_exact_one() -> None:
    rigid = starts.leading_mode(Filament(20, TipLoad(40.0)))[0]
    rates = [
        starts.leading_mode(Filament(20, TipLoad(40.0), 2.0, "weak", stiffness))[0]
        for stiffness in STIFFNESSES[:3]
    ]
    errors = [abs(rate - rigid) for rate in rates]
    # The strain is 0.4 per cent at most, and so is its second-order effect.
    assert -1.03 < np.polyfit(np.log(STIFFNESSES[:3]), np.log(errors), 1)[0] < -0.97


# ------------------------------------------------------------------ what is refused

BAD = (
    [("segments", value) for value in (3, 0, -40, 40.0, 40.5, True, math.nan, math.inf, "40", None)]
    + [("drag_ratio", value) for value in (0.5, 0.0, -2.0, math.nan, math.inf)]
    + [("tensile_stiffness", value) for value in (0.0, -4e4, math.nan, math.inf)]
    + [("inextensibility", "rigid")]
)


@pytest.mark.parametrize(("name", "value"), BAD)
def test_a_value_that_makes_no_filament_is_refused_by_name(name: str, value: Any) -> None:
    arguments: dict[str, Any] = {"segments": 40, "load": TipLoad(75.0), name: value}
    sentence = complaint(lambda: Filament(**arguments))
    assert sentence.startswith(f"{name} = {value!r} ") or sentence.startswith(f"{name} = {value} ")


@pytest.mark.parametrize("shape", [(12, 3), (14, 3), (13, 2), (39,)])
def test_nodes_of_another_shape_are_refused(shape: tuple[int, ...]) -> None:
    assert f"{shape}" in complaint(lambda: filament().from_nodes(np.zeros(shape)))


def test_nodes_that_are_not_finite_are_refused() -> None:
    nodes = filament().nodes(filament().straight())
    nodes[5, 0] = math.nan
    assert "finite" in complaint(lambda: filament().from_nodes(nodes))
