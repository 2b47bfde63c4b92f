"""Runs whose end is known from solved states: each is named rightly or not at all."""

from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest

import undula as un
from cases import mostly_slow
from undula.analysis.regimes.lyapunov import lyapunov
from undula.analysis.run_settings import Schedule
from undula.analysis.runs.checkpoint import checkpoint, resume
from undula.analysis.runs.integrate import carry_on
from undula.analysis.runs.simulation import Simulation
from undula.analysis.solvers.flapping import find_flapping
from undula.analysis.solvers.spinning import find_spinning
from undula.analysis.states.periodic_record import Periodic
from undula.arrays import Array
from undula.models.initial_states import leading_mode
from undula.models.model import Model

SEGMENTS = 20


def tip(force: float, **more: object) -> Model:
    return un.Filament(SEGMENTS, un.TipLoad(force), **more)


def chain(count: int, force: float, **more: object) -> Model:
    return un.Chain(count, un.TipLoad(force), **more)


@cache
def solved(model: Model) -> dict[str, un.Spinning | un.Flapping | None]:
    """The stable states of a model by the name of a run that ends there; None is straight."""
    found: dict[str, un.Spinning | un.Flapping | None] = {}
    if leading_mode(model)[0].real < 0.0:
        found["straight"] = None
    if model.dimension == 3 and (spinning := un.find(model, "spinning")) and spinning.stable:
        found["spinning"] = spinning
    if (flapping := un.find(model, "flapping")) and flapping.stable:
        found["planar flapping"] = flapping
    return found


@dataclass(frozen=True)
class Case:
    """A run to the settled state, from a kick of this seed or from near a solved state."""

    model: Model
    start: int | str = 1
    off: float = 1e-2

    @property
    def name(self) -> str:
        body = "" if isinstance(self.model, un.Filament) else f"{self.model.links} links, "
        plane = ", confined" if self.model.dimension == 2 else ""
        start = f"kick {self.start}" if isinstance(self.start, int) else f"near {self.start}"
        return f"{body}{self.model.load}{plane}, {start}, {self.off:g}"

    def begin(self) -> Array:
        if isinstance(self.start, int):
            return un.kicked(self.model, self.off, seed=self.start)
        find = find_spinning if self.start == "spinning" else find_flapping
        state = find(self.model)
        nodes = state.nodes if state.nodes.ndim == 2 else state.nodes[0]
        x = self.model.from_nodes(nodes)
        random = np.random.default_rng(1)
        return self.model.admissible(x + self.off / self.model.links * random.normal(size=x.size))

    @cache  # noqa: B019  (as many as there are cases)
    def run(self) -> un.Run:
        return un.integrate(self.model, self.begin(), until="settled", limit=200.0)


CASES = [
    *(Case(tip(force)) for force in (20.0, 25.0, 30.0, 36.0, 38.0, 40.0, 45.0, 60.0, 75.0, 100.0)),
    *(Case(tip(force)) for force in (130.0, 160.0, 190.0, 200.0, 230.0, 260.0, 290.0, 310.0)),
    *(Case(tip(force), seed, 0.5) for force in (75.0, 178.0, 200.0) for seed in (2, 3)),
    *(Case(tip(force), "spinning") for force in (40.0, 100.0, 170.0, 180.0, 180.5, 190.0, 300.0)),
    *(Case(tip(force), "flapping") for force in (45.0, 120.0, 174.0, 178.0, 200.0, 300.0, 315.0)),
    *(Case(tip(force, confined=True)) for force in (30.0, 75.0, 250.0)),
    Case(tip(75.0, inextensibility="weak", tensile_stiffness=1e4)),
    *(Case(un.Filament(SEGMENTS, un.LinearLoad(force, 0.5))) for force in (60.0, 200.0, 500.0)),
    *(Case(un.Filament(SEGMENTS, un.PointLoad(force, 0.6))) for force in (80.0, 150.0, 300.0)),
    *(Case(un.Filament(SEGMENTS, un.PowerLoad(force, 3.0))) for force in (100.0, 250.0)),
    *(Case(chain(2, force)) for force in (4.0, 10.0, 60.0)),
    *(Case(chain(3, force)) for force in (4.0, 10.0, 20.0)),
    *(Case(chain(4, force)) for force in (4.0, 20.0, 30.0)),
    *(Case(chain(5, force)) for force in (4.0, 10.0)),
    *(Case(chain(6, force)) for force in (4.0, 10.0, 30.0)),
    *(Case(chain(3, force, confined=True)) for force in (5.0, 12.0)),
]


def ids(cases: list[Case]) -> list[str]:
    return [case.name for case in cases]


@pytest.mark.parametrize(
    "case", mostly_slow(CASES, lambda case: case in CASES[::5]), ids=ids(CASES)
)
def test_no_run_gets_a_wrong_name(case: Case) -> None:
    found, right = case.run().verdict, solved(case.model)
    assert right, "a case whose end is not known"
    assert found.name in (*right, "undecided"), found.reason
    state = right.get(found.name)
    if state is not None:
        # A run settles to 1e-4 of the displacement, and its frequency better than that.
        assert abs(case.run().frequency.value) == pytest.approx(state.frequency, rel=1e-3)


@pytest.mark.slow
def test_hardly_any_run_to_the_settled_state_is_left_undecided() -> None:
    left = [case.name for case in CASES if case.run().verdict.name == "undecided"]
    assert len(left) <= 0.05 * len(CASES), left


