"""Claims on reading the input of a command: defaults, resolution, files and overrides."""

import json
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from refusal import complaint
from undula.inputs.input import (
    RunInput,
    StabilityInput,
    parse_input,
    read_input,
    read_stability_input,
)

DEFAULTS = {
    "model": {
        "kind": "filament",
        "segments": 40,
        "drag_ratio": 2.0,
        "inextensibility": "exact",
        "confined": False,
        "natural_curvature": [0.0, 0.0],
        "bending_ratio": 1.0,
        "twist": "rigid",
    },
    "load": {"profile": "tip", "force": 75.0},
    "start": {"shape": "kicked", "amplitude": 0.01, "seed": 1},
    "time": {"until": 1.0, "samples": 4000, "rtol": 1e-6, "atol": 1e-10},
}


def written(folder: Path, text: str) -> Path:
    path = folder / "run.toml"
    path.write_text(text, encoding="utf-8")
    return path


def optional(**keys: st.SearchStrategy[Any]) -> st.SearchStrategy[dict[str, Any]]:
    return st.fixed_dictionaries({}, optional=keys)


def chosen(
    key: str, value: str, **keys: st.SearchStrategy[Any]
) -> st.SearchStrategy[dict[str, Any]]:
    return st.fixed_dictionaries({key: st.just(value)}, optional=keys)


positive = st.floats(1e-6, 1e6)
force = st.floats(0.0, 1e6) | st.integers(0, 10**6)
amplitude = st.floats(1e-6, 0.5)
angle = st.floats(-10.0, 10.0)
# Less than turns a joint of four segments by pi.
curvature = st.lists(st.floats(-8.0, 8.0), min_size=2, max_size=2) | st.just(
    {"s": [0.0, 0.3, 1.0], "k1": [1.0, 2.0, 0.0], "k2": [0.0, -1.0, 3.0]}
)
directors = {"natural_curvature": curvature, "bending_ratio": positive}
models = (
    optional(segments=st.integers(4, 500), drag_ratio=st.floats(1.0, 5.0), **directors)
    | chosen("twist", "elastic", twist_stiffness=positive, **directors)
    | chosen("inextensibility", "weak", tensile_stiffness=positive, confined=st.booleans())
)
loads = st.one_of(
    chosen("profile", "tip", force=force),
    chosen("profile", "point", force=force, position=st.floats(1e-3, 1.0)),
    chosen("profile", "linear", force=force, slope=st.floats(-1.0, 1.0)),
    chosen("profile", "power", force=force, exponent=st.floats(0.0, 50.0)),
    st.fixed_dictionaries(
        {
            "profile": st.just("table"),
            "s": st.just([0, 0.25, 0.3, 1]),
            # One that pushes outweighs whatever the others pull.
            "density": st.lists(st.floats(-1.0, 1e6), min_size=3, max_size=3).map(
                lambda d: [*d, 9]
            ),
        },
        optional={"force": force},
    ),
)
# No helix: it does not go with a confined model.
starts = st.one_of(
    st.just({"shape": "straight"}),
    chosen("shape", "kicked", amplitude=amplitude, seed=st.integers(0, 2**63 - 1)),
    chosen("shape", "planar", amplitude=amplitude, angle=angle),
    chosen("shape", "mode", amplitude=amplitude, angle=angle),
    st.fixed_dictionaries({"shape": st.just("state"), "file": st.text(min_size=1)}),
)
times = optional(
    until=positive, samples=st.integers(2, 10**6), atol=st.floats(1e-300, 1e-2)
) | chosen("until", "settled", limit=positive, rtol=st.floats(1e-12, 1e-2))


def keeps_to_the_plane(tables: dict[str, Any]) -> bool:
    """Whether a confined model, if it is one, starts in the plane that it is confined to."""
    confined = tables.get("model", {}).get("confined", False)
    return not confined or tables.get("start", {}).get("angle", 0.0) == 0.0


inputs = optional(model=models, load=loads, start=starts, time=times).filter(keeps_to_the_plane)


def test_no_file_and_no_override_give_the_documented_defaults() -> None:
    assert read_input(None).dump() == DEFAULTS


def test_every_default_passes_the_check_that_a_given_value_passes() -> None:
    assert parse_input(DEFAULTS) == RunInput()


@given(inputs)
def test_the_dumped_input_is_plain_json_and_reads_back_equal(tables: dict[str, Any]) -> None:
    spec = parse_input(tables)
    assert parse_input(json.loads(json.dumps(spec.dump()))) == spec


@given(inputs)
def test_the_dumped_input_keeps_every_given_value(tables: dict[str, Any]) -> None:
    dumped = parse_input(tables).dump()
    for name, table in tables.items():
        assert {key: dumped[name][key] for key in table} == table


