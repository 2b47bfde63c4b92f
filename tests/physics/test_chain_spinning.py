"""Spinning of chains: two links in closed form, and how three and more lose it."""

from typing import NamedTuple

import numpy as np
import pytest
from scipy.optimize import brentq

import undula as un
from chains import tangents_of, virtual_work
from undula.analysis.states.branch import Branch
from undula.analysis.states.relative_equilibrium import rotating_spectrum
from undula.arrays import Array, ComplexArray
from undula.models.chain import Chain
from undula.models.filament import Filament
from undula.models.loads.analytic import TipLoad

FORCES = [6.1, 6.5, 7.0, 8.0, 10.0, 12.2, 20.0, 50.0, 100.0]


def plain(links: int, force: float = 1.0) -> Chain:
    return Chain(links, TipLoad(force))


def spinning(model: Chain) -> un.Spinning:
    found = un.find(model, "spinning")
    assert isinstance(found, un.Spinning)
    return found


# ------------------------------------------------------------------ two links spinning


class TwoLinks(NamedTuple):
    """The spinning state of docs/theory/chains.md, at an inclination."""

    force: float
    rate: float
    inclination: float
    turn: float  # of the second joint
    lag: float  # of the second link's azimuth behind the first one's

    @property
    def bending_energy(self) -> float:
        return 0.5 * self.turn**2

    @property
    def tip_radius(self) -> float:
        return np.sin(self.inclination) * np.cos(0.5 * self.lag)


def g(psi: float) -> float:
    return psi / np.sin(psi)


def inclined(a: float, spring: float, inner: float, outer: float) -> TwoLinks:
    """Return the state whose links are inclined by a to the axis."""
    ratio = inner / outer

    def closure(b: float) -> float:
        share = (np.sin(0.5 * b) / np.sin(a)) ** 2
        return ratio * g(b) * share - spring * g(2.0 * a) * (1.0 - share)

    b = brentq(closure, 1e-12, 2.0 * a * (1.0 - 1e-15), xtol=1e-15, rtol=1e-15)
    stiffened = spring * g(2.0 * a)
    return TwoLinks(
        force=stiffened + (4.0 + ratio) * g(b),
        rate=4.0 * np.sqrt(stiffened * g(b) / (inner * outer)),
        inclination=a,
        turn=b,
        lag=2.0 * np.arctan(np.sqrt(stiffened / (ratio * g(b)))),
    )


def shape_of(state: TwoLinks) -> Array:
    """Return the positions of the beads, the first one in the x-z plane."""
    out, up = np.sin(state.inclination), np.cos(state.inclination)
    first = np.array([out, 0.0, up])
    second = np.array([out * np.cos(state.lag), -out * np.sin(state.lag), up])
    return 0.5 * np.concatenate([first, first + second])


def two_links(force: float, spring: float, inner: float, outer: float) -> TwoLinks:
    """Return the state under a force, which rises with the inclination from 0 to pi/2."""

    def excess(a: float) -> float:
        return inclined(a, spring, inner, outer).force - force

    a = brentq(excess, 1e-4, 0.5 * np.pi - 1e-6, xtol=1e-15, rtol=1e-15)
    return inclined(a, spring, inner, outer)


def assert_is(state: un.Spinning, exact: TwoLinks, spring: float) -> None:
    first, second = tangents_of(state.model, state.x)
    # Newton's method ends at round-off; ten digits are asked for.
    assert abs(state.rate) == pytest.approx(exact.rate, rel=1e-10)
    energy = 0.5 * spring * exact.inclination**2 + exact.bending_energy
    assert state.bending_energy.mean == pytest.approx(energy, rel=1e-10)
    assert state.tip_radius.mean == pytest.approx(exact.tip_radius, rel=1e-10)
    for link in (first, second):
        # Round-off of a cosine next to 1.
        assert link[2] == pytest.approx(np.cos(exact.inclination), rel=1e-12)
    azimuths = np.arctan2([first[1], second[1]], [first[0], second[0]])
    lag = np.sign(state.rate) * (azimuths[0] - azimuths[1]) % (2.0 * np.pi)
    assert lag == pytest.approx(exact.lag, rel=1e-10)


