"""Claims on reading a study: what is varied, what each point is, and what is refused."""

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from refusal import complaint
from small_sweeps import AXES, QUICK, done, sweep_of
from undula.inputs.input import RunInput, parse_input, read_input
from undula.storage.differences import difference
from undula.sweeps.chunk_grid import ChunkGrid, chunk_shape
from undula.sweeps.sweep import sweep_from_dump
from undula.views import phase_diagram

RANDOM = QUICK + '[study]\npolicy = "random"\ntries = 3\n' + AXES


def test_axes_are_varied_in_their_order_and_the_last_one_fastest(tmp_path: Path) -> None:
    sweep = sweep_of(tmp_path, QUICK + AXES)
    assert sweep.shape == (2, 5, 1)
    loads = [sweep.tables(number)["load"] for number in range(sweep.count)]
    assert [(load["exponent"], load["force"]) for load in loads] == [
        (exponent, force) for exponent in (0.5, 2.0) for force in (20.0, 75.0, 130.0, 185.0, 240.0)
    ]
    assert {type(load["exponent"]) for load in loads} == {float}


def test_a_range_on_a_log_scale_has_constant_ratios_and_both_ends(tmp_path: Path) -> None:
    sweep = sweep_of(tmp_path, QUICK + AXES.replace("count = 5", 'count = 5\nspacing = "log"'))
    values = np.array(sweep.axes[1].values)
    assert (values[0], values[-1]) == (20.0, 240.0)
    np.testing.assert_allclose(values[1:] / values[:-1], 12.0**0.25, rtol=1e-12)


def test_a_point_is_the_input_that_undula_run_would_read(tmp_path: Path) -> None:
    sweep = sweep_of(tmp_path, QUICK + AXES)
    wanted = read_input(tmp_path / "study.toml", ["load.exponent=2.0", "load.force=185.0"])
    assert parse_input(sweep.tables(8)) == wanted


def test_a_default_that_depends_on_an_axis_follows_it(tmp_path: Path) -> None:
    text = '[model]\nkind = "chain"\n[[study.axes]]\nkey = "model.links"\nvalues = [2, 5]\n'
    sweep = sweep_of(tmp_path, text)
    for number, links in enumerate((2, 5)):
        tables = {"model": {"kind": "chain", "links": links}}
        assert parse_input(sweep.tables(number)) == parse_input(tables)


def test_a_study_is_made_again_from_what_a_store_keeps_of_it(tmp_path: Path) -> None:
    sweep = sweep_of(tmp_path, RANDOM)
    assert sweep_from_dump(json.loads(json.dumps(sweep.dump()))) == sweep


def test_a_key_can_be_changed_from_the_command_line(tmp_path: Path) -> None:
    axis = 'study.axes=[{key="model.drag_ratio", values=[1, 2]}]'
    sweep = sweep_of(tmp_path, RANDOM, "study.seed=7", "load.force=60", axis)
    assert sweep.shape == (2, 3)
    assert sweep.settings["seed"] == 7
    assert sweep.tables(0)["load"]["force"] == 60.0


def test_random_starts_depend_on_seed_point_and_try_alone(tmp_path: Path) -> None:
    sweep = sweep_of(tmp_path, RANDOM)
    starts = [sweep.tables(number)["start"] for number in range(sweep.count)]
    assert len({start["seed"] for start in starts}) == sweep.count
    assert [sweep.seed(number) for number in range(sweep.count)] == [s["seed"] for s in starts]
    again, other = sweep_of(tmp_path, RANDOM), sweep_of(tmp_path, RANDOM, "study.seed=2")
    assert [again.tables(number)["start"] for number in range(sweep.count)] == starts
    assert other.tables(0)["start"]["seed"] != starts[0]["seed"]
    parse_input(sweep.tables(0))


def test_amplitudes_of_random_starts_are_spread_evenly_over_their_decades(tmp_path: Path) -> None:
    sweep = sweep_of(tmp_path, RANDOM, "study.tries=400")
    drawn = [sweep.tables(number)["start"]["amplitude"] for number in range(0, sweep.count, 2)]
    parts = np.histogram(np.log10(drawn), bins=3, range=(-3.0, 0.0))[0] / len(drawn)
    # The share of a third, of 2000 draws, is known to 0.01; five of these are hardly exceeded.
    np.testing.assert_allclose(parts, 1.0 / 3.0, atol=0.05)
    assert min(drawn) >= 1e-3
    assert max(drawn) <= 1.0


def test_a_run_of_a_file_with_a_study_is_its_base(tmp_path: Path) -> None:
    sweep_of(tmp_path, RANDOM)
    assert read_input(tmp_path / "study.toml").load.exponent == 1.0


