"""The commands `undula find`, `follow` and `threshold`: what they answer, draw and refuse."""

from pathlib import Path

import pytest

import undula as un
from cases import mostly_slow
from commands import Ask, Asked, answer
from undula.analysis.solvers.quantities import quantities_of
from undula.analysis.states.extrapolation import extrapolated
from undula.analysis.states.records import Flapping, Spinning

EIGHT = un.Filament(segments=8, load=un.TipLoad(75.0))
FEW = ["--set", "model.segments=8"]
CONFINED = ["--set", "model.confined=true"]
STATE = {
    *("status", "kind", "units", "force", "links", "frequency", "error", "stable"),
    *("error_of", "solver_error"),
    "leading_rate",
    *("bending_energy", "tip_radius", "tip_height", "residual", "power_balance_error"),
}
RANGE = {"min", "max", "mean"}
BIFURCATION = {
    *("kind", "value", "load.force", "error", "error_of", "links"),
    *("frequency", "second_frequency"),
}
THRESHOLD = {
    *("value", "error", "solver_error", "frequency", "second_frequency", "bifurcation"),
    *("reason", "searched_to"),
}
OF = {"error_of", "links"}


pytestmark = pytest.mark.usefixtures("own_folder")


@pytest.fixture(scope="module", autouse=True)
def _compiled() -> None:
    """Have the kernels compiled before anyone listens to what is said on standard error."""
    assert un.find(EIGHT, "spinning")
    assert un.find(EIGHT, "flapping")


def refused(asked: Asked) -> str:
    """Return the sentence with which a question is refused, having checked how it is told."""
    found = answer(asked, status=2)
    assert found.keys() == {"status", "error"}
    assert found["status"] == "bad input"
    assert asked[2] == f"undula: {found['error']}\n"
    assert "np." not in found["error"]
    return str(found["error"])


# ---------------------------------------------------------------- find


def test_spinning_is_answered_with_what_python_computes(ask: Ask) -> None:
    found = answer(ask("find", "spinning", *FEW, "--json"))
    state = un.find(EIGHT, "spinning")
    assert isinstance(state, Spinning)
    assert found.keys() == STATE | {"trivial_rate"}
    assert (found["status"], found["kind"], found["links"]) == ("done", "spinning", 8)
    # JSON holds every digit of a number: these are equal, not close.
    for key in (
        *("force", "frequency", "stable", "leading_rate", "residual", "power_balance_error"),
    ):
        assert found[key] == getattr(state, key), key
    for key in ("bending_energy", "tip_radius", "tip_height"):
        assert found[key] == getattr(state, key).mean, key
    assert found["trivial_rate"] == abs(state.trivial)
    assert not list(Path().iterdir())


def test_flapping_is_answered_with_what_python_computes(ask: Ask) -> None:
    found = answer(ask("find", "flapping", *FEW, "--json"))
    state = un.find(EIGHT, "flapping")
    assert isinstance(state, Flapping)
    assert found.keys() == STATE | {
        *("leading_rate_in_plane", "leading_rate_out_of_plane"),
        *("trivial_multiplier_error", "time_error"),
    }
    assert (found["kind"], found["stable"]) == ("flapping", False)
    for key in ("frequency", "leading_rate", "leading_rate_in_plane", "leading_rate_out_of_plane"):
        assert found[key] == getattr(state, key), key
    for key, values in (
        ("bending_energy", state.bending_energy),
        ("tip_radius", state.tip_radius),
        ("tip_height", state.tip_height),
    ):
        assert found[key] == {"min": values.min, "max": values.max, "mean": values.mean}
    assert found["leading_rate"] == max(
        found["leading_rate_in_plane"], found["leading_rate_out_of_plane"]
    )
    assert found["time_error"] < 1e-6 * found["frequency"]