@given(loads)
def test_a_complete_load_shows_the_defaults_of_the_keys_that_it_uses(load: dict[str, Any]) -> None:
    uses = {
        "tip": [],
        "point": ["position"],
        "linear": ["slope"],
        "power": ["exponent"],
        "table": ["s", "density"],
    }
    dumped = parse_input({"load": load}).dump()["load"]
    assert list(dumped) == ["profile", "force", *uses[load["profile"]]]


def test_a_whole_number_may_stand_for_a_float() -> None:
    force = parse_input({"load": {"force": 80}}).load.force
    assert (force, type(force)) == (80.0, float)


def test_the_input_cannot_be_changed_after_the_check() -> None:
    with pytest.raises(ValidationError, match="frozen"):
        read_input().load.force = 80.0


@pytest.mark.parametrize(
    ("load", "text"),
    [
        ({}, "tip force 75"),
        ({"profile": "point", "position": 0.8}, "point force 75 at s = 0.8"),
        ({"profile": "linear", "slope": 0.5}, "linear force 75, slope 0.5"),
        ({"profile": "power", "force": 37.25, "exponent": 2}, "power force 37.25, exponent 2"),
        (
            {"profile": "table", "s": [0, 0.2, 1], "density": [1, 2, 0]},
            "table force 75 (3 points)",
        ),
    ],
)
def test_the_load_is_told_in_words(load: dict[str, Any], text: str) -> None:
    assert parse_input({"load": load}).load_text == text


def test_a_file_is_read_and_overrides_win_in_order(tmp_path: Path) -> None:
    path = written(tmp_path, '[load]\nprofile = "linear"\nforce = 60\n[time]\nuntil = 2\n')
    spec = read_input(path, ["load.force=70", "load.force = 80", "model.segments=20"])
    assert (spec.load.profile, spec.load.force) == ("linear", 80.0)
    assert (spec.time.until, spec.model.segments) == (2.0, 20)


def test_a_byte_order_mark_is_no_obstacle(tmp_path: Path) -> None:
    path = tmp_path / "run.toml"
    path.write_bytes(b"\xef\xbb\xbf[load]\r\nforce = 60\r\n")
    assert read_input(path).load.force == 60.0


@pytest.mark.parametrize(
    ("override", "value"),
    [
        ("time.until=settled", "settled"),
        ('time.until="settled"', "settled"),
        ("time.until=3", 3.0),
        ("time.until=1e-1", 0.1),
    ],
)
def test_an_override_is_read_as_toml_and_else_as_text(override: str, value: object) -> None:
    assert read_input(None, [override]).time.until == value


def test_a_table_is_given_by_overrides_in_any_order() -> None:
    overrides = ["load.density=[1,2]", "load.profile=table", "load.s=[0, 1]"]
    for order in (overrides, overrides[::-1]):
        load = read_input(None, order).load
        assert (load.profile, load.s, load.density) == ("table", (0.0, 1.0), (1.0, 2.0))


def test_a_table_is_read_from_a_file(tmp_path: Path) -> None:
    path = written(tmp_path, '[load]\ndensity = [1, 0]\ns = [0, 1]\nprofile = "table"\n')
    assert read_input(path).dump()["load"] == {
        "profile": "table",
        "force": 75.0,
        "s": [0.0, 1.0],
        "density": [1.0, 0.0],
    }


#: Tables of every command.
SHARED = """
[model]
segments = 20
[load]
force = 60
[start]
seed = 7
[time]
until = 2
[stability]
method = "modes"
"""


def test_stability_has_defaults_and_needs_neither_start_nor_time() -> None:
    assert read_stability_input().dump() == {
        "model": DEFAULTS["model"],
        "load": DEFAULTS["load"],
        # Which method is the default depends on the model.
        "stability": {"paper_time": False},
    }


def test_every_method_of_stability_is_known() -> None:
    for method in ("spectral", "modes", "discrete"):
        wanted = read_stability_input(None, [f"stability.method={method}"])
        assert wanted.stability.method == method
        assert wanted.dump()["stability"] == {"method": method, "paper_time": False}


def test_a_file_may_hold_the_tables_of_several_commands(tmp_path: Path) -> None:
    path = written(tmp_path, SHARED)
    run, question = read_input(path), read_stability_input(path)
    assert (run.model, run.load) == (question.model, question.load)
    assert (run.start.seed, run.time.until) == (7, 2.0)
    assert question.stability.method == "modes"
    # Each is what it would be had the file held its own tables only.
    assert run == RunInput.model_validate(run.dump())
    assert question == StabilityInput.model_validate(question.dump())
    assert not {"start", "time"} & question.dump().keys()
    assert "stability" not in run.dump()


@pytest.mark.parametrize("override", ["stability.method=modes", "stability.paper_time=true"])
def test_a_run_refuses_changes_of_the_table_of_stability(override: str, tmp_path: Path) -> None:
    path = written(tmp_path, SHARED)
    for file in (None, path):
        sentence = complaint(partial(read_input, file, [override]))
        assert sentence.startswith("--set stability.")
        assert sentence.endswith("it reads [model], [load], [units], [start], [time]")


