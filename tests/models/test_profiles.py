"""Claims on loads whose density the user gives: what they equal, what they refuse."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from refusal import complaint
from undula.arrays import Points
from undula.models.filament import Filament
from undula.models.loads.analytic import LinearLoad, Load
from undula.models.loads.power import PowerLoad
from undula.models.loads.user_density import ProfileLoad, TableLoad

S = np.linspace(0.0, 1.0, 1001)


def difference(load: Load, other: Load) -> float:
    """Return how far two loads of one force are apart, relative to it, in force or in moment."""
    force = np.abs(load.force_below(S) - other.force_below(S)).max()
    moment = np.abs(load.moment_below(S) - other.moment_below(S)).max()
    return float(max(force, moment)) / load.force


@given(st.floats(-1.0, 1.0), st.lists(st.integers(1, 999), unique=True, max_size=30))
def test_a_table_of_a_linear_density_is_the_linear_load(slope: float, inner: list[int]) -> None:
    s = np.array([0, *sorted(inner), 1000]) / 1000
    load = TableLoad(75.0, s, 1.0 + slope * (2.0 * s - 1.0))
    assert difference(load, LinearLoad(75.0, slope)) <= 1e-14  # round-off of 30 pieces
    assert load.breaks == ()


@pytest.mark.parametrize("exponent", [0.0, 1.0, 3.0, 7.5, 30.0])
def test_a_profile_of_a_power_is_the_power_load(exponent: float) -> None:
    load = ProfileLoad(75.0, lambda s: s**exponent)
    # What the function is followed to, relative to its largest value.
    assert difference(load, PowerLoad(75.0, exponent)) <= 1e-13


def test_a_profile_of_straight_lines_is_the_table() -> None:
    s, density = (0.0, 0.2, 0.7, 1.0), (1.0, -0.5, 3.0, 2.0)
    profile = ProfileLoad(75.0, lambda x: np.interp(x, s, density), s[1:-1])
    assert difference(profile, TableLoad(75.0, s, density)) <= 1e-14  # round-off
    assert profile.breaks == TableLoad(75.0, s, density).breaks == s[1:-1]


def test_an_oscillating_density_is_followed_to_round_off() -> None:
    load = ProfileLoad(75.0, lambda s: 1.0 + np.cos(300.0 * s))
    below = (S + np.sin(300.0 * S) / 300.0) / (1.0 + math.sin(300.0) / 300.0)
    assert np.abs(load.force_below(S) - 75.0 * below).max() <= 1e-13 * 75.0  # as promised


def test_a_jump_given_as_a_kink_is_kept_exactly() -> None:
    load = ProfileLoad(24.0, lambda s: np.where(s < 0.3, 1.0, 3.0), [0.3])
    below = np.where(S < 0.3, S, 0.3 + 3.0 * (S - 0.3)) / 2.4
    assert np.abs(load.force_below(S) - 24.0 * below).max() <= 1e-14 * 24.0  # round-off
    assert load.breaks == (0.3,)


def test_a_narrow_load_between_two_kinks_is_found() -> None:
    # Narrower than what is looked at anywhere else.
    load = ProfileLoad(75.0, lambda s: 1e6 * ((s > 0.7) & (s < 0.7001)), (0.7, 0.7001))
    assert load.force_below(np.array([0.0, 0.7, 0.7001, 1.0])) == pytest.approx([0, 0, 75, 75])


def test_a_steep_change_is_followed_by_short_pieces_where_it_is() -> None:
    load = ProfileLoad(75.0, lambda s: 1.0 + np.tanh((s - 0.4) / 1e-3))
    pieces = np.diff([0.0, *load.breaks, 1.0])
    assert pieces.min() < 4e-3
    assert len(pieces) < 30
    # log(cosh) of large arguments without their exponentials.
    at = np.abs(S - 0.4) / 1e-3
    grown = S - 0.4 + 1e-3 * (at + np.log1p(np.exp(-2.0 * at)))
    below = (grown - grown[0]) / (grown[-1] - grown[0])
    assert np.abs(load.force_below(S) - 75.0 * below).max() <= 1e-13 * 75.0  # as promised


@pytest.mark.parametrize(
    ("density", "place"),
    [
        (lambda s: np.abs(np.sin(20.0 * s)), math.pi / 20.0),
        (lambda s: np.where(s < 0.3, 1.0, 2.0), 0.3),
        (lambda s: 1.0 + np.abs(s - 0.6), 0.6),
        (lambda s: 1.0 / np.sqrt(s), 0.0),
        (lambda s: np.sqrt(1.0 - s), 1.0),
    ],
)
def test_a_place_that_is_not_smooth_is_named(
    density: Callable[[Points], Any], place: float
) -> None:
    sentence = complaint(lambda: ProfileLoad(75.0, density))
    assert "kinks" in sentence
    told = float(sentence.split("near s = ")[1].split(";")[0])
    assert told == pytest.approx(place, abs=2e-6)  # pieces of a millionth, and six digits


def test_named_kinks_are_what_makes_it_smooth() -> None:
    kinks = np.arange(1, 7) * np.pi / 20.0
    load = ProfileLoad(75.0, lambda s: np.abs(np.sin(20.0 * s)), kinks)
    arches = np.floor(20.0 * S / np.pi)
    below = (1.0 + 2.0 * arches - np.cos(20.0 * S - arches * np.pi)) / 20.0
    assert (
        np.abs(load.force_below(S) - 75.0 * below / below[-1]).max() <= 1e-13 * 75.0
    )  # as promised


@pytest.mark.parametrize(
    "density", [lambda s: 1.0 + np.cos(1e4 * s), lambda s: np.modf(1e4 * np.sin(1e4 * s))[0] ** 2]
)
def test_a_density_of_too_many_features_is_refused(density: Callable[[Points], Any]) -> None:
    assert "not smooth near s = " in complaint(lambda: ProfileLoad(75.0, density))


@given(st.integers(-300, 300))
def test_the_scale_of_a_density_is_irrelevant(power: int) -> None:
    # A power of two scales without rounding.
    scale, s, density = 2.0**power, [0.0, 0.4, 1.0], np.array([1.0, -0.25, 3.0])
    assert difference(TableLoad(75.0, s, scale * density), TableLoad(75.0, s, density)) == 0.0
    assert (
        difference(ProfileLoad(75.0, lambda x: scale * np.exp(x)), ProfileLoad(75.0, np.exp)) == 0.0
    )


@pytest.mark.parametrize("scale", [1e-320, 1e308])
def test_no_scale_is_too_small_or_too_large(scale: float) -> None:
    load = TableLoad(75.0, (0.0, 1.0), (scale, scale))
    assert difference(load, LinearLoad(75.0, 0.0)) <= 1e-15  # round-off


def test_shares_pull_where_the_density_does() -> None:
    load = TableLoad(75.0, (0.0, 0.3, 0.5, 1.0), (3.0, -1.0, -1.0, 4.0))
    head, foot = load.shares(10)
    assert ((head[3:5] < 0.0) & (foot[3:5] < 0.0)).all()
    assert head.sum() + foot.sum() == pytest.approx(75.0, rel=1e-13)  # round-off


@pytest.mark.parametrize("s", [[0.0, 0.5, 1.0], (0, 0.5, 1), np.linspace(0.0, 1.0, 3)])
def test_tables_of_equal_numbers_are_equal(s: Sequence[float]) -> None:
    load = TableLoad(75.0, s, [1, 2, 3])
    other = TableLoad(75.0, (0.0, 0.5, 1.0), (1.0, 2.0, 3.0))
    assert load == other
    assert hash(load) == hash(other)
    assert load != replace(other, density=(1.0, 2.0, 4.0))


def test_the_ends_of_a_table_are_freed_from_round_off() -> None:
    assert TableLoad(75.0, [1e-13, 0.5, 1.0 - 1e-13], [1, 2, 3]).s == (0.0, 0.5, 1.0)


def test_a_profile_is_told_by_the_name_of_its_function_and_equals_itself() -> None:
    load = ProfileLoad(75.0, np.exp, [0.7, 0.2, 0.7])
    assert repr(load) == "ProfileLoad(force=75.0, density=exp, kinks=(0.2, 0.7))"
    assert load == ProfileLoad(75.0, np.exp, (0.2, 0.7)) != ProfileLoad(75.0, np.exp)
    assert hash(load) == hash(ProfileLoad(75.0, np.exp, (0.2, 0.7)))
    np.testing.assert_array_equal(load.density(S), np.exp(S))


def test_another_force_does_not_call_the_function_again() -> None:
    calls = []

    def density(s: Points) -> Points:
        calls.append(s.size)
        return np.exp(s)

    model = Filament(12, ProfileLoad(75.0, density))
    known = len(calls)
    head = model.with_(force=150.0).system.outer_force
    assert len(calls) == known
    # A power of two scales without rounding.
    np.testing.assert_array_equal(head, 2.0 * model.system.outer_force)


def test_another_density_or_other_kinks_are_resolved_anew() -> None:
    load = ProfileLoad(75.0, np.exp)
    assert replace(load, kinks=(0.5,)).breaks == (0.5,)
    other = replace(load, density=np.cos)
    assert other == ProfileLoad(75.0, np.cos)
    assert difference(other, ProfileLoad(75.0, np.cos)) == 0.0


def test_a_function_may_spoil_its_argument() -> None:
    def density(s: Points) -> Points:
        s *= s
        return s

    assert difference(ProfileLoad(75.0, density), PowerLoad(75.0, 2.0)) <= 1e-13  # as above


@pytest.mark.parametrize(
    ("s", "density", "sentence"),
    [
        ([0, 1], [1, 2, 3], "density has 3 values, where s has 2; give one at each arc length"),
        ([0], [1], "s has 1 value; give at least 2, from 0 to 1"),
        ([], [], "s has 0 values; give at least 2, from 0 to 1"),
        ([0, 0.5, 1], [1, math.nan, 2], "density[1] = nan has to be a finite number"),
        (np.array([0.0, 1.0]), np.array([1.0, -np.inf]), "density[1] = -inf has to be a finite"),
        ([0, np.float64("nan")], [1, 2], "s[1] = nan has to be a finite number"),
        ([0, "1"], [1, 2], "s[1] = '1' has to be a finite number"),
        ([False, 1], [1, 2], "s[0] = False has to be a finite number"),
        (np.eye(2), [1, 2], "s[0] = [1.0, 0.0] has to be a finite number"),
        (0.5, [1, 2], "s = 0.5 has to be a sequence of numbers"),
        ([0, 0.5, 0.5, 1], [1] * 4, "s[2] = 0.5 does not exceed s[1] = 0.5"),
        ([0, 1, 0.5], [1] * 3, "s[2] = 0.5 does not exceed s[1] = 1"),
        ([0, 0.5, 0.9], [1] * 3, "s runs from 0.0 to 0.9; give the density from s = 0, the clamp,"),
        ([1e-11, 1], [1, 1], "s runs from 1e-11 to 1.0"),
        ([-1, 0, 1], [1] * 3, "s runs from -1.0 to 1.0"),
        ([0, 1], [1, -3], "density adds up to -1; a follower force that pushes has to have a"),
        ([0, 1], [1, -1], "density adds up to 0; a follower force"),
        ([0, 1], [0, 0], "density adds up to 0; a follower force"),
    ],
)
def test_a_table_that_is_no_load_is_refused_by_name(s: Any, density: Any, sentence: str) -> None:
    assert complaint(lambda: TableLoad(75.0, s, density)).startswith(f"TableLoad: {sentence}")


def broken(_: Points) -> Points:
    raise KeyError("no such\nmaterial")


@pytest.mark.parametrize(
    ("density", "sentence"),
    [
        (np.ones(3), "density is of type ndarray; give a function of arc length"),
        (lambda _: 1.0, "density gives float64 of shape () at arc lengths of shape"),
        (lambda s: s[:-1], "density gives float64 of shape"),
        (lambda s: 1j * s, "density gives complex128 of shape"),
        (lambda s: np.where(s > 0.9, np.nan, 1.0), "density is nan at s = 0.9"),
        (lambda s: math.exp(s), "density fails (TypeError: "),
        (broken, r"density fails (KeyError: 'no such\nmaterial'); it has to take an array"),
        (lambda s: -s, "density adds up to -0.5; a follower force that pushes has to have a"),
        (lambda s: np.sin(2.0 * np.pi * s), "density adds up to "),
        (lambda s: 0.0 * s, "density adds up to 0; a follower force"),
    ],
)
def test_a_function_that_is_no_density_is_refused(density: Any, sentence: str) -> None:
    assert complaint(lambda: ProfileLoad(75.0, density)).startswith(f"ProfileLoad: {sentence}")


@pytest.mark.parametrize(
    ("kinks", "sentence"),
    [
        ((0.5, 1.0), "kinks[1] = 1.0 has to be an arc length inside (0, 1)"),
        ((math.nan,), "kinks[0] = nan has to be a finite number"),
        (0.5, "kinks = 0.5 has to be a sequence of numbers"),
    ],
)
def test_kinks_off_the_filament_are_refused_by_name(kinks: Any, sentence: str) -> None:
    assert complaint(lambda: ProfileLoad(75.0, np.exp, kinks)) == f"ProfileLoad: {sentence}"


@pytest.mark.parametrize("force", [math.nan, -1.0])
def test_a_force_that_is_none_is_refused_by_name(force: float) -> None:
    for load in (lambda: TableLoad(force, [0, 1], [1, 1]), lambda: ProfileLoad(force, np.exp)):
        assert f"force = {force}" in complaint(load)
