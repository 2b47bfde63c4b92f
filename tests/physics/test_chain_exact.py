"""Chains on the verge of moving: thresholds in closed form, in fifty digits, and for many links."""

from functools import cache

import numpy as np
import pytest

import undula as un
from chains import OPTIONS, chain
from exact_chain import exact_hopf
from refusal import complaint
from undula.analysis.linear.results import Method, Onset
from undula.arrays import Array
from undula.models.chain import Chain
from undula.models.filament import Filament
from undula.models.loads.analytic import TipLoad

ENDS = [(1.0, 1.0, 1.0), (2.0, 1.0, 0.5), (0.3, 0.2, 3.0), (5.0, 4.0, 0.1)]
every_end = pytest.mark.parametrize(("spring", "inner", "outer"), ENDS)


@cache
def onset(links: int, *, of_filament: bool = False) -> Onset:
    return un.onset(chain_of(links, of_filament=of_filament), later=0)


def chain_of(links: int, *, of_filament: bool = False) -> Chain:
    """Return a chain with plain ends, or with those of a filament."""
    if not of_filament:
        return Chain(links, TipLoad(1.0))
    ends = (*[1.0] * (links - 1), 0.5)
    return Chain(links, TipLoad(1.0), base_spring=2.0, bead_drag=ends)


def hopf(links: int, *, of_filament: bool = False) -> tuple[float, float]:
    """Return the Hopf force and the angular frequency there."""
    found = onset(links, of_filament=of_filament).hopf
    assert found is not None
    return found.force, 2.0 * np.pi * found.frequency


# ------------------------------------------------------------------ in fifty digits


def exactly(links: int, *, of_filament: bool = False) -> tuple[float, float]:
    """Return the Hopf point next to the one found."""
    force, omega = hopf(links, of_filament=of_filament)
    # A thousandth off: near enough to be the same crossing, far enough to have to be found.
    ends = ("2", "0.5") if of_filament else ("1", "1")
    return exact_hopf(links, (1.001 * force, 1.001 * omega), ends)


@pytest.mark.parametrize("of_filament", [False, True])
@pytest.mark.parametrize("links", [2, 3, 4, 5, 6, 10, 20, 40])
def test_hopf_points_have_ten_digits(links: int, of_filament: bool) -> None:
    found = hopf(links, of_filament=of_filament)
    # Round-off grows as the fourth power of the links, to 1e-10 for 40 of them.
    np.testing.assert_allclose(found, exactly(links, of_filament=of_filament), rtol=1e-10)


@pytest.mark.parametrize(
    "links", [2, 3, 6, 20, 100, 200, pytest.param(1000, marks=pytest.mark.slow)]
)
def test_the_stated_error_of_a_threshold_covers_the_true_one(links: int) -> None:
    found = onset(links).hopf
    assert found is not None
    force, omega = exactly(links)
    # The exact values are rounded to doubles.
    assert abs(found.force - force) <= found.error + 2e-16 * force
    assert abs(2.0 * np.pi * found.frequency - omega) <= 2.0 * np.pi * (
        found.frequency_error + 2e-16 * omega
    )
    assert found.error < 1e-4 * force


@pytest.mark.parametrize("links", [2, 3, 6, 20])
def test_no_disturbance_grows_below_the_threshold_and_one_pair_above(links: int) -> None:
    force = hopf(links)[0]
    for part in (0.0, 0.3, 0.6, 0.9, 0.999):
        assert un.spectrum(chain_of(links), part * force, count=links).rates[0] < 0.0
    beyond = un.spectrum(chain_of(links), 1.001 * force, count=links)
    assert np.count_nonzero(beyond.rates > 0.0) == 2


@pytest.mark.parametrize("option", OPTIONS)
@pytest.mark.parametrize("links", [1, 2, 3, 5])
def test_the_product_of_all_eigenvalues_knows_no_force(option: str, links: int) -> None:
    model = chain(links, option)
    weights = np.ones(links) * model.bead_drag
    expected = model.base_spring * np.prod(float(links) ** 2 / weights)
    for force in (0.0, 3.0, 50.0):
        values = un.spectrum(model, force, count=links).values
        # Under 50 K/L the largest of five is 1e6 times the smallest, which keeps ten digits.
        assert np.prod(-values) == pytest.approx(expected, rel=1e-8)


