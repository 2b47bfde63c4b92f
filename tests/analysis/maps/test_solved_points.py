"""What points of a diagram do, told by solved states, against states found one by one."""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest

import undula as un
from refusal import complaint
from undula.analysis.linear.spectrum import spectrum
from undula.analysis.maps.stability_along_force import solved_record, stability_along_force
from undula.analysis.maps.states_at_forces import states_along
from undula.analysis.solvers.flapping import find_flapping
from undula.analysis.solvers.spinning import find_spinning
from undula.analysis.solvers.thresholds import single_threshold
from undula.analysis.states.not_found import NotFound
from undula.analysis.states.records import Flapping, Spinning

EIGHT = un.Filament(segments=8, load=un.TipLoad(75.0))
LOW = un.Filament(segments=8, load=un.PointLoad(75.0, position=0.4))
#: Straight, spinning, and beyond both of its neighbours' thresholds; in no order.
FORCES = (100.0, 20.0, 141.0, 160.0, 230.0)


@cache
def line() -> tuple[dict[str, Any], ...]:
    return tuple(stability_along_force(EIGHT, FORCES))


def at(force: float) -> dict[str, Any]:
    return line()[FORCES.index(force)]


@cache
def found(kind: str, force: float) -> Spinning | Flapping | NotFound:
    find: Callable[..., Any] = find_spinning if kind == "spinning" else find_flapping
    return find(EIGHT.with_(force=force))


@pytest.mark.slow
@pytest.mark.parametrize("force", [100.0, 141.0, 160.0])
@pytest.mark.parametrize("kind", ["spinning", "flapping"])
def test_a_branch_is_read_off_where_single_searches_end(kind: str, force: float) -> None:
    state = found(kind, force)
    assert isinstance(state, Spinning | Flapping)
    # Both are solved for to some 1e-8, which rates show magnified.
    assert at(force)[f"{kind}_frequency"] == pytest.approx(state.frequency, rel=1e-7)
    assert at(force)[f"{kind}_rate"] == pytest.approx(state.leading_rate, rel=1e-4)
    assert at(force)[kind] == ("stable" if state.stable else "unstable")


@pytest.mark.slow
def test_the_straight_state_has_the_rate_of_its_spectrum() -> None:
    for force in FORCES:
        rate = spectrum(EIGHT, force, method="discrete", count=1).rates[0]
        assert at(force)["straight_rate"] == pytest.approx(rate, rel=1e-9)
        assert at(force)["straight"] == ("stable" if rate < 0.0 else "unstable")


@pytest.mark.slow
def test_the_verdict_is_the_stable_state_with_its_figures() -> None:
    spins, flaps = found("spinning", 100.0), found("flapping", 160.0)
    assert isinstance(spins, Spinning)
    assert isinstance(flaps, Flapping)
    told = at(100.0)
    assert (told["verdict"], told["also"]) == ("spinning", "")
    for key, value in {
        "margin": spins.leading_rate,
        "frequency": spins.frequency,
        "energy_min": spins.bending_energy.mean,
        "energy_max": spins.bending_energy.mean,
        "tip_radius_max": spins.tip_radius.mean,
        # Of points on a circle a half lies out of any plane.
        "planarity": 0.5**0.5,
    }.items():
        assert told[key] == pytest.approx(value, rel=1e-4), key
    told = at(160.0)
    assert (told["verdict"], told["also"]) == ("planar flapping", "")
    for key, value in {
        "margin": flaps.leading_rate,
        "frequency": flaps.frequency,
        "energy_min": flaps.bending_energy.min,
        "energy_max": flaps.bending_energy.max,
        "energy_mean": flaps.bending_energy.mean,
        "tip_radius_max": flaps.tip_radius.max,
        "planarity": 0.0,
    }.items():
        assert told[key] == pytest.approx(value, rel=1e-4, abs=1e-9), key
    # Of the same orbit by the same steps; what differs is where on it one began.
    assert told["frequency_error"] == pytest.approx(flaps.time_error, rel=0.5)


def test_below_the_onset_the_filament_is_straight() -> None:
    told = at(20.0)
    assert told["verdict"] == "straight"
    assert (told["spinning"], told["flapping"]) == ("none", "none")
    assert told["margin"] == told["straight_rate"] < 0.0
    assert told["frequency"] == told["energy_max"] == told["tip_radius_max"] == 0.0


def test_between_the_thresholds_both_motions_are_told() -> None:
    # 141 lies between the forces from which flapping is and up to which spinning is stable.
    lost = single_threshold(EIGHT, "spinning-lost").value
    assert lost is not None
    assert 141.0 < lost < 160.0
    assert (at(141.0)["verdict"], at(141.0)["also"]) == ("spinning", "planar flapping")


def test_where_no_state_is_stable_runs_have_to_tell() -> None:
    told = at(230.0)
    assert told["verdict"] == "undecided"
    assert {told[kind] for kind in ("straight", "spinning", "flapping")} == {"unstable"}
    assert np.isnan([told[key] for key in ("margin", "frequency", "energy_mean")]).all()
    # The states themselves are known all the same.
    assert told["flapping_rate"] > 0.0
    assert np.isfinite(told["spinning_frequency"])


def test_a_single_record_is_that_of_a_line() -> None:
    for force in (20.0, 141.0):
        alone, among = solved_record(EIGHT.with_(force=force)), at(force)
        assert alone.keys() == among.keys()
        for key, value in alone.items():
            if key == "frequency_error":
                continue  # which differs as much as it is small
            expected = (
                value if isinstance(value, str) else pytest.approx(value, rel=1e-4, nan_ok=True)
            )
            assert among[key] == expected, key


def test_spinning_that_is_born_downwards_is_told_beside_the_straight_state() -> None:
    hopf = un.onset(LOW, method="discrete").force
    assert hopf is not None
    below, far_below, above = stability_along_force(LOW, [0.97 * hopf, 0.7 * hopf, 1.05 * hopf])
    assert (below["verdict"], below["also"]) == ("straight", "spinning")
    assert (far_below["verdict"], far_below["spinning"]) == ("straight", "none")
    assert above["verdict"] == "spinning"
    alone = solved_record(LOW.with_(force=0.97 * hopf))
    assert (alone["verdict"], alone["also"]) == ("straight", "spinning")
    assert alone["spinning_frequency"] == pytest.approx(below["spinning_frequency"], rel=1e-7)


@pytest.mark.slow
def test_a_confined_filament_flaps_and_never_spins() -> None:
    (told,) = stability_along_force(EIGHT.with_(confined=True), [75.0])
    assert (told["verdict"], told["spinning"]) == ("planar flapping", "none")
    free = found("flapping", 75.0)
    assert isinstance(free, Flapping)
    assert told["frequency"] == pytest.approx(free.frequency, rel=1e-7)
    assert told["margin"] == pytest.approx(free.leading_rate_in_plane, rel=1e-4)


def test_progress_tells_the_forces_that_a_branch_has_reached() -> None:
    reached: list[float] = []
    states = states_along(EIGHT, "spinning", [60.0, 50.0], reached.append)
    assert sorted(states) == [50.0, 60.0]
    assert reached == sorted(reached)
    assert reached[-1] >= 60.0


def test_no_forces_have_no_records() -> None:
    assert stability_along_force(EIGHT, []) == []


def test_a_kind_that_is_none_is_refused() -> None:
    assert "'hopping' is no kind" in complaint(lambda: states_along(EIGHT, "hopping", [60.0]))
