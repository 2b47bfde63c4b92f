"""States of filaments that are held in one direction: curved by nature, or not alike all round.

What they are made of is tested in test_framed_rod.py and test_curved_filament.py.
"""

import json
from functools import cache

import numpy as np
import pytest

import undula as un
from motions import ARC, BENT, Clock, ellipse, line, turned, wave
from refusal import complaint
from undula.analysis.observables.alignment import aligned_distance, fixed_distance
from undula.analysis.observables.precession import precession
from undula.analysis.regimes.classify import first_verdict
from undula.analysis.regimes.verdict import Verdict
from undula.analysis.solvers.branches import follow
from undula.analysis.solvers.equilibrium import find_equilibrium
from undula.analysis.states.not_found import NotFound
from undula.analysis.states.periodic_record import Periodic
from undula.analysis.states.records import Equilibrium
from undula.app.cli import main
from undula.arrays import Array
from undula.models.model import Model

CIRCLE = (2.0 * np.pi, 0.0)


def curved(force: float, curvature: tuple[float, float] = CIRCLE, **more: object) -> Model:
    options: dict[str, object] = {"twist": "paper"} | more
    return un.Filament(16, un.TipLoad(force), natural_curvature=curvature, **options)


def flat_sided(force: float, ratio: float) -> Model:
    return un.Filament(16, un.TipLoad(force), bending_ratio=ratio)


def found(state: object) -> Equilibrium:
    assert isinstance(state, Equilibrium), state
    return state


@pytest.mark.parametrize("twist", ["paper", "rigid", "elastic"])
def test_without_a_load_a_curved_filament_rests_unbent(twist: str) -> None:
    model = curved(0.0, twist=twist)
    state = found(find_equilibrium(model))
    assert np.abs(state.nodes - model.nodes(model.rest())).max() < 1e-12
    assert state.bending_energy.mean < 1e-20
    # The paper drops the twist moment, and so its filament can gain energy from nothing: bent to a
    # circle it begins to swing without any load.
    assert state.stable == (twist != "paper")


def test_the_shape_at_rest_is_an_arc_of_a_circle_to_second_order() -> None:
    errors = []
    for links in (16, 32, 64):
        model = un.Filament(links, un.TipLoad(0.0), natural_curvature=(1.5, 0.0))
        nodes = find_equilibrium(model).nodes
        s = np.linspace(0.0, 1.0, links + 1)
        # Curvature about e_x bends the filament towards -y.
        arc = np.stack([0.0 * s, (np.cos(1.5 * s) - 1.0) / 1.5, np.sin(1.5 * s) / 1.5], axis=1)
        errors.append(np.abs(nodes - arc).max())
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)
    assert errors[1] / errors[2] == pytest.approx(4.0, rel=0.05)


@pytest.mark.parametrize("twist", ["paper", "rigid", "elastic"])
def test_under_a_load_nothing_moves_and_a_push_dies_out_at_the_leading_rate(twist: str) -> None:
    state = found(find_equilibrium(curved(15.0, (2.0, 0.5), twist=twist)))
    assert np.abs(state.model.rhs(state.x)).max() < 1e-8
    assert state.stable
    random = np.random.default_rng(1).normal(size=state.x.size)
    # Long enough for others to have died out, and short enough for errors not to matter yet.
    until = 7.0 / abs(state.leading_rate)
    start = state.x + 1e-3 * random / state.model.links
    run = un.integrate(state.model, start, until=until, rtol=1e-9, atol=1e-13)
    away = np.linalg.norm(run.motion.nodes - state.nodes, axis=(1, 2))
    time = run.motion.time
    late = time > 0.6 * until
    rate = np.polyfit(time[late], np.log(away[late]), 1)[0]
    assert rate == pytest.approx(state.leading_rate, rel=0.1)


def onset(model: Model) -> float:
    found = un.threshold(model, "onset")
    assert found.value is not None
    assert found.frequency > 0.0
    return found.value


