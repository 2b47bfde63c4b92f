"""Claims on the input of a chain: its defaults, and one sentence for each mistake."""

import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from refusal import complaint
from undula.inputs.build import build_model
from undula.inputs.input import parse_input
from undula.models.chain import Chain
from undula.models.loads.analytic import LinearLoad, TipLoad
from undula.models.loads.beads import BeadLoad

CHAIN = {"kind": "chain", "links": 3}
BEADS = {"profile": "beads"}
DRAGS = "model.bead_drag takes a number above 0, or a list with one for each bead"
NUMBERS = "load.beads takes 'all' or a list of different whole numbers, from 1 on"


def complaint_on(**tables: Any) -> str:
    return complaint(lambda: parse_input(tables))


# ------------------------------------------------------------------ what is asked for


@pytest.mark.parametrize("links", [1, 2, 6, 1000])
def test_what_is_left_out_corresponds_to_a_filaments_defaults(links: int) -> None:
    asked = parse_input({"model": {"kind": "chain", "links": links}, "time": {"until": "settled"}})
    # 75 B/L^2 and 10 times the filament's unit of time, rounded once.
    assert asked.load.force == pytest.approx(75.0 / links, rel=1e-15)
    assert asked.time.limit == pytest.approx(10.0 * links**2, rel=1e-15)
    assert build_model(asked) == Chain(links, TipLoad(asked.load.force))


def test_a_chain_is_built_as_asked() -> None:
    model = CHAIN | {"drag_ratio": 1.5, "base_spring": 2, "bead_drag": [1, 1, 0.5]}
    asked = parse_input(
        {"model": model | {"confined": True}, "load": BEADS | {"force": 7, "beads": [3, 1]}}
    )
    assert build_model(asked) == Chain(3, BeadLoad(7.0, (1, 3)), 1.5, 2.0, (1.0, 1.0, 0.5), True)
    spread = {"profile": "linear", "force": 7, "slope": 0.5}
    asked = parse_input({"model": CHAIN | {"bead_drag": 2}, "load": spread})
    assert build_model(asked) == Chain(3, LinearLoad(7.0, 0.5), bead_drag=2.0)


positive = st.floats(1e-3, 1e3)
drags = st.integers(1, 9).flatmap(
    lambda n: st.fixed_dictionaries(
        {
            "kind": st.just("chain"),
            "links": st.just(n),
            "bead_drag": positive | st.lists(positive, min_size=n, max_size=n),
        },
        optional={
            "base_spring": positive,
            "drag_ratio": st.floats(1.0, 5.0),
            "confined": st.booleans(),
        },
    )
)
beads = st.just("all") | st.lists(st.integers(1, 9), min_size=1, unique=True)


@given(model=drags, beads=beads)
def test_the_dumped_input_reads_back_equal_and_keeps_what_was_given(model: Any, beads: Any) -> None:
    if beads != "all":
        beads = [bead for bead in beads if bead <= model["links"]] or [1]
    asked = parse_input({"model": model, "load": BEADS | {"beads": beads}})
    dumped = json.loads(json.dumps(asked.dump()))
    assert parse_input(dumped) == asked
    assert {key: dumped["model"][key] for key in model} == model
    assert dumped["load"]["beads"] == beads


@pytest.mark.parametrize(
    ("load", "text"),
    [
        ({"force": 8}, "chain of 3 links, tip force 8 K/L"),
        (BEADS | {"force": 8}, "chain of 3 links, beads force 8 K/L on all"),
        (BEADS | {"force": 8, "beads": [1, 3]}, "chain of 3 links, beads force 8 K/L on 1, 3"),
    ],
)
def test_a_chain_and_its_load_are_told_in_words(load: dict[str, Any], text: str) -> None:
    assert parse_input({"model": CHAIN, "load": load}).load_text == text


# ------------------------------------------------------------------ what is refused


