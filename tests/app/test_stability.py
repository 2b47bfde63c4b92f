"""The command `undula stability`: its answers, what they agree with, and what it refuses."""

import math
from itertools import product
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

import undula as un
from commands import Ask, Asked, answer
from undula.app.cli import main

#: Forces at which nothing coincides, and slopes of a linear load.
FORCES, SLOPES = "0:60:4", "-1:1:3"
LINEAR = ["--set", "load.profile=linear"]
#: Pushes near the clamp and pulls beyond: so does the force inside, nearly everywhere.
PULLED = """
[load]
profile = "table"
s = [0, 0.2, 0.4, 1]
density = [1, 1, -0.4, -0.4]
"""
#: The links of this one are extensible: it stands for no inextensible continuum.
WEAK = ["--set", "model.inextensibility=weak"]


pytestmark = pytest.mark.usefixtures("own_folder")


def refused(asked: Asked) -> str:
    """Return the sentence with which a question is refused, having checked how it is told."""
    found = answer(asked, status=2)
    assert found.keys() == {"status", "error"}
    assert found["status"] == "bad input"
    assert asked[2] == f"undula: {found['error']}\n"
    assert "np." not in found["error"]
    return str(found["error"])


def linear(slope: float, force: float = 75.0) -> un.Filament:
    return un.Filament(segments=40, load=un.LinearLoad(force, slope))


def test_a_single_case_is_answered_with_what_python_computes(ask: Ask) -> None:
    found = answer(ask("stability", "--set", "load.force=60", "--json"))
    filament = un.Filament(segments=40, load=un.TipLoad(60.0))
    onset, spectrum = un.onset(filament), un.spectrum(filament)
    assert onset.hopf is not None
    # JSON holds every digit of a number: these are equal, not close.
    assert found == {
        "status": "done",
        "load": "tip force 60",
        "units": filament.units.names(),
        "method": "spectral",
        "paper_time": False,
        "oscillatory_force": onset.oscillatory_force,
        "oscillatory_error": onset.oscillatory_error,
        "hopf_force": onset.force,
        "hopf_frequency": onset.frequency,
        "hopf_growth_slope": onset.hopf.growth_slope,
        "error": onset.error,
        "frequency_error": onset.hopf.frequency_error,
        "searched_to": onset.searched_to,
        "reason": None,
        "later": [
            {
                "force": crossing.force,
                "frequency": crossing.frequency,
                "growth_slope": crossing.growth_slope,
                "error": crossing.error,
                "frequency_error": crossing.frequency_error,
            }
            for crossing in onset.later
        ],
        "force": 60.0,
        "spectrum": [
            {"rate": rate, "frequency": frequency, "error": error}
            for rate, frequency, error in zip(
                spectrum.rates, spectrum.frequencies, spectrum.errors, strict=True
            )
        ],
        "figure": None,
    }
    assert len(found["later"]) == 2
    assert not list(Path().iterdir())


def test_the_onset_of_the_tip_load_is_the_published_one(ask: Ask) -> None:
    found = answer(ask("stability", "--json"))
    # Both as printed: Beck (1952), by way of Langthjem & Sugiyama (2000), and Ling, Guo & Kanso
    # (2018), who computed with assumed modes.
    assert found["oscillatory_force"] == pytest.approx(20.05, abs=0.005)
    assert found["hopf_force"] == pytest.approx(37.7, abs=0.05)


@pytest.mark.parametrize("method", ["spectral", "modes", "discrete"])
def test_every_method_is_reached_by_its_option_and_by_its_key(method: str, ask: Ask) -> None:
    short = answer(ask("stability", "--method", method, "--json"))
    assert short == answer(ask("stability", "--set", f"stability.method={method}", "--json"))
    assert short["method"] == method
    onset = un.onset(un.Filament(segments=40, load=un.TipLoad(75.0)), method=cast(Any, method))
    assert short["hopf_force"] == onset.force