@pytest.mark.slow
def test_the_stated_error_of_few_links_is_about_the_true_one(ask: Ask) -> None:
    for kind in ("spinning", "flapping"):
        few = answer(ask("find", kind, "--set", "model.segments=16", "--json"))
        many = answer(ask("find", kind, "--set", "model.segments=64", "--json"))
        true = abs(few["frequency"] - many["frequency"])
        # It is taken from the leading term alone, and 64 links have a sixteenth of it left.
        assert few["error"] == pytest.approx(true, rel=0.3)


def test_a_confined_filament_flaps_without_a_rate_out_of_its_plane(ask: Ask) -> None:
    found = answer(ask("find", "flapping", *FEW, *CONFINED, "--json"))
    assert found["leading_rate_out_of_plane"] is None
    assert found["leading_rate"] == found["leading_rate_in_plane"]
    assert found["stable"] is True
    assert "None" not in ask("find", "flapping", *FEW, *CONFINED)[1]


def test_a_converged_state_has_the_keys_of_a_single_one_and_its_errors(ask: Ask) -> None:
    six = ["--set", "model.segments=6", "--converge", "--json"]
    spinning = answer(ask("find", "spinning", *six))
    assert spinning.keys() == STATE | {"trivial_rate", "errors"}
    links = spinning["links"]
    assert links[:3] == [6, 12, 24]
    assert spinning["error"] == spinning["errors"]["frequency"]
    states = [un.find(EIGHT.with_(segments=count), "spinning") for count in links]
    for key in ("frequency", "bending_energy", "tip_radius", "tip_height", "leading_rate"):
        limit, error = extrapolated([quantities_of(state)[key] for state in states])
        # Newton's method ends at round-off wherever it begins; rates have ten digits left.
        assert spinning[key] == pytest.approx(limit, rel=1e-8)
        assert spinning["errors"][key] == pytest.approx(error, rel=1e-2)


@pytest.mark.slow
def test_a_converged_beat_has_ranges_with_errors(ask: Ask) -> None:
    found = answer(ask("find", "flapping", *FEW, "--converge", "--json"))
    assert found["bending_energy"].keys() == RANGE
    for part in RANGE:
        assert found["errors"][f"bending_energy_{part}"] < 0.05
    assert found["leading_rate"] == found["leading_rate_out_of_plane"]


@pytest.mark.parametrize("kind", ["spinning", "flapping"])
def test_below_the_onset_there_is_no_state_and_the_reason_names_the_force(
    kind: str, ask: Ask
) -> None:
    words = ["find", kind, *FEW, "--set", "load.force=30"]
    found = answer(ask(*words, "--json"))
    assert found.keys() == {"status", "units", "reason", "residual"}
    assert found["status"] == "not found"
    assert f"begins at force {un.onset(EIGHT, method='discrete').force:.6g}" in str(found["reason"])
    status, said, told = ask(*words)
    assert (status, told) == (0, "")
    assert said == f"tip force 30: {kind} not found: {found['reason']}\n"


@pytest.mark.parametrize("kind", ["spinning", "flapping"])
def test_people_read_aligned_lines_with_units(kind: str, ask: Ask) -> None:
    status, said, told = ask("find", kind, *FEW)
    assert (status, told) == (0, "")
    head, *lines = said.splitlines()
    assert head == f"tip force 75: {kind}, {'stable' if kind == 'spinning' else 'unstable'}"
    assert len({line.index(line[2:].split("  ")[-1].strip()) for line in lines}) == 1
    assert "cycles per T" in lines[0]
    assert "±" in lines[0]
    for word in ("nan", "None", "np.", "{"):
        assert word not in said
    assert max(len(line) for line in said.splitlines()) < 100


# ---------------------------------------------------------------- follow


