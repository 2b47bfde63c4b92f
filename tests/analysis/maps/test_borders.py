"""Solved borders of a diagram, against the states on both sides; and runs that contradict them."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import undula as un
from refusal import complaint
from sweeps import made_up
from undula.analysis.linear.results import Crossing, Onset
from undula.analysis.maps.contradictions import contradictions
from undula.analysis.maps.stability_boundaries import (
    BOUNDARIES,
    StabilityBoundaries,
    stability_boundaries,
)
from undula.analysis.maps.stability_intervals import StabilityIntervals, straight_intervals
from undula.analysis.solvers.flapping import find_flapping
from undula.analysis.solvers.spinning import find_spinning
from undula.analysis.solvers.thresholds import single_threshold
from undula.analysis.states.extrapolation import extrapolated
from undula.analysis.states.records import Flapping, Spinning
from undula.sweeps.boundary_cache import NAME, read_boundaries, write_boundaries

EIGHT = un.Filament(segments=8, load=un.TipLoad(75.0))
LOW = un.Filament(segments=8, load=un.PointLoad(75.0, position=0.4))
FINDS = {"spinning": find_spinning, "flapping": find_flapping}


@cache
def of_eight() -> StabilityBoundaries:
    return stability_boundaries(EIGHT, None, (), 240.0)


@cache
def over_position() -> StabilityBoundaries:
    return stability_boundaries(LOW, "load.position", (0.4, 1.5, 0.7), 140.0)


def force_of(name: str) -> float:
    return float(of_eight().curve(name)[0][0])


@pytest.mark.slow
def test_the_onset_is_that_of_the_links_as_they_are_and_tends_to_that_of_the_filament() -> None:
    discrete = un.onset(EIGHT, method="discrete").force
    assert force_of("onset") == pytest.approx(discrete, rel=1e-9)
    # Below the onset no branch has to be followed.
    forces = [
        float(stability_boundaries(EIGHT.with_(segments=n), None, (), 30.0).curve("onset")[0][0])
        for n in (8, 16, 32)
    ]
    filament = un.onset(EIGHT).force
    limit, error = extrapolated(forces)
    assert filament is not None
    assert abs(limit - filament) < error < 1e-2 * filament


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "kind", "before"),
    [
        ("spinning-lost", "spinning", True),
        ("flapping-gained", "flapping", False),
        ("flapping-lost", "flapping", True),
    ],
)
def test_on_both_sides_of_a_border_states_are_stable_and_unstable(
    name: str, kind: str, before: bool
) -> None:
    below, above = (
        FINDS[kind](EIGHT.with_(force=share * force_of(name))) for share in (0.999, 1.001)
    )
    assert isinstance(below, Spinning | Flapping)
    assert isinstance(above, Spinning | Flapping)
    assert (below.stable, above.stable) == (before, not before)


@pytest.mark.slow
def test_a_border_is_the_threshold_of_that_name() -> None:
    # Located to 1e-9 of the way that was followed, some hundreds.
    assert force_of("spinning-lost") == pytest.approx(
        single_threshold(EIGHT, "spinning-lost").value, abs=1e-6
    )


def test_stretches_reach_from_border_to_border() -> None:
    column = of_eight().columns[0]
    assert column["straight"].stable == ((0.0, force_of("onset")),)
    assert column["spinning"].stable == ((force_of("onset"), force_of("spinning-lost")),)
    assert column["flapping"].stable == ((force_of("flapping-gained"), force_of("flapping-lost")),)
    assert column["flapping"].searched_to == 240.0


@pytest.mark.slow
def test_a_branch_born_downwards_has_a_fold_below_the_onset() -> None:
    borders = over_position()
    fold, onset = (float(borders.curve(name)[0][0]) for name in ("spinning-fold", "onset"))
    assert fold < 0.95 * onset
    state = borders.columns[0]["spinning"]
    assert state.begins == fold
    # Beyond the fold there is a stable state; short of it there is none.
    assert state.is_stable_at(1.01 * fold)
    assert not state.is_stable_at(0.99 * fold)
    beyond = un.find(LOW.with_(force=1.01 * fold), "spinning")
    assert isinstance(beyond, Spinning)
    assert beyond.stable
    assert not un.find(LOW.with_(force=0.99 * fold), "spinning")


@pytest.mark.slow
def test_values_without_a_border_are_gaps_with_reasons() -> None:
    borders = over_position()
    onsets = borders.curve("onset")[0]
    assert np.isfinite(onsets).tolist() == [True, False, True]
    assert "1.5" in str(borders.why_no_boundary("onset", 1))
    assert borders.why_no_boundary("onset", 0) is None
    assert np.isnan(borders.curve("spinning-lost")[0]).all()
    for name, missing in (
        ("spinning-lost", "lose stability"),
        ("flapping-gained", "become stable"),
    ):
        sentence = f"{name.split('-')[0]} does not {missing} up to force 140"
        assert borders.why_no_boundary(name, 2) == sentence
    assert borders.why_no_boundary("spinning-fold", 2) == "spinning is born upwards"


def test_a_filament_that_stays_straight_has_no_borders() -> None:
    pulled = un.Filament(
        segments=8, load=un.TableLoad(20.0, s=(0.0, 0.2, 0.4, 1.0), density=(1.0, 1.0, -0.4, -0.4))
    )
    borders = stability_boundaries(pulled, None, (), 300.0)
    for name in BOUNDARIES:
        assert np.isnan(borders.curve(name)[0]).all()
        assert "stable" in str(borders.why_no_boundary(name, 0))


def test_a_confined_filament_has_no_border_of_spinning() -> None:
    # Below the onset no branch has to be followed.
    borders = stability_boundaries(EIGHT.with_(confined=True), None, (), 30.0)
    assert borders.why_no_boundary("spinning-lost", 0) == "a confined model cannot spin"
    assert borders.columns[0]["flapping"].stable[0][0] == borders.curve("onset")[0][0]


@pytest.mark.slow
def test_progress_counts_the_values() -> None:
    told: list[tuple[int, int]] = []
    stability_boundaries(
        EIGHT, "model.drag_ratio", (1.5, 2.0), 30.0, progress=lambda *some: told.append(some)
    )
    assert told == [(1, 2), (2, 2)]


def test_a_straight_state_that_comes_to_rest_again_has_two_stretches() -> None:
    crossings = [Crossing(force, 0.0, 5.0, 0.0, slope) for force, slope in ((30, 1), (50, -1))]
    onset = Onset(crossings[0], None, None, (crossings[1],), 50.0, "discrete")
    assert straight_intervals(onset).stable == ((0.0, 30.0), (50.0, np.inf))


@pytest.mark.parametrize("up_to", [0.0, float("inf"), float("nan")])
def test_forces_of_interest_have_an_end(up_to: float) -> None:
    assert f"up_to = {up_to}" in complaint(lambda: stability_boundaries(EIGHT, None, (), up_to))


def test_borders_are_over_no_force() -> None:
    sentence = complaint(lambda: stability_boundaries(EIGHT, "load.force", (1.0,), 100.0))
    assert "take another parameter" in sentence


def test_an_unknown_border_is_refused() -> None:
    assert "'melting' is not known" in complaint(lambda: of_eight().curve("melting"))


# ---------------------------------------------------------------- runs that contradict

FORCES = (20.0, 35.0, 41.0, 100.0, 199.0, 250.0, 400.0)


def made_borders(*, fold: float | None = None) -> StabilityBoundaries:
    """Return borders at 40, spinning stable up to 200, flapping from 180 to 300."""
    begins = 40.0 if fold is None else fold
    column = {
        "straight": StabilityIntervals("straight", 0.0, ((0.0, 40.0),), np.inf),
        "spinning": StabilityIntervals("spinning", begins, ((begins, 200.0),), 350.0),
        "flapping": StabilityIntervals("flapping", 40.0, ((180.0, 300.0),), 350.0),
    }
    return StabilityBoundaries(None, (float("nan"),), 400.0, (column,))


def right(force: float, _: int = 0) -> str:
    if force < 40.0:
        return "straight"
    return "spinning" if force < 200.0 else "planar flapping" if force < 300.0 else "chaotic"


def sweep(**instead: str) -> xr.Dataset:
    """Return a sweep that is right but at some forces, given as f250="spinning"."""
    changed = {float(name.removeprefix("f")): word for name, word in instead.items()}
    return made_up({"load.force": FORCES}, lambda f, k: changed.get(f, right(f, k)))


def test_runs_that_end_in_stable_states_contradict_nothing() -> None:
    assert contradictions(sweep(), made_borders()) == ()


@pytest.mark.parametrize(
    ("instead", "said"),
    [
        ({"f250": "spinning"}, "spinning is stable from force 40 to 200 only"),
        ({"f100": "straight"}, "the straight state is stable from force 0 to 40 only"),
        ({"f100": "planar flapping"}, "planar flapping is stable from force 180 to 300 only"),
        ({"f20": "spinning"}, "spinning begins at force 40"),
        ({"f20": "windmilling"}, "spinning and flapping begin at force 40"),
    ],
)
def test_a_run_in_a_state_that_is_not_stable_contradicts(
    instead: dict[str, str], said: str
) -> None:
    (found,) = contradictions(sweep(**instead), made_borders())
    ((name, verdict),) = instead.items()
    assert found.at == {"load.force": float(name[1:]), "try": 0.0}
    assert found.verdict == verdict
    assert found.sentence == f"{verdict} at load.force = {name[1:]}: {said}"
    assert not found.near


def test_a_contradiction_next_to_a_border_is_told_as_near() -> None:
    # 41 lies 2.5 per cent above the onset at 40.
    store = sweep(f41="straight")
    (far,) = contradictions(store, made_borders())
    (near,) = contradictions(store, made_borders(), near=0.03)
    assert (far.near, near.near) == (False, True)


@pytest.mark.parametrize(
    "instead",
    [
        {"f250": "undecided"},
        {"f100": "chaotic"},
        {"f250": "failed"},
        {"f250": ""},
        # Beyond 350 the branches were not followed.
        {"f400": "spinning"},
        {"f400": "planar flapping"},
    ],
)
def test_what_is_not_known_contradicts_nothing(instead: dict[str, str]) -> None:
    assert contradictions(sweep(**instead), made_borders()) == ()


def test_spinning_between_its_fold_and_the_onset_is_right() -> None:
    store = sweep(f35="spinning")
    assert len(contradictions(store, made_borders())) == 1
    assert contradictions(store, made_borders(fold=30.0)) == ()


def test_each_column_is_judged_by_its_own_borders() -> None:
    first = made_borders()
    column = first.columns[0]
    later = replace(column["straight"], stable=((0.0, 150.0),))
    borders = StabilityBoundaries(
        "load.exponent", (1.0, 2.0), 400.0, (column, {**column, "straight": later})
    )
    axes = {"load.force": (100.0,), "load.exponent": (1.0, 2.0)}
    (found,) = contradictions(made_up(axes, lambda *_: "straight"), borders)
    assert found.at["load.exponent"] == 1.0


def test_borders_over_no_axis_of_the_store_are_refused() -> None:
    borders = replace(made_borders(), parameter="load.slope", values=(0.5,))
    assert "no axis of the store" in complaint(lambda: contradictions(sweep(), borders))
    without = made_up({"load.exponent": (1.0, 2.0)}, lambda *_: "straight")
    assert "load.force" in complaint(lambda: contradictions(without, made_borders()))


# ---------------------------------------------------------------- kept beside a study


@pytest.mark.slow
def test_borders_are_kept_and_read_again(tmp_path: Path) -> None:
    store = sweep()
    assert read_boundaries(tmp_path, store) == []
    for borders in (of_eight(), over_position(), made_borders()):
        write_boundaries(tmp_path, store, borders)
        assert tuple(read_boundaries(tmp_path, store)) == borders.columns


def test_columns_are_kept_before_all_of_them_are_there(tmp_path: Path) -> None:
    borders = over_position()
    some = [None, *borders.columns[1:]]
    write_boundaries(tmp_path, sweep(), replace(borders, columns=()), some)
    assert read_boundaries(tmp_path, sweep()) == some


@pytest.mark.parametrize("content", ["", "{", "[1]", '{"about": {}}'])
def test_kept_borders_of_something_else_are_passed_over(tmp_path: Path, content: str) -> None:
    (tmp_path / NAME).write_text(content, encoding="utf-8")
    assert read_boundaries(tmp_path, sweep()) == []


def test_borders_of_another_study_are_not_used(tmp_path: Path) -> None:
    write_boundaries(tmp_path, sweep(), made_borders())
    other = sweep().assign_attrs(study='{"model": {"segments": 20}}')
    assert read_boundaries(tmp_path, other) == []
    part = sweep().isel({"load.force": slice(0, 3)})
    assert read_boundaries(tmp_path, part) == []
