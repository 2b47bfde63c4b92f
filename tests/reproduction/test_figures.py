"""Figures of the paper, drawn from answers and runs that are known in closed form.

The branches are spinning at a frequency of 2 F with an energy of ln(F - 38.7), stable up to 180,
and flapping a fifth slower between half of that energy and twice as much, stable from 176 on.
"""

import json
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure

from refusal import complaint
from undula.analysis.states.branch_json import read_branch
from undula.models.loads.analytic import LinearLoad
from undula.models.loads.power import PowerLoad
from undula.models.units import FILAMENT_UNITS, chain_units
from undula.reproduction.claims.catalogue import Figure as Shown
from undula.reproduction.claims.catalogue import catalogue
from undula.reproduction.claims.evaluate import ClaimAnswer
from undula.reproduction.figures.bistability import common_intervals
from undula.reproduction.figures.branch_panels import read_pair
from undula.reproduction.figures.by_name import VIEWS
from undula.reproduction.report import figures as report_figures
from undula.storage.run_file import write_run
from undula.views.branches.branch_lines import BranchLine
from undula.views.branches.smooth_lines import smooth_line

FILAMENT, CHAIN = FILAMENT_UNITS.names(), chain_units(2).names()
LOST, GAINED = 180.0, 176.0
FORCES = np.linspace(50.0, 300.0, 26)
ARC = np.linspace(0.0, 1.0, 21)
Law = Callable[[Any], Any]


def law(force: Any) -> Any:
    return np.log(force - 38.7)


def followed(
    forces: Any = FORCES,
    stable: Law = lambda force: force < LOST,
    turns: Any = ((LOST, "lost"),),
    *,
    frequency: Law = lambda force: 2.0 * force,
    energy: Law = law,
    units: Any = FILAMENT,
    **more: Any,
) -> dict[str, Any]:
    """An answer of `undula follow`."""
    points = [
        {
            "load.force": float(force),
            "frequency": float(frequency(force)),
            "bending_energy": energy(force),
            "stable": bool(stable(force)),
            "leading_rate": -1.0 if stable(force) else 1.0,
        }
        for force in forces
    ]
    found = [
        {
            "kind": "torus",
            "value": value,
            "error": 1e-7,
            "frequency": float(frequency(value)),
            "second_frequency": None,
            "stability": what,
        }
        for value, what in turns
    ]
    told = {"status": "done", "units": units, "parameter": "load.force", "points": points}
    return told | {"bifurcations": found} | more


def spinning(**changed: Any) -> dict[str, Any]:
    return followed(**changed)


def flapping(**changed: Any) -> dict[str, Any]:
    def energy(force: float) -> dict[str, float]:
        return {"min": 0.5 * law(force), "max": 2.0 * law(force), "mean": law(force)}

    own: Any = {"stable": lambda force: force > GAINED, "turns": ((GAINED, "gained"),)}
    own |= {"frequency": lambda force: 1.6 * force, "energy": energy}
    return followed(**(own | changed))


def of_chains(answer: Callable[..., dict[str, Any]]) -> dict[str, Any]:
    return answer(
        forces=np.linspace(6.5, 12.0, 12),
        stable=lambda _: answer is spinning,
        turns=(),
        energy=lambda force: force - 6.0,
        units=CHAIN,
    )


def growth(last: float = 300.0, units: Any = FILAMENT, onset: float = 40.0) -> dict[str, Any]:
    """An answer of `undula stability --forces`: a rate of F - onset, without one at the end."""
    forces = np.linspace(0.0, last, 151)
    points = [{"force": f, "rate": f - onset, "frequency": f} for f in forces.tolist()]
    points[-1] |= {"rate": None, "frequency": None}
    return {"units": units, "paper_time": False, "points": points}


def run(force: float, shape: Callable[[np.ndarray], np.ndarray], **summary: Any) -> xr.Dataset:
    """A stored run over a time of 1; its energy is that of the verdict's name."""
    times = np.linspace(0.0, 1.0, 2001)
    nodes = shape(times)
    known: dict[str, Any] = {"force": force, "load": f"tip force {force:g}", "units": FILAMENT}
    energy = 4.0 + 2.0 * (summary["verdict"] != "spinning") * np.sin(50.0 * times) ** 2
    return xr.Dataset(
        {
            "nodes": (("time", "node", "axis"), nodes),
            "bending_energy": ("time", energy),
            "active_power": ("time", energy),
            "dissipation": ("time", energy),
            "rotation_angle": ("time", 0.0 * times),
        },
        coords={"time": times},
        attrs={"summary": json.dumps(known | summary)},
    )


