"""Claims on loads: how much force each link carries and where, and what is refused."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numpy.polynomial import chebyshev

import naive
from cases import every_load
from refusal import complaint
from undula.arrays import Points
from undula.models.loads.analytic import LinearLoad, Load, PointLoad, TipLoad
from undula.models.loads.power import PowerLoad
from undula.models.loads.user_density import ProfileLoad, TableLoad


def stepped(s: Points) -> Points:
    return np.where(s < 0.3, 1.0, 3.0)


#: Profiles as a user may give them, with their centres, integrated by hand.
PROFILES = {
    ProfileLoad(1.0, np.exp): 1.0 / (math.e - 1.0),
    ProfileLoad(1.0, stepped, (0.3,)): 1.41 / 2.4,
}


@st.composite
def tables(draw: st.DrawFn) -> TableLoad:
    inner = draw(st.lists(st.integers(1, 999), unique=True, max_size=6))
    values = st.just(0.0) | st.floats(1e-3, 1e3)
    density = draw(st.lists(values, min_size=len(inner) + 2, max_size=len(inner) + 2).filter(any))
    return TableLoad(draw(forces), [0.0, *(i / 1000 for i in sorted(inner)), 1.0], density)


# No subnormal numbers, which have no relative accuracy.
forces = st.just(0.0) | st.floats(1e-3, 1e3)
links = st.integers(4, 80)
positions = st.floats(1e-6, 1.0)
loads = st.one_of(
    st.builds(TipLoad, forces),
    st.builds(PointLoad, forces, positions),
    st.builds(LinearLoad, forces, st.floats(-1.0, 1.0)),
    st.builds(PowerLoad, forces, st.floats(0.0, 50.0)),
    tables(),
    st.builds(lambda load, force: replace(load, force=force), st.sampled_from([*PROFILES]), forces),
)


def centre(load: Load) -> float:
    """Return the arc length at which the whole load would have the same first moment."""
    if isinstance(load, PointLoad):
        return load.position
    if isinstance(load, LinearLoad):
        return 0.5 + load.slope / 6.0
    if isinstance(load, TableLoad):
        lines = list(zip(pairwise(load.s), pairwise(load.density), strict=True))
        total = sum((b - a) * (low + high) / 2.0 for (a, b), (low, high) in lines)
        moments = (
            (b - a) * (low * (2 * a + b) + high * (a + 2 * b)) / 6.0
            for (a, b), (low, high) in lines
        )
        return sum(moments) / total
    if isinstance(load, ProfileLoad):
        return PROFILES[replace(load, force=1.0)]
    assert isinstance(load, PowerLoad)
    return (load.exponent + 1.0) / (load.exponent + 2.0)


@given(loads, links)
def test_the_shares_add_up_to_the_force(load: Load, links: int) -> None:
    head, foot = load.shares(links)
    # Shares of spread loads are differences of integrals times the number of links.
    assert abs((head + foot).sum() - load.force) <= 1e-15 * links**2 * load.force


@given(loads, links)
def test_the_shares_have_the_first_moment_of_the_load(load: Load, links: int) -> None:
    head, foot = load.shares(links)
    node = np.linspace(0.0, 1.0, links + 1)
    moment = head @ node[1:] + foot @ node[:-1]
    assert abs(moment - load.force * centre(load)) <= 1e-15 * links**2 * load.force  # as above


@given(loads, st.integers(4, 20))
@settings(max_examples=40)
def test_each_share_is_the_integral_over_its_link(load: Load, links: int) -> None:
    naive_head, naive_foot = naive.shares(load, links)
    head, foot = load.shares(links)
    # What the quadrature is asked for.
    assert np.abs(head - naive_head).max() <= 1e-9 * load.force
    assert np.abs(foot - naive_foot).max() <= 1e-9 * load.force


@given(loads, links)
def test_no_share_pulls(load: Load, links: int) -> None:
    # Not a single one where nothing is subtracted; else down to the round-off told above.
    tolerance = 0.0 if isinstance(load, PointLoad) else 1e-15 * links**2 * load.force
    assert min(np.min(share) for share in load.shares(links)) >= -tolerance


@given(position=st.floats(1e-6, 1.0 - 1e-6), links=links)
# The ends of links and their middles, the first and the last of them: where formulas change.
@example(0.5, 10)
@example(0.05, 10)
@example(0.25, 10)
@example(0.95, 10)
@example(0.9, 10)
def test_moving_a_point_load_a_little_changes_its_shares_a_little(
    position: float, links: int
) -> None:
    step = 1e-7
    for low, high in ((position - step, position), (position, position + step)):
        before, after = PointLoad(1.0, low).shares(links), PointLoad(1.0, high).shares(links)
        # No share changes faster than the whole force over one link; round-off beside it.
        limit = 1.01 * links * step + 1e-14 * links
        assert all(np.abs(b - a).max() <= limit for a, b in zip(before, after, strict=True))


def test_a_point_load_acts_on_the_links_whose_middles_enclose_it() -> None:
    head, foot = PointLoad(8.0, 0.5 + 0.025).shares(10)  # a quarter from the middle of link 4 on
    expected = np.zeros(10)
    expected[4:6] = 0.5 * 8.0 * np.array([0.25, 0.75])
    # Round-off of 0.525 times 10.
    np.testing.assert_allclose(head, expected, atol=1e-13)
    np.testing.assert_allclose(foot, expected, atol=1e-13)


def test_the_tip_load_acts_on_the_last_node_alone() -> None:
    head, foot = TipLoad(75.0).shares(10)
    assert head.tolist() == [0.0] * 9 + [75.0]
    assert foot.tolist() == [0.0] * 10


@given(forces, links)
def test_the_tip_load_is_the_point_load_at_the_tip(force: float, links: int) -> None:
    assert np.array_equal(TipLoad(force).shares(links), PointLoad(force, 1.0).shares(links))


@given(forces, links)
def test_the_power_one_is_the_linear_load_of_slope_one(force: float, links: int) -> None:
    linear, power = LinearLoad(force, 1.0), PowerLoad(force, 1.0)
    # Different powers of s, subtracted: round-off as for sums.
    limit = 1e-15 * links**2 * force
    np.testing.assert_allclose(power.shares(links), linear.shares(links), rtol=0.0, atol=limit)


@given(forces, links)
def test_the_power_zero_and_the_slope_zero_are_uniform(force: float, links: int) -> None:
    uniform = np.full((2, links), 0.5 * force / links)
    limit = 1e-15 * links**2 * force  # as above
    for load in (LinearLoad(force, 0.0), PowerLoad(force, 0.0)):
        np.testing.assert_allclose(load.shares(links), uniform, rtol=0.0, atol=limit)


@every_load
def test_shares_are_proportional_to_the_force(load: Load) -> None:
    double = replace(load, force=2.0 * load.force)
    # A power of two scales without rounding.
    assert np.array_equal(double.shares(12), 2.0 * np.array(load.shares(12)))


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, -1e-300, -75.0])
@pytest.mark.parametrize("load", [TipLoad, PointLoad, LinearLoad, PowerLoad])
def test_a_force_that_is_none_is_refused_by_name(load: type[Load], value: float) -> None:
    assert f"{load.__name__}: force = {value}" in complaint(lambda: load(value))


@pytest.mark.parametrize("position", [0.0, -0.5, 1.1, 1.0 + 1e-15, math.nan, math.inf])
def test_a_position_off_the_filament_is_refused_by_name(position: float) -> None:
    sentence = complaint(lambda: PointLoad(75.0, position))
    assert f"position = {position}" in sentence
    assert "(0, 1]" in sentence


@pytest.mark.parametrize("slope", [2.0, -1.0 - 1e-15, math.nan, -math.inf])
def test_a_slope_that_makes_the_load_pull_is_refused_by_name(slope: float) -> None:
    sentence = complaint(lambda: LinearLoad(75.0, slope))
    assert f"slope = {slope}" in sentence
    assert "[-1, 1]" in sentence


@pytest.mark.parametrize("exponent", [-1e-15, -1.0, math.nan, math.inf])
def test_an_exponent_that_concentrates_the_load_at_the_clamp_is_refused_by_name(
    exponent: float,
) -> None:
    assert f"exponent = {exponent}" in complaint(lambda: PowerLoad(75.0, exponent))


@given(loads)
def test_breaks_lie_inside_the_filament_and_increase(load: Load) -> None:
    ends = (0.0, *load.breaks, 1.0)
    assert all(a < b for a, b in pairwise(ends))


def unresolved(load: Load, skip: int = 0) -> float:
    """Return how far degree 20 misses the force below, at worst, after the first `skip` pieces."""
    nodes, between = chebyshev.chebpts1(21), np.cos(np.linspace(0.0, np.pi, 200))
    missed = 0.0
    for a, b in list(pairwise((0.0, *load.breaks, 1.0)))[skip:]:
        # A point load's own value at its position belongs to the piece beyond.
        at_nodes, at_between = (
            np.array(
                load.force_below(np.clip(a + 0.5 * (b - a) * (1.0 + x), a, np.nextafter(b, a)))
            )
            for x in (nodes, between)
        )
        series = chebyshev.chebfit(nodes, at_nodes, 20)
        missed = max(missed, np.abs(chebyshev.chebval(between, series) - at_between).max())
    return missed / load.force


@pytest.mark.parametrize(
    "load",
    [
        TipLoad(75.0),
        PointLoad(75.0, 0.37),
        LinearLoad(75.0, -0.4),
        *(PowerLoad(75.0, p) for p in (0.0, 1.0, 7.0, 8.5, 12.0, 17.9)),
        *(PowerLoad(75.0, p) for p in (18.1, 20.001, 22.0, 22.3, 25.0, 40.001, 44.5, 60.0, 1e3)),
        TableLoad(75.0, (0.0, 0.2, 0.5, 1.0), (1.0, 3.0, -1.0, 2.0)),
        ProfileLoad(75.0, stepped, (0.3,)),
        ProfileLoad(75.0, lambda s: np.cosh(30.0 * s)),
    ],
    ids=repr,
)
def test_between_breaks_a_polynomial_of_degree_20_resolves_the_load(load: Load) -> None:
    # Round-off of the series and of steep powers of rounded arc lengths.
    assert unresolved(load) <= 2e-13


@pytest.mark.parametrize("exponent", [1e5, 1e6])
def test_a_power_of_any_steepness_is_resolved_as_far_as_its_arc_lengths_are(
    exponent: float,
) -> None:
    # An arc length rounded by 1e-16 changes s^p by p times as much.
    assert unresolved(PowerLoad(75.0, exponent)) <= 1e-16 * exponent + 2e-13


@pytest.mark.parametrize("exponent", [0.01, 0.5, 1.5, 2.5, 7.5])
def test_the_singularity_of_a_power_is_kept_to_the_first_piece(exponent: float) -> None:
    load = PowerLoad(75.0, exponent)
    assert unresolved(load, skip=1) <= 2e-13  # round-off
    # At the clamp itself the series converges slowly, from what is small.
    assert unresolved(load) <= 3e-6


@pytest.mark.parametrize("exponent", [3e16, 1e17, 3e17, 1e300])
def test_a_layer_too_thin_for_numbers_has_no_break_in_it(exponent: float) -> None:
    breaks = PowerLoad(75.0, exponent).breaks
    assert sorted(set(breaks)) == list(breaks)
    assert all(s < 1.0 for s in breaks)