#: Every number of an input, with the choice that gives it a meaning and two values.
NUMBERS = {
    "model.segments": ("", "4, 6"),
    "model.links": ('model.kind="chain"', "2, 3"),
    "model.drag_ratio": ("", "1, 2.5"),
    "model.tensile_stiffness": ('model.inextensibility="weak"', "3e4, 5e4"),
    "model.base_spring": ('model.kind="chain"', "1, 2"),
    "model.bead_drag": ('model.kind="chain"', "1, 2"),
    "model.natural_curvature.k1": ("", "0, 2"),
    "model.natural_curvature.k2": ("model.natural_curvature=[1.0, 0.0]", "-1, 1"),
    "model.bending_ratio": ("", "1, 2"),
    "model.twist_stiffness": ('model.twist="elastic"', "1, 2"),
    "load.force": ("", "20, 30"),
    "load.position": ('load.profile="point"', "0.5, 1"),
    "load.slope": ('load.profile="linear"', "-1, 1"),
    "load.exponent": ('load.profile="power"', "0, 2"),
    "start.amplitude": ("", "0.01, 0.1"),
    "start.seed": ("", "1, 2"),
    "start.angle": ('start.shape="planar"', "0, 1.5"),
    "time.until": ("", "0.1, 0.2"),
    "time.limit": ('time.until="settled"', "1, 2"),
    "time.samples": ("", "20, 40"),
    "time.rtol": ("", "1e-6, 1e-4"),
    "time.atol": ("", "1e-10, 1e-8"),
}


def test_every_number_of_an_input_is_tried_as_an_axis() -> None:
    numbers = {
        f"{table}.{key}"
        for table, of in RunInput.model_fields.items()
        if table != "units"  # which makes numbers of those with a unit
        for key, field in of.annotation.model_fields.items()
        if isinstance(field.default, int | float) and not isinstance(field.default, bool)
    }
    assert numbers <= NUMBERS.keys()


@pytest.mark.parametrize("key", NUMBERS)
def test_every_number_of_an_input_can_be_an_axis(key: str, tmp_path: Path) -> None:
    choice, values = NUMBERS[key]
    text = f'[[study.axes]]\nkey = "{key}"\nvalues = [{values}]\n'
    sweep = sweep_of(tmp_path, text, *([choice] if choice else []))
    assert sweep_from_dump(json.loads(json.dumps(sweep.dump()))) == sweep
    for number, value in enumerate(sweep.axes[0].values):
        wanted = parse_input(sweep.tables(number))
        table, name, *component = key.split(".")
        stored = getattr(getattr(wanted, table), name)
        assert (stored[("k1", "k2").index(component[0])] if component else stored) == value


def test_a_component_of_the_natural_curvature_leaves_the_other_as_it_is(tmp_path: Path) -> None:
    text = '[[study.axes]]\nkey = "model.natural_curvature.k1"\nvalues = [1, 2]\n'
    sweep = sweep_of(tmp_path, text, "model.natural_curvature=[5.0, 3.0]")
    pairs = [sweep.tables(number)["model"]["natural_curvature"] for number in (0, 1)]
    assert pairs == [[1.0, 3.0], [2.0, 3.0]]
    # The value in the file does not matter where an axis varies it.
    other = sweep_of(tmp_path, text, "model.natural_curvature=[6.0, 3.0]")
    assert difference(sweep.dump(), other.dump()) is None
    both = text + '[[study.axes]]\nkey = "model.natural_curvature.k2"\nvalues = [0, 4]\n'
    sweep = sweep_of(tmp_path, both)
    assert sweep.tables(3)["model"]["natural_curvature"] == [2.0, 4.0]


def test_a_study_over_the_natural_curvature_is_done_and_drawn(tmp_path: Path) -> None:
    text = QUICK + '[[study.axes]]\nkey = "model.natural_curvature.k1"\nvalues = [0, 2]\n'
    store = done(sweep_of(tmp_path, text), tmp_path / "s.zarr")
    assert (store["status"].values == 1).all()
    assert store["model.natural_curvature.k1"].values.tolist() == [0.0, 2.0]
    assert store["energy_max"].values[0, 0] != store["energy_max"].values[1, 0]
    assert phase_diagram(store).axes


