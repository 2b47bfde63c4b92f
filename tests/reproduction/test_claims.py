"""Statements held against answers: verdicts, and the catalogue of the paper itself."""

import ast
from pathlib import Path

import numpy as np
import pytest

from refusal import complaint
from small_catalogue import small_catalogue
from undula.app.reproduce_command import RUN_COMMAND
from undula.models.filament import Filament
from undula.reproduction.claims import errata
from undula.reproduction.claims import evaluate as claims
from undula.reproduction.claims.catalogue import CATALOGUE, Claim, catalogue, paper_of
from undula.reproduction.claims.evaluate import ClaimAnswer, judge
from undula.reproduction.claims.measures import (
    at,
    crossing,
    first_present,
    holding,
    holding_error,
    peak,
    peak_error,
)
from undula.reproduction.tasks.task import run_captured

ITEMS = catalogue()
ROWS = [(name, claim) for name, item in ITEMS.items() for claim in item.claims]


def claim(**keys) -> Claim:
    given = {"name": "one", "says": "So it is.", "where": "Section 1", "value": "it.value"}
    return Claim.model_validate(given | {"published": 2.0} | keys)


def verdict(told: Claim, value) -> str | None:
    return judge(told, {"it": ClaimAnswer({"value": value})}).verdict


@pytest.mark.parametrize(
    ("value", "keys", "expected"),
    [
        (2.04, {"within": 0.05, "because": "two digits"}, "confirmed"),
        (2.06, {"within": 0.05, "because": "two digits"}, "corrected"),
        (2.06, {"within": 0.05, "because": "d", "silent": "which"}, "not reproducible as stated"),
        ("spinning", {"published": "spinning"}, "confirmed"),
        ("straight", {"published": "spinning"}, "corrected"),
        (True, {"published": False}, "corrected"),
        ([1.0, 2.5], {"published": [1.0, 2.0]}, "corrected"),
        ([1.0, 2.0], {"published": 1.5, "within": 0.1, "because": "digits"}, "corrected"),
    ],
)
def test_a_value_is_held_against_the_published_one(value, keys, expected) -> None:
    assert verdict(claim(**keys), value) == expected


@pytest.mark.parametrize(
    ("found", "expected"),
    [
        ([0.0, 10.0], "confirmed"),
        ([1.2, 8.8], "confirmed within a stated range"),
        ([12.0, 14.0], "corrected"),
    ],
)
def test_a_range_is_held_against_the_one_that_is_stated(found, expected) -> None:
    over = {"published": None, "over": [1.0, 9.0], "within": 0.1, "because": "ends"}
    assert verdict(claim(**over), found) == expected


def test_two_ways_that_differ_leave_a_claim_unchecked() -> None:
    told = claim(agrees_with="it.other", agrees_within=0.1)
    outcome = judge(told, {"it": ClaimAnswer({"value": 2.0, "other": 2.5})})
    assert outcome.verdict is None
    assert "2.5" in outcome.reason


@pytest.mark.parametrize("value", [None, float("nan")])
def test_what_was_not_found_confirms_nothing(value) -> None:
    assert verdict(claim(), value) is None
    assert judge(claim(value="it.missing"), {"it": ClaimAnswer({})}).verdict is None


def test_an_expression_with_an_unknown_word_is_refused() -> None:
    sentence = complaint(lambda: judge(claim(value="open('x')"), {"it": ClaimAnswer({})}))
    assert "open" in sentence


def test_rows_of_an_answer_are_arrays() -> None:
    points = [{"load.force": 1.0, "energy": {"max": 2.0}}, {"load.force": None, "energy": None}]
    rows = ClaimAnswer({"points": points}).points
    assert rows["energy/max"] == pytest.approx([2.0, np.nan], nan_ok=True)
    assert rows["load.force"] == pytest.approx([1.0, np.nan], nan_ok=True)


def test_curves_are_read_between_their_points() -> None:
    places = np.linspace(0.0, 4.0, 9)
    assert at(1.3, places, places**2) == pytest.approx(1.69)
    assert crossing(places, places - 1.25) == pytest.approx(1.25)
    assert peak(places, 3.0 - (places - 1.7) ** 2) == pytest.approx(1.7)
    assert holding(places, 1.0 - (places - 2.0) ** 2, 2.0) == pytest.approx([1.0, 3.0])
    assert max(holding_error(places, 1.0 - (places - 2.0) ** 2, 2.0)) < 0.1
    assert peak_error(places, 3.0 - (places - 1.7) ** 2) < 1e-9
    assert first_present(places, np.where(places < 2.1, np.nan, 1.0)) == [2.25, 0.25]