@pytest.mark.parametrize("override", ["start.seed=3", "time.until=1"])
def test_stability_refuses_changes_of_the_tables_of_a_run(override: str, tmp_path: Path) -> None:
    path = written(tmp_path, SHARED)
    for file in (None, path):
        sentence = complaint(partial(read_stability_input, file, [override]))
        assert sentence.startswith(f"--set {override.split('.')[0]}.")
        assert sentence.endswith("it reads [model], [load], [units], [stability]")


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (
            '[stability]\nmethod = "best"',
            "stability.method = 'best' is not known;"
            " stability.method takes 'spectral', 'modes' or 'discrete'",
        ),
        (
            "[stability]\npaper_time = 1",
            "stability.paper_time = 1 is a whole number; stability.paper_time takes true or false",
        ),
        (
            "[stability]\npapertime = true",
            "stability.papertime is not a known key; did you mean stability.paper_time?",
        ),
        ("[stabilty]\n", "[stabilty] is not a known table; did you mean [stability]?"),
        ("[time]\nuntil = 0", "time.until = 0 is out of range; time.until takes"),
        ("[start]\nshape = 'state'", "start.shape = 'state' needs start.file"),
    ],
)
def test_a_mistake_in_a_file_is_told_whichever_command_reads_it(
    text: str, sentence: str, tmp_path: Path
) -> None:
    path = written(tmp_path, text)
    told = {complaint(lambda: read_input(path)), complaint(lambda: read_stability_input(path))}
    (only,) = told
    assert only.startswith(sentence)


def test_a_file_name_in_an_override_needs_no_quotes() -> None:
    spec = read_input(None, ["start.shape=state", "start.file=../old runs/a=b.nc"])
    assert spec.start.file == "../old runs/a=b.nc"


@pytest.mark.parametrize(
    ("override", "sentence"),
    [
        ("load.force", "--set load.force has no '='; write --set load.force=VALUE"),
        ("", "--set  has no '='; write --set load.force=VALUE"),
        (
            "force=80",
            "--set force=80 does not name a table and a key; write it like --set load.force=75",
        ),
        (
            "load.force.x=80",
            "--set load.force.x=80 does not name a table and a key;"
            " write it like --set load.force=75",
        ),
        ("load.force=", "--set load.force= gives no value; write --set load.force=VALUE"),
        (
            "laod.force=80",
            "[laod] is not a known table; did you mean [load]?",
        ),
        (
            "load.force=8O",
            "load.force = '8O' is text; load.force takes a number of at least 0",
        ),
        (
            "load.force=1\nload = 2",
            "load.force = '1\\nload = 2' is text; load.force takes a number of at least 0",
        ),
    ],
)
def test_a_malformed_override_is_refused_with_its_cure(override: str, sentence: str) -> None:
    assert complaint(lambda: read_input(None, [override])) == sentence


def test_a_number_too_long_to_print_is_refused_without_printing_it(tmp_path: Path) -> None:
    path = written(tmp_path, f"[load]\nforce = 0x{'f' * 9000}")
    assert complaint(lambda: read_input(path)) == (
        "load.force = a number of thousands of digits is too large;"
        " load.force takes a number of at least 0"
    )


def test_a_table_replaced_by_a_value_is_refused_in_spite_of_an_override(tmp_path: Path) -> None:
    path = written(tmp_path, "load = 75")
    sentence = complaint(lambda: read_input(path, ["load.force=80"]))
    assert sentence.startswith("load = 75 is not a table")


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    path = tmp_path / "none.toml"
    sentence = f"there is no input file {path}; check the name"
    assert complaint(lambda: read_input(path)) == sentence


def test_a_folder_in_place_of_a_file_is_named(tmp_path: Path) -> None:
    sentence = complaint(lambda: read_input(tmp_path))
    assert sentence.startswith(f"cannot read the input file {tmp_path} (")
    assert sentence.endswith("); give a readable TOML file")


def test_a_file_that_is_not_text_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.toml"
    path.write_bytes(b"[load]\nforce = \xff")
    assert complaint(lambda: read_input(path)) == (
        f"{path} is not UTF-8 text (byte 15); give a TOML file saved as UTF-8"
    )


@pytest.mark.parametrize(
    ("text", "place"),
    [("[load]\nforce 75\n", ", line 2, column 7: "), ("[load]\nforce = [", ", end of document: ")],
)
def test_a_toml_error_is_placed(tmp_path: Path, text: str, place: str) -> None:
    path = written(tmp_path, text)
    sentence = complaint(lambda: read_input(path))
    assert sentence.startswith(f"{path}{place}")
    assert sentence.endswith("; correct the TOML there")


@pytest.mark.parametrize("value", ["9" * 5000, "[" * 100_000])
def test_a_value_beyond_reading_is_refused(tmp_path: Path, value: str) -> None:
    path = written(tmp_path, f"[load]\nforce = {value}")
    assert complaint(lambda: read_input(path)).startswith(f"{path} holds a value too large")
