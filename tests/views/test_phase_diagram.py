"""Diagrams of a sweep, drawn from one whose verdicts are known in closed form."""

import base64
import json
import re
import shutil
import subprocess
from collections.abc import Callable
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PathCollection
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from commands import Ask, answer, refused, text
from refusal import complaint
from sweeps import coded, made_up, path_of, shape_of
from undula.analysis.maps.stability_boundaries import StabilityBoundaries
from undula.analysis.maps.stability_intervals import Change, StabilityIntervals
from undula.sweeps.boundary_cache import NAME, write_boundaries
from undula.sweeps.store import load_sweep, open_sweep
from undula.sweeps.sweep import read_sweep
from undula.views import gallery, mean_paths, phase_diagram, phase_page
from undula.views.sweep.axes import scale_of
from undula.views.sweep.page_traces import plain

FORCES = tuple(np.geomspace(20.0, 640.0, 6).tolist())  # 20, 40, ..., 640
EXPONENTS = (0.0, 1.0, 2.0, 3.0)
AXES = {"load.exponent": EXPONENTS, "load.force": FORCES}


def rule(exponent: float, force: float, number: int = 0) -> str:
    if force > 600.0 and exponent > 0.0:
        return {1.0: "failed", 2.0: "", 3.0: "chaotic"}[exponent]
    if force < 30.0:
        return "straight"
    if force > 300.0 and number:
        return "planar flapping"
    return "spinning"


STORE = made_up(AXES, rule, tries=2, shapes=True)
LINE = made_up({"load.force": FORCES}, lambda force, k: rule(0.0, force, k), tries=2, shapes=True)
NOWHERE = np.full(4, np.nan)
BORDERS = [
    ("onset", np.array(EXPONENTS), np.array([30.0, 31.0, 32.0, 33.0])),
    ("spinning-lost", np.array(EXPONENTS), np.array([np.nan, np.nan, 350.0, 340.0])),
    ("flapping-lost", np.array(EXPONENTS), NOWHERE),
]
AT_ONE_FORCE = [("onset", np.array([np.nan]), np.array([30.0]))]
NOTE = ({"load.exponent": 1.0, "load.force": FORCES[2], "try": 0.0}, "spinning at 80: it is not")


def dots(figure: Figure, verdict: str) -> list[PathCollection]:
    drawn = [one for one in figure.axes[0].collections if one.get_gid() == verdict]
    return [one for one in drawn if isinstance(one, PathCollection) and len(one.get_offsets())]


def places(figure: Figure, verdict: str) -> set[tuple[float, float]]:
    """Return the places of the dots of a verdict, shifted ones at their points."""
    return {tuple(place) for one in dots(figure, verdict) for place in one.get_offsets().tolist()}


def lines(figure: Figure) -> dict[str, Any]:
    return {str(line.get_gid()): line for axes in figure.axes for line in axes.lines}


def words(figure: Figure) -> list[str]:
    return [text.get_text() for legend in figure.legends for text in legend.get_texts()]


def boxes(figure: Figure) -> list[Any]:
    """Return the frames of all that must not cover one another: axes, legends and texts."""
    renderer = FigureCanvasAgg(figure).get_renderer()
    figure.draw(renderer)
    parts = [*figure.axes, *figure.legends, *(text for text in figure.texts if text.get_text())]
    return [part.get_tightbbox(renderer) for part in parts]


# ---------------------------------------------------------------- two axes


def test_each_verdict_stands_at_its_points() -> None:
    figure = phase_diagram(STORE)
    assert places(figure, "straight") == {(p, FORCES[0]) for p in EXPONENTS}
    assert places(figure, "planar flapping") == {(p, FORCES[4]) for p in EXPONENTS} | {
        (0.0, FORCES[5])
    }
    assert places(figure, "chaotic") == {(3.0, FORCES[5])}
    assert set(words(figure)) == {
        *("straight", "spinning", "planar flapping", "chaotic", "failed", "not done")
    }


def test_dots_are_coloured_by_the_logarithm_of_frequencies_of_many_sizes() -> None:
    (spinning, *_) = dots(phase_diagram(STORE), "spinning")
    assert isinstance(spinning.norm, LogNorm)
    # The sweep's own law, with half an octave of force between neighbours.
    forces = spinning.get_offsets()[:, 1]
    assert np.asarray(spinning.get_array()) == pytest.approx(0.3 * forces ** (4 / 3))
    narrow = STORE.sel({"load.force": list(FORCES[2:4])})
    (spinning, *_) = dots(phase_diagram(narrow), "spinning")
    assert not isinstance(spinning.norm, LogNorm)


