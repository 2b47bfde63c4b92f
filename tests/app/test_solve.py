"""The command `undula solve`: what it answers, refuses, and keeps when it is interrupted."""

import signal

import pytest

import undula as un
from commands import Ask, answer, refused, text
from undula.analysis.solvers.inverse import branch_search
from undula.analysis.solvers.inverse.solve_for import solve_for
from undula.inputs.targets import parse_target

SIX = un.Filament(6, un.TipLoad(75.0))
FEW = ["--set", "model.segments=6"]
BY_FORCE = ["--by", "load.force", "--between", "50:90"]
SHARED = {"value", "error", "error_of", "solver_error", "links", "slope", "frequency"}
ANSWER = {
    *("status", "units", "kind", "quantity", "target", "parameter", "between", "least", "most"),
    *("solutions", "reason", "not_searched"),
}


def test_the_answer_is_what_python_computes(ask: Ask) -> None:
    found = answer(ask("solve", "spinning", "frequency=70", *FEW, *BY_FORCE, "--json"))
    solutions = solve_for(SIX, "spinning", frequency=70.0, by="load.force", between=(50.0, 90.0))
    assert found.keys() == ANSWER
    assert (found["status"], found["kind"], found["quantity"]) == ("done", "spinning", "frequency")
    assert (found["target"], found["parameter"], found["between"]) == (70.0, "load.force", [50, 90])
    assert (found["least"], found["most"]) == solutions.quantity_range
    (solution,) = found["solutions"]
    assert solution.keys() == SHARED | {
        *("load.force", "stable", "leading_rate", "bending_energy", "tip_radius", "tip_height"),
    }
    assert solution["load.force"] == solution["value"]
    # JSON holds every digit of a number: these are equal, not close.
    for key in ("value", "error", "solver_error", "links", "slope"):
        assert solution[key] == getattr(solutions[0], key), key
    assert (found["reason"], found["not_searched"]) == (None, None)


def test_the_answer_put_back_in_gives_the_target(ask: Ask) -> None:
    found = answer(ask("solve", "spinning", "tip_height=0.65", *FEW, *BY_FORCE, "--json"))
    (solution,) = found["solutions"]
    force = f"load.force={solution['value']!r}"
    state = answer(ask("find", "spinning", *FEW, "--set", force, "--json"))
    assert state["tip_height"] == pytest.approx(0.65, rel=1e-8)


def test_people_read_each_solution_in_a_line_with_its_error(ask: Ask) -> None:
    said = text(ask("solve", "spinning", "frequency=70", *FEW, *BY_FORCE))
    head, line = said.splitlines()
    assert head == ("tip load: spinning with frequency 70, solved for load.force between 50 and 90")
    assert line.startswith("  load.force 6")
    assert " ± " in line
    assert "B/L^2: 70 cycles per T, stable, leading rate -" in line
    assert "; on 6 links 6" in line
    for word in ("nan", "None", "np.", "{"):
        assert word not in said


def test_a_target_that_is_not_met_is_an_answer(ask: Ask) -> None:
    words = ["solve", "spinning", "frequency=700", *FEW, *BY_FORCE]
    found = answer(ask(*words, "--json"))
    assert found.keys() == ANSWER
    assert (found["status"], found["solutions"]) == ("not found", [])
    assert "spinning between load.force 50 and 90 has frequency " in found["reason"]
    assert f"none: {found['reason']}" in text(ask(*words))


def test_a_threshold_is_solved_for_along_another_parameter(ask: Ask) -> None:
    words = ["--set", "load.profile=linear", "--by", "load.slope", "--between", "-1:1"]
    onset = un.onset(un.Filament(6, un.LinearLoad(75.0, slope=0.25))).force
    found = answer(ask("solve", "onset", f"value={onset!r}", *FEW, *words, "--json"))
    (solution,) = found["solutions"]
    assert solution.keys() == SHARED | {"load.slope", "force", "second_frequency", "bifurcation"}
    assert solution["load.slope"] == pytest.approx(0.25, abs=1e-9)
    assert solution["force"] == pytest.approx(onset, rel=1e-8)
    assert (solution["links"], solution["bifurcation"]) == (None, "Hopf")
    said = text(ask("solve", "onset", f"value={onset!r}", *FEW, *words))
    assert said.splitlines()[1].startswith("  load.slope 0.25")
    assert " (Hopf), " in said


def test_the_force_of_a_chain_is_given_in_further_units(ask: Ask) -> None:
    chain = ["--set", "model.kind=chain", "--set", "model.links=3"]
    words = ["solve", "spinning", "tip_radius=0.3", *chain, "--by", "load.force"]
    (solution,) = answer(ask(*words, "--json"))["solutions"]
    assert solution["force_in"].keys() == {"K/l", "B/L^2"}
    # The links are the body: nothing is left but the error of the solver.
    assert solution["error"] == solution["solver_error"]
    assert "K/L (" in text(ask(*words))


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["frequency"], "write it like frequency=120"),
        (["frequency="], "write it like frequency=120"),
        (["=120"], "write it like frequency=120"),
        (["frequency=fast"], "fast is no number"),
        (["frequency=nan"], "is not a finite number"),
        (["speed=120"], "speed is no quantity of spinning; take frequency or"),
        (["frequency=70", "--between", "90:50"], "--between 90:50 does not rise"),
        (["frequency=70", "--between", "50"], "--between 50 is no range"),
        (["frequency=70", "--between", "50:60:70"], "--between 50:60:70 is no range"),
        (["frequency=70", "--between", "50:inf"], "an end is not a finite number"),
        (["frequency=70", "--between", "-50:50"], "at least 0"),
        (["frequency=70", "--set", "model.confined=true"], "confined = false"),
    ],
)
def test_bad_input_is_refused_in_one_sentence(words: list[str], said: str, ask: Ask) -> None:
    assert said in refused(ask("solve", "spinning", *words, *FEW, "--by", "load.force"))


def test_an_unknown_kind_or_parameter_is_refused(ask: Ask) -> None:
    assert "no kind of state and no threshold" in refused(
        ask("solve", "resting", "frequency=1", "--by", "load.force")
    )
    assert "take load.force or" in refused(
        ask("solve", "spinning", "frequency=1", "--by", "load.length")
    )
    assert "--by" in refused(ask("solve", "spinning", "frequency=1"))


def test_a_target_is_a_name_and_a_number() -> None:
    assert parse_target(" leading_rate = -1.5e2 ") == ("leading_rate", -150.0)


def test_a_signal_ends_the_search_with_what_was_found(
    ask: Ask, monkeypatch: pytest.MonkeyPatch
) -> None:
    followed = branch_search.followed

    def interrupted(*arguments: object) -> object:
        for number, interval in enumerate(followed(*arguments)):
            if number == 2:
                signal.raise_signal(signal.SIGINT)
            yield interval

    monkeypatch.setattr(branch_search, "followed", interrupted)
    asked = ask("solve", "spinning", "frequency=700", *FEW, "--by", "load.force", "--json")
    found = answer(asked, status=3)
    assert (found["status"], found["not_searched"]) == ("interrupted", "the search was stopped")
    assert found["most"] < 700.0
    assert "interrupted; what was found until then is told" in asked.told
