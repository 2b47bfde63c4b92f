"""± means one thing: the error against the body that the numbers stand for."""

import pytest

import undula as un
from commands import Ask, answer, text
from undula.analysis.linear.stability import method_for_all
from undula.analysis.solvers.threshold_record import Threshold
from undula.analysis.solvers.thresholds import single_threshold, threshold_curve
from undula.terminal.numbers import BODY, LINKS, digits, on_links, with_error, with_error_of

TWELVE = un.Filament(segments=12, load=un.TipLoad(75.0))
THREE = un.Chain(3, un.TipLoad(20.0))
FEW = ["--set", "model.segments=12"]
CHAIN = ["--set", "model.kind=chain", "--set", "model.links=3", "--set", "load.force=20"]


# ---------------------------------------------------------------- words


def test_a_number_of_links_as_they_are_has_no_plus_or_minus() -> None:
    assert with_error(187.54286239, 2.2) == "188 ± 2"
    assert digits(187.54286239, 5e-8) == "187.54286239"
    assert on_links(187.54286239, 5e-8, 40) == "187.54286239 (40 links, solved to 5e-08)"
    assert on_links(187.54286239, None, 40, "T") == "187.543 T (40 links)"
    assert on_links(1.0, 0.1, 9, "T", "do") == "1.0 T (9 links, solved to 0.1; do)"
    assert with_error_of(2.0, 0.1, {"error_of": BODY}, "T") == "2.0 ± 0.1 T"
    assert with_error_of(2.0, 0.1, {"error_of": LINKS, "links": 8}, "T") == (
        "2.0 T (8 links, solved to 0.1)"
    )


# ---------------------------------------------------------------- numbers


def value_of(found: Threshold) -> float:
    assert found.value is not None, found.reason
    return found.value


def test_the_error_of_a_threshold_reaches_to_that_of_the_filament() -> None:
    few = single_threshold(TWELVE, "spinning-lost")
    limit = single_threshold(TWELVE, "spinning-lost", converged=True)
    assert few.error is not None
    assert limit.error is not None
    true = abs(value_of(few) - value_of(limit))
    # It is taken from the leading term of the links' error; the next one is a tenth of it.
    assert few.error == pytest.approx(true, rel=0.2)
    assert few.links == (12,)
    assert limit.links[:2] == (12, 24)
    assert few.solver_error is not None
    # On its own links it is known far better, and the limit lies in between.
    assert few.solver_error < 1e-6
    assert limit.error < 1e-2 * few.error


def test_the_error_of_an_onset_by_links_reaches_to_that_of_the_continuum() -> None:
    by_links, exact = (
        single_threshold(TWELVE, "onset", method="discrete"),
        single_threshold(TWELVE, "onset"),
    )
    assert (by_links.links, exact.links) == ((12,), ())
    # As above.
    assert by_links.error == pytest.approx(value_of(exact) - value_of(by_links), rel=0.2)
    assert by_links.solver_error is not None
    assert by_links.solver_error < 1e-8
    weak = single_threshold(TWELVE.with_(inextensibility="weak"), "onset", converged=True)
    assert len(weak.links) >= 3
    assert weak.error is not None
    assert weak.error < 1e-3


def test_the_links_of_a_chain_are_its_body() -> None:
    for kind in ("onset", "spinning-lost"):
        found = single_threshold(THREE, kind)
        assert found.error == found.solver_error
        assert found.links == (3,)


def test_the_error_on_the_links_is_that_of_the_solver() -> None:
    spinning, flapping = un.find(THREE, "spinning"), un.find(THREE, "flapping")
    assert 0.0 < spinning.solver_error < 1e-10
    assert flapping.solver_error == flapping.time_error


# ---------------------------------------------------------------- answers


RUN = ["run", "--set", "time.until=0.2", "--set", "start.amplitude=0.3", "--no-movie", "--out"]


def test_a_run_says_on_how_many_links_its_numbers_hold(
    ask: Ask, tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path_factory.mktemp("runs"))
    said = text(ask(*RUN, "f", *FEW))
    assert "±" not in said
    assert "cycles per T (12 links, solved to " in said
    assert "links           12; `undula find spinning --converge` gives the filament's" in said
    found = answer(ask(*RUN, "g", *FEW, "--json"))
    assert (found["links"], found["error_of"]) == (12, "links")
    chain = ["--set", "time.until=4", *CHAIN]
    said = text(ask(*RUN, "h", *chain))
    assert "± " in said
    assert "(3 links" not in said