@pytest.mark.parametrize("force", FORCES)
def test_two_links_spin_as_their_closed_form_says(force: float) -> None:
    assert_is(spinning(plain(2, force)), two_links(force, 1.0, 1.0, 1.0), 1.0)


@pytest.mark.parametrize("ends", [(2.0, 1.0, 0.5), (0.3, 0.2, 3.0), (5.0, 4.0, 1.5)])
@pytest.mark.parametrize("part", [1.02, 2.0, 10.0])
def test_with_other_ends_too(ends: tuple[float, float, float], part: float) -> None:
    spring, inner, outer = ends
    force = part * (spring + 4.0 + inner / outer)
    model = Chain(2, TipLoad(force), base_spring=spring, bead_drag=(inner, outer))
    assert_is(spinning(model), two_links(force, *ends), spring)


def test_both_equations_of_the_closed_form_hold_for_its_shape() -> None:
    for a in (0.1, 0.7, 1.2, 1.5):
        found = inclined(a, 2.0, 1.0, 0.5)
        model = Chain(2, TipLoad(found.force), base_spring=2.0, bead_drag=(1.0, 0.5))
        x = shape_of(found)
        first, second = tangents_of(model, x)
        # To the tolerance of the root.
        assert np.arccos(first @ second) == pytest.approx(found.turn, rel=1e-12)
        turning = found.rate * model.rotation_generator(x)
        np.testing.assert_allclose(model.rhs(x), turning, atol=1e-12 * found.force)


def test_force_rate_and_energy_rise_with_the_inclination() -> None:
    for ends in [(1.0, 1.0, 1.0), (0.3, 0.2, 3.0), (5.0, 4.0, 0.1)]:
        found = [inclined(a, *ends) for a in np.linspace(0.01, 1.56, 200)]
        for name in ("force", "rate", "turn", "lag"):
            assert (np.diff([getattr(one, name) for one in found]) > 0.0).all()


def test_two_links_spin_stably_at_every_force_up_to_a_hundred_thousand() -> None:
    for a in np.append(np.linspace(0.02, 1.55, 40), [1.56, 1.57, 1.5706, 1.570785]):
        found = inclined(a, 1.0, 1.0, 1.0)
        model = plain(2, found.force)
        y = model.unknowns(shape_of(found))
        turn, *others = rotating_spectrum(model, y, found.rate)
        # The cube of the distance from folded, 1e-5, is what forces are differences of.
        assert abs(turn) < 1e-6
        assert max(value.real for value in others) < 0.0
    # As the links fold, a pair comes to decay at the rate 2, at the frequency of the spinning.
    assert others[0].real == pytest.approx(-2.0, rel=1e-3)
    assert others[0].imag == pytest.approx(found.rate, rel=1e-3)
    assert found.force > 1e5


def test_two_links_are_followed_from_their_onset_on_without_a_bifurcation() -> None:
    branch = un.follow_from_onset(plain(2), "spinning", 100.0)
    assert isinstance(branch, Branch)
    assert branch.complete
    assert branch.bifurcations == ()
    assert all(state.stable for state in branch.states)
    assert (np.diff(branch.values) > 0.0).all()
    # No pair comes near the axis on the way: rates tend to -2, from where they begin.
    rates = [state.leading_rate for state in branch.states if state.force > 7.0]
    assert -2.0 < min(rates) < max(rates) < -1.0


# ------------------------------------------------------------------ spinning lost

#: Force [K/L], frequency and second frequency [1/T] of docs/notes/chains.md, for N = 3 to 6.
LOST = {
    3: (46.66063, 5.492213, 6.320152),
    4: (43.95065, 7.150147, 8.692541),
    5: (34.45930, 5.856935, 7.698436),
    6: (24.64705, 3.405053, 5.094184),
}


