"""Tables of comma-separated values: headings with units, numbers as in the JSON answer."""

import csv
import io
from pathlib import Path
from typing import Any

import pytest

from commands import Ask, answer, refused, text
from small_sweeps import AXES, QUICK, sweep_of
from undula.sweeps.store import open_sweep

SIX = ["--set", "model.segments=6"]
CHAIN = ["--set", "model.kind=chain", "--set", "model.links=2"]

pytestmark = pytest.mark.usefixtures("own_folder")


def table(said: str) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(said)))


def agree(cells: list[str], values: list[Any]) -> bool:
    """Return whether the cells of a column are the values of an answer, bit for bit."""
    shown = {True: "true", False: "false", None: ""}
    return cells == [shown[v] if v is None or isinstance(v, bool) else str(v) for v in values]


def test_the_rates_over_forces_are_a_table(ask: Ask) -> None:
    words = ["stability", "--forces", "0:60:3", *SIX]
    rows, points = table(text(ask(*words, "--csv"))), answer(ask(*words, "--json"))["points"]
    assert [*rows[0]] == ["force [B/L^2]", "rate [1/T]", "frequency [cycles per T]", "error [1/T]"]
    for heading in rows[0]:
        name = heading.partition(" ")[0]
        assert agree([row[heading] for row in rows], [point[name] for point in points])


def test_the_thresholds_of_chains_have_their_further_forces(ask: Ask) -> None:
    words = ["stability", *CHAIN, "--along", "model.links=2,3"]
    rows, found = table(text(ask(*words, "--csv"))), answer(ask(*words, "--json"))["thresholds"]
    assert agree([row["model.links"] for row in rows], [2.0, 3.0])
    further = [row["hopf_force_in [B/L^2]"] for row in rows]
    assert agree(further, [one["hopf_force_in"]["B/L^2"] for one in found])
    assert {"hopf_force [K/L]", "hopf_frequency [cycles per T]", "reason"} <= rows[0].keys()


def test_a_threshold_along_a_parameter_is_a_table(ask: Ask) -> None:
    words = ["threshold", "onset", *SIX, "--along", "model.drag_ratio=1,2"]
    rows, found = table(text(ask(*words, "--csv"))), answer(ask(*words, "--json"))["thresholds"]
    assert agree([row["value [B/L^2]"] for row in rows], [one["value"] for one in found])
    assert agree([row["model.drag_ratio"] for row in rows], [1.0, 2.0])


def test_the_points_of_a_branch_are_a_table_and_several_have_their_kind(ask: Ask) -> None:
    along = [*SIX, "--along", "load.force=60:64:3"]
    rows = table(text(ask("follow", "spinning", *along, "--csv")))
    points = answer(ask("follow", "spinning", *along, "--json"))["points"]
    assert agree([row["load.force [B/L^2]"] for row in rows], [60.0, 62.0, 64.0])
    energies = [row["bending_energy [B/L]"] for row in rows]
    assert agree(energies, [point["bending_energy"] for point in points])
    assert agree([row["stable"] for row in rows], [point["stable"] for point in points])
    both = table(text(ask("follow", "straight", "spinning", *along, "--csv")))
    assert [row["kind"] for row in both] == 3 * ["straight"] + 3 * ["spinning"]
    assert both[0]["bending_energy [B/L]"] == ""
    assert [row["frequency [cycles per T]"] for row in both[3:]] == [
        row["frequency [cycles per T]"] for row in rows
    ]


def test_where_no_state_is_found_the_table_is_empty_and_a_notice_says_why(ask: Ask) -> None:
    asked = ask("follow", "spinning", *SIX, "--along", "load.force=20:30", "--csv")
    assert (asked.status, asked.said) == (0, "\n")
    assert asked.told.startswith("undula: the state is not found: ")


def test_the_steps_of_a_ramp_are_a_table(ask: Ask) -> None:
    quick = [*CHAIN, "--set", "time.until=0.1", "--set", "time.samples=20"]
    words = ["step", *quick, "--along", "load.force=1,2"]
    rows = table(text(ask(*words, "--csv")))
    steps = answer(ask(*words, "--json"))["steps"]
    assert agree([row["load.force [K/L]"] for row in rows], [1.0, 2.0])
    assert agree([row["bending_energy_mean [K]"] for row in rows], _means(steps))
    assert agree([row["time [T]"] for row in rows], [step["time"] for step in steps])
    assert [row["verdict"] for row in rows] == [step["verdict"] for step in steps]


def _means(steps: list[dict[str, Any]]) -> list[float]:
    return [step["bending_energy"]["mean"] for step in steps]


def test_the_points_of_a_study_are_a_table(ask: Ask) -> None:
    sweep = sweep_of(Path(), QUICK + AXES)
    open_sweep(Path("study.zarr"), sweep)
    rows = table(text(ask("status", "study.zarr", "--csv")))
    assert len(rows) == sweep.count
    for number, row in enumerate(rows):
        load = sweep.tables(number)["load"]
        assert row["load.exponent"] == str(load["exponent"])
        assert row["load.force [B/L^2]"] == str(load["force"])
    assert {row["status"] for row in rows} == {"not_done"}
    assert {row["frequency [cycles per T]"] for row in rows} == {""}
    assert "tip_radius_max [L]" in rows[0]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("stability", "--csv writes a table; give --forces or --along as well"),
        ("threshold onset", "--csv writes a table; give --along as well"),
        ("stability --forces 1,2 --json", "--json and --csv are two forms of the answer"),
        ("follow spinning --along load.force=40:50 --json", "--json and --csv are two forms"),
        ("step --along load.force=1,2 --json", "--json and --csv are two forms of the answer"),
        ("status gone --json", "--json and --csv are two forms of the answer"),
        *(
            (words, f"undula {words.split()[0]} answers with no table; leave out --csv")
            for words in (
                "run",
                "find spinning",
                "units",
                "sweep gone.toml",
                "plot gone",
                "movie x",
            )
        ),
    ],
)
def test_a_table_that_there_is_not_is_refused_in_one_sentence(
    words: str, said: str, ask: Ask
) -> None:
    asked = ask(*words.split(), "--csv")
    assert (asked.status, len(asked.told.splitlines())) == (2, 1)
    assert said in asked.told
    assert not list(Path().iterdir())


def test_the_one_sentence_on_a_wrong_option_stays(ask: Ask) -> None:
    assert refused(ask("run", "--cvs")).startswith("No such option: --cvs")