def test_the_onset_goes_to_that_of_the_straight_filament_as_the_curvature_goes() -> None:
    straight = un.onset(curved(1.0, (0.0, 0.0)), method="discrete").force
    shifts = [onset(curved(1.0, (k, 0.0))) - straight for k in (0.25, 0.5, 1.0)]
    # By symmetry it does with the square.
    assert shifts[2] / shifts[1] == pytest.approx(4.0, rel=0.05)
    assert shifts[1] / shifts[0] == pytest.approx(4.0, rel=0.05)


def test_runs_rest_below_the_onset_and_beat_beyond() -> None:
    at = onset(curved(1.0))
    below, beyond = (
        un.integrate(curved(f * at), un.kicked(curved(f * at), 0.1), until="settled", limit=6.0)
        for f in (0.93, 1.07)
    )
    assert below.verdict.name == "at rest"
    assert beyond.verdict.name == "asymmetric flapping"
    assert below.ending.value == beyond.ending.value == "settled"


def test_onset_and_equilibrium_can_be_asked_along_the_curvature() -> None:
    state = found(find_equilibrium(curved(20.0, (1.0, 0.0))))
    branch = follow(state, "model.natural_curvature.k1", 4.0)
    assert branch.complete
    alone = found(find_equilibrium(curved(20.0, (4.0, 0.0))))
    assert np.abs(branch.states[-1].nodes - alone.nodes).max() < 1e-9
    (one, other) = un.threshold(
        curved(1.0), "onset", along=("model.natural_curvature.k1", (1.0, 4.0))
    )
    assert one.value == pytest.approx(onset(curved(1.0, (1.0, 0.0))), rel=1e-8)
    assert other.value == pytest.approx(onset(curved(1.0, (4.0, 0.0))), rel=1e-8)


def test_in_its_two_planes_an_anisotropic_filament_has_the_forces_of_its_two_stiffnesses() -> None:
    straight = un.onset(curved(1.0, (0.0, 0.0)), method="discrete")
    state = found(find_equilibrium(flat_sided(1.0, 1.5)))
    hopf = [one for one in follow(state, "load.force", 70.0).bifurcations if one.kind == "Hopf"]
    # Located to 1e-9 of the way that is followed.
    assert hopf[0].value == pytest.approx(straight.force, abs=1e-6)
    assert hopf[1].value == pytest.approx(1.5 * straight.force, abs=1e-6)
    assert hopf[1].second_frequency == pytest.approx(1.5 * straight.hopf.frequency, rel=1e-6)


@cache
def beating(ratio: float) -> Periodic:
    model = flat_sided(75.0, ratio)
    run = un.integrate(model, un.planar(model, 0.3, angle=0.5 * np.pi), until="settled", limit=3.0)
    state = un.find(model, "periodic", guess=run)
    assert isinstance(state, Periodic)
    return state


@pytest.mark.slow
def test_a_planar_beat_in_the_soft_plane_is_that_of_the_round_filament() -> None:
    flapping = un.find(curved(75.0, (0.0, 0.0)), "flapping")
    state = beating(1.7)
    beats = round(state.period * flapping.frequency)
    assert state.period * flapping.frequency == pytest.approx(beats, rel=1e-6)
    in_plane = flapping.in_plane[0].real
    assert np.abs(state.exponents.real - in_plane).min() < 1e-3 * abs(in_plane)
    assert max(state.trivial) < 1e-6


@pytest.mark.slow
def test_anisotropy_turns_spinning_into_planar_beating() -> None:
    # Clarke, Hwang & Keaveny (2025) find planar beating stabilised by a ratio near 2.
    branch = follow(beating(1.7), "model.bending_ratio", 1.3)
    (gone,) = (one for one in branch.bifurcations if one.loses)
    assert 1.3 < gone.value < 1.7
    for part, word in ((0.95, "modulated spinning"), (1.05, "planar flapping")):
        model = flat_sided(75.0, part * gone.value)
        run = un.integrate(model, un.kicked(model, 0.2), until="settled", limit=1.5)
        assert run.verdict.name == word


