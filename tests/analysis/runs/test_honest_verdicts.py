"""No verdict is believed that the integrator, and not the body, may have made."""

import json
import subprocess
import sysconfig
from collections import Counter
from dataclasses import dataclass
from functools import cache
from itertools import product
from pathlib import Path

import numpy as np
import pytest

import undula as un
from pages import ROOT
from refusal import complaint
from small_sweeps import done, sweep_of
from undula.analysis.linear.leading_rate import leading_rate
from undula.analysis.ramps.ramp import Ramp, ramp_steps
from undula.analysis.regimes import names, names_without_symmetry
from undula.analysis.run_settings import Ending, Schedule
from undula.analysis.runs import credibility
from undula.analysis.runs.run import Run
from undula.analysis.runs.simulation import Simulation
from undula.arrays import State
from undula.models.model import Model

UNDULA = str(Path(sysconfig.get_path("scripts")) / "undula")
SEGMENTS = 10
#: Of a tip load: beyond the onset of spinning, at 37.7, up to flapping.
FORCES = (38.0, 40.0, 45.0, 60.0, 75.0, 100.0, 135.0, 160.0, 200.0, 250.0, 300.0)
AMPLITUDES = (1e-14, 1e-12, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2)
TOLERANCES = (1e-12, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2)
TEN = un.Filament(SEGMENTS, un.TipLoad(75.0))


def ended(model: Model, start: State, **more: float) -> Run:
    """Return a run to the settled state."""
    return un.integrate(model, start, **{"until": "settled", "limit": 2.0, "samples": 400, **more})


@cache
def stable(force: float) -> frozenset[str]:
    """Return the names of the solved states that are stable."""
    (found,) = un.stability_along_force(TEN, [force])
    names = {found["verdict"], *filter(None, found["also"].split(", "))}
    return frozenset(names - {"undecided"})


@dataclass(frozen=True)
class Case:
    """A kicked run at one force, with tolerances of its own."""

    force: float
    amplitude: float
    atol: float
    rtol: float = 1e-6
    seed: int = 1

    def verdict(self) -> str:
        model = TEN.with_(force=self.force)
        start = un.kicked(model, self.amplitude, seed=self.seed)
        return ended(model, start, atol=self.atol, rtol=self.rtol).verdict.name

    def contradicts(self, verdict: str) -> bool:
        """Tell whether a verdict is none of the stable states, where those are known."""
        return (
            verdict != "undecided"
            and bool(stable(self.force))
            and verdict not in stable(self.force)
        )


def contradicting(cases: list[Case]) -> tuple[list[tuple[Case, str]], Counter[str]]:
    """Return the cases whose verdict contradicts solved states, and how often there is which."""
    told = [(case, case.verdict()) for case in cases]
    wrong = [(case, verdict) for case, verdict in told if case.contradicts(verdict)]
    return wrong, Counter(verdict for _, verdict in told)


# ------------------------------------------------------------------ the table


def test_no_verdict_contradicts_the_solved_states() -> None:
    # Corners of the table, and of each seed some of its inside.
    some = np.random.default_rng(5).permutation(list(product(FORCES, AMPLITUDES, TOLERANCES)))
    cases = [Case(*map(float, one)) for one in some[:6]]
    cases += [Case(force, 1e-14, atol) for force in (38.0, 75.0) for atol in (1e-12, 1e-2)]
    cases += [Case(120.0, 1e-2, 1e-10, rtol) for rtol in (1e-3, 1e-2)]
    wrong, told = contradicting(cases)
    assert not wrong
    assert told["spinning"] + told["planar flapping"] > 0


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_no_verdict_of_the_whole_table_contradicts_the_solved_states(seed: int) -> None:
    inside = product(FORCES, AMPLITUDES, TOLERANCES, [1e-6, 1e-4, 1e-2])
    wrong, told = contradicting([Case(*one, seed=seed) for one in inside])
    assert not wrong
    print(f"seed {seed}: {dict(told)}")  # noqa: T201 - how many are undecided is of interest
    # What is kicked by ten thousand times the tolerance or more is told by itself.
    resolved = [
        Case(force, 1e-2, atol, seed=seed)
        for force, atol in product((45.0, 75.0, 100.0, 200.0), (1e-12, 1e-10, 1e-8, 1e-6))
    ]
    assert all(case.verdict() in stable(case.force) for case in resolved)


# ------------------------------------------------------------------ one rule each


@pytest.mark.parametrize("force", [38.0, 60.0, 75.0, 300.0])
def test_a_kick_that_is_damped_below_the_tolerance_is_not_called_straight(force: float) -> None:
    model = TEN.with_(force=force)
    found = ended(model, un.kicked(model, 1e-10)).verdict
    assert (found.name, found.margin) == ("undecided", 0.0)
    assert f"{leading_rate(model):.4g}/T" in found.reason
    assert "larger amplitude" in found.reason
    assert found.evidence["leading_rate"] == pytest.approx(leading_rate(model), rel=1e-12)