def helix(times: np.ndarray, nodes: int = 21) -> np.ndarray:
    """Twenty turns about z in a unit time, the tip at a radius of a half."""
    arc = np.linspace(0.0, 1.0, nodes)
    phase = 2.0 * np.pi * 20.0 * times[:, None] + 3.0 * arc
    radius = 0.5 * arc**2
    plane = [radius * np.cos(phase), radius * np.sin(phase)]
    return np.stack([*plane, 0.0 * phase + 0.7 * arc], axis=-1)


def beat(times: np.ndarray) -> np.ndarray:
    """Ten beats in a unit time in the plane y = 0, in which the tip rises twenty times."""
    side = 0.6 * ARC * np.sin(2.0 * np.pi * 10.0 * times[:, None])
    return np.stack([side, 0.0 * side, np.sqrt(ARC**2 - side**2)], axis=-1)


def spins(force: float = 180.0, **more: Any) -> xr.Dataset:
    return run(force, helix, **({"verdict": "spinning", "frequency": -20.0} | more))


def flaps(force: float = 190.0, **more: Any) -> xr.Dataset:
    return run(force, beat, **({"verdict": "planar flapping", "frequency": 10.0} | more))


def exponents(force: float, count: int, *, pairs: bool = False) -> xr.Dataset:
    values = [100.0 - 50.0 * k for k in range(count)]
    known: dict[str, Any] = {"exponents": values, "errors": [5.0] * count}
    known["finite_separation"] = {"rate": 97.0, "error": 8.0} if pairs else None
    return run(force, helix, verdict="chaotic", frequency=None, lyapunov=known)


def threshold(name: str, forces: Any, errors: Any, **more: Any) -> dict[str, Any]:
    """An answer of `undula threshold --along`."""
    rows = [
        {"model.drag_ratio": 1.0 + k, "value": force, "error": error}
        for k, (force, error) in enumerate(zip(forces, errors, strict=True))
    ]
    told = {"threshold": name, "units": FILAMENT, "parameter": "model.drag_ratio"}
    return told | {"thresholds": rows} | more


def steps(verdicts: Any = ("straight", "spinning")) -> xr.Dataset:
    count = len(verdicts)
    shapes = np.broadcast_to(helix(np.linspace(0.0, 0.05, 4)), (count, 4, 21, 3))
    return xr.Dataset(
        {
            "value": ("step", np.arange(count, dtype=float)),
            "direction": ("step", np.array(["up"] * count)),
            "verdict": ("step", np.array(verdicts)),
            "bending_energy_min": ("step", np.ones(count)),
            "bending_energy_max": ("step", 2.0 * np.ones(count)),
            "shapes": (("step", "shape", "node", "axis"), shapes),
        },
        attrs={"parameter": "load.force", "load": "tip load", "units": json.dumps(CHAIN)},
    )


DRAWN: dict[str, Callable[[], tuple[Any, ...]]] = {
    "bending_energies": lambda: (spinning(), flapping()),
    "bistability": lambda: (spinning(), flapping()),
    "force_profiles": lambda: (),
    "frequencies": lambda: (growth(), spinning(), flapping(), spins(100.0)),
    "lyapunov": lambda: (exponents(800.0, 3, pairs=True), exponents(1200.0, 4)),
    "slowness": lambda: (spinning(), flapping()),
    "stepped": lambda: (steps(), steps()),
    "threshold_lines": lambda: (threshold("onset", (37.7, 37.7), (0.1, 0.1)),),
    "transition": lambda: (spins(), flaps()),
    "two_links": lambda: (spins(), flaps()),
    "windings": lambda: (spins(), flaps()),
}


def draw(name: str, *given: Any) -> Figure:
    return VIEWS[name](*(given or DRAWN[name]()))


def lines(figure: Figure, name: str) -> list[Any]:
    return [line for axes in figure.axes for line in axes.lines if line.get_gid() == name]


