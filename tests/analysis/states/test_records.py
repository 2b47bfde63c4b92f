"""All solved states have the same fields, and all searches the same outcome."""

from dataclasses import replace
from typing import Any, get_args

import numpy as np
import pytest

import undula as un
from undula.analysis.solvers.state_kinds import KINDS, Solved
from undula.analysis.states.along_parameter import with_unknowns_of
from undula.analysis.states.not_found import NotFound, SearchStatus
from undula.analysis.states.records import Equilibrium
from undula.analysis.states.state import State
from undula.models.filament import Filament
from undula.models.loads.analytic import TipLoad

MODEL = Filament(6, TipLoad(60.0))
CURVED = Filament(6, TipLoad(10.0), natural_curvature=(1.0, 0.0))
DECAYING = np.array([-1.0 + 0j])


def states() -> list[Any]:
    """Return a state of each kind, whose numbers are made up."""
    flat = MODEL.with_(confined=True)
    straight = MODEL.unknowns(MODEL.straight())
    bent = flat.unknowns(flat.admissible(flat.from_nodes(CURVED.nodes(CURVED.rest()))))
    beat = np.stack([bent, flat.equations.mirrored(bent)] * 2)
    return [
        un.Spinning(MODEL, straight, 6.0, 0.0, DECAYING, 0j),
        un.Flapping(MODEL, 0.5, np.arange(4) / 8, beat, 0.0, DECAYING, DECAYING, (0.0, 0.0), 0.0),
        Equilibrium(CURVED, CURVED.unknowns(CURVED.rest()), 0.0, DECAYING),
        un.Periodic(MODEL, 0.5, 0.0, np.tile(straight, (4, 1)), 0.0, DECAYING, (0.0, 0.0), 0.0),
    ]


def test_each_kind_has_a_name_of_its_own_by_which_its_functions_are_found() -> None:
    assert {kind.kind for kind in get_args(Solved)} == KINDS.keys()
    assert {state.kind for state in states()} == KINDS.keys()


@pytest.mark.parametrize("state", states(), ids=lambda state: state.kind)
def test_all_kinds_have_the_same_fields(state: Any) -> None:
    assert isinstance(state, State)
    for values in (state.bending_energy, state.tip_radius, state.tip_height):
        assert values.min <= values.mean <= values.max
        assert (values.min == values.max) >= state.steady
    assert state.leading_rate == -1.0
    assert state.stable
    assert state.residual == 0.0
    assert state.error is None
    assert state.solver_error >= 0.0
    assert state.period > 0.0
    assert state.force == state.model.load.force
    assert replace(state, error=0.1).error == 0.1


def test_a_cycle_is_a_turn_a_beat_or_nothing() -> None:
    spinning, flapping, resting, _ = states()
    assert spinning.period == pytest.approx(2.0 * np.pi / 6.0, rel=1e-15)
    assert flapping.frequency == 2.0
    assert (resting.frequency, resting.period) == (0.0, np.inf)
    assert replace(spinning, rate=0.0).period == np.inf


def test_former_names_are_kept_with_a_word() -> None:
    *_, periodic = states()
    with pytest.warns(DeprecationWarning, match="now bending_energy"):
        assert periodic.energy is periodic.bending_energy
    with pytest.warns(DeprecationWarning, match="now period"):
        assert periodic.duration == periodic.period


def test_a_search_without_a_state_says_why_in_one_sentence_and_is_false() -> None:
    failed = NotFound(SearchStatus.NOT_CONVERGED, "no state", "begin nearer", 0.1)
    assert not failed
    assert failed.reason == "no state; begin nearer"
    assert replace(failed, advice=None).reason == "no state"


def test_a_state_that_a_body_cannot_have_any_more_is_not_found_instead_of_refused() -> None:
    spinning = states()[0]
    failed = NotFound(SearchStatus.NOT_CONVERGED, "no orbit", "begin nearer", 0.1)
    held = MODEL.with_(keep_directors=True)
    told = with_unknowns_of(held, spinning, "model.bending_ratio", lambda *_: failed)
    assert isinstance(told, NotFound)
    assert (told.status, told.residual) == (failed.status, failed.residual)
    assert told.reason == (
        "the state cannot be followed along model.bending_ratio, where the filament is held in one"
        " direction: no orbit; begin nearer"
    )
