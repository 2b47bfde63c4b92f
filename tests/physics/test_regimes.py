"""What the filament does under a tip force: the four regimes, found by running it."""

import numpy as np
import pytest

import undula as un
from undula.analysis.observables.linear_mode import linear_motion
from undula.analysis.runs.run import Run
from undula.models.initial_states import leading_mode

SEGMENTS = 20


def ran(force: float, *, confined: bool = False, until: float | str = "settled", **more) -> Run:
    filament = un.Filament(SEGMENTS, un.TipLoad(force), confined=confined)
    start = un.planar(filament) if confined else un.kicked(filament)
    return un.integrate(filament, start, until=until, **more)


def test_a_weak_force_lets_the_filament_return_to_straight_monotonically() -> None:
    run = ran(10.0, until=0.2)
    assert run.verdict.name == "straight"
    assert "monotone" in run.verdict.reason


@pytest.mark.parametrize(("force", "until"), [(25.0, 0.12), (30.0, 0.15), (35.0, 0.5)])
def test_below_threshold_it_rings_down_as_the_linear_theory_says(
    force: float, until: float
) -> None:
    filament = un.Filament(SEGMENTS, un.TipLoad(force))
    run = un.integrate(filament, un.kicked(filament, 1e-3), until=until)
    assert run.verdict.name == "straight"
    assert "ringing" in run.verdict.reason
    late = run.motion.late(0.05)  # the second mode has decayed by e^-50 there
    motion = linear_motion(late.time, late.nodes)
    growth, _ = leading_mode(filament)
    assert motion is not None
    # 1 per cent: what is asked; the fit's own error is some tenths of it.
    assert motion.rate == pytest.approx(growth.real, rel=1e-2)
    assert motion.frequency == pytest.approx(growth.imag / (2 * np.pi), rel=1e-2)


def test_above_threshold_a_non_planar_kick_ends_in_spinning_with_locked_curvature() -> None:
    run = ran(75.0)
    assert run.ending.value == "settled"
    assert run.verdict.name == "spinning"
    energy, height = run.summary()["bending_energy"], run.summary()["tip_height"]
    # Settled to 100 rtol = 1e-4 of the displacement; energy and height follow to the same order.
    assert energy["max"] - energy["min"] < 1e-3 * energy["mean"]
    assert height["max"] - height["min"] < 1e-3


def test_the_same_force_in_a_plane_makes_it_flap() -> None:
    run = ran(75.0, confined=True)
    assert run.verdict.name == "planar flapping"
    assert np.all(run.motion.nodes[..., 1] == 0.0)
    energy = run.summary()["bending_energy"]
    # A hundred times what a settled spinning state may show.
    assert energy["max"] - energy["min"] > 0.1 * energy["mean"]


def test_spinning_is_faster_than_flapping_at_the_same_force() -> None:
    spinning, flapping = ran(75.0).frequency, ran(75.0, confined=True).frequency
    assert spinning is not None
    assert flapping is not None
    assert abs(spinning.value) > abs(flapping.value)


def test_a_strong_force_makes_even_a_non_planar_kick_flap_in_a_plane() -> None:
    run = ran(300.0)
    assert run.verdict.name == "planar flapping"
    # The kick was not planar: less of it is left out of plane than the verdict's own limit.
    assert run.summary()["planarity"] < 0.02


@pytest.mark.parametrize(("force", "verdict"), [(180.0, "spinning"), (190.0, "planar flapping")])
def test_between_180_and_190_a_kick_ends_in_another_regime(force: float, verdict: str) -> None:
    # Ling, Guo & Kanso (2018), section on spinning and flapping: 180 spins, 190 flaps.
    filament = un.Filament(40, un.TipLoad(force))
    run = un.integrate(filament, un.kicked(filament), until="settled")
    assert run.verdict.name == verdict


def test_the_weak_form_tends_to_the_exact_one_as_one_over_the_stiffness() -> None:
    exact = un.Filament(12, un.TipLoad(75.0))
    tight = {"until": "settled", "rtol": 1e-8}
    rate = un.integrate(exact, un.kicked(exact), **tight).rotation_frequency
    stiffness = np.array([1e4, 4e4, 1.6e5])
    errors = []
    for value in stiffness:
        weak = exact.with_(inextensibility="weak", tensile_stiffness=float(value))
        found = un.integrate(weak, un.kicked(weak), **tight).rotation_frequency
        errors.append(abs(found.value / rate.value - 1.0))
    slope = np.polyfit(np.log(stiffness), np.log(errors), 1)[0]
    # The next term of the expansion is 1e-3 of the first at the softest: the slope is -1 to 0.02.
    assert slope == pytest.approx(-1.0, abs=0.02)