def test_the_same_kick_under_a_force_that_leaves_it_is_straight() -> None:
    model = TEN.with_(force=20.0)
    assert ended(model, un.kicked(model, 1e-6)).verdict.name == "straight"


def test_a_motion_that_falls_below_the_tolerance_is_not_seen_to_come_back() -> None:
    # Stable or not: where nothing is resolved, nothing was seen.
    model = TEN.with_(force=20.0)
    found = ended(model, un.kicked(model, 1e-9)).verdict
    assert found.name == "undecided"
    assert "atol" in found.reason


def test_what_stands_straight_where_that_is_unstable_is_undecided() -> None:
    found = ended(TEN, un.straight(TEN)).verdict
    assert found.name == "undecided"
    assert "unstable" in found.reason
    model = TEN.with_(force=20.0)
    assert ended(model, un.straight(model)).verdict.name == "straight"


def test_a_disturbance_that_first_falls_is_waited_for_until_it_grows() -> None:
    # A fast mode that falls at once, and a little of the growing one: a ten-thousandth of the start
    # would count as rest, and so little is still far above atol.
    model = TEN.with_(force=45.0)
    stiffness, drag = model.linearised()
    values, vectors = np.linalg.eig(-np.linalg.solve(drag, stiffness))
    order = np.argsort(values.real)
    fast, growing = (np.diff(vectors[:, k], prepend=0.0) for k in (order[0], order[-1]))
    slope = 1e-3 * fast / np.abs(fast).max() + 5e-8 * growing / np.abs(growing).max()
    across = np.sin(np.stack([slope.real, slope.imag], axis=1)) / SEGMENTS
    along = np.sqrt(SEGMENTS**-2 - (across**2).sum(axis=1))
    start = np.cumsum(np.column_stack([across, along]), axis=0).ravel()
    run = ended(model, start)
    assert run.verdict.name == "spinning"
    # Asked when it looked at rest, it was undecided, and told how much longer to run.
    early = un.integrate(model, start, until=0.02, samples=400).verdict
    assert early.name == "undecided"
    assert early.longer is not None
    assert 0.02 + early.longer < run.motion.time[-1]


@pytest.mark.slow
def test_a_held_body_that_rests_where_it_would_not_stay_is_undecided() -> None:
    # Beyond its Hopf point, and started there: the shape solved for is exact.
    held = un.Filament(8, un.TipLoad(100.0), natural_curvature=(1.0, 0.0))
    rest = un.find(held, "equilibrium")
    assert isinstance(rest, un.Equilibrium)
    assert not rest.stable
    found = un.integrate(held, rest.x, until="settled", limit=0.05, samples=400).verdict
    assert found.name == "undecided"
    calm = held.with_(force=10.0)
    assert ended(calm, calm.rest()).verdict.name == "at rest"


def test_a_run_whose_energy_does_not_balance_is_undecided() -> None:
    # Where nothing but the tolerance moves the body.
    model = TEN.with_(force=20.0)
    run = ended(model, un.kicked(model), atol=1e-2)
    assert run.health.power_balance_error > credibility.MAX_BALANCE_ERROR
    assert run.verdict.name == "undecided"
    assert "power balance" in run.verdict.reason
    assert "rtol" in run.verdict.reason


def test_the_balance_that_the_paper_drops_is_no_fault_of_the_run() -> None:
    held = un.Filament(
        8, un.TipLoad(100.0), natural_curvature=(2.0, 2.0), bending_ratio=1.5, twist="paper"
    )
    assert not held.balances
    run = ended(held, un.kicked(held, 0.1))
    assert run.verdict.name != "undecided" or "balance" not in run.verdict.reason


def test_modulation_is_not_told_from_coarse_steps_which_can_keep_it_alive() -> None:
    model = TEN.with_(force=145.0)
    coarse = ended(model, un.kicked(model), rtol=1e-4)
    assert coarse.verdict.name == "undecided"
    assert "rtol" in coarse.verdict.reason
    assert ended(model, un.kicked(model)).verdict.name == "spinning"


def test_a_run_that_fails_is_undecided_whatever_it_looks_like() -> None:
    finer = un.Filament(20, un.TipLoad(75.0))
    # Below round-off no step succeeds.
    run = ended(finer, un.kicked(finer, 1e-12), atol=1e-16)
    assert run.ending is Ending.FAILED
    assert (run.verdict.name, run.verdict.margin) == ("undecided", 0.0)
    assert "failed" in run.verdict.reason
    assert run.frequency is None


def test_a_run_that_comes_to_hold_a_number_that_is_not_finite_has_failed() -> None:
    simulation = Simulation.begin(TEN, un.kicked(TEN), Schedule(until=1.0))
    simulation.advance()
    simulation.memory.differences[0, 0] = np.nan
    while simulation.advance():
        pass
    run = Run.of(simulation)
    assert run.ending is Ending.FAILED
    assert run.verdict.name == "undecided"
    assert np.isfinite(run.motion.nodes).all()


