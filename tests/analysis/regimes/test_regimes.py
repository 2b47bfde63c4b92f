"""First verdicts on motions made by hand, whose right name is known."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from undula.analysis.observables.linear_mode import linear_motion
from undula.analysis.regimes.classify import first_verdict
from undula.analysis.regimes.stationary_window import late_windows
from undula.analysis.regimes.verdict import Verdict
from undula.arrays import Array

ARC = np.linspace(0.0, 1.0, 21)
TIME = np.linspace(0.0, 2.0, 600)
COLUMN = TIME[:, None]
BENT = 0.3 * ARC**2 * np.exp(0.8j * ARC)
TURNING = 2.0 * np.pi * 8.0 * TIME
STILL = np.zeros_like(TIME)
WAVE = 0.3 * ARC**2 * np.cos(2.0 * np.pi * 6.0 * COLUMN - 2.0 * ARC) + 0.03 * ARC**3 * np.cos(
    2.0 * np.pi * 18.0 * COLUMN - 4.0 * ARC + 1.0
)
RINGING = 1e-2 * ARC**2 * np.cos(2.0 * np.pi * 4.0 * COLUMN - 2.0 * ARC)
NOISE = 1e-6 * np.random.default_rng(0).normal(size=(600, 21))


def motion(sides: NDArray[np.complex128] | Array) -> tuple[Array, Array]:
    """Nodes at these transverse places, at heights of an inextensible line, and their energy."""
    nodes = np.zeros((*sides.shape, 3))
    nodes[..., 0], nodes[..., 1] = np.real(sides), np.imag(sides)
    slopes = np.diff(sides, axis=1) / ARC[1]
    nodes[:, 1:, 2] = np.cumsum(1.0 - 0.5 * np.abs(slopes) ** 2, axis=1) * ARC[1]
    return nodes, 0.5 * np.sum(np.abs(np.diff(slopes, axis=1)) ** 2, axis=1) / ARC[1]


def judge(
    sides: NDArray[np.complex128] | Array,
    angle: Array = STILL,
    *,
    time: Array = TIME,
    settled_from: float | None = None,
) -> Verdict:
    nodes, energy = motion(sides)
    return first_verdict(time, nodes, energy, angle, settled_from=settled_from)


def spin(amplitude: NDArray[np.complex128] | Array | float = 1.0) -> NDArray[np.complex128]:
    return BENT * np.exp(1j * TURNING)[:, None] * amplitude


@pytest.mark.parametrize("settled_from", [None, 0.7])
@pytest.mark.parametrize("noise", [0.0, 1.0])
def test_a_rigid_rotation_is_spinning(settled_from: float | None, noise: float) -> None:
    found = judge(spin() + noise * NOISE, TURNING, settled_from=settled_from)
    assert found.name == "spinning"
    # Eight turns in T, noise of a millionth at amplitude 0.1.
    assert found.evidence["frequency"] == pytest.approx(8.0, abs=1e-4)


def test_the_window_starts_where_the_integrator_saw_the_motion_settle() -> None:
    found = judge(spin(), TURNING, settled_from=0.7)
    # The first sample at or after that time; samples are 1/299.5 apart.
    assert 0.7 <= found.window_start < 0.7 + 1 / 299.0


def test_a_settling_time_that_leaves_too_few_samples_is_passed_over() -> None:
    found = judge(spin(), TURNING, settled_from=1.999)
    assert found.name == "spinning"
    assert found.window_start < 1.5


def test_a_rotation_whose_transient_has_died_out_is_spinning() -> None:
    assert judge(spin(1.0 + 0.5 * ARC * np.exp(-8.0 * COLUMN)), TURNING).name == "spinning"


def test_a_shorter_window_is_judged_when_the_longer_one_holds_a_transient() -> None:
    found = judge(spin(1.0 + 0.5 * ARC * np.exp(-4.0 * COLUMN)), TURNING)
    assert found.name == "spinning"
    assert found.window_start > 1.2


def test_a_rotation_with_a_lasting_transient_is_told_to_run_longer() -> None:
    found = judge(spin(1.0 + 0.3 * ARC * np.exp(-COLUMN)), TURNING)
    assert found.name == "undecided"
    assert "per turn: run longer" in found.reason


def test_a_bent_shape_that_hardly_turns_is_not_spinning() -> None:
    slow = 0.3 * TIME
    found = judge(BENT * np.exp(1j * slow)[:, None], slow)
    assert found.name == "undecided"
    assert "of a turn" in found.reason


@pytest.mark.parametrize("angle", [0.0, 0.3, np.pi / 2])
@pytest.mark.parametrize("noise", [0.0, 1.0])
def test_a_wave_in_a_plane_is_planar_flapping(angle: float, noise: float) -> None:
    found = judge((WAVE + 1j * noise * NOISE) * np.exp(1j * angle))
    assert found.name == "planar flapping"
    # Six swings in T, noise of a millionth.
    assert found.evidence["frequency"] == pytest.approx(6.0, abs=1e-4)
    assert found.evidence["planarity"] < 1e-4


def test_a_standing_swing_through_straight_is_flapping_and_not_straight() -> None:
    # A sample falls on every passage, with the whole filament on the axis.
    time = np.arange(481) / 240.0
    sides = 0.3 * ARC**2 * np.sin(2.0 * np.pi * 6.0 * time[:, None])
    assert judge(sides, np.zeros(481), time=time).name == "planar flapping"


def test_a_good_seven_samples_a_period_are_enough_to_see_flapping() -> None:
    time = np.arange(150) * (1.0 / 43.7)
    phase = 2.0 * np.pi * 6.0 * time[:, None] - 2.0 * ARC
    sides = 0.3 * ARC**2 * (np.cos(phase) + 0.2 * np.cos(3.0 * phase) + 0.1 * np.cos(5.0 * phase))
    found = judge(sides, np.zeros(150), time=time)
    assert found.name == "planar flapping"
    # The third and fifth harmonics fold, apart from each other, and are fitted where they fold to.
    assert found.evidence["misfit"] < 0.01


def test_three_samples_a_period_are_reported_as_too_few() -> None:
    time = np.arange(150) * (1.0 / 19.3)
    sides = 0.3 * ARC**2 * np.cos(2.0 * np.pi * 6.0 * time[:, None] - 2.0 * ARC)
    found = judge(sides, np.zeros(150), time=time)
    assert found.name == "undecided"
    assert "about 3.2 samples a period" in found.reason


def test_a_flapping_that_still_grows_is_undecided() -> None:
    found = judge(WAVE * np.exp(0.3 * COLUMN))
    assert found.name == "undecided"
    assert "between halves of the window: run longer" in found.reason


@pytest.mark.parametrize(
    ("sides", "angle", "name"),
    [
        (
            np.real(WAVE) + 0.15j * ARC**2 * np.sin(2 * np.pi * 6.0 * COLUMN - 2.0 * ARC),
            TURNING,
            "modulated spinning",
        ),
        (
            np.real(WAVE) + 0.02j * ARC**2 * np.sin(2 * np.pi * 6.0 * COLUMN - 2.0 * ARC),
            STILL,
            "non-planar flapping",
        ),
        (
            spin(1.0 + 0.1 * ARC * np.cos(2.0 * np.pi * 13.3 * COLUMN)),
            TURNING,
            "modulated spinning",
        ),
        (WAVE * np.exp(0.5j * COLUMN), 0.5 * TIME, "precessing flapping"),
    ],
    ids=["ellipse", "narrow ellipse", "modulated rotation", "turning plane"],
)
def test_settled_motions_that_are_neither_planar_nor_steady_have_names_of_their_own(
    sides: NDArray[np.complex128], angle: Array, name: str
) -> None:
    found = judge(sides, angle)
    assert found.name == name
    assert found.margin > 1.0


def test_a_small_motion_that_grows_exponentially_is_told_so_with_its_rate() -> None:
    found = judge(1e-2 * RINGING * np.exp(2.0 * COLUMN))
    assert found.name == "undecided"
    assert "growing from straight at rate 2/T" in found.reason


def test_growth_that_saturates_at_the_end_is_undecided() -> None:
    grown = 1.0 / np.sqrt(1.0 + 1e3 * np.exp(-6.0 * COLUMN))
    assert judge(spin(grown), TURNING).name == "undecided"


@pytest.mark.parametrize("noise", [0.0, 1e-3])
def test_a_ringing_decay_is_straight_with_its_rate_and_frequency(noise: float) -> None:
    sides = (RINGING * np.exp(-3.0 * COLUMN) + 1e-2 * noise * NOISE) * np.exp(1j)
    found = judge(sides)
    assert found.name == "straight"
    assert "ringing" in found.reason
    # Exact without noise; noise of 1e-5 of the last amplitude stays far below 0.1 per cent.
    assert found.evidence["decay_rate"] == pytest.approx(3.0, rel=1e-3)
    assert found.evidence["ringing_frequency"] == pytest.approx(4.0, rel=1e-3)
    # The later second of the run holds eight half-swings.
    assert found.evidence["zero_crossings"] == pytest.approx(8, abs=1)


def test_a_monotone_decay_is_straight_with_the_rate_of_its_slowest_mode() -> None:
    sides = 1e-2 * (ARC**2 * np.exp(-2.0 * COLUMN) - 0.4 * ARC**3 * np.exp(-30.0 * COLUMN))
    found = judge(sides)
    assert found.name == "straight"
    assert "monotone" in found.reason
    # The faster mode has fallen by exp(-28) at the start of the later half.
    assert found.evidence["decay_rate"] == pytest.approx(2.0, rel=1e-6)
    assert found.evidence["zero_crossings"] == 0.0


def test_a_decay_out_of_plane_is_measured_like_one_in_a_plane() -> None:
    later = 1e-2 * ARC**2 * np.cos(2.0 * np.pi * 4.0 * COLUMN - 2.0 * ARC + 1.0)
    found = judge((RINGING + 0.5j * later) * np.exp(-3.0 * COLUMN))
    assert found.name == "straight"
    # One mode pair, whatever the phases of its two directions: exact.
    assert found.evidence["decay_rate"] == pytest.approx(3.0, rel=1e-6)
    assert found.evidence["ringing_frequency"] == pytest.approx(4.0, rel=1e-6)


def test_a_decay_down_to_round_off_is_measured_before_it_gets_there() -> None:
    found = judge(RINGING * np.exp(-20.0 * COLUMN) + 1e-4 * NOISE)
    assert found.name == "straight"
    # Noise of 1e-10 is 1e-4 of the amplitude where the measuring stops.
    assert found.evidence["decay_rate"] == pytest.approx(20.0, rel=1e-3)


def test_a_decay_that_has_not_come_far_is_undecided_and_named() -> None:
    found = judge(RINGING * np.exp(-0.8 * COLUMN))
    assert found.name == "undecided"
    assert "decaying at rate 0.8/T" in found.reason
    assert "run longer" in found.reason


def test_a_fall_to_a_small_rotation_is_not_straight() -> None:
    assert judge(spin(0.03 + np.exp(-8.0 * COLUMN)), TURNING).name == "spinning"


def test_a_standing_swing_that_dies_out_shows_its_frequency_too() -> None:
    time = np.linspace(0.0, 1.0, 200)
    sides = 1e-2 * ARC**2 * (np.exp(-5.0 * time) * np.cos(2.0 * np.pi * 4.0 * time))[:, None]
    found = linear_motion(time, motion(sides)[0])
    assert found is not None
    # The model is exact: round-off only.
    assert found.rate == pytest.approx(-5.0, rel=1e-9)
    assert found.frequency == pytest.approx(4.0, rel=1e-9)


def test_a_filament_that_has_not_moved_is_straight() -> None:
    for samples in (1, 2, 600):
        found = judge(np.zeros((samples, 21)), STILL[:samples], time=TIME[:samples])
        assert (found.name, found.reason) == ("straight", "the filament has not moved")


@pytest.mark.parametrize("samples", [1, 2, 3, 7])
def test_a_handful_of_samples_is_undecided(samples: int) -> None:
    found = judge(spin()[:samples], TURNING[:samples], time=TIME[:samples])
    assert found.name == "undecided"
    assert "samples" in found.reason


@given(
    samples=st.integers(1, 60),
    seed=st.integers(0, 10_000),
    kind=st.sampled_from(["noise", "one", "last", "steps", "huge", "tiny"]),
    settled_from=st.sampled_from([None, -1.0, 0.5, 9.0]),
)
def test_odd_but_finite_data_get_a_verdict_with_finite_numbers(
    samples: int, seed: int, kind: str, settled_from: float | None
) -> None:
    rng = np.random.default_rng(seed)
    nodes = motion(np.zeros((samples, 21)))[0]
    jolt = rng.normal(scale={"huge": 1e6, "tiny": 1e-11}.get(kind, 0.3), size=(samples, 21, 3))
    moved = {"one": rng.integers(samples), "last": slice(-1, None), "steps": slice(1, None, 2)}
    nodes[moved.get(kind, slice(None))] += jolt[moved.get(kind, slice(None))]
    energy = rng.uniform(0.0, 1.0, size=samples) * (seed % 2)
    angle = rng.normal(size=samples)
    time = np.linspace(0.0, 1.0, samples)
    found = first_verdict(time, nodes, energy, angle, settled_from=settled_from)
    assert found.name in {"straight", "spinning", "planar flapping", "undecided"}
    assert found.reason
    assert np.all(np.isfinite(list(found.evidence.values())))


def test_the_window_is_the_longest_stationary_one() -> None:
    settling = WAVE * (1.0 - np.exp(-8.0 * COLUMN))
    starts = list(late_windows(TIME, *motion(settling)))
    assert starts == sorted(starts)
    # Half of the run is stationary by then.
    assert starts[0] == 300


def test_a_motion_without_a_stationary_window_is_judged_on_its_last_third() -> None:
    assert list(late_windows(TIME, *motion(WAVE * np.exp(COLUMN)))) == [400]
