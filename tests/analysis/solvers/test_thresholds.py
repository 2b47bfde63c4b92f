"""Forces at which states gain or lose stability, against the states on both sides of them."""

from collections.abc import Callable
from functools import cache

import pytest

import undula as un
from refusal import complaint
from undula.analysis.solvers.flapping import find_flapping
from undula.analysis.solvers.refind import limit_of, refind_bifurcation
from undula.analysis.solvers.spinning import find_spinning
from undula.analysis.solvers.threshold_record import Threshold
from undula.analysis.solvers.thresholds import THRESHOLDS, single_threshold, threshold_curve
from undula.analysis.states.extrapolation import extrapolated
from undula.analysis.states.not_found import NotFound
from undula.analysis.states.records import Flapping, Spinning

EIGHT = un.Filament(segments=8, load=un.TipLoad(75.0))
CONFINED = EIGHT.with_(confined=True)
PULLED = un.Filament(
    segments=8, load=un.TableLoad(20.0, s=(0.0, 0.2, 0.4, 1.0), density=(1.0, 1.0, -0.4, -0.4))
)


@cache
def of_eight(kind: str) -> Threshold:
    return single_threshold(EIGHT, kind)


def value_of(found: Threshold) -> float:
    assert found.value is not None, found.reason
    return found.value


def test_the_onset_is_that_of_the_straight_state() -> None:
    onset, found = un.onset(EIGHT), of_eight("onset")
    # A search for later crossings too has a larger pencil: same root, other round-off.
    assert found.value == pytest.approx(onset.force, rel=1e-12)
    assert found.frequency == pytest.approx(onset.frequency, rel=1e-12)
    assert found.error is not None
    assert found.error < 1e-11
    assert found.bifurcation == "Hopf"


@pytest.mark.parametrize(
    ("kind", "find", "before"),
    [
        ("spinning-lost", find_spinning, True),
        pytest.param("flapping-gained", find_flapping, False, marks=pytest.mark.slow),
        pytest.param("flapping-lost", find_flapping, True, marks=pytest.mark.slow),
    ],
)
def test_a_threshold_is_where_the_leading_rate_of_the_state_changes_its_sign(
    kind: str, find: Callable[..., Spinning | Flapping | NotFound], before: bool
) -> None:
    found = of_eight(kind)
    assert found.solver_error is not None
    assert found.solver_error < 1e-6
    below, at, above = (
        find(EIGHT.with_(force=share * value_of(found))) for share in (0.999, 1.0, 1.001)
    )
    assert isinstance(below, Spinning | Flapping)
    assert isinstance(at, Spinning | Flapping)
    assert isinstance(above, Spinning | Flapping)
    assert (below.stable, above.stable) == (before, not before)
    # The force is located to 1e-9 of the way that was followed, some hundreds.
    slope = (above.leading_rate - below.leading_rate) / (0.002 * value_of(found))
    assert abs(at.leading_rate) < 1e-5 * abs(slope)
    assert found.frequency == pytest.approx(at.frequency, rel=1e-8)
    if isinstance(at, Flapping):
        # It is the disturbances out of the plane that decide.
        assert at.leading_rate == at.leading_rate_out_of_plane
        assert found.bifurcation == "symmetry breaking"
        assert found.second_frequency is None
    else:
        turns = abs(at.exponents[0].imag) / 6.283185307179586
        assert found.bifurcation == "torus"
        assert found.second_frequency == pytest.approx(turns, rel=1e-6)


def test_a_threshold_tells_itself_in_one_line() -> None:
    found = of_eight("spinning-lost")
    assert str(found).startswith(f"spinning-lost at force {value_of(found):.10g} ± ")
    assert "torus" in str(found)
    none = Threshold("spinning-lost", None, reason="it stays stable")
    assert str(none) == "no spinning-lost: it stays stable"


@pytest.mark.slow
def test_spinning_is_lost_and_flapping_gained_at_forces_of_their_own() -> None:
    lost, gained = value_of(of_eight("spinning-lost")), value_of(of_eight("flapping-gained"))
    # Both states are stable between the two: where a motion ends depends on where it starts.
    assert gained < 0.99 * lost
    between = EIGHT.with_(force=0.5 * (lost + gained))
    for find in (find_spinning, find_flapping):
        state = find(between)
        assert state
        assert state.stable


@pytest.mark.parametrize(
    ("kind", "ratios"),
    [
        ("spinning-lost", [1.5, 2.0, 2.5]),
        pytest.param("flapping-gained", [2.0, 2.2], marks=pytest.mark.slow),
    ],
)
def test_a_curve_holds_the_thresholds_of_single_searches(kind: str, ratios: list[float]) -> None:
    seen: list[tuple[int, int]] = []
    curve = threshold_curve(
        EIGHT, kind, "model.drag_ratio", ratios, progress=lambda *done: seen.append(done)
    )
    assert seen == [(1 + k, len(ratios)) for k in range(len(ratios))]
    for ratio, found in zip(ratios, curve, strict=True):
        single = (
            of_eight(kind)
            if ratio == 2.0
            else single_threshold(EIGHT.with_(drag_ratio=ratio), kind)
        )
        # Each is located on its own way, to 1e-9 of it.
        assert found.value == pytest.approx(value_of(single), abs=1e-6)
        assert found.bifurcation == single.bifurcation


def test_a_curve_begins_each_search_at_the_threshold_before() -> None:
    first = of_eight("spinning-lost")
    other = EIGHT.with_(drag_ratio=2.05)
    reached: dict[bool, list[float]] = {True: [], False: []}
    for begun, forces in reached.items():
        near = first if begun else None
        found = single_threshold(
            other, "spinning-lost", near=near, progress=lambda _, force, to=forces: to.append(force)
        )
        assert found.value == pytest.approx(value_of(first), rel=0.02)
    # The short way leaves out what lies between the onset and the threshold.
    assert min(reached[True]) > 0.9 * value_of(first)
    assert len(reached[True]) < len(reached[False])


