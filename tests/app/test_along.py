"""One grammar of --along in all commands, and several kinds of states in one call."""

from pathlib import Path

import numpy as np
import pytest

import undula as un
from commands import Ask, answer, refused, text

SIX = ["--set", "model.segments=6"]

pytestmark = pytest.mark.usefixtures("own_folder")


@pytest.mark.parametrize("values", ["1:3:3", "1,2,3"])
@pytest.mark.parametrize(
    ("command", "rows"), [("stability", "thresholds"), ("threshold onset", "thresholds")]
)
def test_a_range_and_a_list_are_read_alike(values: str, command: str, rows: str, ask: Ask) -> None:
    found = answer(ask(*command.split(), *SIX, "--along", f"model.drag_ratio={values}", "--json"))
    assert [row["model.drag_ratio"] for row in found[rows]] == [1.0, 2.0, 3.0]


@pytest.mark.parametrize("values", ["60:64:3", "60,62,64"])
def test_a_branch_is_told_at_the_values_that_are_asked_for(values: str, ask: Ask) -> None:
    found = answer(ask("follow", "spinning", *SIX, "--along", f"load.force={values}", "--json"))
    assert [point["load.force"] for point in found["points"]] == [60.0, 62.0, 64.0]
    for point in found["points"]:
        state = un.find(un.Filament(6, un.TipLoad(point["load.force"])), "spinning")
        assert point["frequency"] == pytest.approx(state.frequency, rel=1e-9)
        assert point["leading_rate"] == pytest.approx(state.leading_rate, rel=1e-6)


def test_values_change_no_bifurcation(ask: Ask) -> None:
    words = ["follow", "spinning", *SIX, "--json", "--along"]
    whole = answer(ask(*words, "load.force=100:160"))
    chosen = answer(ask(*words, "load.force=100:160:3"))
    assert [point["load.force"] for point in chosen["points"]] == [100.0, 130.0, 160.0]
    assert chosen["bifurcations"] == whole["bifurcations"] != []
    assert chosen["points"][-1] == whole["points"][-1]


@pytest.mark.slow
def test_the_straight_state_is_told_at_the_values_that_are_asked_for(ask: Ask) -> None:
    words = ["follow", "straight", *SIX, "--json", "--along"]
    whole = answer(ask(*words, "load.force=20:50"))
    chosen = answer(ask(*words, "load.force=20:50:3"))
    assert chosen["points"] == [whole["points"][place] for place in (0, 100, 200)]
    assert chosen["bifurcations"] == whole["bifurcations"]


@pytest.mark.slow
def test_several_kinds_are_answered_one_after_another_and_drawn_in_one_figure(ask: Ask) -> None:
    words = ["--set", "model.segments=4", "--along", "load.force=onset:44"]
    found = answer(ask("follow", "spinning", "flapping", *words, "--plot", "a.svg", "--json"))
    assert found.keys() == {"status", "units", "parameter", "branches", "figure"}
    assert (found["status"], found["parameter"]) == ("done", "load.force")
    assert [branch["kind"] for branch in found["branches"]] == ["spinning", "flapping"]
    single = answer(ask("follow", "spinning", *words, "--json"))
    assert {**single, "kind": "spinning"} == {**found["branches"][0], "figure": None}
    drawn = Path("a.svg").read_text()
    assert 'id="spinning, stable"' in drawn
    assert 'id="planar flapping' in drawn


def test_people_read_several_kinds_one_below_the_other(ask: Ask) -> None:
    said = text(ask("follow", "straight", "spinning", *SIX, "--along", "load.force=50,51"))
    straight, spinning = said.split("\n\n")
    assert straight.startswith("tip load: straight state along load.force from 50 to 51")
    assert spinning.startswith("tip load: spinning along load.force from 50 to 51, 2 points")


def test_kinds_may_be_followed_by_an_input_file(ask: Ask) -> None:
    Path("six.toml").write_text("[model]\nsegments = 6\n")
    along = ["--along", "load.force=50:51:2", "--json"]
    found = answer(ask("follow", "spinning", "six.toml", *along))
    assert found == answer(ask("follow", "spinning", *SIX, *along))
    pair = answer(ask("follow", "straight", "spinning", "six.toml", *along))
    assert [branch["kind"] for branch in pair["branches"]] == ["straight", "spinning"]


def test_a_kind_without_a_state_does_not_keep_the_others_from_being_followed(ask: Ask) -> None:
    words = [*SIX, "--along", "load.force=30:32", "--json", "--plot", "a.svg"]
    found = answer(ask("follow", "spinning", "straight", *words[:-2]))
    assert found["status"] == "not found"
    assert [branch["status"] for branch in found["branches"]] == ["not found", "done"]
    none = answer(ask("follow", "spinning", "flapping", *words))
    assert none["figure"] is None
    assert not Path("a.svg").exists()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("spinning spinning --along load.force=40:50", "spinning is given twice"),
        ("spinning gone --along load.force=40:50", "there is no input file gone"),
        ("spinning flaping --along load.force=40:50", "'flaping' is no kind of state"),
        ("hopping gone.toml --along load.force=40:50", "'hopping' is no kind of state"),
        ("spinning straight --along load.force=40:50 --plot a.png", "a figure of its own"),
        ("spinning --along load.force=onset:50:3", "write load.force=onset:50, or give a number"),
        ("spinning --along load.force=40,50,45", "goes from 50 to 45; give values that rise"),
        ("spinning --along load.force=50:50:3", "goes from 50 to 50"),
        ("spinning --along load.force=40:50:1", "is one value; give at least two"),
        ("spinning --along load.force=40:50:2.5", "2.5 is no number of points"),
        ("spinning --along load.force=40,x", "40,x is no range"),
        ("spinning flapping --along load.force=40", "write it like load.force=38:300"),
    ],
)
def test_a_wrong_way_or_kind_is_refused_in_one_sentence(words: str, said: str, ask: Ask) -> None:
    assert said in refused(ask("follow", *words.split()))
    assert not list(Path().iterdir())


@pytest.mark.slow
def test_a_ramp_takes_values_by_number_by_size_and_one_by_one(ask: Ask) -> None:
    quick = [*SIX, "--set", "time.until=0.01", "--set", "time.samples=20", "--json", "--overwrite"]
    asked = [
        ask("step", *quick, "--along", f"load.force={values}")
        for values in ("1:3:3", "1,2,3", "1:3:1.0", "1:3:1")
    ]
    values = [[step["value"] for step in answer(one)["steps"]] for one in asked]
    assert values == [[1.0, 2.0, 3.0]] * 4
    remark = "undula: --along load.force=1:3:1 takes steps of 1; a later version may not, write"
    assert [one.told.startswith(remark) for one in asked] == [False, False, False, True]
    assert np.array_equal(un.load("results/step/steps.nc")["value"], [1.0, 2.0, 3.0])