def turning_exponents(state: un.Spinning) -> ComplexArray:
    """Return the exponents of a spinning state from the slow twin, in the turning frame.

    The velocity less that of the turn vanishes at the state, so that its derivative along
    displacements that keep the lengths is one in any coordinates.
    """
    model, step = state.model, 1e-5
    work, columns = virtual_work(model, state.x), []

    def relative(x: Array) -> Array:
        return virtual_work(model, x).velocity - state.rate * model.rotation_generator(x)

    # The state is a solution of the twin as well.
    assert np.abs(relative(state.x)).max() < 1e-9 * abs(state.rate)
    for across in work.displacements.T:
        more, less = (model.admissible(state.x + side * across) for side in (step, -step))
        columns.append(work.rates_of((relative(more) - relative(less)) / (2.0 * step)))
    values = np.linalg.eigvals(np.array(columns).T)
    return values[np.argsort(-values.real)]


@pytest.mark.parametrize("links", LOST)
def test_three_links_and_more_lose_spinning_to_a_second_frequency(links: int) -> None:
    force, frequency, second = LOST[links]
    lost = un.threshold(plain(links), "spinning-lost")
    # The digits of the note.
    assert lost.value == pytest.approx(force, rel=2e-7)
    assert lost.frequency == pytest.approx(frequency, rel=2e-7)
    assert lost.second_frequency == pytest.approx(second, rel=2e-7)
    assert lost.bifurcation == "torus"
    pairs = []
    for part in (0.999, 1.0, 1.001):
        values = turning_exponents(spinning(plain(links, part * force)))
        # One is that of a turn, the two next ones are the pair.
        pairs.append(values[np.abs(values.imag) > 1.0][0])
    slope = (pairs[2].real - pairs[0].real) / (0.002 * force)
    assert pairs[0].real < 0.0 < pairs[2].real
    # The force is rounded to its seventh digit, and the twin's derivative good to 1e-9.
    assert abs(pairs[1].real) < slope * 1e-6 * force
    assert abs(pairs[1].imag) / (2.0 * np.pi) == pytest.approx(second, rel=1e-6)


@pytest.mark.parametrize("force", [6.5, 12.0, 50.0, 100.0])
def test_the_exponents_of_two_links_are_those_of_the_slow_twin(force: float) -> None:
    state = spinning(plain(2, force))
    expected = turning_exponents(state)
    found = np.append(state.exponents, state.trivial)
    for value in expected:
        # Central differences: the square of the step times third derivatives of folded joints.
        assert np.abs(found - value).min() < 1e-6 * abs(state.rate)


# ------------------------------------------------------------------ runs


@pytest.mark.parametrize(("links", "force"), [(2, 8.0), (2, 20.0), (3, 8.0), (3, 30.0)])
def test_a_run_spins_at_the_frequency_solved_for(links: int, force: float) -> None:
    model = plain(links, force)
    run = un.integrate(model, un.kicked(model, 0.1), until="settled", limit=200.0)
    state = spinning(model)
    assert run.verdict.name == "spinning"
    assert run.frequency is not None
    # What is left of its shape's change when it counts as settled, and its steps.
    assert abs(run.frequency.value) == pytest.approx(state.frequency, rel=1e-6)
    energy = run.window.energetics.bending_energy[-1]
    assert energy == pytest.approx(state.bending_energy.mean, rel=1e-3)


# ------------------------------------------------------------------ many links


def test_many_links_spin_to_second_order_like_a_filament_longer_by_one() -> None:
    limit = un.find(Filament(20, TipLoad(75.0), drag_ratio=1.0), "spinning", converged=True).values
    links, errors = np.array([10, 20, 40]), []
    for n in links:
        stretch = 1.0 + 1.0 / n
        state = spinning(plain(n, 75.0 / (n * stretch**2)))
        frequency = n**2 * stretch**4 * state.frequency
        energy = n * stretch * state.bending_energy.mean
        errors.append([frequency / limit["frequency"], energy / limit["bending_energy"]])
    orders = -np.polyfit(np.log(links), np.log(np.abs(np.array(errors) - 1.0)), 1)[0]
    np.testing.assert_allclose(orders, 2.0, atol=0.15)