def letters(figure: Figure) -> str:
    return "".join(text.get_text() for text in figure.texts if text.get_gid() == "letter")


def test_every_view_of_the_registry_is_drawn_here_and_every_one_that_the_catalogue_names_exists():
    assert DRAWN.keys() == VIEWS.keys()
    named = {figure.view for item in catalogue().values() for figure in item.figures}
    assert named - {None} <= VIEWS.keys()


@pytest.mark.parametrize("name", sorted(DRAWN))
def test_every_axis_with_numbers_has_a_name_and_all_names_fit_on_the_figure(name: str) -> None:
    figure = draw(name)
    figure.draw_without_rendering()
    # Two pixels: text of less is only its side bearing.
    edges = figure.bbox.padded(2.0)
    for legend in figure.legends:
        box = legend.get_window_extent()
        assert edges.x0 <= box.x0
        assert box.x1 <= edges.x1
    for axes in figure.axes:
        if axes.axison and hasattr(axes, "get_zlabel"):
            assert "[L]" in axes.get_xlabel() + axes.get_zlabel()
        elif axes.axison and any(text.get_text() for text in axes.get_xticklabels()):
            shown = [axes.xaxis.label, axes.yaxis.label]
            assert any(text.get_text() for text in shown)
            for text in shown:
                box = text.get_window_extent()
                assert edges.x0 <= box.x0
                assert edges.y0 <= box.y0
                assert box.x1 <= edges.x1


@pytest.mark.parametrize("name", ["bending_energies", "frequencies", "slowness", "bistability"])
def test_a_branch_along_something_else_is_refused(name: str) -> None:
    other = spinning() | {"parameter": "model.drag_ratio"}
    given = (growth(), other, flapping()) if name == "frequencies" else (other, flapping())
    assert "along model.drag_ratio" in complaint(lambda: draw(name, *given))


@pytest.mark.parametrize("name", ["slowness", "bistability"])
def test_answers_of_two_kinds_of_models_are_refused(name: str) -> None:
    assert "in B/L^2 and in K/L" in complaint(lambda: draw(name, spinning(), of_chains(flapping)))


def line_of(answer: dict[str, Any]) -> BranchLine:
    return smooth_line(read_branch(answer, "load.force"))


def test_an_answer_without_a_state_is_refused_with_its_reason() -> None:
    none = {"status": "not found", "units": FILAMENT, "reason": "spinning begins at 37.7"}
    assert "spinning begins at 37.7" in complaint(lambda: read_branch(none, "load.force"))


def test_a_stable_part_ends_at_the_bifurcation_and_not_at_a_state() -> None:
    # The bifurcation is looked for by its force to better than a millionth of an interval.
    assert line_of(spinning()).stable_intervals == [(50.0, pytest.approx(LOST, abs=1e-5))]
    assert line_of(flapping()).stable_intervals == [(pytest.approx(GAINED, abs=1e-5), 300.0)]


def test_a_stable_part_that_ends_at_no_known_place_ends_half_way() -> None:
    (interval,) = line_of(spinning(turns=())).stable_intervals
    # States at 170 and 180; half of the way along the branch is nearly half of the force.
    assert interval == (50.0, pytest.approx(175.0, abs=0.1))


def test_a_branch_that_loses_and_gains_stability_has_two_stable_parts() -> None:
    answer = spinning(
        stable=lambda force: not 101.0 < force < 199.0,
        turns=((101.0, "lost"), (150.0, "unchanged"), (199.0, "gained")),
    )
    line = line_of(answer)
    edges = [*line.stable_intervals[0], *line.stable_intervals[1]]
    assert edges == pytest.approx([50.0, 101.0, 199.0, 300.0], abs=1e-5)
    assert line.values[line.marks] == pytest.approx([101.0, 199.0], abs=1e-5)


def test_a_branch_that_folds_back_is_parted_at_its_fold() -> None:
    way = np.linspace(-1.0, 1.0, 20)
    forces = 150.0 + 60.0 * way**2
    answer = spinning(forces=forces, stable=lambda _: False, turns=((150.0, "gained"),))
    for point, at in zip(answer["points"], way, strict=True):
        point |= {"stable": bool(at > 0.0), "frequency": 100.0 + 20.0 * at}
    line = line_of(answer)
    ((low, high),) = line.stable_intervals
    # The states next to the fold are 0.17 beyond it, their neighbours 1.5.
    assert (low, high) == (pytest.approx(150.0, abs=0.1), 210.0)
    refused = complaint(lambda: line.interpolated(line.frequencies, np.array([160.0])))
    assert "folds back" in refused


