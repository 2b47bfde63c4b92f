"""Motions whose name is known, made by hand: each is named rightly or not at all."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest

from motions import (
    ARC,
    BENT,
    SWING,
    Clock,
    Moved,
    chain,
    ellipse,
    figure_of_eight,
    line,
    modulated,
    pointing,
    turned,
    wave,
    windmill,
)
from undula.analysis.regimes.classify import first_verdict, with_exponents
from undula.analysis.regimes.lyapunov import Lyapunov
from undula.analysis.regimes.verdict import Verdict
from undula.arrays import Array

GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)


@dataclass(frozen=True)
class Case:
    """A motion over some time with its right names."""

    name: str
    right: str
    move: Callable[[Array], Moved]
    clock: Clock = Clock()  # noqa: RUF009  (frozen)
    settled_from: float | None = None

    @cache  # noqa: B019  (as many as there are cases)
    def verdict(self) -> Verdict:
        return first_verdict(*self.move(self.clock.time).data, settled_from=self.settled_from)


def spin(time: Array, rate: float = 1.0, size: float = 1.0) -> Array:
    return turned(size * np.broadcast_to(BENT, (time.size, ARC.size)), rate * time)


def fading(time: Array, depth: float, decay: float) -> Array:
    """A spinning shape with a modulation that decays, or grows if that is negative."""
    swing = depth * np.exp(-decay * time) * np.cos(2.0 * np.pi * time)
    return turned(BENT * (1.0 + swing[:, None] * SWING), GOLDEN * time)


def leaving(time: Array, start: float, rate: float) -> Array:
    """A beat in a plane with a part across it that grows."""
    across = np.cos(2.0 * np.pi * time[:, None] - ARC + 1.0)
    return wave(time) + 0.3j * start * np.exp(rate * time)[:, None] * ARC**2 * across


SPINNING = [
    Case("counterclockwise", "spinning", lambda t: line(t, spin(t))),
    Case("clockwise", "spinning", lambda t: line(t, spin(t, -1.3))),
    Case("few samples a turn", "spinning", lambda t: line(t, spin(t)), Clock(12.0, 9.0)),
    Case("a few turns", "spinning", lambda t: line(t, spin(t)), Clock(5.0, 60.0)),
    Case("many turns", "spinning", lambda t: line(t, spin(t)), Clock(300.0, 13.0)),
    Case("noise of 1e-6", "spinning", lambda t: line(t, spin(t), 1e-6)),
    Case("noise of 1e-5", "spinning", lambda t: line(t, spin(t), 1e-5)),
    Case("small", "spinning", lambda t: line(t, spin(t, size=0.03), 1e-7)),
    Case("a trace of modulation", "spinning", lambda t: line(t, fading(t, 1e-3, 0.0))),
    Case("a modulation dies out", "spinning", lambda t: line(t, fading(t, 0.3, 0.25)), Clock(60.0)),
    Case("settled at once", "spinning", lambda t: line(t, fading(t, 0.3, 0.3)), settled_from=20.0),
    Case(
        "last link upside down",
        "spinning",
        lambda t: chain(
            t, np.stack([pointing(0.3, 2 * np.pi * t), pointing(2.6, 2 * np.pi * t)], axis=1)
        ),
    ),
]

MODULATED = [
    Case(
        f"depth {depth:g}, {word}",
        "modulated spinning",
        lambda t, depth=depth, rate=rate: line(t, turned(modulated(t, (depth, 1.0)), rate * t)),
    )
    for depth in (0.03, 0.1, 0.4)
    for word, rate in (("twice a turn", 0.5), ("thrice in two turns", 2 / 3), ("golden", GOLDEN))
]
MODULATED += [
    Case(
        "noise",
        "modulated spinning",
        lambda t: line(t, turned(modulated(t, (0.1, 1.0)), GOLDEN * t), 1e-6),
    ),
    Case(
        "14 samples a period",
        "modulated spinning",
        lambda t: line(t, turned(modulated(t, (0.1, 1.0)), GOLDEN * t)),
        Clock(20.0, 14.0),
    ),
    Case(
        "every second swing is larger",
        "modulated spinning",
        lambda t: line(t, turned(modulated(t, (0.2, 1.0), (0.1, 0.5)), GOLDEN * t)),
    ),
    Case(
        "five swings a period",
        "modulated spinning",
        lambda t: line(t, turned(modulated(t, (0.2, 1.0), (0.1, 0.4)), GOLDEN * t)),
        Clock(80.0),
    ),
    Case("round an ellipse", "modulated spinning", lambda t: line(t, ellipse(t, 0.5))),
    Case(
        "round another, tilted",
        "modulated spinning",
        lambda t: line(t, turned(ellipse(t, -0.8), 0.1)),
    ),
]

FLAPPING = [
    *(
        Case(
            f"azimuth {azimuth:g}",
            "planar flapping",
            lambda t, azimuth=azimuth: line(t, turned(wave(t), azimuth)),
        )
        for azimuth in (0.0, 0.11, 0.25, 0.37)
    ),
    Case("noise of 1e-6", "planar flapping", lambda t: line(t, wave(t) + 0j, 1e-6)),
    Case("noise of 1e-5", "planar flapping", lambda t: line(t, wave(t) + 0j, 1e-5)),
    Case("small", "planar flapping", lambda t: line(t, 0.03 * wave(t))),
    Case("8 samples a beat", "planar flapping", lambda t: line(t, wave(t, 0.0)), Clock(20.0, 8.3)),
    Case("few beats", "planar flapping", lambda t: line(t, wave(t)), Clock(9.0, 60.0)),
    Case("many beats", "planar flapping", lambda t: line(t, wave(t)), Clock(300.0, 13.0)),
    Case("violent", "planar flapping", lambda t: line(t, wave(t, 0.5))),
    Case(
        "every second beat is larger",
        "planar flapping",
        lambda t: line(t, wave(t) * (1.0 + 0.2 * np.cos(np.pi * t))[:, None]),
    ),
    Case(
        "an asymmetric beat",
        "planar flapping",
        lambda t: line(t, wave(t) + 0.1 * ARC**2 * np.cos(4.0 * np.pi * t[:, None])),
    ),
    Case(
        "a link swings through all but a turn",
        "planar flapping",
        lambda t: chain(
            t,
            np.stack(
                [
                    pointing(0.1 * np.sin(2 * np.pi * t), 0.5),
                    pointing(2.9 * np.sin(2 * np.pi * t), 0.5),
                ],
                axis=1,
            ),
        ),
    ),
]

OTHERS = [
    *(
        Case(
            f"{turn:g} of a turn a beat",
            "precessing flapping",
            lambda t, turn=turn: line(t, turned(wave(t), turn * t)),
        )
        for turn in (-0.1, 0.03, 0.01)
    ),
    Case("noise", "precessing flapping", lambda t: line(t, turned(wave(t), 0.02 * t), 1e-6)),
    Case(
        "a thin ellipse turns",
        "precessing flapping",
        lambda t: line(t, turned(ellipse(t, 0.08), 0.02 * t)),
    ),
    *(
        Case(
            f"a figure of eight, {width:g}",
            "non-planar flapping",
            lambda t, width=width: line(t, turned(figure_of_eight(t, width), 0.2)),
        )
        for width in (0.1, 0.3, 0.8)
    ),
    Case("a thin ellipse", "non-planar flapping", lambda t: line(t, ellipse(t, 0.1))),
    Case(
        "a figure of eight turns",
        "non-planar flapping",
        lambda t: line(t, turned(figure_of_eight(t, 0.6), 0.02 * t)),
    ),
    Case("the last of two", "windmilling", lambda t: windmill(t, 2, 1)),
    Case("the last two of five", "windmilling", lambda t: windmill(t, 5, 2)),
    Case("the whole chain", "windmilling", lambda t: windmill(t, 3, 3)),
    Case("about an axis that turns", "windmilling", lambda t: windmill(t, 4, 1, 0.02)),
]

STRAIGHT = [
    Case("rings", "straight", lambda t: line(t, 1e-2 * np.exp(-0.2 * t)[:, None] * wave(t))),
    Case(
        "rings out of plane",
        "straight",
        lambda t: line(t, 1e-2 * np.exp(-0.2 * t)[:, None] * ellipse(t, 0.4)),
    ),
    Case("spirals in", "straight", lambda t: line(t, 0.1 * np.exp(-0.2 * t)[:, None] * spin(t))),
    Case("creeps", "straight", lambda t: line(t, 1e-2 * np.exp(-0.2 * t)[:, None] * BENT.real)),
    Case(
        "creeps, from afar",
        "straight",
        lambda t: line(t, np.exp(-0.2 * t)[:, None] * (BENT + np.exp(-t)[:, None] * SWING * ARC)),
    ),
    Case("noise", "straight", lambda t: line(t, np.exp(-0.2 * t)[:, None] * wave(t) + 0j, 1e-6)),
]

#: What is not told from what is seen of it, and should not be.
OPEN = [
    Case("modulation decays", "undecided", lambda t: line(t, fading(t, 0.2, 0.01))),
    Case("slowly", "undecided", lambda t: line(t, fading(t, 0.2, 0.003)), Clock(80.0)),
    Case(
        "settled, it was said",
        "undecided",
        lambda t: line(t, fading(t, 0.05, 0.01)),
        settled_from=1.0,
    ),
    Case("modulation grows", "undecided", lambda t: line(t, fading(t, 0.01, -0.05))),
    Case("steady, but less and less", "undecided", lambda t: line(t, fading(t, 2e-5, -0.1))),
    Case("leaves its plane", "undecided", lambda t: line(t, leaving(t, 1e-4, 0.1))),
    Case("leaves it slowly", "undecided", lambda t: line(t, leaving(t, 4e-3, 0.02))),
    Case("grows", "undecided", lambda t: line(t, 1e-4 * np.exp(0.1 * t)[:, None] * spin(t))),
    Case(
        "grows and saturates",
        "undecided",
        lambda t: line(t, spin(t) / np.sqrt(1.0 + 1e3 * np.exp(-0.3 * t))[:, None]),
        Clock(30.0),
    ),
    Case(
        "decays by half",
        "undecided",
        lambda t: line(t, 1e-2 * np.exp(-0.02 * t)[:, None] * wave(t)),
    ),
    Case("3 samples a beat", "undecided", lambda t: line(t, wave(t)), Clock(40.0, 3.2)),
    Case("half a turn", "undecided", lambda t: line(t, spin(t, 0.02))),
    Case("two beats", "undecided", lambda t: line(t, turned(wave(t), 0.03 * t)), Clock(2.0, 48.0)),
    Case("six samples", "undecided", lambda t: line(t, spin(t)), Clock(5.0, 1.0)),
]

NAMED = SPINNING + MODULATED + FLAPPING + OTHERS + STRAIGHT


def ids(cases: list[Case]) -> list[str]:
    return [f"{case.right}: {case.name}" for case in cases]


@pytest.mark.parametrize("case", NAMED, ids=ids(NAMED))
def test_no_motion_gets_a_wrong_name(case: Case) -> None:
    found = case.verdict()
    assert found.name in (case.right, "undecided"), found.reason


def test_of_motions_that_can_be_told_hardly_any_is_left_undecided() -> None:
    assert len(NAMED) >= 60
    left = [case.name for case in NAMED if case.verdict().name == "undecided"]
    assert len(left) <= 0.05 * len(NAMED), left


@pytest.mark.parametrize("case", OPEN, ids=ids(OPEN))
def test_what_is_not_told_yet_is_left_open(case: Case) -> None:
    assert case.verdict().name == "undecided", case.verdict().reason


@pytest.mark.parametrize("case", OPEN, ids=ids(OPEN))
def test_what_is_left_open_says_what_to_do(case: Case) -> None:
    found = case.verdict()
    assert found.margin == 0.0
    if found.longer is None:
        assert "more samples" in found.reason
    else:
        assert "run longer" in found.reason
        assert 0.0 < found.longer < 100.0 * case.clock.periods


@pytest.mark.parametrize("case", NAMED, ids=ids(NAMED))
def test_a_name_has_a_margin_and_needs_no_longer_run(case: Case) -> None:
    found = case.verdict()
    if found.name != "undecided":
        assert 1.0 <= found.margin <= 100.0
        assert found.longer is None


@pytest.mark.parametrize(
    ("width", "right"), [(0.9, {"modulated spinning"}), (0.02, {"planar flapping"})]
)
def test_margins_shrink_towards_a_border_and_on_it_nothing_is_told(
    width: float, right: set[str]
) -> None:
    time = Clock().time
    # From round the axis over to and fro, and in no plane, to the plane.
    far, near = (
        first_verdict(*line(time, ellipse(time, w)).data, settled_from=None)
        for w in ((0.9, 0.25) if width > 0.5 else (0.005, 0.015))
    )
    assert far.margin > near.margin > 1.0
    assert {far.name, near.name} == right


def test_between_going_round_and_to_and_fro_there_is_a_width_that_is_not_told() -> None:
    time = Clock().time
    widths = np.linspace(0.12, 0.3, 91)
    names = [
        first_verdict(*line(time, ellipse(time, width)).data, settled_from=None).name
        for width in widths
    ]
    changes = [name for k, name in enumerate(names) if k == 0 or name != names[k - 1]]
    assert changes == ["non-planar flapping", "undecided", "modulated spinning"]


def torus(time: Array) -> Moved:
    """A shape modulated at two frequencies that have no common period."""
    return line(time, turned(modulated(time, (0.2, 1.0), (0.15, np.sqrt(2.0))), GOLDEN * time))


def exponents(*values: float, error: float = 0.01) -> Lyapunov:
    return Lyapunov(np.array(values), np.full(len(values), error), 2, 100.0)


def test_a_torus_waits_for_its_exponents_and_is_named_by_how_it_moves() -> None:
    found = first_verdict(*torus(Clock(200.0, 30.0).time).data, settled_from=None)
    assert found.name == "undecided"
    assert found.late is not None
    regular = with_exponents(found, exponents(0.004, 0.001, -0.002))
    assert regular.name == "modulated spinning"
    assert "quasi-periodic" in regular.reason
    assert regular.longer is None


def test_an_irregular_motion_is_chaotic_if_neighbouring_ones_part() -> None:
    found = first_verdict(*torus(Clock(200.0, 30.0).time).data, settled_from=None)
    chaotic = with_exponents(found, exponents(0.6, 0.001, -0.002))
    assert chaotic.name == "chaotic"
    # 0.6 over three errors of 0.01.
    assert chaotic.margin == pytest.approx(20.0)
    assert chaotic.longer is None
    # Neither clearly positive nor clearly too small to matter.
    open_ = with_exponents(found, exponents(0.1, 0.0, 0.0, error=0.08))
    assert open_.name == "undecided"
    assert open_.longer is not None


def test_an_irregular_motion_whose_neighbours_join_it_is_still_settling() -> None:
    found = first_verdict(*torus(Clock(200.0, 30.0).time).data, settled_from=None)
    settling = with_exponents(found, exponents(0.002, -0.001, -0.3))
    assert settling.name == "undecided"
    # To come from the size of the motion to where shapes count as the same.
    assert settling.longer == pytest.approx(np.log(200.0) / 0.3)


def test_exponents_change_no_name_that_is_told_without_but_tell_what_will_not_last() -> None:
    found = SPINNING[0].verdict()
    stable = with_exponents(found, exponents(0.0, 0.0, -2.0))
    assert (stable.name, stable.reason) == (found.name, found.reason)
    unstable = with_exponents(found, exponents(5.0, 0.0, 0.0))
    assert unstable.name == found.name
    assert "neighbouring motions part at 5" in unstable.reason
    assert unstable.evidence["lyapunov"] == 5.0


def test_a_beat_whose_plane_hardly_turns_is_planar_however_long_it_is_watched() -> None:
    # By 2 mrad a beat, which is less than shapes that come back may be off.
    time = Clock(80.0, 48.0).time
    found = first_verdict(
        *line(time, turned(wave(time), 2e-3 / (2.0 * np.pi) * time)).data, settled_from=0.0
    )
    assert found.evidence["planarity"] > 0.02  # that of all beats together
    assert found.name == "planar flapping"


def test_what_comes_nearer_to_a_plane_all_the_time_has_not_settled() -> None:
    time = Clock(12.0, 48.0).time
    for rate, told in ((0.0, "non-planar flapping"), (0.015, "undecided")):
        # By a fifth in all, and by less than that from one half to the other.
        across = 0.1 * np.exp(-rate * time)[:, None]
        sides = wave(time) + 1j * across * np.roll(wave(time), 12, axis=0)
        found = first_verdict(*line(time, sides).data, settled_from=0.0)
        assert found.name == told, found.reason
    assert "settles into a plane" in found.reason