def test_a_branch_is_answered_with_its_points_and_bifurcations(ask: Ask) -> None:
    words = ["follow", "spinning", *FEW, "--along", "load.force=120:160", "--json"]
    found = answer(ask(*words))
    assert found.keys() == {"status", "units", "parameter", "points", "bifurcations", "figure"}
    assert (found["status"], found["parameter"], found["figure"]) == ("done", "load.force", None)
    points = found["points"]
    assert (points[0]["load.force"], points[-1]["load.force"]) == (120.0, 160.0)
    for point in points:
        assert point.keys() == {
            *("load.force", "frequency", "bending_energy", "tip_radius", "tip_height"),
            *("stable", "leading_rate"),
        }
        assert point["stable"] == (point["leading_rate"] < 0.0)
    (torus,) = found["bifurcations"]
    assert torus.keys() == BIFURCATION | {"stability"}
    assert (torus["kind"], torus["stability"]) == ("torus", "lost")
    assert torus["value"] == torus["load.force"]
    stable = [point["load.force"] for point in points if point["stable"]]
    unstable = [point["load.force"] for point in points if not point["stable"]]
    assert max(stable) < torus["value"] < min(unstable)
    # The points of the branch are the states that are found there.
    alone = answer(ask("find", "spinning", *FEW, "--set", "load.force=160", "--json"))
    for key in ("frequency", "bending_energy", "tip_radius", "leading_rate"):
        assert points[-1][key] == pytest.approx(alone[key], rel=1e-9)


@pytest.mark.slow
def test_a_branch_of_beats_holds_both_rates(ask: Ask) -> None:
    found = answer(ask("follow", "flapping", *FEW, "--along", "load.force=130:145", "--json"))
    for point in found["points"]:
        assert point["bending_energy"].keys() == RANGE
        assert {"leading_rate_in_plane", "leading_rate_out_of_plane"} < point.keys()
    (breaking,) = found["bifurcations"]
    assert (breaking["kind"], breaking["stability"]) == ("symmetry breaking", "gained")
    assert breaking["second_frequency"] is None


def test_a_branch_may_be_followed_down_and_along_the_drag_ratio(ask: Ask) -> None:
    down = answer(ask("follow", "spinning", *FEW, "--along", "load.force=60:50", "--json"))
    forces = [point["load.force"] for point in down["points"]]
    assert forces == sorted(forces, reverse=True)
    assert (forces[0], forces[-1]) == (60.0, 50.0)
    ratio = answer(ask("follow", "spinning", *FEW, "--along", "model.drag_ratio=2:1", "--json"))
    assert ratio["points"][-1]["model.drag_ratio"] == 1.0
    alone = answer(ask("find", "spinning", *FEW, "--set", "model.drag_ratio=1", "--json"))
    assert ratio["points"][-1]["frequency"] == pytest.approx(alone["frequency"], rel=1e-9)


def test_a_branch_from_the_onset_tells_how_it_is_born(ask: Ask) -> None:
    found = answer(ask("follow", "spinning", *FEW, "--along", "load.force=onset:45", "--json"))
    onset = un.onset(EIGHT, method="discrete")
    assert found["birth"] == "supercritical"
    # Located to round-off by both.
    assert found["onset"] == pytest.approx(onset.force, rel=1e-9)
    # The first point lies a little off the Hopf point.
    assert found["points"][0]["load.force"] == pytest.approx(onset.force, rel=0.01)
    assert found["points"][0]["frequency"] == pytest.approx(onset.frequency, rel=0.02)
    assert found["points"][-1]["load.force"] == 45.0


def test_the_straight_state_is_followed_through_its_onset(ask: Ask) -> None:
    found = answer(ask("follow", "straight", *FEW, "--along", "load.force=20:50", "--json"))
    onset = un.onset(EIGHT)
    (hopf,) = found["bifurcations"]
    assert hopf.keys() == BIFURCATION
    # Bisected to round-off of the rate.
    assert hopf["value"] == pytest.approx(onset.force, abs=1e-9)
    assert hopf["frequency"] == pytest.approx(onset.frequency, abs=1e-9)
    stable = [point["load.force"] for point in found["points"] if point["stable"]]
    assert max(stable) < hopf["value"]