def test_the_errata_are_those_of_independent_formulas() -> None:
    assert errata.second_moment_over_area_squared() == pytest.approx(1.0 / (4.0 * np.pi))
    assert errata.twist_over_bending(0.25) == pytest.approx(0.8)
    assert errata.springs_of_chain(5) == pytest.approx(5.0)
    assert errata.power_of_length_in_chain_time() == pytest.approx(2.0)
    assert errata.rank_of_angles_at_straight() == 1
    assert errata.rank_of_test_functions(4) == 1


def test_the_catalogue_has_a_claim_for_all_that_matters() -> None:
    assert paper_of(CATALOGUE).title
    assert len(ROWS) >= 40
    # One for each slip: time of the linear equation, B = E A², second time scale, springs, sum over
    # modes, units of force and time of chains, pole, one transition, 15 to 20 per cent, logarithm.
    assert sum(told.erratum for _, told in ROWS) >= 11


@pytest.mark.parametrize(("name", "told"), ROWS, ids=[f"{name}-{c.name}" for name, c in ROWS])
def test_a_claim_is_computed_from_tasks(name: str, told: Claim) -> None:
    known = {*ITEMS[name].tasks, *ITEMS[name].uses}
    nodes = [node for text in told.expressions for node in ast.walk(ast.parse(text.strip()))]
    bound = {n.id for n in nodes if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
    assert told.asks - bound <= known | claims._WORDS.keys()
    assert told.asks & (known | set(errata.__all__))


@pytest.mark.parametrize(("name", "told"), ROWS, ids=[f"{name}-{c.name}" for name, c in ROWS])
def test_a_number_has_an_error(name: str, told: Claim) -> None:
    numbers = isinstance(told.published, list) or type(told.published) is float
    assert (told.error is not None) == (numbers or told.over is not None), name


def test_a_wrong_published_value_changes_the_verdict(tmp_path: Path) -> None:
    answers = {"onset": ClaimAnswer(run_captured(RUN_COMMAND, ("stability",))["answer"])}
    folder = small_catalogue(tmp_path / "right")
    wrong = small_catalogue(tmp_path / "wrong", onset=("published = 37.7", "published = 38.7"))
    assert judge(catalogue(folder)["onset"].claims[0], answers).verdict == "confirmed"
    assert judge(catalogue(wrong)["onset"].claims[0], answers).verdict == "corrected"


@pytest.mark.slow
def test_a_perturbed_coefficient_of_the_equations_changes_verdicts(monkeypatch, tmp_path) -> None:
    item = ITEMS["transition"]
    asked = {told.name: told for told in item.claims}
    command = (item.tasks["above"].quick or "").replace("{out}", str(tmp_path / "above")).split()
    command = [word.replace('"', "").replace("\\", "") for word in command]

    def outcome() -> str | None:
        answer = run_captured(RUN_COMMAND, tuple(command))["answer"]
        return judge(asked["flaps-above"], {"above": ClaimAnswer(answer)}).verdict

    assert outcome() == "confirmed"
    right = Filament.system.func
    # The drag along the links as large as that across them: spinning is lost later.
    monkeypatch.setattr(
        Filament, "system", property(lambda self: right(self)._replace(anisotropy=0.0))
    )
    assert outcome() == "corrected"


def test_mistakes_in_a_catalogue_are_told(tmp_path: Path) -> None:
    assert "no catalogue" in complaint(lambda: catalogue(tmp_path / "nothing"))
    unknown = ("where = ", "place = ")
    text = 'name = "hopf"\nsays = "It begins to oscillate at 37.7."\nwhere = "Section 1"'
    folder = small_catalogue(tmp_path / "a", onset=(text, text.replace(*unknown)))
    assert "onset.toml" in complaint(lambda: catalogue(folder))
    folder = small_catalogue(tmp_path / "b", study=('onset = "onset/onset"', 'onset = "onset/no"'))
    assert "onset/no" in complaint(lambda: catalogue(folder))
    folder = small_catalogue(tmp_path / "c", onset=('because = "three digits are printed"\n', ""))
    assert "because" in complaint(lambda: catalogue(folder))