def test_links_that_are_no_continuum_are_judged_as_they_are(ask: Ask) -> None:
    few = ["--set", "model.segments=6"]
    assert answer(ask("stability", *WEAK, *few, "--json"))["method"] == "discrete"
    assert "use method = 'discrete'" in refused(
        ask("stability", *WEAK, "--method", "spectral", "--json")
    )
    assert "use method = 'discrete'" in refused(
        ask("stability", *WEAK, "--method", "modes", "--json")
    )


def test_forces_give_the_leading_eigenvalue_at_each(ask: Ask) -> None:
    found = answer(ask("stability", "--forces", FORCES, "--json"))
    growth = un.growth_curve(linear(0.0).with_(load=un.TipLoad(75.0)), [0.0, 20.0, 40.0, 60.0])
    assert found["points"] == [
        {"force": force, "rate": rate, "frequency": frequency, "error": error}
        for force, rate, frequency, error in zip(
            growth.forces, growth.rates, growth.frequencies, growth.errors, strict=True
        )
    ]
    assert found["load"] == "tip load"


def test_forces_may_be_listed(ask: Ask) -> None:
    points = answer(ask("stability", "--forces", "40,10", "--json"))["points"]
    assert [point["force"] for point in points] == [40.0, 10.0]


def test_a_parameter_gives_the_thresholds_along_it(ask: Ask) -> None:
    found = answer(ask("stability", *LINEAR, "--along", f"load.slope={SLOPES}", "--json"))
    curve = un.critical_curve(linear(0.3), "load.slope", [-1.0, 0.0, 1.0])
    # What is swept over is not told of the load.
    assert (found["parameter"], found["load"]) == ("load.slope", "linear load")
    thresholds = found["thresholds"]
    assert [each["load.slope"] for each in thresholds] == [-1.0, 0.0, 1.0]
    for key, values in (
        ("hopf_force", curve.forces),
        ("hopf_frequency", curve.frequencies),
        ("hopf_growth_slope", curve.growth_slopes),
        ("oscillatory_force", curve.oscillatory_forces),
        ("error", curve.errors),
    ):
        assert [each[key] for each in thresholds] == values.tolist(), key


def test_a_threshold_on_a_curve_is_that_of_the_single_case(ask: Ask) -> None:
    (curve,) = answer(ask("stability", *LINEAR, "--along", "load.slope=0.5", "--json"))[
        "thresholds"
    ]
    single = answer(ask("stability", *LINEAR, "--set", "load.slope=0.5", "--json"))
    # The single case looks for later crossings too, with a larger pencil: same root, other
    # round-off.
    for key in ("hopf_force", "hopf_frequency", "oscillatory_force"):
        assert curve[key] == pytest.approx(single[key], rel=1e-11)


def test_forces_and_a_parameter_give_a_map(ask: Ask) -> None:
    words = ["--along", f"load.slope={SLOPES}", "--forces", "10,50"]
    found = answer(ask("stability", *LINEAR, *words, "--json"))
    points = found["points"]
    places = [(point["load.slope"], point["force"]) for point in points]
    assert places == list(product([-1.0, 0.0, 1.0], [10.0, 50.0]))
    growth = un.growth_curve(
        linear(0.0), [10.0, 50.0], parameter="load.slope", values=[-1.0, 0.0, 1.0]
    )
    assert [point["rate"] for point in points] == growth.rates.ravel().tolist()
    assert [point["frequency"] for point in points] == growth.frequencies.ravel().tolist()


@pytest.mark.parametrize("drag_ratio", [2.0, 3.0])
def test_the_printed_time_divides_rates_and_frequencies_and_no_force(
    drag_ratio: float, ask: Ask
) -> None:
    words = ["--set", f"model.drag_ratio={drag_ratio}", "--json"]
    paper = ["--set", "stability.paper_time=true"]
    ours, theirs = answer(ask("stability", *words)), answer(ask("stability", *words, *paper))
    assert (ours["paper_time"], theirs["paper_time"]) == (False, True)
    for key in ("oscillatory_force", "hopf_force", "error"):
        assert theirs[key] == ours[key]
    for key in ("hopf_frequency", "hopf_growth_slope", "frequency_error"):
        assert theirs[key] == pytest.approx(ours[key] / drag_ratio, rel=1e-14)
    for mine, printed in zip(ours["spectrum"], theirs["spectrum"], strict=True):
        assert printed["rate"] == pytest.approx(mine["rate"] / drag_ratio, rel=1e-14)
        assert printed["frequency"] == pytest.approx(mine["frequency"] / drag_ratio, rel=1e-14)
    ours, theirs = (
        answer(ask("stability", *words, *more, "--forces", "50")) for more in ([], paper)
    )
    assert theirs["points"][0]["rate"] == pytest.approx(ours["points"][0]["rate"] / drag_ratio)


