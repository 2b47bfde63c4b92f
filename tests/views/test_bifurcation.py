"""Diagrams of states along a parameter, drawn from branches known in closed form.

A branch is followed by t: its frequency is 100 + 20 t and its mean energy 4 + t, without a fold at
force 100 + 50 t, with one at force 150 + 60 t^2, so that it folds back at 150.
"""

import json
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure

from refusal import complaint
from undula.analysis.observables.shapes import Range
from undula.analysis.states.branch import Bifurcation, Branch
from undula.analysis.states.records import Flapping, Spinning
from undula.models.filament import Filament
from undula.models.loads.analytic import TipLoad
from undula.views import bifurcation_diagram, threshold_curves
from undula.views.branches.branch_lines import branch_line
from undula.views.common.labels import spread


@dataclass(frozen=True)
class Known:
    """A state that is only its figures."""

    frequency: float
    bending_energy: Range
    exponents: np.ndarray

    @property
    def stable(self) -> bool:
        return bool(self.exponents[0].real < 0.0)


def straight_on(t: float) -> float:
    return 100.0 + 50.0 * t


def folding(t: float) -> float:
    return 150.0 + 60.0 * t**2


def known(t: float, growing: int, swing: float = 0.0) -> Known:
    exponents = np.concatenate([np.ones(growing), -np.ones(6 - growing)]) + 0j
    return Known(100.0 + 20.0 * t, Range(4.0 + t - swing, 4.0 + t + swing, 4.0 + t), exponents)


def followed(along, places, counts, turns=(), swing=0.0, parameter="load.force") -> Branch:
    """A branch through `places` with so many growing disturbances, and `turns` in between.

    A turn is its kind, its t, and how many disturbances grow before and after it.
    """
    states = [known(t, count, swing) for t, count in zip(places, counts, strict=True)]
    found = [
        Bifurcation(
            kind=kind,
            value=along(t),
            error=1e-9,
            state=known(t, before, swing),
            frequency=100.0 + 20.0 * t,
            second_frequency=None,
            unstable_before=before,
            unstable_after=after,
        )
        for kind, t, before, after in turns
    ]
    values = np.array([along(t) for t in places])
    return Branch(parameter, values, tuple(states), tuple(found), complete=True)


PLACES = np.linspace(0.0, 2.0, 6)
LOST = followed(straight_on, PLACES, [0, 0, 0, 2, 2, 2], [("torus", 0.9, 0, 2)])
STABLE = followed(straight_on, PLACES, [0] * 6)
UNSTABLE = followed(straight_on, PLACES, [1] * 6, swing=0.5)
BACK = np.linspace(-1.1, 1.3, 7)  # -1.1, -0.7, -0.3, 0.1, ..., 1.3
FOLDED = followed(
    folding,
    BACK,
    [3, 2, 1, 0, 0, 2, 2],
    [
        ("symmetry breaking", -0.9, 3, 2),
        ("period doubling", -0.5, 2, 1),
        ("fold", 0.0, 1, 0),
        ("torus", 0.6, 0, 2),
    ],
    swing=0.5,
)


def stored(force: float, *, verdict: str = "spinning", inputs=None, **summary) -> xr.Dataset:
    energy = {"min": 3.0, "max": 6.0, "mean": 4.0}
    told = {"verdict": verdict, "frequency": 90.0, "bending_energy": energy} | summary
    given = {"load": {"force": force}} if inputs is None else inputs
    return xr.Dataset(attrs={"summary": json.dumps(told), "input": json.dumps(given)})


def marked(figure: Figure, name: str) -> list:
    return [a for axes in figure.axes for a in axes.get_children() if a.get_gid() == name]


def paths(figure: Figure, name: str) -> list[np.ndarray]:
    """The points of every line that has this name."""
    return [line.get_xydata() for line in marked(figure, name)]