@pytest.mark.parametrize(
    ("key", "value", "sentence"),
    [
        ("kind", "chian", "model.kind = 'chian' is not known; model.kind takes 'filament' or"),
        ("links", 0, "model.links = 0 is out of range; model.links takes a whole number from 1 to"),
        ("links", 1001, "model.links = 1001 is out of range; model.links takes a whole number"),
        ("links", 3.0, "model.links = 3.0 is a decimal number; model.links takes a whole number"),
        ("links", True, "model.links = true is a truth value; model.links takes a whole number"),
        (
            "links",
            "3",
            "model.links = '3' is text; model.links takes a whole number from 1 to 1000",
        ),
        ("base_spring", 0, "model.base_spring = 0 is out of range; model.base_spring takes a"),
        ("base_spring", "1", "model.base_spring = '1' is text; model.base_spring takes a number"),
        ("bead_drag", 0, f"model.bead_drag = 0 is out of range; {DRAGS}"),
        ("bead_drag", "1", f"model.bead_drag = '1' is text; {DRAGS}"),
        ("drag_ratio", 0.5, "model.drag_ratio = 0.5 is out of range; model.drag_ratio takes a"),
        ("link", 3, "model.link is not a known key; did you mean model.links?"),
    ],
)
def test_a_wrong_value_of_a_chain_is_named_with_what_would_be_right(
    key: str, value: object, sentence: str
) -> None:
    assert complaint_on(model=CHAIN | {key: value}).startswith(sentence)


@pytest.mark.parametrize("value", [[1, 0, 1], [1, "a", 1], [1, -1, 1], [True, 1, 1]])
def test_a_list_of_drags_with_a_wrong_one_is_told_with_the_cure(value: list[Any]) -> None:
    sentence = complaint_on(model=CHAIN | {"bead_drag": value})
    assert sentence.startswith("model.bead_drag")
    assert DRAGS in sentence


@pytest.mark.parametrize("count", [0, 1, 4])
def test_a_list_of_drags_that_is_not_one_for_each_bead_is_told(count: int) -> None:
    sentence = complaint_on(model=CHAIN | {"bead_drag": [1.0] * count})
    assert sentence.startswith(f"model.bead_drag lists {count} beads, and with model.links = 3")
    assert sentence.endswith("give one number for each, or one for all")


@pytest.mark.parametrize(
    ("key", "value", "given", "wanted"),
    [
        ("segments", 40, "chain", "filament"),
        ("inextensibility", "weak", "chain", "filament"),
        ("links", 3, "filament", "chain"),
        ("base_spring", 1.0, "filament", "chain"),
        ("bead_drag", 1.0, "filament", "chain"),
    ],
)
def test_a_key_of_the_other_kind_is_refused(
    key: str, value: object, given: str, wanted: str
) -> None:
    assert complaint_on(model={"kind": given, key: value}) == (
        f"model.{key} = {value!r} has no meaning for model.kind = '{given}';"
        f" use model.kind = '{wanted}' or remove model.{key}"
    )


@pytest.mark.parametrize("value", [[0], [1, -2], [1.5], ["1"], [True], [], 2, "some"])
def test_what_is_no_list_of_beads_is_told_with_the_cure(value: object) -> None:
    sentence = complaint_on(model=CHAIN, load=BEADS | {"beads": value})
    assert sentence.startswith("load.beads")
    assert NUMBERS in sentence


def test_beads_that_are_not_there_or_there_twice_are_told() -> None:
    assert complaint_on(model=CHAIN, load=BEADS | {"beads": [2, 7]}) == (
        "load.beads = (2, 7) asks for bead 7 of a chain of 3 links; give numbers from 1 to 3"
    )
    assert complaint_on(model=CHAIN, load=BEADS | {"beads": [1, 1]}) == (
        "load.beads = (1, 1) has to be 'all' or different whole numbers, counted from 1 at the base"
    )


def test_beads_are_a_chains_and_their_numbers_the_bead_loads() -> None:
    assert complaint_on(load=BEADS) == (
        "load.profile = 'beads' acts on beads, and a filament has none; use model.kind = 'chain'"
        " or another profile"
    )
    assert complaint_on(model=CHAIN, load={"beads": [1]}) == (
        "load.beads = [1] has no meaning for load.profile = 'tip'; use load.profile = 'beads' or"
        " remove load.beads"
    )


def test_the_cure_for_a_key_of_the_other_kind_is_the_kind_whatever_else_it_hangs_on() -> None:
    told = complaint_on(model={"kind": "chain", "tensile_stiffness": 1e4})
    assert "model.kind" in told
    assert "inextensibility" not in told