def test_failed_and_missing_points_are_small_crosses() -> None:
    drawn = lines(phase_diagram(STORE))
    for name, marker, place in (("failed", "x", 1.0), ("not done", "+", 2.0)):
        assert drawn[name].get_marker() == marker
        assert drawn[name].get_xydata().tolist() == [[place, FORCES[5]]]


def test_tries_that_end_differently_stand_side_by_side() -> None:
    figure = phase_diagram(STORE)
    shown = {}
    for verdict in ("spinning", "planar flapping"):
        for one in dots(figure, verdict):
            for place in one.get_offsets():
                if tuple(place) == (1.0, FORCES[4]):
                    shown[verdict] = one.get_offset_transform().transform(place)
    middle = figure.axes[0].transData.transform((1.0, FORCES[4]))
    left, right = shown["spinning"], shown["planar flapping"]
    assert left[0] < middle[0] < right[0]
    assert left[0] + right[0] == pytest.approx(2.0 * middle[0])
    assert left[1] == right[1] == pytest.approx(middle[1])


def test_borders_are_lines_with_names_that_break_at_gaps() -> None:
    figure = phase_diagram(STORE, BORDERS)
    drawn = lines(figure)
    assert np.array_equal(drawn["spinning-lost"].get_ydata(), BORDERS[1][2], equal_nan=True)
    # Nothing is drawn or named for a border that is nowhere.
    assert "flapping-lost" not in drawn
    assert {"onset", "spinning-lost"} <= set(words(figure))
    assert "flapping-lost" not in words(figure)
    assert drawn["onset"].get_linestyle() != drawn["spinning-lost"].get_linestyle()


def test_a_border_at_one_force_goes_all_the_way_across() -> None:
    drawn = lines(phase_diagram(STORE, AT_ONE_FORCE))
    assert list(drawn["onset"].get_xdata()) == [0, 1]
    assert list(drawn["onset"].get_ydata()) == [30.0, 30.0]


def test_points_that_contradict_the_solved_states_are_ringed() -> None:
    figure = phase_diagram(STORE, contradicting=[NOTE])
    assert lines(figure)["contradicting"].get_xydata().tolist() == [[1.0, FORCES[2]]]
    assert "contradicts the solved states" in words(figure)
    assert "contradicts the solved states" not in words(phase_diagram(STORE))


def test_the_force_goes_upwards_whatever_the_order_of_the_axes() -> None:
    turned = made_up(
        {"load.force": FORCES, "load.exponent": EXPONENTS}, lambda f, p, k: rule(p, f, k), tries=2
    )
    one, other = phase_diagram(STORE), phase_diagram(turned)
    assert places(one, "spinning") == places(other, "spinning")
    assert "force" in other.axes[0].get_ylabel()


def test_codes_with_meanings_are_drawn_as_the_words_themselves() -> None:
    one, other = phase_diagram(STORE), phase_diagram(coded(STORE))
    for verdict in ("straight", "spinning", "planar flapping", "chaotic"):
        assert places(one, verdict) == places(other, verdict) != set()


def test_units_are_those_of_the_store() -> None:
    units = {"force": "K/L", "energy": "K", "time": "zeta L^2/K"}
    store = STORE.assign_attrs(units=json.dumps(units))
    assert phase_diagram(store).axes[0].get_ylabel() == r"force $F$  $[K/L]$"
    assert "[K]" in phase_diagram(LINE.assign_attrs(units=json.dumps(units))).axes[0].get_ylabel()


@pytest.mark.parametrize(
    ("values", "scale"),
    [
        ((10.0, 20.0, 30.0, 500.0, 1000.0), "log"),
        ((1.0, 3.0, 10.0, 30.0), "log"),
        (tuple(range(1, 101)), "linear"),
        ((0.0, 1.0, 100.0), "linear"),
        ((10.0, 200.0), "linear"),
    ],
)
def test_an_axis_has_the_scale_on_which_its_values_are_more_even(
    values: tuple[float, ...], scale: str
) -> None:
    assert scale_of(np.array(values, dtype=float)) == scale


