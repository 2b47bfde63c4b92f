"""A branch written as plain JSON types and read back, against the branch itself."""

import json
from functools import cache
from typing import Any

import numpy as np
import pytest

import undula as un
from refusal import complaint
from undula.analysis.solvers.branches import follow_from_onset
from undula.analysis.states.branch import Branch
from undula.analysis.states.branch_json import read_branch
from undula.app.commands.follow import branch_answer

EIGHT = un.Filament(segments=8, load=un.TipLoad(75.0))


@cache
def spinning() -> Branch[Any]:
    branch = follow_from_onset(EIGHT, "spinning", 200.0)
    assert isinstance(branch, Branch)
    return branch


def read(branch: Branch[Any]) -> Branch[Any]:
    answer = json.loads(json.dumps(branch_answer(branch, EIGHT.units, converge=False)))
    return read_branch(answer, "load.force")


def test_values_and_states_are_the_same_to_the_last_bit() -> None:
    again = read(spinning())
    assert np.array_equal(again.values, spinning().values)
    for state, own in zip(again.states, spinning().states, strict=True):
        assert (state.frequency, state.bending_energy, state.stable) == (
            own.frequency,
            own.bending_energy,
            own.stable,
        )
        assert state.exponents[0].real == own.leading_rate
    assert (again.parameter, again.complete) == ("load.force", True)


def test_bifurcations_keep_their_place_and_their_change_of_stability() -> None:
    (own,) = [point for point in spinning().bifurcations if point.loses]
    (again,) = [point for point in read(spinning()).bifurcations if point.loses]
    assert (again.kind, again.value, again.error) == (own.kind, own.value, own.error)
    assert (again.frequency, again.second_frequency) == (own.frequency, own.second_frequency)
    assert np.isnan(again.state.bending_energy.mean)


def test_the_onset_is_the_hopf_point_and_a_branch_from_elsewhere_has_none() -> None:
    again = read(spinning())
    # Both are located to round-off.
    assert again.onset == pytest.approx(un.onset(EIGHT, method="discrete").force, rel=1e-9)
    assert again.criticality == "supercritical"
    assert again.values[0] > again.onset
    elsewhere = un.follow(un.find(EIGHT, "spinning"), "load.force", 80.0)
    assert (read(elsewhere).onset, read(elsewhere).criticality) == (None, None)


def test_a_branch_along_another_parameter_is_refused() -> None:
    answer = branch_answer(spinning(), EIGHT.units, converge=False)
    assert "along load.force; give another" in complaint(
        lambda: read_branch(answer, "model.drag_ratio")
    )