@pytest.mark.slow
@pytest.mark.parametrize(
    ("force", "kind"),
    [(100.0, "flapping"), (170.0, "flapping"), (200.0, "spinning"), (250.0, "spinning")],
)
def test_a_run_that_still_leaves_an_unstable_state_is_not_named_wrongly(
    force: float, kind: str
) -> None:
    case = Case(tip(force), kind, 1e-3)
    find = find_spinning if kind == "spinning" else find_flapping
    state = find(case.model)
    left = {"spinning": "spinning", "flapping": "planar flapping"}[kind]
    right, seen = {left, *solved(case.model), "undecided"}, []
    # From where nothing can be seen of it to where it is over.
    for folds in (1.0, 3.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 12.0, 14.0, 17.0, 20.0, 30.0, 60.0):
        run = un.integrate(case.model, case.begin(), until=folds / state.leading_rate)
        seen.append(run.verdict.name)
        assert seen[-1] in right, f"after {folds:g} e-foldings: {run.verdict.reason}"
    # What it leaves is not named any longer once it leaves visibly.
    assert left not in seen[seen.index("undecided") :]
    assert seen[-1] in solved(case.model)


@pytest.mark.parametrize(
    ("force", "until"), [(36.0, 0.15), (37.0, 0.3), (45.0, 0.15), (75.0, 0.04), (200.0, 0.02)]
)
def test_an_undecided_run_is_decided_when_it_goes_on_as_long_as_it_is_told(
    force: float, until: float
) -> None:
    model = tip(force)
    start, name, tries = un.kicked(model, 1e-3), "undecided", 0
    while name == "undecided":
        run = un.integrate(model, start, until=until)
        name, tries = run.verdict.name, tries + 1
        until += run.verdict.longer or 0.0
        assert tries < 6
    assert tries > 1
    assert name in solved(model)


@cache
def beyond(force: float) -> un.Run:
    model = tip(force)
    return un.integrate(model, un.kicked(model), until="settled")


@pytest.mark.parametrize("force", [340.0, 400.0, 500.0, 600.0])
def test_beyond_planar_flapping_a_run_ends_in_a_stable_motion_that_goes_round(
    force: float,
) -> None:
    run = beyond(force)
    assert run.verdict.name == "modulated spinning"
    state = un.find(run.model, "periodic", guess=run)
    assert isinstance(state, Periodic)
    assert state.exponents[0].real < 0.0
    seen = run.verdict.evidence
    repeats = round(seen["shape_period"] / state.period)
    # Returns are seen to 5e-3 of the displacement at worst.
    assert seen["shape_period"] == pytest.approx(repeats * state.period, rel=1e-3)
    off = np.exp(1j * (seen["turn_a_period"] - repeats * state.angle))
    assert abs(np.angle(off)) < 5e-3


@pytest.mark.slow
def test_just_beyond_planar_flapping_a_run_ends_in_a_beat_that_is_in_no_plane() -> None:
    # Flapping is lost at 316.17 in a symmetry breaking, which keeps the frequency.
    run = beyond(320.0)
    assert run.verdict.name == "non-planar flapping"
    assert run.frequency.value == pytest.approx(un.find(run.model, "flapping").frequency, rel=0.01)
    assert not un.find(run.model, "flapping").stable
    found = lyapunov(run.model, run.model.from_nodes(run.motion.nodes[-1]), 0.5)
    assert found.beyond_symmetry < -3.0 * found.beyond_symmetry_error


@pytest.mark.parametrize("force", [800.0, 1000.0, pytest.param(1500.0, marks=pytest.mark.slow)])
def test_at_large_forces_runs_end_in_chaos(force: float) -> None:
    run = beyond(force)
    assert run.ending.value == "irregular"
    assert run.verdict.name == "chaotic"
    assert run.lyapunov.beyond_symmetry > 3.0 * run.lyapunov.beyond_symmetry_error


@pytest.mark.parametrize(
    ("count", "force"),
    [(3, 100.0), (4, 150.0), (5, 200.0), pytest.param(4, 60.0, marks=pytest.mark.slow)],
)
def test_chains_of_three_to_five_links_windmill_at_large_forces(count: int, force: float) -> None:
    # Ling, Guo & Kanso (2018), on chains: the upper links turn about an axis across z.
    model = chain(count, force)
    run = un.integrate(model, un.kicked(model), until="settled", limit=100.0)
    assert run.verdict.name == "windmilling"
    links = np.diff(run.window.nodes, axis=1)
    upright = links[:, -1, 2] / np.linalg.norm(links[:, -1], axis=1)
    # The last link points up and down, once a turn: many times.
    assert np.count_nonzero(np.diff(np.sign(upright))) > 20
    assert upright.min() < -0.9
    assert upright.max() > 0.9


def test_a_run_that_has_settled_but_cannot_be_named_goes_on_until_it_can() -> None:
    # Out of a plane it dies out so slowly that the motion repeats itself long before it is planar.
    model = un.Filament(20, un.PowerLoad(193.2, exponent=10.0))
    simulation = Simulation.begin(
        model, un.kicked(model, 0.3), Schedule("settled", limit=20.0, rtol=1e-5)
    )
    assert carry_on(simulation).verdict.name == "planar flapping"
    asked_for = simulation.observe_until
    assert simulation.observation.until < asked_for <= simulation.time
    # What was asked for outlasts a stop.
    resumed = resume(model, simulation.schedule, checkpoint(simulation))
    assert resumed.observe_until == asked_for