def test_between_states_a_branch_follows_the_curve_that_they_lie_on() -> None:
    line = line_of(spinning())
    forces = np.linspace(50.0, 300.0, 77)
    # A cubic through states ten apart; the logarithm curves most at the first of them.
    assert line.interpolated(line.mean, forces) == pytest.approx(law(forces), abs=5e-3)
    assert line.interpolated(line.frequencies, forces) == pytest.approx(2.0 * forces, rel=1e-3)


def test_frequencies_end_at_a_third_and_at_the_end_of_the_branches() -> None:
    figure = draw("frequencies")
    ends = [axes.get_xlim()[1] for axes in figure.axes]
    assert sorted(ends) == pytest.approx([100.0, 100.0, 300.0, 300.0])
    assert letters(figure) == "(a)(b)"


def test_zero_of_frequencies_is_at_the_height_of_zero_of_rates() -> None:
    figure = draw("frequencies")
    heights = [axes.transData.transform((0.0, 0.0))[1] for axes in figure.axes]
    assert heights[0] == pytest.approx(heights[1])
    assert heights[2] == pytest.approx(heights[3])


def test_frequencies_of_chains_are_in_one_panel_in_their_own_units() -> None:
    figure = draw("frequencies", growth(12.0, CHAIN, 6.0), *map(of_chains, (spinning, flapping)))
    (panel,) = {axes.get_xlabel() for axes in figure.axes if axes.get_xlabel()}
    assert "K/L" in panel
    assert letters(figure) == ""


def test_the_loss_of_the_straight_state_is_told_where_its_rate_passes_zero() -> None:
    figure = draw("frequencies")
    assert "straight lost\n40.00" in [text.get_text() for text in figure.texts]
    assert {line.get_xdata()[0] for line in lines(figure, "straight, loss")} == {40.0}


def test_runs_are_dots_by_verdict_without_those_that_do_not_move() -> None:
    runs = spins(250.0), flaps(50.0), spins(20.0, verdict="straight"), flaps(frequency=None)
    figure = draw("frequencies", growth(), spinning(), flapping(), *runs)
    dots = lines(figure, "run, spinning") + lines(figure, "run, planar flapping")
    assert {(*line.get_xdata(), *line.get_ydata()) for line in dots} == {
        (250.0, 20.0),
        (50.0, 10.0),
    }
    assert not lines(figure, "run, straight")
    chain = spins(units=CHAIN)
    refused = complaint(lambda: draw("frequencies", growth(), spinning(), flapping(), chain))
    assert "in B/L^2 and in K/L" in refused


def test_growth_in_the_time_unit_of_the_printed_equation_is_refused() -> None:
    given = growth() | {"paper_time": True}, spinning(), flapping()
    assert "package's own time unit" in complaint(lambda: draw("frequencies", *given))


def test_parts_are_told_apart_by_width_and_dashes() -> None:
    figure = draw("frequencies")
    (stable, *_), (unstable, *_) = (lines(figure, f"spinning, {k}stable") for k in ("", "un"))
    assert stable.get_linewidth() > unstable.get_linewidth()
    assert (stable.get_linestyle(), unstable.get_linestyle()) == ("-", "--")


def test_flapping_a_fifth_slower_is_drawn_at_twenty_per_cent() -> None:
    (line,) = lines(draw("slowness"), "slowness")
    # The two branches are interpolated by themselves.
    assert line.get_ydata() == pytest.approx(np.full(len(line.get_ydata()), 20.0), abs=0.1)


def test_branches_without_a_common_force_cannot_be_compared() -> None:
    late = flapping(forces=[310.0, 320.0])
    assert "no overlap" in complaint(lambda: draw("slowness", spinning(), late))


def test_energies_that_follow_the_logarithm_differ_by_nothing_from_it() -> None:
    figure = draw("bending_energies")
    lower = figure.axes[1]
    drawn = [line for line in lower.lines if str(line.get_gid()).startswith("spinning, ")]
    heights = np.concatenate([line.get_ydata() for line in drawn if len(line.get_ydata()) > 2])
    # Of the cubic between the states, most at the first of them.
    assert np.abs(heights).max() < 0.3
    bounds = [line.get_ydata() for line in lines(figure, "planar flapping, stable")]
    assert max(map(np.max, bounds)) == pytest.approx(2.0 * law(300.0))


