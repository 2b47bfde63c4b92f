"""Claims on wrong input: every mistake gets one sentence with the culprit and the cure."""

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from refusal import complaint
from undula.errors import InputError
from undula.inputs.input import parse_input


def complaint_on(**tables: Any) -> str:
    return complaint(lambda: parse_input(tables))


@pytest.mark.parametrize(
    ("table", "key", "value", "sentence"),
    [
        ("load", "forc", 1, "load.forc is not a known key; did you mean load.force?"),
        ("load", "Force", 1, "load.Force is not a known key; did you mean load.force?"),
        ("load", "segments", 1, "load.segments is not a known key; did you mean model.segments?"),
        (
            "load",
            "zzz",
            1,
            "load.zzz is not a known key; the keys of [load] are profile, force, position, slope,"
            " exponent, s, density and beads",
        ),
        ("load", "a\nb", 1, "load.'a\\nb' is not a known key; the keys of [load] are"),
        (
            "load",
            "force",
            "75",
            "load.force = '75' is text; load.force takes a number of at least 0",
        ),
        ("load", "force", True, "load.force = true is a truth value; load.force takes a number"),
        ("load", "force", [75.0], "load.force = [75.0] is a list; load.force takes a number"),
        ("load", "force", float("nan"), "load.force = nan is not a finite number; load.force"),
        ("load", "force", float("inf"), "load.force = inf is not a finite number; load.force"),
        ("load", "force", -1, "load.force = -1 is out of range; load.force takes a number of at"),
        ("load", "force", 10**400, "load.force = 1000000000"),
        (
            "load",
            "profile",
            "tpi",
            "load.profile = 'tpi' is not known; load.profile takes 'tip', 'point', 'linear',"
            " 'power', 'table' or 'beads'",
        ),
        ("load", "profile", 5, "load.profile = 5 is a whole number; load.profile takes 'tip'"),
        (
            "model",
            "segments",
            3,
            "model.segments = 3 is out of range; model.segments takes a whole number from 4",
        ),
        ("model", "segments", 40.0, "model.segments = 40.0 is a decimal number; model.segments"),
        ("model", "segments", True, "model.segments = true is a truth value; model.segments takes"),
        ("model", "drag_ratio", 0.5, "model.drag_ratio = 0.5 is out of range; model.drag_ratio"),
        ("model", "confined", 1, "model.confined = 1 is a whole number; model.confined takes true"),
        ("start", "amplitude", 0.0, "start.amplitude = 0.0 is out of range; start.amplitude takes"),
        ("start", "amplitude", 3.2, "start.amplitude = 3.2 is out of range; start.amplitude takes"),
        ("start", "seed", -1, "start.seed = -1 is out of range; start.seed takes a whole number"),
        ("start", "seed", 2**63, "start.seed = 9223372036854775808 is out of range; start.seed"),
        ("time", "until", "setled", "time.until = 'setled' is text; time.until takes a number"),
        ("time", "until", 0, "time.until = 0 is out of range; time.until takes a number above 0"),
        ("time", "until", float("nan"), "time.until = nan is not a finite number; time.until"),
        ("time", "samples", 1, "time.samples = 1 is out of range; time.samples takes a whole"),
        ("time", "rtol", 0.1, "time.rtol = 0.1 is out of range; time.rtol takes a number from"),
        (
            "time",
            "atol",
            0.0,
            "time.atol = 0.0 is out of range; time.atol takes a number above 0 and at most 0.01",
        ),
    ],
)
def test_a_wrong_key_or_value_is_named_with_what_would_be_right(
    table: str, key: str, value: object, sentence: str
) -> None:
    assert complaint_on(**{table: {key: value}}).startswith(sentence)


@pytest.mark.parametrize(
    ("table", "keys", "sentence"),
    [
        ("model", {"inextensibility": "weak", "tensile_stiffness": -4e4}, "a number above 0"),
        ("load", {"profile": "point", "position": 0.0}, "a number above 0 and at most 1"),
        ("load", {"profile": "point", "position": 1.5}, "a number above 0 and at most 1"),
        ("load", {"profile": "linear", "slope": -1.5}, "a number from -1 to 1"),
        ("load", {"profile": "power", "exponent": -0.5}, "a number of at least 0"),
        ("time", {"until": "settled", "limit": 0.0}, "a number above 0"),
    ],
)
def test_the_range_of_a_conditional_key_is_told(
    table: str, keys: dict[str, Any], sentence: str
) -> None:
    key, value = list(keys.items())[1]
    name = f"{table}.{key}"
    expected = f"{name} = {value} is out of range; {name} takes {sentence}"
    assert complaint_on(**{table: keys}) == expected


@pytest.mark.parametrize(
    ("table", "keys", "chooser", "values"),
    [
        ("model", {"tensile_stiffness": 1e4}, "inextensibility = 'exact'", "'weak'"),
        ("load", {"slope": 0.5}, "profile = 'tip'", "'linear'"),
        ("load", {"position": 1.0}, "profile = 'tip'", "'point'"),
        ("load", {"exponent": 7.0}, "profile = 'tip'", "'power'"),
        ("load", {"s": [0.0, 1.0]}, "profile = 'tip'", "'table'"),
        ("load", {"density": [1.0], "profile": "point"}, "profile = 'point'", "'table'"),
        ("start", {"angle": 1.0}, "shape = 'kicked'", "'planar' or 'mode'"),
        ("start", {"handedness": "left"}, "shape = 'kicked'", "'helix'"),
        ("start", {"file": "a.nc"}, "shape = 'kicked'", "'state'"),
        ("start", {"seed": 2, "shape": "planar"}, "shape = 'planar'", "'kicked'"),
        (
            "start",
            {"amplitude": 0.1, "shape": "straight"},
            "shape = 'straight'",
            "'kicked', 'planar', 'helix', 'mode' or 'state'",
        ),
        ("time", {"limit": 5.0}, "until = 1.0", "'settled' or 'solved'"),
    ],
)
def test_a_key_that_nothing_would_read_is_refused(
    table: str, keys: dict[str, Any], chooser: str, values: str
) -> None:
    key, value = next(iter(keys.items()))
    word = chooser.split(" = ")[0]
    assert complaint_on(**{table: keys}) == (
        f"{table}.{key} = {value!r} has no meaning for {table}.{chooser};"
        f" use {table}.{word} = {values} or remove {table}.{key}"
    )