def words(figure: Figure) -> str:
    said = [text.get_text() for text in figure.texts]
    said += [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    said += [label for axes in figure.axes for label in (axes.get_xlabel(), axes.get_ylabel())]
    return "\n".join(said)


def test_the_diagram_has_a_title_names_symbols_and_units() -> None:
    said = words(bifurcation_diagram([LOST], title="tip load"))
    for label in ("tip load", "Known", "unstable", "$F$  $[B/L^2]$", "$E$  $[B/L]$"):
        assert label in said
    assert "frequency  [cycles per $T$]" in said
    slopes = followed(lambda t: t - 1.0, PLACES, [0] * 6, parameter="load.slope")
    assert r"slope $\alpha$" in words(bifurcation_diagram([slopes], title=""))


def test_spinning_and_flapping_are_named_and_numbered_where_there_are_several() -> None:
    model = Filament(4, TipLoad(50.0))
    decaying = np.array([-1.0 + 0j])
    spinning = Spinning(
        model, model.unknowns(model.straight()), 6.0, residual=0.0, exponents=decaying, trivial=0j
    )
    planar = model.with_(confined=True)
    flapping = Flapping(
        model,
        period=0.5,
        time=np.arange(3) / 6,
        unknowns=np.tile(planar.unknowns(planar.straight()), (3, 1)),
        residual=0.0,
        in_plane=decaying,
        out_of_plane=decaying,
        trivial=(0.0,),
        time_error=0.0,
    )
    branches = [
        Branch("load.force", np.array([50.0]), (state,), (), complete=True)
        for state in (spinning, flapping, flapping)
    ]
    figure = bifurcation_diagram(branches, title="")
    names = [text.get_text() for text in figure.legends[0].get_texts()]
    assert names == ["spinning", "planar flapping 1", "planar flapping 2"]
    drawn = [paths(figure, f"{name}, point")[0] for name in names]
    np.testing.assert_allclose(drawn, [[[50.0, 3.0 / np.pi]], [[50.0, 2.0]], [[50.0, 2.0]]])


def test_solid_turns_to_dashed_exactly_at_the_bifurcation_in_both_panels() -> None:
    figure = bifurcation_diagram([LOST], title="")
    at = [[145.0, 118.0], [145.0, 4.9]]  # t = 0.9
    calm, wild = paths(figure, "Known, stable"), paths(figure, "Known, unstable")
    np.testing.assert_allclose([line[-1] for line in calm], at)
    np.testing.assert_allclose([line[0] for line in wild], at)
    np.testing.assert_allclose(np.concatenate(paths(figure, "Known, bifurcations")), at)
    assert [len(line) for line in calm + wild] == [4, 4, 4, 4]
    for name, dashed in (("stable", False), ("unstable", True)):
        assert [line.is_dashed() for line in marked(figure, f"Known, {name}")] == [dashed] * 2


def test_bifurcations_of_a_branch_that_folds_back_lie_on_their_own_sheet() -> None:
    line = branch_line(FOLDED)
    inserted = [-1.1, -0.9, -0.7, -0.5, -0.3, 0.0, 0.1, 0.5, 0.6, 0.9, 1.3]
    np.testing.assert_allclose(line.values, folding(np.array(inserted)))
    np.testing.assert_allclose(line.frequencies, 100.0 + 20.0 * np.array(inserted))
    assert line.marks.tolist() == [1, 3, 5, 8]
    assert line.stable.tolist() == [False] * 5 + [True] * 3 + [False] * 2


def test_several_bifurcations_between_two_states_keep_their_order() -> None:
    turns = [("torus", 0.9, 0, 2), ("symmetry breaking", 1.1, 2, 3)]
    line = branch_line(followed(straight_on, PLACES, [0, 0, 0, 3, 3, 3], turns))
    np.testing.assert_allclose(line.values, [100, 120, 140, 145, 155, 160, 180, 200])
    assert line.stable.tolist() == [True] * 3 + [False] * 4


@pytest.mark.parametrize(
    ("counts", "t"), [([0, 0, 0, 2, 2, 2], 0.8 - 1e-10), ([0, 0, 2, 2, 2, 2], 0.8 + 1e-10)]
)
def test_a_bifurcation_at_a_state_parts_stable_from_unstable_there(
    counts: list[int], t: float
) -> None:
    # Within the error of locating it, it lies on the other side of the state at t = 0.8.
    line = branch_line(followed(straight_on, PLACES, counts, [("torus", t, 0, 2)]))
    ends = np.column_stack([line.values[:-1], line.values[1:]])
    assert np.all(ends[line.stable] < 140.0 + 1e-7)
    assert np.all(ends[~line.stable] > 140.0 - 1e-7)


def test_a_fold_at_which_nothing_turns_stable_is_found_by_its_place() -> None:
    line = branch_line(followed(folding, BACK, [1] * 7, [("fold", 0.0, 1, 1)]))
    assert line.marks.tolist() == [3]
    assert line.values[3] == 150.0


def test_a_loss_of_stability_that_was_not_located_is_not_drawn_as_stable() -> None:
    line = branch_line(followed(straight_on, PLACES, [0, 0, 0, 2, 2, 2]))
    assert line.stable.tolist() == [True, True, False, False, False]


def test_the_range_of_the_energy_is_shaded_on_both_sheets_of_a_fold() -> None:
    figure = bifurcation_diagram([FOLDED], title="")
    sheets = [area.get_paths() for area in marked(figure, "Known, range")]
    assert len(sheets) == 2
    for (path,), t in zip(sheets, (-0.7, 0.9), strict=True):
        for share, inside in ((-0.49, True), (0.0, True), (0.49, True), (-0.51, False)):
            assert path.contains_point((folding(t), 4.0 + t + share)) is inside
    assert "range over a cycle" in words(figure)
    steady = bifurcation_diagram([LOST], title="")
    assert not marked(steady, "Known, range")
    assert "range over a cycle" not in words(steady)


def test_every_bifurcation_is_labelled_and_no_label_covers_another() -> None:
    near = [("period doubling", 1.0 + k / 100, k, k + 1) for k in range(6)]
    many = [("symmetry breaking", k / 10, 0, 1) for k in range(18)]
    for turns in (near, many):
        branch = followed(straight_on, [0.0, 2.0], [0, 6], turns[:6])
        others = [followed(straight_on, [0.0, 2.0], [0, 1], [turn]) for turn in turns[6:]]
        figure = bifurcation_diagram([branch, *others], title="")
        labels = [text for text in figure.texts if text.get_gid() == "label"]
        expected = sorted(f"{kind}\nat {straight_on(t):.4g}" for kind, t, _, _ in turns)
        assert sorted(text.get_text() for text in labels) == expected
        boxes = [text.get_window_extent() for text in labels]
        assert all(left.x1 < right.x0 for left, right in pairwise(boxes))
        assert boxes[0].x0 > 0
        assert boxes[-1].x1 < figure.bbox.x1
        assert min(box.y0 for box in boxes) > figure.axes[0].bbox.y1
        assert max(box.y1 for box in boxes) < figure.legends[0].get_window_extent().y0


def test_labels_stay_where_they_belong_unless_they_collide() -> None:
    apart = np.array([0.1, 0.5, 0.9])
    np.testing.assert_array_equal(spread(apart, np.full(3, 0.2), 0.0, 1.0), apart)
    together = spread(np.array([0.5, 0.5, 0.5]), np.full(3, 0.2), 0.0, 1.0)
    np.testing.assert_allclose(together, [0.3, 0.5, 0.7])
    edge = spread(np.array([0.95, 1.0]), np.full(2, 0.2), 0.0, 1.0)
    np.testing.assert_allclose(edge, [0.7, 0.9])


def test_runs_are_dots_at_their_force_with_the_range_of_their_energy() -> None:
    nested = {"model": {"load": {"force": 170.0}}}
    runs = [stored(120.0), stored(0.0, inputs=nested, verdict="planar flapping")]
    figure = bifurcation_diagram([LOST], title="", runs=runs)
    frequencies, energies = paths(figure, "runs")
    np.testing.assert_array_equal(frequencies, [[120.0, 90.0], [170.0, 90.0]])
    np.testing.assert_array_equal(energies, [[120.0, 4.0], [170.0, 4.0]])
    (whiskers,) = marked(figure, "runs, range")
    assert [s.tolist() for s in whiskers.get_segments()] == [
        [[force, 3.0], [force, 6.0]] for force in (120.0, 170.0)
    ]
    assert "runs" in [text.get_text() for text in figure.legends[0].get_texts()]
    assert "left out" not in words(figure)


@pytest.mark.parametrize(
    "lacking",
    [
        stored(120.0, frequency=None),
        stored(120.0, verdict="straight"),
        stored(120.0, inputs={"load": {"slope": 0.5}}),
        stored(120.0, inputs={"model": "a model of one's own"}),
        stored(120.0, bending_energy={"min": None, "max": None, "mean": None}),
        xr.Dataset(),
    ],
)
def test_a_run_that_has_no_place_in_the_diagram_is_counted(lacking: xr.Dataset) -> None:
    figure = bifurcation_diagram([LOST], title="", runs=[stored(130.0), lacking])
    np.testing.assert_array_equal(paths(figure, "runs")[0], [[130.0, 90.0]])
    assert "1 of 2 runs left out" in words(figure)


def test_a_run_beyond_the_branch_is_seen() -> None:
    figure = bifurcation_diagram([LOST], title="", runs=[stored(400.0)])
    assert all(axes.viewLim.contains(400.0, axes.viewLim.y0) for axes in figure.axes)


ONE = followed(straight_on, [1.0], [0], swing=0.5)
LONE = followed(straight_on, [1.0], [1])
REST = followed(lambda _: 100.0, PLACES, [0] * 6)


@pytest.mark.parametrize("branch", [ONE, LONE, REST, STABLE, UNSTABLE, FOLDED])
@pytest.mark.parametrize("runs", [(), (stored(100.0),), (xr.Dataset(),)])
def test_short_steady_and_folding_branches_are_drawn(branch: Branch, runs: tuple) -> None:
    figure = bifurcation_diagram([branch], title="", runs=runs)
    figure.canvas.draw()
    said = words(figure).splitlines()
    assert ("unstable" in said) is not all(state.stable for state in branch.states)


def test_no_branch_and_branches_along_two_parameters_are_refused() -> None:
    assert "branches is empty" in complaint(lambda: bifurcation_diagram([], title=""))
    slopes = followed(straight_on, PLACES, [0] * 6, parameter="load.slope")
    said = complaint(lambda: bifurcation_diagram([STABLE, slopes], title=""))
    assert "load.force and load.slope" in said


SLOPES = np.array([0.0, 1.0, 0.5])
GAPPY = np.array([150.0, 120.0, np.nan])
ERRORS = np.array([1.0, 2.0, np.nan])


def thresholds(*forces: np.ndarray) -> Figure:
    curves = [(f"kind {k}", SLOPES, force, ERRORS) for k, force in enumerate(forces)]
    return threshold_curves(curves, parameter="load.slope", title="linear loads")


def test_each_threshold_is_a_labelled_line_with_its_own_marker_and_errors() -> None:
    figure = thresholds(np.array([40.0, 30.0, 35.0]), GAPPY)
    np.testing.assert_array_equal(
        paths(figure, "kind 0")[0], [[0.0, 40.0], [0.5, 35.0], [1.0, 30.0]]
    )
    np.testing.assert_array_equal(
        paths(figure, "kind 1")[0], [[0.0, 150.0], [0.5, np.nan], [1.0, 120.0]]
    )
    (whiskers,) = marked(figure, "kind 1, error")
    assert [s.tolist() for s in whiskers.get_segments()] == [
        [[0.0, 149.0], [0.0, 151.0]],
        [[1.0, 118.0], [1.0, 122.0]],
    ]
    assert len({line.get_marker() for line in figure.axes[0].lines}) == 2
    for label in ("linear loads", "kind 0", "kind 1", r"slope $\alpha$", "$F$  $[B/L^2]$"):
        assert label in words(figure)


def test_a_threshold_that_was_found_nowhere_is_said_to_be_so() -> None:
    figure = thresholds(GAPPY, np.full(3, np.nan))
    figure.canvas.draw()
    assert "kind 1: none found" in words(figure)
    assert "kind 0: none found" not in words(figure)


def test_thresholds_of_several_decades_have_a_logarithmic_force() -> None:
    assert thresholds(np.array([40.0, 4000.0, 400.0])).axes[0].get_yscale() == "log"
    assert thresholds(GAPPY).axes[0].get_yscale() == "linear"


@pytest.mark.parametrize("count", [0, 1])
def test_short_curves_are_drawn(count: int) -> None:
    one = ("onset", SLOPES[:1], GAPPY[:1], ERRORS[:1])
    none = ("lost", SLOPES[:count], GAPPY[:count], ERRORS[:count])
    threshold_curves([one, none], parameter="load.slope", title="").canvas.draw()


def test_no_curve_and_curves_of_unequal_length_are_refused() -> None:
    said = complaint(lambda: threshold_curves([], parameter="load.slope", title=""))
    assert "curves is empty" in said
    uneven = [("onset", SLOPES, GAPPY[:2], ERRORS)]
    said = complaint(lambda: threshold_curves(uneven, parameter="load.slope", title=""))
    assert "'onset' has 3 values, 2 thresholds and 3 errors" in said