def test_a_curve_goes_on_beyond_a_value_without_a_threshold(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked = []

    def fake(
        model: un.Filament,
        kind: str,
        *,
        converged: bool,
        near: Threshold | None,
        **_: object,
    ) -> Threshold:
        asked.append(near)
        ratio = model.drag_ratio
        return Threshold(kind, None if ratio == 2.0 else ratio, reason=f"{converged}")

    monkeypatch.setattr("undula.analysis.solvers.thresholds.single_threshold", fake)
    found = threshold_curve(EIGHT, "spinning-lost", "model.drag_ratio", [1.0, 2.0, 3.0, 4.0])
    assert [one.value for one in found] == [1.0, None, 3.0, 4.0]
    assert asked == [None, found[0], None, found[2]]


@pytest.mark.parametrize("kind", THRESHOLDS)
def test_a_filament_that_is_pulled_has_no_threshold_and_says_why(kind: str) -> None:
    found = single_threshold(PULLED, kind)
    assert (found.value, found.error, found.frequency, found.at) == (None, None, None, None)
    assert found.reason is not None
    assert "stable" in found.reason


@pytest.mark.slow
def test_flapping_that_is_held_in_its_plane_has_nothing_to_gain(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # Near enough that only the beginning of the branch is followed.
    monkeypatch.setattr("undula.analysis.solvers.threshold_search.FARTHEST", 2.0)
    found = single_threshold(CONFINED, "flapping-gained")
    assert found.value is None
    assert found.reason is not None
    assert found.reason.startswith("flapping is stable from its beginning at force ")


def test_a_confined_model_is_told_that_it_cannot_spin() -> None:
    assert "cannot spin" in complaint(lambda: single_threshold(CONFINED, "spinning-lost"))


@pytest.mark.parametrize("kind", ["", "spinning", "Onset", "flapping-won"])
def test_a_threshold_of_no_known_name_is_refused_with_those_that_are(kind: str) -> None:
    told = complaint(lambda: single_threshold(EIGHT, kind))
    assert repr(kind) in told
    for known in THRESHOLDS:
        assert known in told


def test_a_curve_along_the_force_itself_is_refused() -> None:
    told = complaint(lambda: threshold_curve(EIGHT, "onset", "load.force", [1.0, 2.0]))
    assert "take another parameter" in told


def test_a_curve_along_what_the_model_does_not_have_is_refused() -> None:
    for parameter, values, culprit in (
        ("load.slope", [0.0], "load.slope is no number of this model"),
        ("model.drag_ratio", [2.0, 0.5], "drag_ratio = 0.5"),
    ):
        told = complaint(lambda: threshold_curve(EIGHT, "onset", parameter, values))  # noqa: B023
        assert culprit in told


def test_many_links_are_reached_from_few(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("undula.analysis.states.extrapolation.REFINEMENTS", (1, 2, 4))
    few = EIGHT.with_(segments=6)
    limit = single_threshold(few, "spinning-lost", converged=True)
    single = [single_threshold(few.with_(segments=6 * part), "spinning-lost") for part in (1, 2, 4)]
    expected, error = extrapolated([value_of(one) for one in single])
    # Located to 1e-9 of the way each, and extrapolated with weights of order 1.
    assert limit.value == pytest.approx(expected, abs=1e-5)
    assert limit.error == pytest.approx(error, rel=1e-4)
    assert limit.at is not None
    assert limit.at.state.model.links == 24
    # Frequencies are those of the limit too, not of its finest links.
    for name in ("frequency", "second_frequency"):
        expected, _ = extrapolated([getattr(one, name) for one in single])
        assert getattr(limit, name) == pytest.approx(expected, rel=1e-6)
        assert getattr(limit, name) != pytest.approx(getattr(limit.at, name), rel=1e-3)


def test_a_bifurcation_moves_to_other_links_though_it_is_not_near() -> None:
    known = of_eight("spinning-lost").at
    assert known is not None
    again = refind_bifurcation(known, EIGHT.with_(segments=16), "load.force", lambda one: one.loses)
    assert not isinstance(again, NotFound)
    # A fifth higher: beyond the nearest surroundings that are looked through first.
    assert again.value > 1.1 * known.value
    assert again.value == pytest.approx(
        value_of(single_threshold(EIGHT.with_(segments=16), "spinning-lost"))
    )


def test_a_bifurcation_at_the_edge_of_a_range_is_found_again_within_it() -> None:
    # Along the drag ratio, which is at least 1.
    near_one = single_threshold(EIGHT.with_(drag_ratio=1.02), "spinning-lost")
    state = find_spinning(EIGHT.with_(force=value_of(near_one), drag_ratio=1.1))
    assert isinstance(state, Spinning)
    branch = un.follow(state, "model.drag_ratio", 1.0)
    (known,) = branch.bifurcations
    assert known.value == pytest.approx(1.02, abs=1e-6)
    again = refind_bifurcation(
        known, EIGHT.with_(force=value_of(near_one)), "model.drag_ratio", lambda _: True
    )
    assert not isinstance(again, NotFound)
    assert again.value == pytest.approx(known.value, abs=1e-6)


def test_a_limit_that_is_not_reached_says_why(monkeypatch: pytest.MonkeyPatch) -> None:
    known = of_eight("spinning-lost").at
    assert known is not None
    monkeypatch.setattr("undula.analysis.solvers.refind._HALF_WIDTHS", (0.01,))
    limit = limit_of(known, "load.force")
    assert isinstance(limit, NotFound)
    assert "no such change between load.force" in limit.reason