@pytest.mark.slow
@pytest.mark.parametrize(
    ("force", "word"), [(100.0, "asymmetric spinning"), (250.0, "asymmetric flapping")]
)
def test_a_beat_of_a_curved_filament_is_solved_for(force: float, word: str) -> None:
    model = curved(force)
    run = un.integrate(model, un.kicked(model, 0.1), until="settled", limit=3.0)
    assert run.verdict.name == word
    state = un.find(model, "periodic", guess=run)
    assert isinstance(state, Periodic)
    assert state.residual < 1e-10
    assert max(state.trivial) < 1e-6
    assert state.stable
    # A run settles to 1e-4, its period is known better.
    assert state.period == pytest.approx(run.settled.period, rel=1e-4)
    again = un.integrate(model, state.start, until=state.period, samples=2, rtol=1e-9)
    assert np.abs(again.motion.nodes[-1] - again.motion.nodes[0]).max() < 1e-4


def test_a_run_that_does_not_repeat_itself_gives_no_orbit() -> None:
    model = curved(20.0)
    run = un.integrate(model, un.kicked(model, 0.1), until=0.01)
    state = un.find(model, "periodic", guess=run)
    assert isinstance(state, NotFound)
    assert "run until it has settled" in state.reason


REFUSED = {
    "is straight at rest": lambda: find_equilibrium(curved(20.0, (0.0, 0.0))),
    "natural_curvature = (0, 0)": lambda: un.find(curved(100.0), "spinning"),
    "has no turning symmetry": lambda: un.find(curved(100.0), "flapping"),
    "periodic motions begin where others": lambda: un.follow_from_onset(
        curved(1.0), "periodic", 50.0
    ),
}


@pytest.mark.parametrize("words", REFUSED)
def test_what_a_held_body_has_not_is_refused(words: str) -> None:
    assert words in complaint(REFUSED[words])