@pytest.mark.parametrize(
    ("tables", "sentence"),
    [
        ({"force": 75}, "force stands outside its table; write load.force"),
        ({"laod": {}}, "[laod] is not a known table; did you mean [load]?"),
        (
            {"zzz": {}},
            "[zzz] is not a known table; the tables are model, load, units, start and time",
        ),
        ({"load": 75}, "load = 75 is not a table; write [load] and its keys below"),
        (
            {"start": {"shape": "state"}},
            "start.shape = 'state' needs start.file; give start.file = the name of a result file",
        ),
        (
            {"start": {"shape": "state", "file": ""}},
            "start.file = '' is empty; start.file takes the name of a result file",
        ),
        (
            {"start": {"shape": "helix"}, "model": {"confined": True}},
            "start.shape = 'helix' leaves the plane that model.confined = true keeps;"
            " use start.shape = 'planar' or model.confined = false",
        ),
    ],
)
def test_tables_that_do_not_fit_are_named(tables: dict[str, Any], sentence: str) -> None:
    assert complaint_on(**tables) == sentence


LIST_OF_S = "load.s takes a list of numbers, increasing from 0 to 1"
LIST_OF_DENSITY = "load.density takes a list of numbers, one for each s"


@pytest.mark.parametrize(
    ("keys", "sentence"),
    [
        (
            {"density": [1, float("nan")]},
            f"load.density[1] = nan is not a finite number; {LIST_OF_DENSITY}",
        ),
        (
            {"density": [float("inf"), 1]},
            f"load.density[0] = inf is not a finite number; {LIST_OF_DENSITY}",
        ),
        ({"s": [0, "1"]}, f"load.s[1] = '1' is text; {LIST_OF_S}"),
        ({"s": [False, 1]}, f"load.s[0] = false is a truth value; {LIST_OF_S}"),
        ({"s": [[0], 1]}, f"load.s[0] = [0] is a list; {LIST_OF_S}"),
        ({"s": 5}, f"load.s = 5 is a whole number; {LIST_OF_S}"),
        ({"s": "0, 1"}, f"load.s = '0, 1' is text; {LIST_OF_S}"),
        ({"s": {"a": 1}}, f"load.s = {{'a': 1}} is a table; {LIST_OF_S}"),
        (
            {"s": [0, "a", "b"], "density": 1},
            f"load.s[1] = 'a' is text; {LIST_OF_S} (1 more mistake)",
        ),
        ({"s": []}, "load.density has 2 values, where s has 0; give one at each arc length"),
        ({"s": [0], "density": [1]}, "load.s has 1 value; give at least 2, from 0 to 1"),
        (
            {"density": [1, 2, 3]},
            "load.density has 3 values, where s has 2; give one at each arc length",
        ),
        (
            {"s": [0, 0.5, 0.5, 1], "density": [1, 1, 2, 2]},
            "load.s[2] = 0.5 does not exceed s[1] = 0.5; give increasing arc lengths, and a jump as"
            " two that are close",
        ),
        (
            {"s": [0, 0.9]},
            "load.s runs from 0.0 to 0.9; give the density from s = 0, the clamp,"
            " to s = 1, the tip",
        ),
        (
            {"density": [1, -3]},
            "load.density adds up to -1; a follower force that pushes has to have a positive total",
        ),
    ],
)
def test_a_table_that_is_no_load_is_named(keys: dict[str, Any], sentence: str) -> None:
    table = {"profile": "table", "s": [0, 1], "density": [1, 2]}
    assert complaint_on(load=table | keys) == sentence


@pytest.mark.parametrize(("given", "missing"), [("s", "density"), ("density", "s")])
def test_half_a_table_is_refused(given: str, missing: str) -> None:
    assert complaint_on(load={"profile": "table", given: [0, 1]}) == (
        f"load.profile = 'table' needs load.{missing}; give load.s and load.density as lists of"
        " numbers of one length"
    )


def test_of_several_mistakes_the_first_is_told_and_the_others_are_counted() -> None:
    load = {"force": -1, "slope": 0.5, "zzz": 1}
    assert complaint_on(load=load).endswith("takes a number of at least 0 (2 more mistakes)")
    assert complaint_on(load={"force": -1}, time={"until": "x"}).endswith("(1 more mistake)")


def test_a_value_refused_as_number_and_as_word_is_one_mistake() -> None:
    assert complaint_on(time={"until": "x"}) == (
        "time.until = 'x' is text; time.until takes a number above 0, 'settled' or 'solved'"
    )


@given(
    st.dictionaries(st.text(), st.none() | st.integers() | st.dictionaries(st.text(), st.text()))
)
def test_whatever_comes_in_is_accepted_or_refused_in_one_line(tables: dict[str, Any]) -> None:
    try:
        sentence = str(parse_input(tables).load_text)
    except InputError as error:
        sentence = str(error)
    assert len(sentence.splitlines()) == 1
