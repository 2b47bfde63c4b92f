"""The option --sensitivities of find and threshold."""

import pytest

import undula as un
from commands import Ask, answer, refused, text

FEW = ("--set", "model.segments=4")
MODEL = un.Filament(4, un.TipLoad(75.0))


def test_a_state_is_answered_with_its_derivatives(ask: Ask) -> None:
    found = answer(ask("find", "spinning", *FEW, "--sensitivities", "--json"))["sensitivities"]
    state = un.find(MODEL, "spinning")
    assert isinstance(state, un.Spinning)
    expected = un.sensitivities(state)
    assert found.keys() == set(expected)
    for parameter, row in expected.items():
        assert found[parameter] == pytest.approx(dict(row), rel=1e-12)


def test_people_read_a_row_for_each_parameter(ask: Ask) -> None:
    lines = text(ask("find", "spinning", *FEW, "--sensitivities")).splitlines()
    (head,) = (number for number, line in enumerate(lines) if "derivatives of frequency" in line)
    assert [line.split()[0] for line in lines[head + 1 :]][:2] == ["load.force", "model.drag_ratio"]


def test_a_threshold_has_them_too_but_not_along_a_parameter(ask: Ask) -> None:
    found = answer(ask("threshold", "onset", *FEW, "--sensitivities", "--json"))["sensitivities"]
    # The onset of a straight filament does not depend on its tangential drag.
    assert abs(found["model.drag_ratio"]["value"]) < 1e-9
    along = ("--along", "model.drag_ratio=1:2:2")
    assert "--along" in refused(ask("threshold", "onset", *FEW, *along, "--sensitivities"))
