"""Thresholds of the straight filament against published ones and against independent solutions."""

import tomllib
from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cases import every_form, every_load, filament
from independent import (
    by_integral_equation,
    of_the_curvature,
    point_determinant,
    tip_determinant,
    uniform_determinant,
    zero,
)
from undula.analysis.linear.onset import find_onset
from undula.analysis.linear.pencils import AssumedModes, Polynomials, linearised
from undula.analysis.linear.results import Method, Onset
from undula.analysis.linear.spectrum import spectrum
from undula.analysis.linear.stability import onset as onset_of
from undula.arrays import ComplexArray
from undula.models.filament import Filament
from undula.models.initial_states import leading_mode
from undula.models.loads.analytic import LinearLoad, Load, PointLoad, TipLoad
from undula.models.loads.power import PowerLoad
from undula.models.loads.user_density import TableLoad

PUBLISHED = tomllib.loads((Path(__file__).with_name("thresholds.toml")).read_text())
NAMED = {"tip": TipLoad(1.0), "uniform": LinearLoad(1.0)}
MAIN_LOADS = [*NAMED.values(), LinearLoad(1.0, 1.0), PointLoad(1.0, 0.6), PowerLoad(1.0, 2.5)]
SMOOTH_LOADS = [TipLoad(1.0), *(LinearLoad(1.0, slope) for slope in (-1.0, -0.5, 0.0, 0.5, 1.0))]
POINTS = [PointLoad(1.0, position) for position in (0.2, 0.45, 0.7, 0.95)]
POWERS = [PowerLoad(1.0, exponent) for exponent in (0.1, 0.5, 2.5, 10.5, 50.0)]
#: Pulls beyond s = 0.3: nothing bends it.
PULLING = TableLoad(10.0, (0.0, 0.2, 0.4, 1.0), (1.0, 1.0, -0.4, -0.4))


@cache
def onset(load: Load, method: Method | None = None, *, segments: int = 40, later: int = 0) -> Onset:
    return onset_of(Filament(segments, load), method=method, later=later)


def hopf(load: Load, method: Method | None = None, *, segments: int = 40) -> tuple[float, float]:
    """Return the Hopf force and the frequency there."""
    found = onset(load, method, segments=segments).hopf
    assert found is not None
    return found.force, found.frequency


def under(load: Load, force: float) -> ComplexArray:
    """Return the eigenvalues by the integral equation under another force."""
    return by_integral_equation(Filament(40, load).with_(force=force).load)


@pytest.mark.parametrize("published", PUBLISHED["threshold"], ids=lambda each: each["source"][:20])
def test_published_thresholds_are_met_to_their_last_digit(published: dict) -> None:
    found = getattr(onset(NAMED[published["load"]]), published["quantity"])
    assert found == pytest.approx(published["value"], abs=0.5 * published["digit"])


def test_the_value_quoted_for_haugers_column_lies_a_thousandth_above_its_threshold() -> None:
    # q0 L^3 / EI = 150.8 for the load q0 (1 - s), whose total is q0 / 2; see the theory page.
    found = onset(LinearLoad(1.0, -1.0)).oscillatory_force
    assert found is not None
    assert 150.8 / (2.0 * found) - 1.0 == pytest.approx(1e-3, abs=1e-4)


def test_the_tip_load_agrees_with_its_characteristic_equation_in_twelve_digits() -> None:
    force, frequency = hopf(TipLoad(1.0))
    expected = zero(lambda p, omega: tip_determinant(p, 1j * omega), (38.0, 190.0))
    np.testing.assert_allclose([force, 2.0 * np.pi * frequency], expected, rtol=1e-12)

    def doubly(p: float, sigma: float) -> complex:
        # A complex step: the derivative of a function that is real on the axis, without loss.
        return tip_determinant(p, sigma).real + 1e20j * tip_determinant(p, sigma + 1e-20j).imag

    ringing = onset(TipLoad(1.0)).oscillatory_force
    assert ringing == pytest.approx(zero(doubly, (20.0, -120.0))[0], rel=1e-12)


@pytest.mark.parametrize("load", POINTS, ids=repr)
def test_a_point_load_agrees_with_its_characteristic_equation(load: PointLoad) -> None:
    found = np.array(hopf(load)) * [1.0, 2.0 * np.pi]
    expected = zero(
        lambda p, omega: point_determinant(p, 1j * omega, load.position), (*(1.001 * found),)
    )
    # Exponential matrices at F = 450 keep twelve digits of the solution.
    np.testing.assert_allclose(found, expected, rtol=1e-12)


def test_a_uniform_load_agrees_with_integration_from_clamp_to_tip() -> None:
    force, frequency = hopf(LinearLoad(1.0))
    expected = zero(lambda p, omega: uniform_determinant(p, 1j * omega), (76.0, 196.0))
    # The integration's tolerance of 1e-12, times the growth of its errors.
    np.testing.assert_allclose([force, 2.0 * np.pi * frequency], expected, rtol=1e-10)