REFUSED = {
    "a component of a table": (
        '[[study.axes]]\nkey = "model.natural_curvature.k1"\nvalues = [1, 2]\n'
        "[model.natural_curvature]\ns = [0.0, 1.0]\nk1 = [1.0, 1.0]\nk2 = [0.0, 0.0]\n",
        "model.natural_curvature is no pair of numbers; give two numbers, or leave out this axis",
    ),
    "a pair as a whole": (
        AXES.replace("load.exponent", "model.natural_curvature"),
        "model.natural_curvature = 0.5 is a decimal number",
    ),
    "nothing varied": ("", "varies nothing; add a table [study] and [[study.axes]]"),
    "no such key": (
        AXES.replace("load.force", "load.forse"),
        "study.axes varies load.forse, which is no key of a run; did you mean load.force?",
    ),
    "out of range": (
        AXES.replace("20", "-20"),
        "the study cannot run at load.exponent = 0.5, load.force = -20.0: load.force = -20.0 is"
        " out of range; load.force takes a number of at least 0",
    ),
    "no number": (
        AXES.replace("load.exponent", "load.profile"),
        "load.profile = 0.5 is a decimal number; load.profile takes 'tip'",
    ),
    "no whole number": (
        AXES.replace("load.exponent", "model.segments"),
        "model.segments = 0.5 is a decimal number; model.segments takes a whole number",
    ),
    "idle": (
        AXES.replace("load.exponent", "load.slope"),
        "load.slope = 0.5 has no meaning for load.profile = 'power'",
    ),
    "twice the key": (AXES.replace("load.exponent", "load.force"), "two axes of the study vary"),
    "twice the value": (AXES.replace("[0.5, 2]", "[2, 2.0]"), "takes the value 2.0 twice"),
    "a wrong entry": (
        AXES.replace("[0.5, 2]", "[0.5, true]"),
        "study.axes[0].values[1] = true is a truth value; study.axes[0].values takes a list of",
    ),
    "an unknown entry": (
        AXES.replace("count", "cuont"),
        "study.axes[1].cuont is not a known key; did you mean study.axes.count?",
    ),
    "no values": (AXES.replace("[0.5, 2]", "[]"), "study.axes[0].values = [] is empty"),
    "half a range": (
        AXES.replace("to = 240", ""),
        "the axis load.force has neither values nor to; give values, or from, to and count",
    ),
    "both": (
        AXES.replace("count = 5", "count = 5\nvalues = [1]"),
        "the axis load.force has both values and from",
    ),
    "logarithm of zero": (
        AXES.replace("from = 20", 'spacing = "log"\nfrom = 0'),
        "spacing = 'log' between 0.0 and 240.0; give ends above 0",
    ),
    "too many": (
        AXES.replace("count = 5", "count = 900000"),
        "the study has 1800000 points, more than 1000000",
    ),
    "tries without chance": (
        "[study]\ntries = 3\n" + AXES,
        "study.tries = 3 has no meaning for study.policy = 'same'",
    ),
    "two starts": (
        '[start]\nseed = 3\n[study]\npolicy = "random"\n' + AXES,
        "start.seed has no meaning for study.policy = 'random'",
    ),
    "a start along the way": (
        '[study]\npolicy = "neighbour"\n' + AXES.replace("load.force", "start.amplitude"),
        "start.amplitude has no meaning along the last axis for study.policy = 'neighbour'",
    ),
    "falling amplitudes": (
        '[study]\npolicy = "random"\namplitudes = [1.0, 0.1]\n' + AXES,
        "study.amplitudes = [1.0, 0.1] fall; give the least inclination first",
    ),
    "shapes of many lengths": (
        '[study]\nkeep = "period"\n'
        + AXES.replace("load.exponent", "model.segments").replace("0.5, 2", "4, 8"),
        "model.segments varies, and shapes of different lengths",
    ),
    "a run of what is solved": (
        '[study]\nlabel = "solved"\nkeep = "run"\n' + AXES,
        "study.keep = 'run' has no meaning for study.label = 'solved'",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_a_wrong_study_is_refused_in_one_sentence_before_anything_runs(
    case: str, tmp_path: Path
) -> None:
    text, cure = REFUSED[case]
    assert cure in complaint(lambda: sweep_of(tmp_path, QUICK + text))


@given(
    shape=st.lists(st.integers(1, 12), min_size=2, max_size=4),
    point_bytes=st.sampled_from([8, 10**5, 10**6, 10**8]),
    whole_rows=st.booleans(),
)
def test_chunks_follow_one_another_and_hold_every_point_once(
    shape: list[int], point_bytes: int, whole_rows: bool
) -> None:
    chunks = ChunkGrid(
        tuple(shape), chunk_shape(shape, point_bytes=point_bytes, whole_rows=whole_rows)
    )
    numbers = np.arange(np.prod(shape)).reshape(shape)
    ends = [0]
    for chunk in range(len(chunks)):
        inside = chunks.numbers(chunk)
        assert inside.start == ends[-1]
        ends.append(inside.stop)
        assert numbers[chunks.region(chunk)].ravel().tolist() == list(inside)
        if whole_rows:
            assert len(inside) % (shape[-1] * shape[-2]) == 0
    assert ends[-1] == numbers.size


@pytest.mark.parametrize(
    ("found", "wanted", "told"),
    [
        ({"a": {"b": 1}}, {"a": {"b": 1}}, None),
        ({"a": {"b": 1}}, {"a": {"b": 2}}, "a.b = 1 instead of 2"),
        ({"a": 1}, {"b": 1}, "b = null instead of 1"),
        ({"a": [1, 2]}, {"a": [1, 3]}, "a[1] = 2 instead of 3"),
        ({"a": [1, 2]}, {"a": [1]}, "a of length 2 instead of 1"),
        ({"a": "no"}, {"a": "yes"}, 'a = "no" instead of "yes"'),
    ],
)
def test_the_first_difference_is_told_with_both_values(
    found: dict[str, object], wanted: dict[str, object], told: str | None
) -> None:
    assert difference(found, wanted) == told