def test_the_logarithm_is_not_held_against_chains() -> None:
    chains = of_chains(spinning), of_chains(flapping)
    assert "give answers about filaments" in complaint(lambda: draw("bending_energies", *chains))


def test_both_are_stable_between_the_gain_of_the_one_and_the_loss_of_the_other() -> None:
    ((low, high),) = common_intervals(read_pair(spinning(), flapping()))
    assert (low, high) == pytest.approx((GAINED, LOST), abs=1e-5)
    figure = draw("bistability")
    assert letters(figure) == "(a)(b)"
    close = figure.axes[1].get_xlim()
    assert close == pytest.approx((GAINED - 4.0, LOST + 4.0), abs=1e-4)
    assert letters(draw("bistability", *map(of_chains, (spinning, flapping)))) == ""


def test_the_straight_state_is_shown_only_where_its_end_is_known() -> None:
    assert not lines(draw("bistability"), "straight, stable")
    from_onset = spinning(forces=np.linspace(40.0, 300.0, 27)) | {"onset": 39.0}
    figure = draw("bistability", from_onset, flapping())
    ends = [line.get_xdata()[1] for line in lines(figure, "straight, stable")]
    assert ends == [39.0] * len(ends)
    assert ends


@pytest.mark.parametrize("load", [LinearLoad, PowerLoad])
def test_the_densities_are_those_of_the_loads(load: type[LinearLoad] | type[PowerLoad]) -> None:
    figure = draw("force_profiles")
    panel = figure.axes[0 if load is LinearLoad else 2]
    assert len(panel.lines) == (5 if load is LinearLoad else 4)
    for line in panel.lines:
        value = float(str(line.get_gid()).removeprefix("density "))
        s, density = line.get_xdata(), line.get_ydata()
        middles, steps = 0.5 * (density[1:] + density[:-1]), np.diff(s)
        below = np.concatenate([[0.0], np.cumsum(middles * steps)])
        # The trapezoid rule errs by f''/12 of the square of 1/200, with f'' up to 990.
        assert below == pytest.approx(load(1.0, value).force_below(s), abs=5e-4)


def test_each_concentrated_force_has_its_arrow_head_at_its_place() -> None:
    panel = draw("force_profiles").axes[1]
    arrows = [text for text in panel.texts if str(text.get_gid()).startswith("force ")]
    for text in arrows:
        assert text.xy[0] == float(str(text.get_gid()).removeprefix("force "))
        assert text.xyann[0] > text.xy[0]
    assert [label.get_text() for label in panel.get_yticklabels()][-1] == "1"


def test_a_spinning_tip_draws_a_circle_at_one_height_and_a_flapping_one_a_line() -> None:
    figure = draw("transition")
    assert sorted(letters(figure)) == sorted("(a)(b)(c)(d)")
    (circle,), (beaten,) = (lines(figure, f"path, {k}") for k in ("spinning", "planar flapping"))
    # Between samples the motion is interpolated; there are 100 a turn.
    assert np.hypot(*circle.get_data()) == pytest.approx(np.full(700, 0.5), abs=1e-6)
    assert np.abs(beaten.get_ydata()).max() < 1e-6
    height, energy = lines(figure, "spinning")
    assert np.ptp(height.get_ydata()) < 1e-6
    assert energy.get_ydata() == pytest.approx(np.full(700, 4.0))


@pytest.mark.parametrize("name", ["transition", "two_links"])
def test_curves_are_over_two_periods_of_the_slower_motion(name: str) -> None:
    for line in lines(draw(name), "planar flapping") + lines(draw(name), "spinning"):
        assert line.get_xdata()[[0, -1]] == pytest.approx([0.0, 0.2])


def test_few_nodes_are_beads_and_many_are_not() -> None:
    two = run(8.0, lambda times: helix(times, 3), verdict="spinning", frequency=20.0)
    assert len(lines(draw("two_links", two, flaps()), "beads")) == 1
    assert not lines(draw("two_links"), "beads")