def test_a_bifurcation_is_taken_to_many_links_on_request(
    ask: Ask, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("undula.analysis.states.extrapolation.REFINEMENTS", (1, 2, 4))
    words = [*FEW, "--along", "load.force=130:150", "--converge"]
    (torus,) = answer(ask("follow", "spinning", *words, "--json"))["bifurcations"]
    assert torus["links"] == [8, 16, 32]
    limit = un.threshold(EIGHT, "spinning-lost", converged=True)
    # Both find each bifurcation to 1e-9 of their way, and combine them alike.
    assert torus["value"] == pytest.approx(limit.value, abs=1e-4)
    assert torus["error"] == pytest.approx(limit.error, rel=1e-2)


def test_a_bifurcation_without_a_limit_says_so(ask: Ask, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("undula.analysis.solvers.refind._HALF_WIDTHS", (0.01,))
    words = ["follow", "spinning", *FEW, "--along", "load.force=140:145", "--converge"]
    (torus,) = answer(ask(*words, "--json"))["bifurcations"]
    assert "no such change" in torus["not_converged"]
    assert torus["value"] == pytest.approx(
        un.threshold(EIGHT, "spinning-lost").value or 0.0, abs=1e-6
    )
    assert "(not converged: no such change" in ask(*words)[1]


def test_where_there_is_no_state_to_begin_at_nothing_is_followed_or_drawn(ask: Ask) -> None:
    words = ["follow", "spinning", *FEW, "--along", "load.force=30:45", "--plot", "new.png"]
    found = answer(ask(*words, "--json"))
    assert (found["status"], found["figure"]) == ("not found", None)
    assert not list(Path().iterdir())
    assert ask(*words)[1].startswith("tip load: spinning not found: ")


# ---------------------------------------------------------------- threshold


@pytest.mark.parametrize("name", ["onset", "spinning-lost"])
def test_a_threshold_is_answered_with_what_python_computes(name: str, ask: Ask) -> None:
    found = answer(ask("threshold", name, *FEW, "--json"))
    single = un.threshold(EIGHT, name)
    assert found == {
        "status": "done",
        "units": EIGHT.units.names(),
        "threshold": name,
        "figure": None,
        "error_of": "body",
        "links": None if name == "onset" else 8,
        **{key: getattr(single, key) for key in THRESHOLD},
    }
    assert found["value"] is not None
    assert found["reason"] is None


def test_a_threshold_along_a_parameter_is_a_list(ask: Ask) -> None:
    words = ["threshold", "spinning-lost", *FEW, "--along", "model.drag_ratio=1.8,2", "--json"]
    found = answer(ask(*words))
    assert found.keys() == {"status", "units", "threshold", "parameter", "thresholds", "figure"}
    assert [one["model.drag_ratio"] for one in found["thresholds"]] == [1.8, 2.0]
    for one in found["thresholds"]:
        assert one.keys() == THRESHOLD | OF | {"model.drag_ratio"}
    single = un.threshold(EIGHT, "spinning-lost")
    assert found["thresholds"][1]["value"] == pytest.approx(single.value, abs=1e-6)


def test_no_threshold_is_an_answer_with_a_reason(ask: Ask, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("undula.analysis.solvers.threshold_search.FARTHEST", 1.2)
    found = answer(ask("threshold", "spinning-lost", *FEW, "--json"))
    for key in THRESHOLD - {"reason", "searched_to"}:
        assert found[key] is None, key
    assert found["reason"].startswith("spinning is stable from force ")
    assert found["reason"].endswith(f" up to force {found['searched_to']:.6g}")
    status, said, _ = ask("threshold", "spinning-lost", *FEW)
    assert status == 0
    assert said == (f"tip load: spinning-lost none: {found['reason']}; --up-to looks farther\n")
    # A curve of none is drawn too.
    words = ["--along", "model.drag_ratio=2,3", "--plot", "none.png"]
    drawn = answer(ask("threshold", "spinning-lost", *FEW, *words, "--json"))
    assert [one["value"] for one in drawn["thresholds"]] == [None, None]
    assert Path("none.png").read_bytes().startswith(b"\x89PNG")


# ---------------------------------------------------------------- figures


DRAWN = {
    "spinning": ["follow", "spinning", *FEW, "--along", "load.force=40:45"],
    "flapping": ["follow", "flapping", *FEW, "--along", "load.force=40:45"],
    "straight": ["follow", "straight", *FEW, "--along", "load.force=30:45"],
    "curve": ["threshold", "onset", *FEW, "--along", "model.drag_ratio=1:3:3"],
}


@pytest.mark.parametrize("question", mostly_slow(DRAWN, lambda name: name != "flapping"))
def test_every_curve_can_be_drawn_and_says_where(question: str, ask: Ask) -> None:
    status, said, _ = ask(*DRAWN[question], "--plot", "new/figure.png")
    assert status == 0
    assert said.splitlines()[-1].split() == ["figure", "new/figure.png"]
    assert Path("new/figure.png").read_bytes().startswith(b"\x89PNG")
    assert answer(ask(*DRAWN[question], "--plot", "figure.svg", "--json"))["figure"] == "figure.svg"
    assert "<svg" in Path("figure.svg").read_text()


@pytest.mark.parametrize("question", mostly_slow(DRAWN, lambda name: name == "curve"))
def test_a_figure_replaces_nothing_unless_told_to(
    question: str, ask: Ask, monkeypatch: pytest.MonkeyPatch
) -> None:
    Path("mine.pdf").write_text("mine")
    with monkeypatch.context() as patched:
        for compute in ("follow.follow_along", "threshold.answer_threshold_curve"):
            patched.setattr(
                f"undula.app.commands.{compute}", lambda *_: pytest.fail("it was computed")
            )
        assert "--overwrite" in refused(ask(*DRAWN[question], "--plot", "mine.pdf", "--json"))
    assert Path("mine.pdf").read_text() == "mine"
    assert ask(*DRAWN[question], "--plot", "mine.pdf", "--overwrite")[0] == 0
    assert Path("mine.pdf").read_bytes().startswith(b"%PDF")


def test_stored_runs_are_drawn_as_dots_beside_a_branch(ask: Ask) -> None:
    settled = ["--set", "time.until=settled", "--set", "start.amplitude=0.3", "--no-movie"]
    assert ask("run", *FEW, "--set", "load.force=44", *settled, "--out", "stored")[0] == 0
    words = [*DRAWN["spinning"], "--run", "stored/run.nc", "--plot", "figure.svg"]
    assert ask(*words)[0] == 0
    drawn = Path("figure.svg").read_text()
    assert drawn.split('id="runs"')[1].split("</g>")[0].count("<use") == 1


# ---------------------------------------------------------------- what is refused


#: What is asked, and a part of what is said to it.
BAD_WORDS = [
    ("find hopping", "'hopping' is no kind of state; take spinning or flapping"),
    ("find straight", "'straight' is no kind of state"),
    ("find", "Missing argument"),
    ("find spinning --set model.confined=true", "a confined model cannot spin"),
    ("find spinning --set model.segments=2", "model.segments"),
    ("find spinning --set start.seed=3", "it reads [model], [load]"),
    ("find spinning gone.toml", "there is no input file gone.toml"),
    ("find spinning --plot a.png", "No such option"),
    ("follow spinning", "Missing option"),
    ("follow hopping --along load.force=40:50", "'hopping' is no kind of state"),
    ("follow spinning --along load.force", "write it like load.force=38:300"),
    ("follow spinning --along load.force=40", "write it like load.force=38:300"),
    ("follow spinning --along load.force=40:50:3:4", "write it like load.force=38:300"),
    ("follow spinning --along load.force=40:40", "goes nowhere"),
    ("follow spinning --along load.force=40:nan", "nan is not a finite number"),
    ("follow spinning --along load.force=-1:40", "force = -1.0"),
    ("follow spinning --along model.drag_ratio=2:0.5", "drag_ratio = 0.5"),
    ("follow spinning --along load.slope=0:1", "nothing can be followed along load.slope"),
    ("follow spinning --along model.segments=8:16", "nothing can be followed along model.segments"),
    ("follow straight --along load.force=onset:50", "ends at its onset"),
    ("follow spinning --along model.drag_ratio=onset:3", "an onset is a value of load.force"),
    ("follow spinning --along load.force=onset:20", "give an end beyond it"),
    ("follow straight --along load.force=20:50 --converge", "leave --converge out"),
    ("follow straight --along model.drag_ratio=1:2 --plot a.png", "along load.force only"),
    ("follow spinning --along load.force=40:50 --plot a.gif", "does not end like a figure"),
    ("follow spinning --along load.force=40:50 --plot folder.png", "folder.png is a folder"),
    ("follow spinning --along load.force=40:50 --run file", "give --plot"),
    ("follow straight --along load.force=40:50 --run file --plot a.png", "spinning or flapping"),
    ("follow spinning --along load.force=40:50 --run file --plot a.png", "file"),
    ("follow spinning --along load.force=40:50 --run gone.nc --plot a.png", "gone.nc"),
    ("threshold spinning-won", "'spinning-won' is not known; take onset, spinning-lost"),
    ("threshold onset --plot a.png", "give --along as well"),
    ("threshold onset --along load.force=1:2:3", "take another parameter"),
    ("threshold onset --along load.slope=0:1:3", "load.slope is no number of this model"),
    ("threshold onset --along model.drag_ratio=0:2:3", "drag_ratio = 0.0"),
    ("threshold onset --along model.drag_ratio", "has no 'KEY=RANGE'"),
    ("threshold spinning-lost --set model.confined=true", "a confined model cannot spin"),
]


@pytest.mark.parametrize(("words", "cure"), BAD_WORDS)
def test_bad_input_gets_one_sentence_and_with_json_one_object(
    words: str, cure: str, ask: Ask
) -> None:
    Path("file").touch()
    Path("folder.png").mkdir()
    assert cure in refused(ask(*words.split(), "--json"))
    status, said, told = ask(*words.split())
    assert (status, said, len(told.splitlines())) == (2, "", 1)
    assert cure in told
    assert {path.name for path in Path().iterdir()} == {"file", "folder.png"}


def test_what_cannot_be_drawn_is_refused_before_anything_is_computed(
    ask: Ask, monkeypatch: pytest.MonkeyPatch
) -> None:
    for compute in ("follow.follow_along", "threshold.answer_threshold"):
        monkeypatch.setattr(
            f"undula.app.commands.{compute}", lambda *_: pytest.fail("it was computed")
        )
    along = ["--along", "load.force=40:50"]
    for words in (
        ["follow", "straight", "--along", "model.drag_ratio=1:2", "--plot", "a.png"],
        ["follow", "spinning", *along, "--plot", "a.png", "--run", "gone.nc"],
        ["follow", "spinning", *along, "--run", "gone.nc"],
        ["threshold", "onset", "--plot", "a.png"],
    ):
        refused(ask(*words, "--json"))


# ---------------------------------------------------------------- progress


@pytest.mark.parametrize(
    ("words", "task"),
    [
        (["follow", "spinning", *FEW, "--along", "load.force=40:45"], "following spinning: at "),
        (["threshold", "spinning-lost", *FEW], "spinning-lost: 8 links, force "),
        (
            ["threshold", "onset", *FEW, "--along", "model.drag_ratio=1,2"],
            "onset along model.drag_ratio: 1 of 2",
        ),
    ],
)
def test_progress_is_told_apart_from_the_answer(
    words: list[str], task: str, ask: Ask, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("undula.terminal.meter.SECONDS_BETWEEN_LINES", 0.0)
    asked = ask(*words, "--json")
    answer(asked)
    told = asked[2].splitlines()
    assert told[0].startswith(task)
    assert all(line.startswith(task.split(":")[0]) for line in told)