# ------------------------------------------------------------------ two links


def quadratic(spring: float, inner: float, outer: float, force: float) -> list[float]:
    """Return the characteristic polynomial of two links, docs/theory/chains.md."""
    middle = 4.0 / inner * (spring + 4.0 + inner / outer - force)
    return [1.0, middle, 16.0 * spring / (inner * outer)]


@every_end
@pytest.mark.parametrize("force", [0.0, 2.0, 7.0, 40.0])
def test_two_links_have_the_eigenvalues_of_their_quadratic(
    spring: float, inner: float, outer: float, force: float
) -> None:
    model = Chain(2, TipLoad(force), base_spring=spring, bead_drag=(inner, outer))
    expected = np.roots(quadratic(spring, inner, outer, force)).astype(complex)
    expected = expected[np.lexsort((-expected.imag, -expected.real))]
    # Next to a coalescence eigenvalues keep half of their digits; none of these is very near.
    np.testing.assert_allclose(un.spectrum(model, count=2).values, expected, rtol=1e-11)


@every_end
def test_two_links_have_thresholds_in_closed_form(
    spring: float, inner: float, outer: float
) -> None:
    model = Chain(2, TipLoad(1.0), base_spring=spring, bead_drag=(inner, outer))
    found, ratio = un.onset(model), inner / outer
    assert found.hopf is not None
    # A few operations on doubles.
    assert found.hopf.force == pytest.approx(spring + 4.0 + ratio, rel=1e-13)
    omega = 4.0 * np.sqrt(spring / (inner * outer))
    assert 2.0 * np.pi * found.hopf.frequency == pytest.approx(omega, rel=1e-13)
    ringing = 4.0 + (np.sqrt(spring) - np.sqrt(ratio)) ** 2
    assert found.oscillatory_force == pytest.approx(ringing, rel=1e-13)
    assert found.hopf.growth_slope == pytest.approx(2.0 / inner, rel=1e-12)


def test_two_links_ring_from_4_on_and_oscillate_from_6_on_with_an_angular_frequency_of_4() -> None:
    found = onset(2)
    assert found.hopf is not None
    assert found.oscillatory_force == pytest.approx(4.0, rel=1e-14)
    assert found.hopf.force == pytest.approx(6.0, rel=1e-14)
    assert 2.0 * np.pi * found.hopf.frequency == pytest.approx(4.0, rel=1e-14)


def test_in_units_of_k_over_a_link_two_links_are_straight_at_2_and_oscillate_at_4() -> None:
    model = Chain(2, TipLoad(1.0))
    for per_link, grows in ((2.9, False), (3.1, True), (4.0, True)):
        force = per_link / model.units.forces["K/l"]
        assert (un.spectrum(model, force).rates[0] > 0.0) == grows


# ------------------------------------------------------------------ three links


def real_roots(coefficients: list[float]) -> Array:
    roots = np.roots(coefficients)
    return np.sort(roots.real[np.abs(roots.imag) < 1e-9])


def test_three_links_have_the_thresholds_of_their_cubic() -> None:
    (force,) = real_roots([4.0, -100.0, 816.0, -2151.0])
    omega = np.sqrt(27.0 * force**2 - 432.0 * force + 1620.0)
    # The roots of a cubic are solved for to some units of the last digit.
    np.testing.assert_allclose(hopf(3), [force, omega], rtol=1e-13)
    discriminant = [4.0, -224.0, 5152.0, -62088.0, 410760.0, -1397088.0, 1861461.0]
    # Coefficients of a million leave a sixth of the digits less.
    assert onset(3).oscillatory_force == pytest.approx(real_roots(discriminant)[0], rel=1e-11)