def test_values_of_a_third_axis_have_to_be_chosen() -> None:
    axes = AXES | {"model.drag_ratio": (1.0, 2.0)}
    store = made_up(axes, lambda p, f, _, k: rule(p, f, k))
    sentence = complaint(lambda: phase_diagram(store))
    assert "load.exponent, load.force, model.drag_ratio" in sentence
    figure = phase_diagram(store.sel({"model.drag_ratio": [2.0]}))
    assert figure.texts[0].get_text() == r"tip load, drag ratio $\gamma$ = 2"
    assert phase_diagram(store.sel({"model.drag_ratio": 2.0})).axes


@pytest.mark.parametrize("draw", [phase_diagram, gallery, phase_page])
def test_what_is_no_sweep_is_refused(draw: Callable[[xr.Dataset], Any]) -> None:
    run = xr.Dataset({"shapes": ("shape", [0.0])})
    assert "lacks status, verdict" in complaint(lambda: draw(run))


def everything() -> list[Figure]:
    names = [*("spinning", "modulated spinning", "planar flapping", "non-planar flapping")]
    names += ["precessing flapping", "windmilling", "chaotic", "undecided", "failed", ""]
    names += ["asymmetric spinning", "asymmetric flapping", "straight"]
    order = {f: k for k, f in enumerate(FORCES)}

    def many(p: float, f: float, k: int) -> str:
        return names[int(3 * p + order[f] + k) % len(names)]

    full = made_up(AXES, many, tries=2, shapes=True)
    return [
        phase_diagram(full, [*BORDERS, *AT_ONE_FORCE], contradicting=[NOTE]),
        phase_diagram(LINE, AT_ONE_FORCE, contradicting=[NOTE]),
        gallery(full),
        gallery(LINE),
        mean_paths(full, BORDERS),
    ]


@pytest.mark.parametrize("which", range(5))
def test_nothing_covers_anything_else_or_leaves_the_page(which: int) -> None:
    figure = everything()[which]
    assert tuple(figure.get_size_inches()) == (10.0, 7.0)
    width, height = figure.bbox.size
    found = boxes(figure)
    for box in found:
        assert min(box.x0, box.y0) >= -0.5
        assert box.x1 <= width + 0.5
        assert box.y1 <= height + 0.5
    for one, other in combinations(found, 2):
        across = min(one.x1, other.x1) - max(one.x0, other.x0)
        up = min(one.y1, other.y1) - max(one.y0, other.y0)
        # A pixel where frames touch.
        assert min(across, up) <= 1.0, (one, other)


# ---------------------------------------------------------------- one axis


def test_over_one_axis_frequency_and_energy_are_drawn_against_it() -> None:
    figure = phase_diagram(LINE, AT_ONE_FORCE, contradicting=[NOTE])
    lower, upper = figure.axes
    spinning = {line.get_gid(): line for line in upper.lines}["spinning"]
    forces = spinning.get_xdata()
    assert sorted(set(forces.tolist())) == pytest.approx(list(FORCES[1:]))
    assert spinning.get_ydata() == pytest.approx(0.3 * forces ** (4 / 3))
    bars = {
        tuple(np.round(segment[:, 1], 9))
        for drawn in lower.collections
        for segment in drawn.get_segments()
    }
    energy = 0.02 * 0.3 * FORCES[5] ** (4 / 3)
    assert (round(0.5 * energy, 9), round(1.5 * energy, 9)) in bars
    assert [line.get_xdata()[0] for line in lower.lines if line.get_gid() == "onset"] == [30.0]
    assert any(text.get_text() == "onset\n30" for text in figure.texts)


def test_borders_are_drawn_over_the_force_only() -> None:
    store = made_up({"load.exponent": EXPONENTS}, lambda *_: "spinning")
    assert "load.exponent" in complaint(lambda: phase_diagram(store, BORDERS))


# ---------------------------------------------------------------- shapes


def test_the_gallery_has_a_cell_for_each_point_with_its_verdict() -> None:
    figure = gallery(STORE)
    cells = [axes for axes in figure.axes if axes.get_gid() == "cell"]
    told = [text.get_text() for text in figure.texts if text.get_gid() == "cell words"]
    # Of six forces every other one is drawn; failed points and those not done have none.
    assert len(cells) == 12
    assert told.count("spinning") == 8
    assert told.count("straight") == 4


def test_the_gallery_of_one_axis_tells_its_values() -> None:
    told = [text.get_text() for text in gallery(LINE).texts if text.get_gid() == "cell words"]
    assert {"20", "40", "80", "160", "320", "640"} <= set(told)


