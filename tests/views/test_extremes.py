"""Figures of runs that are short, long, sparse or steady: all panels show what was computed."""

import ast
import json
import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure

import undula as un
from undula.analysis.regimes import classify as regimes
from undula.analysis.regimes import names as naming
from undula.inputs.build import build_model
from undula.inputs.input import parse_input
from undula.inputs.model_tables import ModelTable
from undula.models.description import describe_model
from undula.views import portrait
from undula.views.common import style
from undula.views.common.verdict_styles import LOOKS, look_of
from undula.views.ramp.figure import ramp_diagram
from undula.views.run.traces import limits

NODES = 9
ARC = np.linspace(0.0, 1.0, NODES)
VERDICTS = [verdict for verdict in LOOKS if verdict != "straight"]


def run(times: np.ndarray, *, rate: float, energy: np.ndarray, **summary) -> xr.Dataset:
    """A stored run of a curve that turns about z, so many turns in a unit of time."""
    phase = 2 * np.pi * rate * times[:, None] + 3.0 * ARC
    radius = 0.5 * ARC**2
    sides = radius * np.cos(phase), radius * np.sin(phase), 0 * phase + 0.7 * ARC
    known = {"verdict": "spinning", "frequency": rate, "load": "tip force 75"} | summary
    return xr.Dataset(
        {
            "nodes": (("time", "node", "axis"), np.stack(sides, axis=-1)),
            "bending_energy": ("time", energy),
            "active_power": ("time", 3 * energy),
            "dissipation": ("time", 3 * energy),
            "rotation_angle": ("time", np.zeros(len(times))),
        },
        coords={"time": times, "arclength": ("node", ARC), "axis": ["x", "y", "z"]},
        attrs={"summary": json.dumps(known)},
    )


def traces(figure: Figure) -> list:
    return [axes for axes in figure.axes if axes.name == "rectilinear" and axes.lines]


def shows(axes) -> bool:
    """Tell whether something inside of the limits is drawn, and is more than an empty line."""
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    for line in axes.lines:
        x, y = map(np.asarray, line.get_data())
        inside = np.sum((x >= left) & (x <= right) & (y >= low) & (y <= high))
        marked = line.get_marker() not in ("None", "none", "", None)
        joined = line.get_linestyle() not in ("None", "none", "")
        if (marked and inside) or (joined and inside > 1 and np.ptp(x) > 0):
            return True
    return False


@pytest.mark.parametrize("samples", [2, 3, 20, 59, 61, 301, 396, 1300, 5000])
@pytest.mark.parametrize("cycles_a_sample", [0.01, 0.3, 6.77])
def test_no_panel_is_blank(samples: int, cycles_a_sample: float) -> None:
    times = np.linspace(0.0, 5.0, samples)
    rate = cycles_a_sample * (samples - 1) / 5.0
    energy = 7.0 + 2.0 * np.sin(2 * np.pi * 2.3 * rate * times)
    figure = portrait(run(times, rate=rate, energy=energy))
    panels = traces(figure)
    assert len(panels) >= 3
    assert all(shows(axes) for axes in panels)


STEADY = {
    "at once": np.full(2000, 3.64052240706),
    "after a short rise": 3.64052240706 * (1 - np.exp(-np.arange(2000) / 2.0)),
    "after a spike": 3.64052240706 * (1 + 1e4 * np.exp(-np.arange(2000) / 2.0)),
    "at nothing": np.exp(-np.arange(2000) / 5.0),
    "at nought": np.zeros(2000),
    "at much": np.full(2000, 7.123456e11),
}


@pytest.mark.parametrize("energy", STEADY.values(), ids=STEADY)
def test_what_is_steady_is_not_drawn_to_round_off(energy: np.ndarray) -> None:
    noise = 1e-13 * np.sin(np.arange(energy.size) ** 2)
    figure = portrait(run(np.linspace(0.0, 10.0, 2000), rate=86.0, energy=energy * (1 + noise)))
    figure.draw_without_rendering()
    for axes in traces(figure):
        words = [
            re.sub(r"[$]|.mathdefault|[{}]", "", one.get_text()) for one in axes.get_yticklabels()
        ]
        assert max(map(len, words), default=0) <= 8, words
        # The view in space, with the numbers on its axes, ends at 0.45 of the width.
        assert axes.get_tightbbox().x0 > 0.45 * figure.bbox.width
        assert shows(axes)


def test_the_way_to_a_steady_value_is_on_the_axis_but_a_spike_does_not_decide_it() -> None:
    low, high = limits([STEADY["after a short rise"]])
    assert low < 0.0 < 3.7 < high
    low, high = limits([STEADY["after a spike"]])
    assert 0.0 < low < 3.7 < high < 10.0
    assert limits([np.zeros(5)])[0] < 0.0 < limits([np.zeros(5)])[1]


def test_a_beginning_that_takes_little_more_room_is_shown_whole() -> None:
    tip = np.where(np.arange(4000) < 4, 1.0, 0.65)
    low, high = limits([tip, 0.45 * np.sin(np.arange(4000.0))])
    assert low < -0.45
    assert high > 1.0


def test_a_motion_that_lasts_decides_its_axis_however_small_it_is() -> None:
    energy = 5.0 + 0.05 * np.sin(np.arange(4000.0))
    low, high = limits([energy])
    assert 4.93 < low < 4.95 < 5.05 < high < 5.07


# ------------------------------------------------------------------- colours and legends