@pytest.mark.parametrize("force", [0.0, 3.0, 5.0, 30.0])
def test_three_links_have_the_eigenvalues_of_their_cubic(force: float) -> None:
    cubic = [1.0, 108.0 - 12.0 * force, 27.0 * force**2 - 432.0 * force + 1620.0, 729.0]
    values = un.spectrum(chain_of(3), force, count=3).values
    np.testing.assert_allclose(np.poly(values).real, cubic, rtol=1e-11)


# ------------------------------------------------------------------ many links

LINKS = [20, 40, 80, 160]


def converged_onset() -> tuple[float, float]:
    found = un.onset(Filament(40, TipLoad(1.0)), later=0)
    assert found.force is not None
    assert found.frequency is not None
    return found.force, 2.0 * np.pi * found.frequency


def errors(*, of_filament: bool, longer: float = 0.0) -> Array:
    """Return the relative errors of N F and N^2 omega, shape (2, 4).

    They may be seen as those of a filament that is longer by some links.
    """
    stretch = 1.0 + longer / np.array(LINKS)
    force, omega = np.transpose([hopf(n, of_filament=of_filament) for n in LINKS])
    scaled = np.array([LINKS * force * stretch**2, np.square(LINKS) * omega * stretch**4])
    return scaled / np.array(converged_onset())[:, None] - 1.0


def orders(of: Array) -> Array:
    return -np.polyfit(np.log(LINKS), np.log(np.abs(of.T)), 1)[0]


def test_plain_ends_tend_to_the_filament_with_first_order() -> None:
    # Orders are fitted within 0.15, as everywhere.
    np.testing.assert_allclose(orders(errors(of_filament=False)), 1.0, atol=0.15)


def test_the_filaments_ends_make_it_second_order() -> None:
    np.testing.assert_allclose(orders(errors(of_filament=True)), 2.0, atol=0.15)


def test_a_plain_chain_is_to_second_order_a_filament_longer_by_one_link() -> None:
    np.testing.assert_allclose(orders(errors(of_filament=False, longer=1.0)), 2.0, atol=0.15)
    # So the first order is -2/N for the force and -4/N for the frequency.
    for share, expected in zip(errors(of_filament=False), (-2.0, -4.0), strict=True):
        first = LINKS * share
        limit = 2.0 * first[-1] - first[-2]
        # What is left of the third order at 160 links.
        assert limit == pytest.approx(expected, abs=0.01)


# ------------------------------------------------------------------ what is asked and refused


def test_a_chain_is_judged_link_by_link_without_being_asked_to() -> None:
    assert onset(3).method == "discrete"
    assert un.spectrum(chain_of(3)).method == "discrete"
    assert un.growth_curve(chain_of(3), [1.0]).method == "discrete"
    assert onset(3) == un.onset(chain_of(3), method="discrete", later=0)


@pytest.mark.parametrize("method", ["spectral", "modes"])
def test_the_methods_of_the_continuum_are_refused(method: Method) -> None:
    sentence = complaint(lambda: un.onset(chain_of(3), method=method))
    assert "no continuous inextensible filament" in sentence
    assert sentence.endswith("use method = 'discrete'")


def test_the_links_of_a_chain_have_no_limit() -> None:
    for ask in (
        lambda: un.find(chain_of(3).with_(force=8.0), "spinning", converged=True),
        lambda: un.threshold(chain_of(3), "spinning-lost", converged=True),
    ):
        assert "links of this model are its body" in complaint(ask)


@pytest.mark.parametrize("option", OPTIONS)
def test_one_link_has_no_threshold_and_says_so(option: str) -> None:
    model = chain(1, option)
    found = un.onset(model)
    assert found.hopf is None
    assert found.oscillatory_force is None
    assert str(found).startswith("straight and stable at every force up to")
    for kind in ("onset", "spinning-lost", "flapping-gained", "flapping-lost"):
        told = un.threshold(model, kind)
        assert told.value is None
        assert told.reason == str(un.onset(model, later=0))
    assert not un.find(model, "spinning")
    assert not un.follow_from_onset(model, "flapping", 10.0)