def test_mean_paths_are_circles_and_lines_of_one_scale() -> None:
    figure = mean_paths(STORE)
    drawn = [one for one in figure.axes[0].collections if one.get_gid() == "mean path"]
    # Sixteen below 600, and two beyond.
    assert len(drawn) == 18
    # A circle: all corners are as far from the axis.
    mean = shape_of("spinning")[:, :, :2]
    weights = np.full(mean.shape[1], 1.0)
    weights[[0, -1]] = 0.5
    radius = np.hypot(*(np.einsum("kna,n->ka", mean, weights) / weights.sum()).T)[0]
    corners = np.array([segment[0] for segment in drawn[0].get_segments()])
    assert np.hypot(*corners.T) == pytest.approx(radius)
    # Later is darker.
    shades = np.array(drawn[0].get_colors())[:, 0]
    assert np.all(np.diff(shades) < 0.0)


def test_a_sweep_without_shapes_says_how_to_keep_them() -> None:
    bare = STORE.drop_vars("shapes")
    for draw in (gallery, mean_paths):
        assert "study.keep = 'period'" in complaint(lambda draw=draw: draw(bare))
    assert "two axes" in complaint(lambda: mean_paths(LINE))


# ---------------------------------------------------------------- the page


def content_of(page: str) -> Any:
    (found,) = re.findall(r'<script type="application/json" id="content">(.*?)</script>', page)
    return json.loads(found)


def test_a_page_needs_nothing_from_elsewhere() -> None:
    page = phase_page(STORE, BORDERS)
    # Names of XML are written like addresses; they are not fetched.
    addresses = set(re.findall(r"https?://[^\s\"'/]+", page))
    assert addresses <= {"http://www.w3.org"}
    assert not re.search(r"<(script|link|img|iframe)[^>]*\b(src|href)=", page)
    assert "default-src 'none'" in page
    assert page.count("<script") == page.count("</script>") == 3


def test_a_page_has_the_dots_of_the_figure_and_all_figures_of_each() -> None:
    content = content_of(phase_page(STORE, BORDERS, contradicting=[NOTE]))
    traces = {trace["name"]: trace for trace in content["traces"] if trace.get("customdata")}
    assert set(zip(traces["straight"]["x"], traces["straight"]["y"], strict=True)) == places(
        phase_diagram(STORE), "straight"
    )
    assert [len(traces[name]["x"]) for name in ("failed", "not done", "chaotic")] == [1, 1, 1]
    shown = [number for trace in traces.values() for number in trace["customdata"]]
    assert sorted(shown) == list(range(len(content["points"])))
    told = [dict(point["figures"]) for point in content["points"]]
    (noted,) = [point for point in told if "contradicts" in point]
    assert noted["contradicts"] == NOTE[1]
    assert (noted["load.exponent"], noted["verdict"]) == ("1", "spinning")
    assert float(noted["frequency"]) == pytest.approx(0.3 * FORCES[2] ** (4 / 3), rel=1e-5)
    assert [trace["name"] for trace in content["traces"]][:2] == ["onset", "spinning-lost"]


def test_shapes_on_a_page_are_those_of_the_store() -> None:
    content = content_of(phase_page(STORE))
    point = next(p for p in content["points"] if dict(p["figures"])["verdict"] == "spinning")
    packed = np.frombuffer(base64.b64decode(point["shapes"]), dtype="<i2")
    shapes = packed.reshape(-1, content["nodes"], 3) / content["per_length"]
    # Rounded to whole numbers of 1e-4 L.
    assert shapes == pytest.approx(shape_of("spinning"), abs=0.51e-4)
    bare = content_of(phase_page(STORE.drop_vars("shapes")))
    assert not any("shapes" in point for point in bare["points"])


def test_a_page_of_one_axis_shows_frequencies() -> None:
    content = content_of(phase_page(LINE, AT_ONE_FORCE))
    traces = {trace["name"]: trace for trace in content["traces"] if "customdata" in trace}
    forces = np.array(traces["spinning"]["x"])
    assert traces["spinning"]["y"] == pytest.approx(0.3 * forces ** (4 / 3))
    (onset,) = [trace for trace in content["traces"] if trace["name"] == "onset"]
    assert onset["x"] == [30.0, 30.0]


def test_a_title_cannot_break_out_of_the_page() -> None:
    page = phase_page(STORE, title="</title><script>alert(1)</script>")
    assert "alert(1)</script>" not in page