def test_every_verdict_has_its_own_look_and_the_same_colour_in_every_figure() -> None:
    given = {
        call.args[0].value
        for room in (naming, regimes)
        for call in ast.walk(ast.parse(Path(room.__file__).read_text("utf-8")))
        if isinstance(call, ast.Call)
        and getattr(call.func, "id", "") in ("Name", "Verdict")
        and isinstance(call.args[0], ast.Constant)
    }
    assert "modulated spinning" in given
    assert given <= LOOKS.keys()
    assert len({look.marker + look.colour for look in LOOKS.values()}) == len(LOOKS)
    figure = ramp_diagram([series(VERDICTS)])
    for verdict in VERDICTS:
        lines = [line for axes in figure.axes for line in axes.lines]
        colours = {line.get_mfc() for line in lines if line.get_gid() == f"{verdict}, up"}
        assert colours == {look_of(verdict).colour}


def series(verdicts: list[str]) -> xr.Dataset:
    """A stored series of steps up and down again, with these verdicts on both ways."""
    values = np.linspace(5.0, 60.0, len(verdicts))
    both = [*verdicts, *reversed(verdicts)]
    shapes = np.zeros((len(both), 3, NODES, 3)) + ARC[:, None] * [0.3, 0.1, 0.8]
    return xr.Dataset(
        {
            "value": ("step", np.concatenate([values, values[::-1]])),
            "direction": ("step", ["up"] * len(verdicts) + ["down"] * len(verdicts)),
            "verdict": ("step", both),
            "bending_energy_min": ("step", np.arange(len(both)) * 1.0),
            "bending_energy_max": ("step", np.arange(len(both)) * 2.0),
            "shapes": (("step", "shape", "node", "axis"), shapes),
        },
        attrs={"parameter": "load.force", "load": "chain of 3 links, tip load"},
    )


@pytest.mark.parametrize("count", [1, 2, 5])
def test_the_legend_of_steps_stays_on_the_page_and_covers_nothing(count: int) -> None:
    thresholds = [{"onset": 7.0, "spinning-lost": 30.0}] * count
    figure = ramp_diagram([series(["straight", *VERDICTS])] * count, thresholds=thresholds)
    figure.draw_without_rendering()
    (legend,) = figure.legends
    named = {text.get_text() for text in legend.get_texts()}
    assert named >= {"straight", *VERDICTS, "up", "down", "solved threshold"}
    box = legend.get_window_extent()
    assert box.x0 > 0
    assert box.x1 < figure.bbox.x1
    cells = [axes for axes in figure.axes if axes.get_gid() == "cell"]
    assert min(axes.get_tightbbox().y0 for axes in cells) > 0
    words = [text for text in figure.texts if text.get_text() and text.get_gid() != "cell words"]
    for text in words:
        # A pixel is no overlap.
        assert not text.get_window_extent().padded(-1.0).overlaps(box.padded(-1.0)), text


# ------------------------------------------------------------------------------ titles


@pytest.mark.parametrize("length", [10, 100, 160, 2000])
@pytest.mark.parametrize("paper_time", [False, True])
def test_a_title_stays_on_the_page(length: int, paper_time: bool) -> None:
    with style.figure_style():
        figure = style.headed_figure("m" * length, paper_time=paper_time)
    boxes = [text.get_window_extent() for text in figure.texts]
    assert max(box.x1 for box in boxes) <= figure.bbox.x1
    if paper_time:
        assert not boxes[0].overlaps(boxes[1])


#: A value of each key of the model that its physics depends on, and what else it needs.
OTHERWISE = {
    "drag_ratio": (3.5, {}),
    "inextensibility": ("weak", {}),
    "tensile_stiffness": (123.5, {"inextensibility": "weak"}),
    "confined": (True, {}),
    "natural_curvature": ([2.5, 0.0], {}),
    "bending_ratio": (1.25, {}),
    "twist": ("paper", {"bending_ratio": 1.5}),
    "twist_stiffness": (0.25, {"bending_ratio": 1.5, "twist": "elastic"}),
    "kind": ("chain", {}),
    "links": (4, {"kind": "chain"}),
    "base_spring": (0.5, {"kind": "chain"}),
    "bead_drag": (7.25, {"kind": "chain"}),
    "spring": ("unwrapped", {"kind": "chain", "confined": True}),
}


@pytest.mark.parametrize("key", sorted(ModelTable.model_fields.keys() - {"segments"}))
def test_words_tell_every_key_of_the_model_that_departs_from_its_default(key: str) -> None:
    value, needed = OTHERWISE[key]
    plain = parse_input({"model": needed})
    changed = parse_input({"model": {**needed, key: value}})
    assert plain.load_text != changed.load_text
    # A curve over the key leaves its value out, and Python says the same as the command line.
    if not isinstance(value, str):
        assert str(value) not in changed.describe({f"model.{key}"})
    assert describe_model(build_model(changed)) == changed.load_text


def test_a_run_made_in_python_is_titled_in_words() -> None:
    curved = un.Filament(
        segments=4, load=un.TipLoad(60.0), natural_curvature=(1.5, 0.0), twist="paper"
    )
    assert describe_model(curved) == "tip force 60, curvature k1 = 1.5, twist moment left out"
    filament = un.Filament(4, un.PointLoad(60.0, 0.5))
    stored = un.dataset_of(un.integrate(filament, un.kicked(filament, 0.1), until=0.01))
    title = portrait(stored).texts[0].get_text()
    assert title.startswith("point force 60 at s = 0.5")
    bump = un.ProfileLoad(50.0, lambda s: 1.0 + s)
    assert describe_model(un.Filament(4, bump)) == "spread force 50"