def told(capsys: pytest.CaptureFixture[str], *words: str) -> dict[str, object]:
    shape = ["--set", "model.segments=12", "--set", "model.natural_curvature=[3.0, 0.0]"]
    assert main([*words, *shape, "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert isinstance(answer, dict)
    return answer


def test_the_commands_know_of_equilibria(capsys: pytest.CaptureFixture[str]) -> None:
    answer = told(capsys, "find", "equilibrium", "--set", "load.force=20")
    assert answer["kind"] == "equilibrium"
    assert answer["stable"]
    assert answer["frequency"] == 0.0
    branch = told(capsys, "follow", "equilibrium", "--along", "load.force=0:60")
    lost = branch["bifurcations"][0]
    threshold = told(capsys, "threshold", "onset")
    assert threshold["value"] == pytest.approx(lost["value"], rel=1e-6)
    assert threshold["bifurcation"] == lost["kind"] == "Hopf"


# ---------------------------------------------------------------- names


def name_of(time: Array, sides: Array, noise: float = 0.0) -> Verdict:
    return first_verdict(*line(time, sides, noise).data, settled_from=None, axisymmetric=False)


def askew(time: Array) -> Array:
    """Circles about an axis that leans."""
    return BENT * np.exp(2j * np.pi * time[:, None]) + 0.1 * ARC**2


NAMES = {
    "at rest": lambda t: np.broadcast_to(BENT, (t.size, ARC.size)),
    "modulated spinning": lambda t: ellipse(t, 0.8),
    "asymmetric spinning": askew,
    "planar flapping": lambda t: turned(wave(t), 0.2),
    "asymmetric flapping": lambda t: turned(wave(t) + 0.3 * ARC**2, 0.2),
    "non-planar flapping": lambda t: ellipse(t, 0.1),
    "precessing flapping": lambda t: turned(wave(t), 0.2 * t) + 0.05 * ARC**2,
}


@pytest.mark.parametrize("word", NAMES)
def test_motions_of_held_bodies_have_names_of_their_own(word: str) -> None:
    verdict = name_of(Clock().time, NAMES[word](Clock().time) + 0j)
    assert verdict.name == word, verdict.reason
    assert verdict.margin >= 1.0


def test_a_held_body_that_turns_slowly_has_not_come_back() -> None:
    # Up to turns it is a planar beat in a slowly turning plane; as it is it comes back to nothing.
    slow = name_of(Clock().time, turned(wave(Clock().time), 0.0013 * Clock().time))
    assert slow.name == "undecided"


def test_shapes_are_compared_as_they_are_or_up_to_turns() -> None:
    shape = line(np.array([0.0, 1.0]), turned(np.stack([BENT, BENT]), np.array([0.0, 0.25]))).data[
        1
    ]
    assert aligned_distance(shape[0], shape[1]).distance < 1e-12
    apart = np.linalg.norm(shape[0] - shape[1], axis=-1)
    assert 0.3 * apart.max() < fixed_distance(shape[0], shape[1]).distance < apart.max()


# ---------------------------------------------------------------- how they go round


def test_a_beat_in_a_turning_plane_is_measured() -> None:
    time = Clock(60.0, 40.0).time
    found = precession(time, line(time, turned(ellipse(time, 0.1), 0.03 * time)).nodes)
    assert found is not None
    # The edges of the window cut a beat each.
    assert found.plane_turns == pytest.approx(0.03, rel=0.02)
    assert found.beats == pytest.approx(1.0, rel=0.02)
    # The tip goes round once a beat on top of it.
    assert found.tip_turns == pytest.approx(1.03, rel=0.02)


def test_sides_of_the_plane_are_told() -> None:
    time = Clock(40.0, 40.0).time
    phase = 2.0 * np.pi * time[:, None]
    to_and_fro = 0.3 * ARC**2 * np.cos(phase)
    # Beyond its plane on one side at every maximum, or on the other side half a beat later.
    same = precession(time, line(time, to_and_fro + 0.03j * ARC**2 * np.cos(2.0 * phase)).nodes)
    assert same is not None
    assert same.side_switching == 0.0
    assert abs(same.plane_turns) < 1e-3
    # Every second beat on the other side: + - - + at its maxima, two a beat.
    slow = precession(
        time, line(time, to_and_fro + 0.03j * ARC**2 * np.cos(0.5 * phase + 0.6)).nodes
    )
    assert slow is not None
    assert slow.side_switching == pytest.approx(0.5, abs=0.05)


def test_a_curved_run_tells_how_it_goes_round() -> None:
    model = curved(100.0)
    run = un.integrate(model, un.kicked(model, 0.1), until="settled", limit=3.0)
    told = run.summary()["precession"]
    assert abs(told["tip_turns"]) == pytest.approx(abs(run.frequency.value), rel=0.05)
    round_one = curved(100.0, (0.0, 0.0))
    spun = un.integrate(round_one, un.kicked(round_one, 0.1), until="settled", limit=3.0)
    assert spun.summary()["precession"] is None


# ---------------------------------------------------------------- the figure


def test_the_figure_of_winding_shows_angle_and_height_of_the_tip() -> None:
    time = np.linspace(0.0, 3.0, 301)
    nodes = line(time, askew(time)).nodes
    figure = un.views.winding_figure([un.views.TipAngleSeries("askew", time, nodes, 1.0)])
    traces = [one for axes in figure.axes for one in axes.lines if one.get_gid() == "trace"]
    angle, height = (one.get_ydata() for one in traces)
    assert angle[-1] - angle[0] == pytest.approx(6.0 * np.pi, abs=0.1)
    assert height == pytest.approx(nodes[:, -1, 2])
    assert "give at least one" in complaint(lambda: un.views.winding_figure([]))