def test_labels_are_written_without_formulas() -> None:
    assert plain(r"force $F$  $[B/L^2]$") == "force F  [B/L²]"
    assert plain(r"position $s_a$  $[L]$") == "position sₐ  [L]"
    assert plain(r"slope $\alpha$") == "slope α"
    assert plain("model.bead_drag") == "model.bead_drag"


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("chromium") is None, reason="needs a browser")
def test_pointing_at_a_dot_draws_its_shapes_in_a_browser(tmp_path: Path) -> None:
    force, here = FORCES[2], "const d = document.getElementById('diagram'), l = d._fullLayout"
    script = f"""<script>setTimeout(() => {{ {here}, r = d.getBoundingClientRect();
      const at = {{ clientX: r.left + l._size.l + l.xaxis.d2p(2), bubbles: true, view: window,
        clientY: r.top + l._size.t + l.yaxis.d2p({force}) }};
      for (const name of ["mouseover", "mousemove", "mousemove"])
        document.querySelector(".nsewdrag").dispatchEvent(new MouseEvent(name, at));
    }}, 800);</script></body>"""
    page = tmp_path / "page.html"
    page.write_text(phase_page(STORE, BORDERS).replace("</body>", script), encoding="utf-8")
    browser = ["chromium", "--headless", "--no-sandbox", "--disable-gpu"]
    browser += ["--virtual-time-budget=8000", "--dump-dom", page.as_uri()]
    seen = subprocess.run(browser, capture_output=True, text=True, check=True, timeout=120).stdout
    table = re.search(r'<table id="figures">(.*?)</table>', seen, re.DOTALL)
    assert table is not None
    assert "<td>load.exponent</td><td>2</td>" in table[1]
    assert "<td>verdict</td><td>spinning</td>" in table[1]
    side = re.search(r'<svg id="side".*?</svg>', seen, re.DOTALL)
    assert side is not None
    assert side[0].count("<polyline") == shape_of("spinning").shape[0]


# ---------------------------------------------------------------- the command


STUDY = """
[model]
segments = 8
[load]
profile = "power"
[study]
keep = "period"
policy = "random"
tries = 2
[[study.axes]]
key = "load.exponent"
values = [0.0, 1.0]
[[study.axes]]
key = "load.force"
values = [20.0, 40.0, 80.0, 160.0]
"""