def test_one_file_serves_a_run_and_a_question_of_stability(ask: Ask) -> None:
    Path("both.toml").write_text(
        "[model]\nsegments = 8\n[load]\nforce = 60\n[start]\nseed = 7\n"
        "[time]\nuntil = 0.001\nsamples = 3\n[stability]\nmethod = 'modes'\n"
    )
    assert main(["run", "both.toml", "--no-movie"]) == 0
    found = answer(ask("stability", "both.toml", "--json"))
    assert (found["method"], found["load"]) == ("modes", "tip force 60")


@pytest.mark.parametrize("change", ["start.seed=3", "time.until=2"])
def test_changes_of_a_table_that_is_not_read_are_refused(change: str, ask: Ask) -> None:
    Path("run.toml").write_text("[start]\nseed = 7\n")
    told = refused(ask("stability", "run.toml", "--set", change, "--json"))
    assert f"--set {change.split('.')[0]}" in told
    assert "it reads [model], [load], [units], [stability]" in told


def test_a_mistake_in_a_table_of_another_command_is_told(ask: Ask) -> None:
    Path("run.toml").write_text("[time]\nuntill = 2\n")
    assert "did you mean time.until?" in refused(ask("stability", "run.toml", "--json"))


def test_a_filament_that_never_loses_stability_is_told_to_be_stable(ask: Ask) -> None:
    Path("pulled.toml").write_text(PULLED)
    found = answer(ask("stability", "pulled.toml", "--json"))
    for key in ("hopf_force", "hopf_frequency", "hopf_growth_slope", "error", "oscillatory_force"):
        assert found[key] is None, key
    assert found["later"] == []
    assert found["searched_to"] >= 100.0
    assert found["reason"].startswith("straight and stable at every force up to ")
    status, said, _ = ask("stability", "pulled.toml")
    assert status == 0
    assert found["reason"] in said
    assert "None" not in said
    # Exponentially slow, where twelve decimals would show nothing but noughts.
    said = ask("stability", "pulled.toml", "--set", "load.force=300")[1]
    assert any("rate -" in line and "e-" in line.split("±")[0] for line in said.splitlines())


def test_a_table_from_a_file_is_the_profile_that_it_samples(ask: Ask) -> None:
    Path("half.toml").write_text('[load]\nprofile = "table"\ns = [0, 0.5, 1]\ndensity = [4, 3, 2]')
    found = answer(ask("stability", "half.toml", "--json"))
    assert found["load"] == "table force 75 (3 points)"
    # Falls from 4/3 to 2/3 of its mean.
    same = un.onset(linear(-1.0 / 3.0))
    # Equal but for round-off: the matrices come from other integrals.
    assert found["hopf_force"] == pytest.approx(same.force, rel=1e-11)


BAD_TABLES = {
    "density = [1, 1, nan]": "load.density[2] = nan is not a finite number",
    "density = [1, -2, 1]": "has to have a positive total",
    "density = [1, 1]": "density has 2 values, where s has 3",
    "density = [1, 1, 1]\ns = [0, 0.5, 0.9]": "s runs from 0.0 to 0.9",
    "density = [1, 1, 1]\ns = [0.1, 0.5, 1]": "s runs from 0.1 to 1.0",
    "density = [1, 1, 1]\ns = [0, 0, 1]": "give increasing arc lengths",
    "density = 1": "load.density takes a list of numbers",
    "": "needs load.density",
}


@pytest.mark.parametrize("text", BAD_TABLES)
def test_a_table_that_is_no_load_is_refused(text: str, ask: Ask) -> None:
    s = "" if "s = " in text else "\ns = [0, 0.5, 1]"
    Path("bad.toml").write_text(f'[load]\nprofile = "table"\n{text}{s}\n')
    assert BAD_TABLES[text] in refused(ask("stability", "bad.toml", "--json"))