@pytest.mark.parametrize("load", [*SMOOTH_LOADS, *POINTS, *POWERS], ids=repr)
def test_a_finer_resolution_moves_no_threshold_and_the_stated_error_covers_it(load: Load) -> None:
    found = onset(load)
    first = linearised(Filament(40, load))
    assert isinstance(first, Polynomials)
    for degree in (3 * first.degree // 2, 9 * first.degree // 4):
        finer = find_onset(Polynomials(load, degree), 0)
        assert found.hopf is not None
        assert finer.hopf is not None
        for stated, error, resolved in [
            (found.hopf.force, found.hopf.error, finer.hopf.force),
            (found.hopf.frequency, found.hopf.frequency_error, finer.hopf.frequency),
            (found.oscillatory_force, found.oscillatory_error, finer.oscillatory_force),
        ]:
            assert stated == pytest.approx(resolved, rel=1e-12)
            # The finer answer has a round-off of its own.
            assert abs(stated - resolved) <= error + 1e-14 * resolved


@pytest.mark.parametrize("load", MAIN_LOADS, ids=repr)
def test_the_three_methods_agree(load: Load) -> None:
    exact, by_modes = np.array(hopf(load)), np.array(hopf(load, "modes"))
    coarse, fine = (np.array(hopf(load, "discrete", segments=n)) for n in (80, 160))
    # 72 modes: of order 72^-4 at the tip, 72^-3 at a point, with the factors of the next test.
    np.testing.assert_allclose(by_modes, exact, rtol=1e-6)
    # Second order, extrapolated: of order 80^-4 with a factor of some units.
    np.testing.assert_allclose((4.0 * fine - coarse) / 3.0, exact, rtol=1e-6)
    order = np.log2((coarse - exact) / (fine - exact))
    np.testing.assert_allclose(order, 2.0, rtol=0.0, atol=0.15)


def test_assumed_modes_converge_at_the_stated_orders() -> None:
    for load, order in [(TipLoad(1.0), 4.0), (LinearLoad(1.0), 5.0), (LinearLoad(1.0, 1.0), 5.0)]:
        found = [find_onset(AssumedModes(load, count), 0).force for count in (30, 60)]
        coarse, fine = (abs(force - hopf(load)[0]) for force in found)
        assert np.log2(coarse / fine) == pytest.approx(order, abs=0.15)
    # A point load converges unevenly: at twice the modes the error falls by 2^3, more or less.
    load = PointLoad(1.0, 0.6)
    found = [find_onset(AssumedModes(load, count), 0).force for count in (10, 80)]
    coarse, fine = (abs(force - hopf(load)[0]) for force in found)
    assert np.log2(coarse / fine) / 3.0 == pytest.approx(3.0, abs=0.5)


@pytest.mark.parametrize("method", ["modes", "discrete"])
@pytest.mark.parametrize("load", [*MAIN_LOADS, LinearLoad(1.0, -1.0)], ids=repr)
def test_the_stated_errors_of_the_other_methods_are_near_the_true_ones(
    load: Load, method: Method
) -> None:
    found = onset(load, method)
    assert found.error is not None
    # An estimate from two resolutions, whose difference has a higher term too.
    assert abs(found.force - hopf(load)[0]) < 1.5 * found.error


# ---------------------------------------------------------------- every profile


def check_onset(load: Load) -> None:
    """Check an answer against the integral equation on either side of each threshold."""
    found = onset(load)
    assert found.force is not None
    assert found.oscillatory_force is not None
    assert found.oscillatory_force <= found.force
    assert under(load, 0.999 * found.force)[0].real < 0.0
    assert under(load, 1.001 * found.force)[0].real > 0.0
    below, above = (under(load, x * found.oscillatory_force)[0] for x in (0.999, 1.001))
    assert below.imag == 0.0
    assert above.imag > 0.0
    # To all digits but those that round-off of ever larger eigenvalues leaves uncertain.
    assert found.error < 1e-11 * found.force


few = settings(max_examples=20, derandomize=True)


@few
@given(slope=st.floats(-1.0, 1.0))
def test_the_onset_of_every_linear_load_is_its_first(slope: float) -> None:
    check_onset(LinearLoad(1.0, slope))


@few
@given(position=st.floats(0.2, 1.0))
def test_the_onset_of_every_point_load_is_its_first(position: float) -> None:
    check_onset(PointLoad(1.0, position))


@few
@given(exponent=st.floats(0.0, 50.0))
def test_the_onset_of_every_power_load_is_its_first(exponent: float) -> None:
    check_onset(PowerLoad(1.0, exponent))


@pytest.mark.parametrize("position", [0.05, 0.1])
def test_a_load_near_the_clamp_has_the_onset_of_a_short_filament_with_a_light_tail(
    position: float,
) -> None:
    load = PointLoad(1.0, position)
    found = np.array(hopf(load)) * [1.0, 2.0 * np.pi]
    expected = zero(
        lambda p, omega: point_determinant(p, 1j * omega, position), (*(1.0001 * found),)
    )
    # The determinant holds terms of exp(30) that cancel.
    np.testing.assert_allclose(found, expected, rtol=1e-8)


def test_a_steep_power_load_tends_to_the_tip_load_as_one_over_its_exponent() -> None:
    force, frequency = hopf(TipLoad(1.0))
    for exponent in (1e3, 1e5):
        found = hopf(PowerLoad(1.0, exponent))
        # Its centre is 1 / exponent away from the tip, where curvature and its slope vanish.
        np.testing.assert_allclose(found, [force, frequency], rtol=1.0 / exponent)
        assert found != (force, frequency)


def test_each_later_crossing_adds_a_pair_that_grows() -> None:
    # Ten functions and more miss the third crossing of this table before they find the fourth.
    uneven = TableLoad(1.0, (0.0, 0.17, 0.3, 1.0), (0.05, 0.175, 0.19, 0.54))
    for load in (TipLoad(1.0), PowerLoad(1.0, 2.5), uneven):
        found = onset(load, later=2)
        assert found.hopf is not None
        assert found.later
        forces = [crossing.force for crossing in (found.hopf, *found.later)]
        assert forces == sorted(forces)
        assert found.searched_to == forces[-1]
        for before, (low, high) in enumerate(pairwise([0.0, *forces]), start=0):
            assert np.count_nonzero(under(load, 0.5 * (low + high)).real > 0.0) == 2 * before
            assert np.count_nonzero(under(load, 0.999 * high).real > 0.0) == 2 * before


@pytest.mark.parametrize("method", ["spectral", "modes", "discrete"])
def test_a_profile_that_pulls_the_tip_never_loses_stability_and_says_so(method: Method) -> None:
    found = onset(PULLING, method)
    assert found.hopf is None
    assert (found.force, found.frequency, found.error) == (None, None, None)
    assert "stable at every force up to" in str(found)
    assert f"{found.searched_to:.4g}" in str(found)
    assert found.searched_to >= 32.0
    for force in np.geomspace(1.0, min(found.searched_to, 1e3), 12):
        # An eigenvalue that approaches 0 from below, to round-off.
        assert under(PULLING, force)[0].real < 1e-9


# ---------------------------------------------------------------- the links


@every_form
@every_load
def test_the_linearised_links_are_the_transverse_blocks_of_the_jacobian(form, load: Load) -> None:
    model = filament(form, load)
    stiffness, drag = model.linearised()
    expected = -np.linalg.solve(drag, stiffness)
    whole = model.jacobian(model.straight())
    n, d = model.links, model.dimension
    blocks = whole.reshape(n, d, n, d)
    # Round-off of a few hundred operations on the largest entries.
    tolerance = {"rtol": 0.0, "atol": 1e-11 * np.abs(whole).max()}
    for across in range(d - 1):
        np.testing.assert_allclose(blocks[:, across, :, across], expected, **tolerance)
        for other in set(range(d)) - {across}:
            np.testing.assert_allclose(blocks[:, across, :, other], 0.0, **tolerance)
    values = spectrum(model, count=n, method="discrete").values
    own = np.linalg.eigvals(expected)
    np.testing.assert_allclose(values, own[np.lexsort((-own.imag, -own.real))], rtol=1e-8)


@pytest.mark.parametrize("segments", [4, 5, 6, 8, 12, 20])
@pytest.mark.parametrize("load", [TipLoad(1.0), LinearLoad(1.0, -1.0)], ids=repr)
def test_few_links_have_an_onset_of_their_own(load: Load, segments: int) -> None:
    model, force = Filament(segments, load), hopf(load, "discrete", segments=segments)[0]
    assert leading_mode(model.with_(force=0.999 * force))[0].real < 0.0
    assert leading_mode(model.with_(force=1.001 * force))[0].real > 0.0


@pytest.mark.parametrize(("force", "sign"), [(72.0, -1.0), (80.0, 1.0)])
@pytest.mark.parametrize("method", ["spectral", "modes", "discrete"])
def test_a_uniform_load_of_72_decays_and_one_of_80_grows(
    force: float, sign: float, method: Method
) -> None:
    # flatironinstitute/SkellySim, tests/combined/test_clamped_buckling_sigma72.py and _sigma80.py.
    rate = spectrum(Filament(40, LinearLoad(force)), method=method).rates[0]
    assert np.sign(rate) == sign


# ---------------------------------------------------------------- the printed equation


def test_the_printed_equation_for_the_curvature_holds_under_a_tip_load_only() -> None:
    for load, tension in [(TipLoad(50.0), [-50.0]), (LinearLoad(50.0), [-50.0, 50.0])]:
        expected = spectrum(Filament(40, load), count=4).values
        corrected = of_the_curvature(np.array(tension), printed=False)[:4]
        # Fourth derivatives of 28 polynomials: their round-off, 28^8 eps, beside 1e4.
        np.testing.assert_allclose(corrected, expected, rtol=1e-6)
        printed = of_the_curvature(np.array(tension), printed=True)[:4]
        if load == TipLoad(50.0):
            np.testing.assert_allclose(printed, expected, rtol=1e-6)
        else:
            assert abs(printed[0] - expected[0]) > 0.1 * abs(expected[0])