@pytest.fixture
def sweep(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a stored study in which all runs spin but those below 30, which are straight."""
    monkeypatch.chdir(tmp_path)
    Path("study.toml").write_text(STUDY, encoding="utf-8")
    wanted = read_sweep(Path("study.toml"))
    store = open_sweep(Path("study"), wanted)
    for chunk in range(len(store.grid)):
        numbers = list(store.grid.numbers(chunk))
        arrays = store.read(chunk)
        records = [_record(wanted.tables(number)) for number in numbers]
        store.put(arrays, range(len(numbers)), records)
        store.write(chunk, arrays)
    return Path("study")


def _record(tables: Any) -> dict[str, Any]:
    force = tables["load"]["force"]
    word = "straight" if force < 30.0 else "spinning"
    shape = shape_of(word)
    shapes, path = np.repeat(shape, 2, axis=0), np.repeat(path_of(word), 30, axis=0)
    kept = {"shapes": shapes, "path": path}
    return {"status": 1, "verdict": word, "frequency": force, "energy_min": 1.0, **kept}


def known_borders(up_to: float = 160.0) -> StabilityBoundaries:
    """Return borders by which spinning ends at 100."""
    column = {
        "straight": StabilityIntervals(
            "straight", 0.0, ((0.0, 30.0),), np.inf, lost=Change(30.0, 0.1, 5.0)
        ),
        "spinning": StabilityIntervals(
            "spinning", 30.0, ((30.0, 100.0),), up_to, lost=Change(100.0, 0.1, 90.0)
        ),
        "flapping": StabilityIntervals("flapping", 30.0, (), up_to),
    }
    return StabilityBoundaries("load.exponent", (0.0, 1.0), up_to, (column, column))


def test_a_folder_is_drawn_as_a_study(sweep: Path, ask: Ask) -> None:
    found = answer(ask("plot", sweep, "--json"))
    assert (found["points"], found["done"], found["failed"]) == (16, 16, 0)
    assert found["verdicts"] == {"spinning": 12, "straight": 4}
    assert found["figure"] == "study.png"
    assert Path("study.png").read_bytes()[:4] == b"\x89PNG"
    shares = found["basins"][1]
    assert (shares["load.exponent"], shares["load.force"], shares["tries"]) == (0.0, 40.0, 2)
    # Both of two: Wilson's interval ends at 1 / (1 + z^2 / n).
    assert shares["verdicts"]["spinning"]["low"] == pytest.approx(1 / (1 + 1.959964**2 / 2))
    assert not (sweep / NAME).exists()


@pytest.mark.parametrize(("value", "taken"), [("33", 40.0), ("0", 20.0), ("1e9", 160.0)])
def test_the_nearest_stored_value_is_drawn_and_said(
    value: str, taken: float, sweep: Path, ask: Ask
) -> None:
    asked = ask("plot", sweep, "--at", f"load.force={value}", "--json", "--overwrite")
    found = answer(asked)
    assert (found["at"], found["points"]) == ({"load.force": taken}, 4)
    number = f"{float(value):g}"
    assert asked.told == (
        f"undula: {sweep} has no load.force = {number}; {taken:g}, the nearest value, is drawn\n"
    )


def test_a_stored_value_written_with_fewer_digits_is_drawn_without_a_word(
    sweep: Path, ask: Ask
) -> None:
    asked = ask("plot", sweep, "--at", "load.force=40.00001", "--json", "--overwrite")
    assert (answer(asked)["at"], asked.told) == ({"load.force": 40.0}, "")


@pytest.mark.parametrize("view", ["gallery", "paths", "basins"])
def test_each_view_has_a_file_of_its_own(view: str, sweep: Path, ask: Ask) -> None:
    assert answer(ask("plot", sweep, "--view", view, "--json"))["figure"] == f"study-{view}.png"
    assert Path(f"study-{view}.png").exists()


def test_a_page_is_written_where_its_name_says_so(sweep: Path, ask: Ask) -> None:
    asked = ask("plot", sweep, "--out", "study.html")
    content = content_of(Path("study.html").read_text(encoding="utf-8"))
    assert len(content["points"]) == 8
    assert all("shapes" in point for point in content["points"])
    assert text(asked).startswith("study.html\n")
    # It is not replaced unasked.
    assert ask("plot", sweep, "--out", "study.html").status == 2


def test_kept_borders_are_used_and_contradicting_runs_told(sweep: Path, ask: Ask) -> None:
    write_boundaries(sweep, load_sweep(sweep), known_borders())
    found = answer(ask("plot", sweep, "--borders", "--json"))
    assert [one["force"] for one in found["borders"]["spinning-lost"]] == [100.0, 100.0]
    assert found["borders"]["flapping-gained"][0]["force"] is None
    # Spinning at 160, for two exponents and two tries.
    assert len(found["disagreements"]) == 4
    assert {one["load.force"] for one in found["disagreements"]} == {160.0}
    said = text(ask("plot", sweep, "--borders"))
    assert "points that contradict the solved states: 4, 0 of them next to a border" in said
    assert "spinning is stable from force 30 to 100 only" in said


@pytest.mark.slow
def test_borders_are_solved_for_once(sweep: Path, ask: Ask) -> None:
    # Below the onset no branch has to be followed, which is quick.
    part = ["plot", sweep, "--borders", "--json", "--at", "load.force=20", "--overwrite"]
    first = answer(ask(*part))
    assert (sweep / NAME).exists()
    kept = (sweep / NAME).stat().st_mtime_ns
    assert answer(ask(*part)) == first
    assert (sweep / NAME).stat().st_mtime_ns == kept
    onsets = [one["force"] for one in first["borders"]["onset"]]
    assert onsets[0] > onsets[1] > 30.0
    assert first["disagreements"] == []


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--view", "pie"], "--view pie is not known"),
        (["--out", "study.gif"], "does not end like a figure"),
        (["--out", "study.html", "--view", "gallery"], "is a page"),
        (["--at", "load.slope=0"], "load.slope is no axis"),
        (["--at", "load.force=20,40"], "has 2 values"),
    ],
)
def test_a_mistake_is_told_in_one_sentence(
    options: list[str], said: str, sweep: Path, ask: Ask
) -> None:
    assert said in refused(ask("plot", sweep, *options))


def test_options_of_studies_are_refused_for_runs(tmp_path: Path, ask: Ask) -> None:
    run = tmp_path / "run.nc"
    run.write_bytes(b"")
    assert "--borders is about studies" in refused(ask("plot", run, "--borders"))