#: What is asked, and a part of what is said to it.
BAD_WORDS = [
    ("--forces 0:60", "--forces 0:60 is no range"),
    ("--forces 0:60:0", "0 is no number of points"),
    ("--forces 0:60:2.5", "2.5 is no number of points"),
    ("--forces 0:nan:3", "nan is not a finite number"),
    ("--forces -1e308:1e308:3", "give a shorter range"),
    ("--forces -5:5:3", "force = -5.0 has to be a finite number, at least 0"),
    ("--forces much", "--forces much is no range"),
    ("--along load.slope", "write it like load.slope=-1:1:41"),
    ("--along load.slope=0:1:0", "0 is no number of points"),
    ("--along load.slope=inf", "inf is not a finite number"),
    ("--along load.slope=0:1:3", "load.slope is no number of this model"),
    ("--along model.colour=1", "model.colour is no number of this model"),
    ("--along model.segments=4:5:3", "model.segments = 4.5 has to be a whole number"),
    ("--along model.segments=3,4", "a whole number from 4 to 2000"),
    ("--along model.drag_ratio=0.5", "drag_ratio = 0.5"),
    ("--along load.force=0:1:3", "take another parameter"),
    ("--along load.force=0:1:3 --forces 10,20", "take another parameter"),
    ("--set load.profile=point --along load.position=0,0.5", "position = 0.0"),
    ("--set load.profile=linear --along load.slope=0:2:3 --forces 10", "slope = 2.0"),
    ("--method best", "stability.method takes 'spectral', 'modes' or 'discrete'"),
    ("--method=", "gives no value"),
    ("--set stability.metod=modes", "did you mean stability.method?"),
    ("--set stability.paper_time=1", "stability.paper_time takes true or false"),
    ("--set load.force=nan", "load.force = nan is not a finite number"),
    ("--plot figure.gif", "--plot figure.gif does not end like a figure"),
    ("--plot figure", "--plot figure does not end like a figure"),
    ("--plot file/figure.png", "cannot write figure.png in file"),
    ("--plot folder.png", "folder.png is a folder"),
    ("gone.toml", "there is no input file gone.toml"),
    ("--no-such-option", "No such option"),
]


@pytest.mark.parametrize(("words", "cure"), BAD_WORDS)
def test_bad_input_gets_one_sentence_and_with_json_one_object(
    words: str, cure: str, ask: Ask
) -> None:
    Path("file").touch()
    Path("folder.png").mkdir()
    assert cure in refused(ask("stability", *words.split(), "--json"))
    status, said, told = ask("stability", *words.split())
    assert (status, said, len(told.splitlines())) == (2, "", 1)
    assert cure in told
    assert {path.name for path in Path().iterdir()} == {"file", "folder.png"}


QUESTIONS = {
    "onset": [],
    "growth": ["--forces", FORCES],
    "thresholds": [*LINEAR, "--along", f"load.slope={SLOPES}"],
    "map": [*LINEAR, "--along", f"load.slope={SLOPES}", "--forces", FORCES],
}


@pytest.mark.parametrize("question", QUESTIONS)
def test_every_answer_can_be_drawn_and_says_where(question: str, ask: Ask) -> None:
    words = QUESTIONS[question]
    status, said, _ = ask("stability", *words, "--plot", "new/figure.png")
    assert status == 0
    assert said.splitlines()[-1].split() == ["figure", "new/figure.png"]
    assert Path("new/figure.png").read_bytes().startswith(b"\x89PNG")
    assert (
        answer(ask("stability", *words, "--plot", "figure.svg", "--json"))["figure"] == "figure.svg"
    )
    assert "<svg" in Path("figure.svg").read_text()


