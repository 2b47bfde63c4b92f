"""Claims on the table `[units]` and on numbers of an input that are given with their units."""

import subprocess
import sys
from typing import Any

import pytest

from refusal import complaint
from undula.inputs.input import (
    RunInput,
    StabilityInput,
    SweepInput,
    changed_tables,
    parse_input,
    read_input,
)
from undula.models.scales import Scales

FILAMENT = {"length": "12 um", "stiffness": "25 pN um^2"}
SCALES = Scales(12e-6, 25e-24)


def read(**tables: Any) -> RunInput:
    return parse_input({"units": FILAMENT, **tables})


def refusal(**tables: Any) -> str:
    return complaint(lambda: parse_input(tables))


def test_an_input_without_the_table_has_no_scales_and_states_none() -> None:
    assert parse_input({}).scales is None
    assert "units" not in parse_input({}).dump()


def test_the_table_gives_the_scales_and_changes_no_other_number() -> None:
    assert read().scales == SCALES
    assert {**read().dump(), "units": None} == {**parse_input({}).dump(), "units": None}


def test_what_the_table_leaves_out_is_as_in_the_default_scales() -> None:
    assert parse_input({"units": {}}).scales == Scales()


def test_the_dump_of_an_input_is_read_as_the_same_input() -> None:
    given = read(load={"force": "8 pN"})
    assert parse_input(given.dump()) == given
    assert given.dump()["units"] == {**FILAMENT, "viscosity": "1 mPa s", "slenderness": 0.01}


@pytest.mark.parametrize(
    ("tables", "table", "key", "value"),
    [
        # 8 pN over 25 pN um^2 / (12 um)^2.
        ({"load": {"force": "8 pN"}}, "load", "force", 46.08),
        ({"load": {"force": "8e-12 N"}}, "load", "force", 46.08),
        ({"load": {"force": 8}}, "load", "force", 8),
        ({"load": {"profile": "point", "position": "3 um"}}, "load", "position", 0.25),
        ({"time": {"until": "0.2 s"}}, "time", "until", 0.2 / SCALES.time),
        ({"time": {"until": "settled", "limit": "0.2 s"}}, "time", "limit", 0.2 / SCALES.time),
        ({"time": {"until": "settled"}}, "time", "until", "settled"),
        (
            {"model": {"natural_curvature": ["0.1 1/um", 0]}},
            "model",
            "natural_curvature",
            (1.2, 0.0),
        ),
        (
            {"model": {"inextensibility": "weak", "tensile_stiffness": "6944 pN"}},
            "model",
            "tensile_stiffness",
            6944 / 25 * 144,
        ),
    ],
)
def test_numbers_with_a_unit_are_dimensionless_behind(
    tables: dict[str, Any], table: str, key: str, value: Any
) -> None:
    given = getattr(getattr(read(**tables), table), key)
    assert given == (value if isinstance(value, str) else pytest.approx(value, rel=1e-14))


def test_lists_of_points_are_given_in_units_too() -> None:
    load = {"profile": "table", "s": ["0 um", "6 um", 1.0], "density": [1, 2, 1]}
    assert read(load=load).load.s == (0.0, 0.5, 1.0)
    curvature = {"s": [0.0, "12 um"], "k1": ["0.1 1/um", 0.0], "k2": [0.0, 0.0]}
    given = read(model={"natural_curvature": curvature}).model.natural_curvature
    assert (given.s, given.k1) == ((0.0, 1.0), (1.2, 0.0))


def test_axes_of_a_study_take_the_units_of_their_keys() -> None:
    axes = [
        {"key": "load.force", "from": "1 pN", "to": "8 pN", "count": 2},
        {"key": "load.slope", "values": [0.5]},
    ]
    study = {"units": FILAMENT, "study": {"axes": axes}}
    first, second = changed_tables(SweepInput, study, ())[1].study.axes
    assert first.resolved == pytest.approx((5.76, 46.08), rel=1e-14)
    assert second.resolved == (0.5,)


def test_the_table_is_changed_from_the_command_line_before_numbers_are_converted() -> None:
    changes = ["load.force=8 pN", 'units.length="12 um"', "units.stiffness=25 pN um^2"]
    assert read_input(overrides=changes).load.force == 46.08


@pytest.mark.parametrize(
    ("units", "sentence"),
    [
        ({"length": 12}, "units.length = 12 is a whole number; units.length takes a text with"),
        ({"length": "12"}, "units.length = '12' has no unit; give a length with its unit, such"),
        ({"length": "12 s"}, "units.length = '12 s' has a unit that is not that of a length;"),
        ({"length": "-1 um"}, "units.length = '-1 um' is not above 0; give a length"),
        ({"length": "nan um"}, "units.length = 'nan um' is not a number and its unit; give a"),
        ({"length": "12 parsec"}, "units.length = '12 parsec' is 3.7e+17 m, which is out of"),
        ({"viscosity": "1 zork"}, "units.viscosity = '1 zork' has a unit that is not known;"),
        ({"slenderness": 1.0}, "units.slenderness = 1.0 is out of range; units.slenderness"),
        ({"slenderness": "0.01"}, "units.slenderness = '0.01' is text; units.slenderness takes"),
        ({"lenght": "12 um"}, "units.lenght is not a known key; did you mean units.length?"),
        ("12 um", "units = '12 um' is not a table; write [units] and its keys below"),
    ],
)
def test_a_wrong_table_is_refused_in_a_sentence(units: Any, sentence: str) -> None:
    assert refusal(units=units).startswith(sentence)


@pytest.mark.parametrize(
    ("tables", "sentence"),
    [
        ({"force": "8 s"}, "load.force = '8 s' has a unit that is not that of a force; give a"),
        ({"force": "8"}, "load.force = '8' has no unit; give a force with its unit, such as"),
        ({"force": "-8 pN"}, "load.force = -46.08 is out of range; load.force takes a number"),
        ({"force": "much"}, "load.force = 'much' is text; load.force takes a number of at"),
        ({"slope": "1 pN", "profile": "linear"}, "load.slope = '1 pN' is text; load.slope takes"),
    ],
)
def test_a_wrong_number_with_a_unit_is_refused_in_a_sentence(
    tables: dict[str, Any], sentence: str
) -> None:
    assert refusal(units=FILAMENT, load=tables).startswith(sentence)


def test_a_unit_needs_the_table() -> None:
    assert refusal(load={"force": "8 pN"}) == (
        "load.force = '8 pN' has a unit, which needs a table [units] with the filament's length"
        " and stiffness, such as units.length = '12 um'; give one, or a number in B/L^2"
    )


def test_a_chain_has_units_of_its_own() -> None:
    assert refusal(units=FILAMENT, model={"kind": "chain"}).startswith("[units] are those of a")


def test_the_time_of_the_printed_equation_has_no_physical_unit() -> None:
    tables = {"units": FILAMENT, "stability": {"paper_time": True}}
    refused = complaint(lambda: changed_tables(StabilityInput, tables, ()))
    assert refused.startswith("stability.paper_time = true has a unit of time that is not that")


def test_the_library_of_units_is_imported_only_for_an_input_with_units() -> None:
    program = (
        "import sys; from undula.inputs.input import read_input; read_input();"
        "assert 'pint' not in sys.modules; read_input(overrides=['units.length=1 um']);"
        "assert 'pint' in sys.modules"
    )
    subprocess.run([sys.executable, "-c", program], check=True, timeout=60)
