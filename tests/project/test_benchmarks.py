"""Claims on the benchmarks: what is compared is the same physics, and errors are what they say."""

from pathlib import Path

import numpy as np
import pytest

import naive
from contenders import compiled, page, textbook
from contenders.orbits import FORCES, FullCells, orbit
from contenders.solvers import Solver, solvers
from contenders.windows import OURS, names, once
from undula.arrays import Array
from undula.models.filament import Filament
from undula.models.initial_states import helix
from undula.models.loads.analytic import TipLoad

EXTRA = "of the extra `bench`, which the tests do without: pip install -e '.[bench]'"
SEGMENTS = 12
every_layout = pytest.mark.parametrize("half", [False, True], ids=["full cells", "half cells"])


def bent(seed: int) -> Array:
    """Return a strongly bent state whose links are not quite of their length."""
    model = Filament(SEGMENTS, TipLoad(75.0))
    noise = np.random.default_rng(seed).normal(size=model.size)
    return helix(model, 1.2) + 1e-3 / SEGMENTS * noise


def dense(banded: Array) -> Array:
    """Return the matrix that a band stands for."""
    size, reach = banded.shape[1], textbook.HALF_BANDWIDTH
    matrix = np.zeros((size, size))
    for row, below in zip(banded, range(-reach, reach + 1), strict=True):
        for j in range(max(0, -below), min(size, size - below)):
            matrix[j + below, j] = row[j]
    return matrix


@every_layout
@pytest.mark.parametrize("rhs", [textbook.rhs, compiled.rhs], ids=["numpy", "compiled"])
def test_the_equations_of_the_contenders_are_those_of_the_package(rhs, half) -> None:  # type: ignore[no-untyped-def]
    kind = Filament if half else FullCells
    model = kind(SEGMENTS, TipLoad(75.0), inextensibility="weak")
    rod = textbook.textbook(SEGMENTS, 75.0, half=half)
    for seed in range(3):
        x = bent(seed)
        expected = model.rhs(x)
        # Springs of 4e4 n^2 on differences of positions leave some 1e-12 of the velocity.
        assert np.abs(rhs(x, rod) - expected).max() < 1e-11 * np.abs(expected).max()


@every_layout
def test_the_band_holds_the_derivative_and_nothing_lies_beyond(half: bool) -> None:
    rod, x = textbook.textbook(SEGMENTS, 200.0, half=half), bent(3)
    expected = naive.differences(lambda x: compiled.rhs(x, rod), x, 1e-5)
    found = dense(compiled.band(x, rod))
    # Differences of fourth order with steps of 1e-5: 1e-20 n^4 and round-off over the step.
    assert np.abs(found - expected).max() < 1e-8 * np.abs(expected).max()


@pytest.mark.parametrize("motion", FORCES)
def test_the_exact_motions_obey_the_contenders_equations(motion: str) -> None:
    exact = orbit("textbook", SEGMENTS, motion)
    rod = textbook.textbook(SEGMENTS, FORCES[motion])
    phase, step = np.array([0.3]), 1e-5
    later, earlier = exact.at(phase + step)[0], exact.at(phase - step)[0]
    velocity = (later - earlier) * exact.frequency / (2.0 * step)
    computed = compiled.rhs(exact.at(phase)[0], rod)
    # The beat has 32 harmonics, the last of which are some 1e-7 L, times the stiffness of bending
    # and stretching over the speed of the beat.
    tolerance = {"spinning": 1e-6, "flapping": 1e-2}[motion]
    assert np.abs(computed - velocity).max() < tolerance * np.abs(velocity).max()


@pytest.mark.parametrize("motion", FORCES)
def test_a_wrong_frequency_is_seen_as_wrong_by_as_much(motion: str) -> None:
    exact = orbit("undula", SEGMENTS, motion)
    times = np.linspace(0.0, 3.0 / exact.frequency, 25)
    for error in (0.0, 1e-6, 1e-3):
        states = exact.at((1.0 + error) * exact.frequency * times)
        # Phases come out of products of some 1e-16 over steps of Gauss and Newton.
        assert exact.frequency_error(times, states) == pytest.approx(error, rel=1e-6, abs=1e-12)


@pytest.mark.parametrize("solver", solvers(), ids=lambda solver: solver.name)
def test_every_solver_stays_on_the_motion(solver: Solver) -> None:
    if solver.method == "CVODE":
        pytest.importorskip("sksundae", reason=EXTRA)
    exact = orbit("textbook", SEGMENTS, "flapping")
    rod = textbook.textbook(SEGMENTS, FORCES["flapping"])
    times = np.linspace(0.0, 0.1 / exact.frequency, 3)
    # The tip moves by some 0.1 L; the roughest leave 2e-4 L of it at this tolerance.
    assert exact.tip_error(times, solver.run(rod, exact.start, times, 1e-5)) < 1e-3


@pytest.mark.parametrize("name", OURS)
def test_the_package_stays_on_the_motion_in_each_of_its_ways(name: str) -> None:
    found = once(name, "spinning", SEGMENTS, 2.0, 1e-5)
    # An error of the frequency of 1e-5 moves the tip by 2e-5 L in two turns.
    assert found.frequency_error < 5e-5
    assert found.tip_error < 5e-4


def test_the_step_of_the_cosserat_rod_is_limited_by_its_shear_waves() -> None:
    pytest.importorskip("elastica", reason=EXTRA)
    from contenders import elastica_rod

    mass = 1e-5
    exact = orbit("undula", SEGMENTS, "spinning")
    found = elastica_rod.longest_stable_step(exact.start, FORCES["spinning"], mass)
    # Cross-sections turn against the shear stiffness: omega^2 = k G A / (rho I), limit 2 / omega.
    shear, inertia = 27.0 / 28.0 * 4e4 / 3.0, 0.25 * mass * elastica_rod.RADIUS**2
    limit = 2.0 * np.sqrt(inertia / shear)
    # Other waves lower it a little, and the damping of rotations by about dt / 2 m.
    assert 0.8 * limit < found < 1.05 * limit


@pytest.mark.parametrize("motion", FORCES)
def test_the_page_has_a_row_for_every_contender(motion: str) -> None:
    table = page.PAGE.read_text(encoding="utf-8").partition(f"<!-- {motion} -->")[2]
    rows = [line.split(" | ")[0].removeprefix("| ") for line in table.splitlines()]
    for name in (*names(), "PyElastica (extrapolated)"):
        assert name in rows


def test_a_table_replaces_the_one_between_its_marks(tmp_path: Path) -> None:
    file = tmp_path / "page.md"
    file.write_text("a\n<!-- x -->\nold\n<!-- end of x -->\nb\n", encoding="utf-8")
    page.write("x", page.table(["k"], [["1"]]), file)
    page.write("x", page.table(["k"], [["2"]]), file)
    told = file.read_text(encoding="utf-8")
    assert told == "a\n<!-- x -->\n\n| k |\n| --- |\n| 2 |\n\n<!-- end of x -->\nb\n"
    with pytest.raises(ValueError, match="no place for y"):
        page.write("y", "", file)