@pytest.mark.slow
def test_a_state_has_the_error_of_links_and_solver_together(ask: Ask) -> None:
    for kind in ("spinning", "flapping"):
        found = answer(ask("find", kind, *FEW, "--json"))
        assert (found["error_of"], found["links"]) == ("body", 12)
        assert found["error"] > 100.0 * found["solver_error"] > 0.0
        chain = answer(ask("find", kind, *CHAIN, "--json"))
        assert chain["error"] == chain["solver_error"] > 0.0
    assert "12; --converge gives the filament's" in text(ask("find", "spinning", *FEW))
    assert "converge" not in text(ask("find", "spinning", *CHAIN))


def test_a_threshold_tells_both_errors_apart(ask: Ask) -> None:
    said = text(ask("threshold", "spinning-lost", *FEW))
    assert " ± " in said.split("; on 12 links ")[0]
    assert "±" not in said.split("; on 12 links ")[1]
    assert "solved to" in said
    assert said.splitlines()[1] == "  --converge gives the filament's"
    assert "links" not in text(ask("threshold", "onset", *FEW))
    assert "on 3 links" not in text(ask("threshold", "spinning-lost", *CHAIN))


def test_a_bifurcation_of_links_as_they_are_says_so(ask: Ask) -> None:
    words = ["follow", "spinning", "--along"]
    said = text(ask(*words, "load.force=150:170", *FEW))
    assert "±" not in said
    assert "(12 links, solved to " in said
    assert "; --converge gives the filament's)" in said
    assert " ± " in text(ask(*words, "load.force=44:48", *CHAIN))
    weak = text(ask("follow", "straight", "--along", "load.force=30:40", *WEAK))
    assert "(12 links; --converge gives the filament's)" in weak


WEAK = [*FEW, "--set", "model.inextensibility=weak"]


# ---------------------------------------------------------------- curves


STEP = 1e-2
SMALL = TWELVE.with_(segments=8)
#: Every number that is offered, at the values where a body changes its kind, or anywhere.
OFFERED: list[tuple[un.Filament | un.Chain, str, float]] = [
    (SMALL, "model.drag_ratio", 1.0),
    (SMALL, "model.bending_ratio", 1.0),
    (SMALL, "model.natural_curvature.k1", 0.0),
    (SMALL, "model.natural_curvature.k1", -STEP),
    (SMALL, "model.natural_curvature.k2", 0.0),
    (SMALL, "model.twist_stiffness", 1.0),
    (SMALL, "model.tensile_stiffness", 2000.0),
    (SMALL.with_(inextensibility="weak"), "model.tensile_stiffness", 2000.0),
    (SMALL.with_(bending_ratio=1.5), "model.twist_stiffness", 1.0),
    (un.Filament(8, un.PointLoad(1.0, 0.5)), "load.position", 0.5),
    (un.Filament(8, un.PointLoad(1.0, 0.5)), "load.position", 1.0 - 2.0 * STEP),
    (un.Filament(8, un.LinearLoad(1.0, 0.0)), "load.slope", -STEP),
    (un.Filament(8, un.PowerLoad(1.0, exponent=1.0)), "load.exponent", 0.0),
    (un.Filament(8, un.PowerLoad(1.0, exponent=1.0)), "load.exponent", 1.0 - STEP),
    (un.Chain(4, un.TipLoad(1.0)), "model.drag_ratio", 1.0),
    (un.Chain(4, un.TipLoad(1.0)), "model.base_spring", 1.0),
    (un.Chain(4, un.TipLoad(1.0)), "model.bead_drag", 1.0),
]


@pytest.mark.parametrize(
    ("model", "parameter", "first"), OFFERED, ids=lambda one: str(one).split("(")[0]
)
def test_a_curve_of_onsets_has_no_cliff(
    model: un.Filament | un.Chain, parameter: str, first: float
) -> None:
    values = [first, first + STEP, first + 2.0 * STEP]
    curve = threshold_curve(model, "onset", parameter, values)
    one, two, three = (value_of(found) for found in curve)
    steps = max(abs(two - one), abs(three - two))
    # Straight to a tenth over so short a way, or flat to 1e-3; another method is off by 3 per cent.
    assert abs(three - 2.0 * two + one) < 0.1 * steps + 1e-3 * two
    assert len({found.links for found in curve}) == 1


@pytest.mark.slow
def test_a_converged_curve_has_no_cliff_either() -> None:
    curve = threshold_curve(SMALL, "onset", "model.bending_ratio", [1.0, 1.01], converged=True)
    one, two = (value_of(found) for found in curve)
    allowed = sum(found.error or 0.0 for found in curve)
    assert abs(two - one) < 10.0 * allowed
    assert allowed < 1e-2


def test_one_method_is_for_all_models_of_a_curve() -> None:
    weak = TWELVE.with_(inextensibility="weak")
    assert method_for_all([TWELVE]) == "spectral"
    assert method_for_all([TWELVE, weak]) == "discrete"