def test_windings_show_the_last_beats_of_the_height_or_of_the_motion() -> None:
    figure = draw("windings", spins(units=FILAMENT), flaps())
    shaded = [axes.patches[0] for axes in figure.axes if axes.patches]
    lengths = {round(patch.get_width(), 3) for patch in shaded}
    # Both have twenty cycles in a unit time: of the motion, whose height is constant, and of the
    # height. The lines of a spectrum over half of it are two apart.
    assert lengths == {round(5.3 / 20.0, 3)}
    said = [text.get_text() for text in figure.texts]
    assert "(b)  $F$ = 190: planar flapping" in said


def test_a_threshold_that_was_not_found_is_a_gap_and_errors_are_bars() -> None:
    given = threshold("spinning-lost", (200.0, None, 150.0), (4.0, None, 2.0))
    (axes,) = draw("threshold_lines", given).axes
    (line,) = axes.lines
    assert line.get_label() == "spinning lost"
    assert line.get_ydata() == pytest.approx([200.0, np.nan, 150.0], nan_ok=True)
    ends = [segment[:, 1].tolist() for segment in axes.collections[0].get_segments()]
    assert ends == [[196.0, 204.0], [148.0, 152.0]]


def test_thresholds_along_different_parameters_or_none_are_refused() -> None:
    one = threshold("onset", (37.0,), (0.1,))
    for given in ([one, one | {"parameter": "load.slope"}], [], [one | {"parameter": None}]):
        refused = complaint(lambda given=given: VIEWS["threshold_lines"](*given))
        assert "with one parameter" in refused


def test_eight_exponents_are_drawn_with_their_errors_after_the_rate_of_pairs() -> None:
    figure = draw("lyapunov", exponents(800.0, 10, pairs=True), exponents(75.0, 2))
    (axes,) = figure.axes
    counts = [len(bars.lines[0].get_xdata()) for bars in axes.containers]
    assert counts == [8, 1, 2]
    assert [bars.lines[0].get_xdata()[0] < 0.5 for bars in axes.containers] == [False, True, False]
    named = [label.get_text() for label in axes.get_xticklabels()]
    assert named == ["pairs\nof runs", *map(str, range(1, 9))]
    (bars,) = axes.containers[0].lines[2]
    assert np.ptp(bars.get_segments()[0][:, 1]) == pytest.approx(10.0)


def test_runs_without_exponents_and_no_runs_are_refused() -> None:
    reason = {"lyapunov": None, "without_lyapunov": "the run was too short"}
    assert "the run was too short" in complaint(lambda: draw("lyapunov", spins(**reason)))
    assert "no runs" in complaint(VIEWS["lyapunov"])


def test_names_of_many_verdicts_stand_in_as_many_rows_as_hold_them() -> None:
    many = steps([f"motion of the kind {k}" for k in range(9)])
    figure = draw("stepped", many, many)
    (legend,) = figure.legends
    box = legend.get_window_extent()
    assert box.x1 <= figure.bbox.x1
    assert legend.get_texts()[0].get_text() == "motion of the kind 0"


def done(folder: Path, answer: dict[str, Any]) -> Any:
    """What of a job that is done matters here."""
    return SimpleNamespace(folder=folder, stored=lambda: {"answer": answer})


def test_a_view_is_given_stored_datasets_and_otherwise_plain_answers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    answers = {"stored": {"verdict": "spinning"}, "told": {"points": [{"force": 1.0}]}}
    jobs = {name: done(tmp_path / name, answer) for name, answer in answers.items()}
    write_run(tmp_path / "stored" / "run.nc", spins(), {})
    seen: list[Any] = []

    def view(*given: Any) -> Figure:
        seen.extend(given)
        return Figure()

    monkeypatch.setitem(VIEWS, "seen", view)  # type: ignore[arg-type]
    shown = Shown(name="one", shows="", caption="", view="seen", of=["told", "stored"])
    wrapped = {name: ClaimAnswer(answers[name], jobs[name].folder) for name in answers}
    ending, content = report_figures._content(shown, wrapped, jobs)
    assert ending == ".svg"
    assert b"<svg" in content
    assert seen[0] == answers["told"]
    assert type(seen[0]["points"]) is list
    assert np.array_equal(seen[1]["nodes"], spins()["nodes"])