def test_a_figure_replaces_nothing_unless_told_to(
    ask: Ask, monkeypatch: pytest.MonkeyPatch
) -> None:
    Path("mine.pdf").write_text("mine")
    with monkeypatch.context() as patched:
        patched.setattr(
            "undula.app.commands.stability.analyse", lambda *_: pytest.fail("it was computed")
        )
        assert "--overwrite" in refused(
            ask("stability", "--forces", "10", "--plot", "mine.pdf", "--json")
        )
    assert Path("mine.pdf").read_text() == "mine"
    assert ask("stability", "--forces", "10,20", "--plot", "mine.pdf", "--overwrite")[0] == 0
    assert Path("mine.pdf").read_bytes().startswith(b"%PDF")


@pytest.mark.parametrize("question", QUESTIONS)
def test_people_read_aligned_lines_of_plain_numbers(question: str, ask: Ask) -> None:
    status, said, told = ask("stability", *QUESTIONS[question])
    assert (status, told) == (0, "")
    head, *lines = said.splitlines()
    swept = {"onset": "tip force 75", "growth": "tip load"}.get(question, "linear load")
    assert head.startswith(f"{swept}: ")
    assert len({len(line) for line in lines}) == 1 or question == "onset"
    assert max(len(line) for line in said.splitlines()) < 100
    for word in ("nan", "None", "np.", "e+00"):
        assert word not in said


def test_people_read_what_happens_at_which_force(ask: Ask) -> None:
    said = ask("stability")[1]
    lines = [line.split(maxsplit=2) for line in said.splitlines()[1:]]
    names = [line[:18].rstrip() for line in said.splitlines()[1:]]
    assert [name.strip() for name in names] == [
        *("rings from", "oscillates from", "frequency", "growth slope", "later", "later"),
        *("at 75", "at 75", "at 75"),
    ]
    onset = un.onset(un.Filament(segments=40, load=un.TipLoad(75.0)))
    assert f"{onset.force:.10f}" in said
    assert "cycles per T" in lines[2][-1]
    assert "(T/gamma)" in ask("stability", "--set", "stability.paper_time=true")[1]


def test_a_table_for_people_holds_the_numbers_of_the_answer(ask: Ask) -> None:
    rows = [line.split() for line in ask("stability", *QUESTIONS["map"])[1].splitlines()[2:]]
    points = answer(ask("stability", *QUESTIONS["map"], "--json"))["points"]
    told = np.array([[float(cell) for cell in row[:4]] for row in rows])
    keys = ("load.slope", "force", "rate", "frequency")
    # Eight digits are told.
    np.testing.assert_allclose(told, [[point[key] for key in keys] for point in points], rtol=1e-7)


def test_thresholds_that_do_not_exist_are_told_as_none(ask: Ask) -> None:
    Path("pulled.toml").write_text(PULLED)
    asked = ask("stability", "pulled.toml", "--along", "model.drag_ratio=2")
    assert asked[1].splitlines()[-1].split() == ["2", *["none"] * 5]
    (found,) = answer(ask("stability", "pulled.toml", "--along", "model.drag_ratio=2", "--json"))[
        "thresholds"
    ]
    assert found["hopf_force"] is None
    assert found["reason"].startswith("straight and stable")


def test_progress_is_told_apart_from_the_answer(ask: Ask, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("undula.terminal.meter.SECONDS_BETWEEN_LINES", 0.0)
    for question, task in (("thresholds", "thresholds"), ("map", "growth rates")):
        asked = ask("stability", *QUESTIONS[question], "--json")
        answer(asked)
        told = asked[2].splitlines()
        assert len(told) == 3
        assert told[0].startswith(f"{task}: 1 of 3, ")
        assert told[-1].startswith(f"{task}: 3 of 3, ")


def test_a_filament_without_a_force_has_the_rates_of_a_free_beam(ask: Ask) -> None:
    found = answer(ask("stability", "--set", "load.force=0", "--json"))
    # cos a cosh a = -1; roots as in any table of beam functions (e.g. Young & Felgar 1949).
    roots = (1.87510407, 4.69409113, 7.85475744, 10.99554073)
    rates = [each["rate"] for each in found["spectrum"]]
    # Nine digits of the root are four times as far off in its fourth power.
    assert rates == pytest.approx([-(root**4) for root in roots], rel=1e-8)
    assert all(each["frequency"] == 0.0 for each in found["spectrum"])
    assert math.isfinite(found["hopf_force"])
