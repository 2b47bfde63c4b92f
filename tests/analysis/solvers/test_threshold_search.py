"""How far thresholds are looked for, and what is said where there is none."""

import pytest

import undula as un
from refusal import complaint
from undula.analysis.solvers.criticality import is_subcritical
from undula.analysis.solvers.thresholds import single_threshold, threshold_curve
from undula.app.cli import main

EIGHT = un.Filament(segments=8, load=un.TipLoad(75.0))
# Its spinning is born downwards at 97.9 and turns in a fold below.
LOW = un.Filament(12, un.PointLoad(97.0, 0.4))


def reason(model: un.Filament, kind: str, up_to: float) -> tuple[str, float | None]:
    found = single_threshold(model, kind, up_to=up_to)
    assert found.value is None
    assert found.reason is not None
    return found.reason, found.searched_to


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "said"),
    [
        ("spinning-lost", "spinning is stable from force 35.8968 up to force 60"),
        (
            "flapping-lost",
            "flapping is unstable from force 35.8968 up to force 60, so that there is no stability"
            " to lose",
        ),
        ("flapping-gained", "flapping is unstable from force 35.8968 up to force 60"),
        ("onset", "the straight state is stable up to force 30"),
    ],
)
def test_where_there_is_none_a_sentence_says_what_there_is_instead(kind: str, said: str) -> None:
    up_to = 30.0 if kind == "onset" else 60.0
    assert reason(EIGHT, kind, up_to) == (said, up_to)


@pytest.mark.slow
def test_stability_that_is_gained_and_kept_is_told() -> None:
    told, _ = reason(EIGHT, "flapping-lost", 145.0)
    said, gained = told.split(" at force ")[0], float(told.split(" at force ")[1].split()[0])
    assert said == "flapping becomes stable"
    assert told.endswith(" and stays so up to force 145")
    below, above = (un.find(EIGHT.with_(force=part * gained), "flapping") for part in (0.99, 1.01))
    assert (below.stable, above.stable) == (False, True)


def test_a_search_that_ends_before_the_branch_begins_says_so() -> None:
    told, searched_to = reason(EIGHT, "spinning-lost", 20.0)
    assert "spinning begins at the onset, at force 35.19" in told
    assert searched_to == 20.0


def test_a_farther_search_finds_what_a_nearer_one_does_not(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = single_threshold(EIGHT, "spinning-lost")
    monkeypatch.setattr("undula.analysis.solvers.threshold_search.FARTHEST", 1.5)
    none = single_threshold(EIGHT, "spinning-lost")
    assert none.value is None
    assert none.searched_to == pytest.approx(1.5 * 35.193, rel=1e-3)
    assert "a larger up_to looks farther" in str(none)
    # Beyond the first stretch it goes on in further ones.
    found = single_threshold(EIGHT, "spinning-lost", up_to=150.0)
    # Each is located to 1e-9 of its way.
    assert found.value == pytest.approx(whole.value, abs=1e-5)


def test_a_curve_ends_its_searches_where_it_is_told_to() -> None:
    curve = threshold_curve(EIGHT, "spinning-lost", "model.drag_ratio", [1.5, 2.0], up_to=60.0)
    assert [one.searched_to for one in curve] == [60.0, 60.0]


def test_a_branch_that_is_born_downwards_is_searched_from_its_fold_on() -> None:
    onset = un.onset(LOW, method="discrete").force
    assert onset is not None
    assert is_subcritical(LOW, "spinning")
    assert not is_subcritical(LOW, "flapping")
    reached: list[float] = []
    found = single_threshold(
        LOW, "spinning-lost", up_to=0.99 * onset, progress=lambda _, force: reached.append(force)
    )
    assert found.reason is not None
    fold = min(reached)
    assert fold < 0.97 * onset
    assert found.reason.startswith("spinning becomes stable at force ")
    said = float(found.reason.split(" at force ")[1].split()[0])
    # The fold lies between the points that were reached.
    assert said == pytest.approx(fold, rel=1e-2)
    assert said < 0.97 * onset


def test_bounds_that_are_none_are_refused() -> None:
    for bound in (0.0, -1.0, float("nan"), float("inf")):
        assert "force above 0" in complaint(lambda: single_threshold(EIGHT, "onset", up_to=bound))  # noqa: B023


@pytest.mark.parametrize("words", [["0"], ["-3"], ["nan"], ["inf"]])
def test_the_command_refuses_them_in_one_sentence(
    words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["threshold", "onset", "--up-to", *words]) == 2
    said = capsys.readouterr()
    assert (said.out, len(said.err.splitlines())) == ("", 1)
    assert "--up-to" in said.err


def test_the_command_says_how_to_look_farther(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["threshold", "spinning-lost", "--set", "model.segments=8", "--up-to", "60"]
    assert main(words) == 0
    assert "up to force 60; --up-to looks farther" in capsys.readouterr().out


@pytest.mark.parametrize("kind", ["spinning-lost", "flapping-lost", "flapping-gained"])
def test_a_filament_of_other_symmetries_is_refused_before_any_search(
    kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        "undula.analysis.solvers.thresholds.single_threshold",
        lambda *_, **__: pytest.fail("searched"),
    )
    for parameter, values in (
        ("model.bending_ratio", [1.0, 1.25, 1.5]),
        ("model.natural_curvature.k1", [0.0, 1.0]),
    ):
        told = complaint(lambda: threshold_curve(EIGHT, kind, parameter, values))  # noqa: B023
        assert "has no such state" in told


def test_a_state_with_another_symmetry_is_no_guess() -> None:
    state = un.find(EIGHT, "spinning")
    told = complaint(lambda: un.find(EIGHT.with_(bending_ratio=1.5), "spinning", guess=state))
    assert "has no turning symmetry" in told
    beat = un.find(EIGHT, "flapping")
    told = complaint(
        lambda: un.find(EIGHT.with_(natural_curvature=(1.0, 0.0)), "flapping", guess=beat)
    )
    assert "has no turning symmetry" in told