@pytest.mark.parametrize(("name", "value"), [("rtol", 0.1), ("rtol", 1e-13), ("atol", 0.1)])
def test_tolerances_have_ends_that_the_sentence_tells(name: str, value: float) -> None:
    told = complaint(lambda: Schedule(**{name: value}))
    assert f"{name} = {value}" in told
    assert "0.01" in told
    told = complaint(lambda: un.integrate(TEN, un.kicked(TEN), **{name: value}))
    assert f"{name} = {value}" in told


# ------------------------------------------------------------------ one pipeline


BELOW = """
[model]
segments = 10
[start]
amplitude = 1e-10
[time]
until = "{until}"
samples = 400
limit = 2.0
[[study.axes]]
key = "load.force"
values = [20.0, 45.0, 75.0]
"""


@pytest.mark.parametrize("until", ["settled", "solved"])
def test_points_of_a_study_keep_to_the_same_rules(tmp_path: Path, until: str) -> None:
    stored = done(sweep_of(tmp_path, BELOW.format(until=until)), tmp_path / "s.zarr")
    verdicts = stored["verdict"].values.ravel()
    assert verdicts[1:].tolist() == ["undecided", "undecided"]
    assert all("unstable" in reason for reason in stored["reason"].values.ravel()[1:])


def test_undecided_points_can_be_decided_by_the_solved_states(tmp_path: Path) -> None:
    sweep = sweep_of(tmp_path, BELOW.format(until="settled"), "study.undecided=solve")
    verdicts = done(sweep, tmp_path / "s.zarr")["verdict"].values.ravel().tolist()
    assert verdicts == ["straight", "spinning", "spinning"]


def test_steps_of_a_series_keep_to_the_same_rules() -> None:
    course = Ramp("load.force", (60.0, 75.0), kick=0.0)
    schedule = Schedule(until="settled", limit=2.0, samples=400)
    steps = list(ramp_steps(TEN, course, un.kicked(TEN, 1e-10), schedule))
    assert [step.verdict for step in steps] == ["undecided", "undecided"]


@pytest.mark.slow
@pytest.mark.parametrize("command", ["run"])
def test_the_command_tells_it_with_the_cure(tmp_path: Path, command: str) -> None:
    words = ["--set", "model.segments=10", "--set", "start.amplitude=1e-10", "--json"]
    words += ["--set", 'time.until="settled"', "--no-movie", "--out", str(tmp_path / "r")]
    asked = subprocess.run(
        [UNDULA, command, *words], capture_output=True, text=True, timeout=300, check=False
    )
    assert asked.returncode == 0, asked.stderr
    answer = json.loads(asked.stdout)
    assert answer["verdict"] == "undecided"
    assert "smaller atol" in answer["reason"]


# ------------------------------------------------------------------ senses, and small words


@pytest.mark.parametrize("until", ["settled", "solved"])
def test_frequencies_are_positive_and_the_sense_is_in_the_rotation(until: str) -> None:
    start = un.kicked(TEN, 0.1)
    there, back = (ended(TEN, x, until=until) for x in (start, TEN.reflect(start)))
    for run in (there, back):
        assert run.verdict.name == "spinning"
        told = run.summary()
        assert run.frequency is not None
        assert run.frequency.value > 0.0
        assert told["frequency"] == run.frequency.value == told["evidence"]["frequency"]
        assert abs(told["rotation_frequency"]) == told["frequency"]
        assert "-" not in run.verdict.reason.split("turns")[0].replace("e-", "")
        assert told["evidence"]["turns"] * told["rotation_frequency"] > 0.0
    # A mirror image goes round the other way.
    one, other = (run.summary()["rotation_frequency"] for run in (there, back))
    assert one * other < 0.0


def test_a_run_does_not_settle_after_its_end() -> None:
    model = TEN.with_(force=20.0)
    for start in (un.straight(model), un.kicked(model)):
        run = ended(model, start)
        assert run.settled is not None
        assert run.settled.since <= run.motion.time[-1]
    stood = un.integrate(model, un.straight(model), until="settled")
    assert stood.settled is not None
    assert stood.settled.since == 0.0


def test_a_bent_body_that_starts_straight_has_not_settled_before_it_moves() -> None:
    held = un.Filament(8, un.TipLoad(0.0), natural_curvature=(1.0, 0.0))
    run = ended(held, un.straight(held))
    assert run.verdict.name == "at rest"
    # An arc of this curvature.
    assert run.last_shape[-1, 2] == pytest.approx(np.sin(1.0), abs=0.01)


def test_the_glossary_names_every_verdict() -> None:
    page = (ROOT / "docs" / "glossary.md").read_text(encoding="utf-8")
    (row,) = (line for line in page.splitlines() if line.startswith("| verdict "))
    words = Path(names.__file__).read_text(encoding="utf-8")
    words += Path(names_without_symmetry.__file__).read_text(encoding="utf-8")
    known = {"straight", "undecided", "chaotic"} | {
        line.split("|")[1].strip() for line in words.splitlines() if line.startswith("| ")
    }
    why_undecided = {name for name in known - {"name", "---"} if f"`{name}`" not in row}
    assert not why_undecided
