"""The units of a chain's numbers are named wherever a user sees one, and no filament's are."""

import json
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

import undula as un
from commands import Ask, answer, text
from refusal import complaint
from undula.analysis.states.branch import Branch
from undula.analysis.states.not_found import NotFound
from undula.analysis.states.records import Spinning
from undula.app.cli import main
from undula.storage.run_file import load_result
from undula.views import (
    bifurcation_diagram,
    growth_figure,
    portrait,
    stability_portrait,
    threshold_curves,
    threshold_figure,
)

TWO = un.Chain(links=2, load=un.TipLoad(8.0))
FEW = un.Filament(segments=8, load=un.TipLoad(75.0))
UNITS = {
    "length": "L",
    "force": "K/L",
    "energy": "K",
    "power": "K^2/(zeta L^2)",
    "time": "zeta L^2/K",
    "frequency": "cycles per T",
}
CHAIN = ["--set", "model.kind=chain", "--set", "model.links=2", "--set", "load.force=8"]
SHORT = ["--set", "time.until=0.02", "--set", "time.samples=5", "--no-movie", "--overwrite"]
#: Each command, with how many times its text tells an energy.
COMMANDS = {
    "run": (["run", *SHORT], 1),
    "onset": (["stability"], 0),
    "growth": (["stability", "--forces", "2,4"], 0),
    "curve": (["stability", "--along", "model.drag_ratio=1,2"], 0),
    "find": (["find", "spinning"], 1),
    "follow": (["follow", "spinning", "--along", "load.force=onset:7"], 0),
    "straight": (["follow", "straight", "--along", "load.force=4:7"], 0),
    "threshold": (["threshold", "onset"], 0),
    "thresholds": (["threshold", "onset", "--along", "model.drag_ratio=1,2"], 0),
    "nothing": (["find", "spinning", "--set", "load.force=4"], 0),
}


pytestmark = pytest.mark.usefixtures("own_folder")


def said(ask: Ask, command: str, *words: str) -> str:
    """Return what a command says of the chain of two links."""
    # Of two settings of one key the later one holds.
    return text(ask(command, *CHAIN, *words))


def beside(force: float, links: int) -> Any:
    """Return what stands beside a force: a link is the N-th part of L, and B = K L/N."""
    # Products and quotients, each rounded once or twice.
    return pytest.approx({"K/l": force / links, "B/L^2": force * links}, rel=1e-15)


def answered(ask: Ask, command: str, *words: str) -> dict[str, Any]:
    return answer(ask(command, *CHAIN, *words, "--json"))


# ---------------------------------------------------------------- answers and texts


@pytest.mark.parametrize("name", COMMANDS)
def test_every_answer_of_a_chain_holds_the_names_of_its_units(name: str, ask: Ask) -> None:
    assert answered(ask, *COMMANDS[name][0])["units"] == UNITS


@pytest.mark.parametrize("name", COMMANDS)
def test_every_text_of_a_chain_tells_its_force_and_its_time_below_the_heading(
    name: str, ask: Ask
) -> None:
    words, energies = COMMANDS[name]
    head, second, *lines = said(ask, *words).splitlines()
    assert head.startswith("chain of 2 links, ")
    assert second.startswith("  force in K/L, T = zeta L^2/K")
    rest = "\n".join([head, *lines])
    assert "zeta" not in rest
    # Neither the energy of a filament nor its force alone.
    assert not re.search(r"B/L(?!\^2)", rest)
    assert len(re.findall(r"B/L\^2", rest)) == len(re.findall(r"K/l", rest))
    assert len(re.findall(r" K(,|\n)", rest)) == energies


@pytest.mark.slow
def test_a_force_beside_a_chains_own_is_explained_where_it_is_told(ask: Ask) -> None:
    explained = set()
    for name, (words, _) in COMMANDS.items():
        head, second, *lines = said(ask, *words).splitlines()
        if any("K/l" in line for line in (head, *lines)):
            assert second.endswith("; l = L/N, B = K l of the filament it stands for"), name
            explained.add(name)
    assert explained == {"onset", "curve", "straight", "threshold", "thresholds"}


def test_the_force_that_two_links_bear_is_told_in_all_units(ask: Ask) -> None:
    told = r"6(\.0+ ± \S+)? K/L \(3 K/l or 12 B/L\^2\)"
    for name, line in (
        ("onset", rf"  oscillates from  {told}\n"),
        ("straight", rf"  Hopf at {told}: 0\.6366198 cycles per T\n"),
        ("threshold", rf"tip load: onset at force {told} \(Hopf\), 0\.6366198 cycles per T\n"),
        ("thresholds", rf"\n +2  at force {told} \(Hopf\), "),
        ("curve", r"\n +2 +4 +6 +\S+ +3 +12 +0\.6366"),
    ):
        assert re.search(line, said(ask, *COMMANDS[name][0])), name


def test_every_force_that_is_answered_has_the_others_beside_it(ask: Ask) -> None:
    # Matrices of two rows: a few roundings on the way to 6 K/L.
    onset_in = pytest.approx({"K/l": 3.0, "B/L^2": 12.0}, rel=1e-12)
    onset = answered(ask, *COMMANDS["onset"][0])
    assert onset["hopf_force"] == pytest.approx(6.0, rel=1e-12)
    assert onset["hopf_force_in"] == onset_in
    # Where the two eigenvalues meet: F^2 - 12 F + 32 = 0.
    assert onset["oscillatory_force_in"] == pytest.approx({"K/l": 2.0, "B/L^2": 8.0}, rel=1e-12)
    assert onset["force_in"] == {"K/l": 4.0, "B/L^2": 16.0}
    for name in ("run", "find"):
        found = answered(ask, *COMMANDS[name][0])
        assert (found["force"], found["force_in"]) == (8.0, {"K/l": 4.0, "B/L^2": 16.0})
    assert answered(ask, *COMMANDS["threshold"][0])["force_in"] == onset_in
    curves = answered(ask, *COMMANDS["curve"][0]), answered(ask, *COMMANDS["thresholds"][0])
    for curve, key in zip(curves, ("hopf_force_in", "force_in"), strict=True):
        assert [one[key] for one in curve["thresholds"]] == [onset_in, onset_in]
    (hopf,) = answered(ask, *COMMANDS["straight"][0])["bifurcations"]
    assert hopf["force_in"] == onset_in


def test_later_crossings_and_bifurcations_of_states_have_theirs(ask: Ask) -> None:
    three = ["--set", "model.links=3"]
    words = ["follow", "spinning", "--along", "load.force=46:47", *three]
    (torus,) = answered(ask, *words)["bifurcations"]
    assert torus["force_in"] == beside(torus["value"], 3)
    told = f"({torus['value'] / 3.0:.6g} K/l or {3.0 * torus['value']:.6g} B/L^2)"
    assert f" K/L {told}: " in said(ask, *words)
    later = answered(ask, "stability", "--set", "model.links=6")["later"]
    assert later
    for one in later:
        assert one["force_in"] == beside(one["force"], 6)


@pytest.mark.parametrize("command", ["stability", "threshold onset"])
def test_along_the_number_of_links_each_has_a_length_of_its_own(command: str, ask: Ask) -> None:
    found = answered(ask, *command.split(), "--along", "model.links=2,3")["thresholds"]
    for links, one in zip((2, 3), found, strict=True):
        force, told = (
            (one["value"], one["force_in"])
            if "value" in one
            else (one["hopf_force"], one["hopf_force_in"])
        )
        assert told == beside(force, links)
    assert "17.4894" in said(ask, *command.split(), "--along", "model.links=2,3")


def test_what_is_no_force_has_no_other_units_beside_it(ask: Ask) -> None:
    words = ["follow", "straight", "--along", "model.base_spring=0.5:4", "--set", "load.force=6.5"]
    found = answered(ask, *words)
    (hopf,) = found["bifurcations"]
    assert "force_in" not in hopf
    assert "K/l" not in said(ask, *words)
    one = answered(ask, "threshold", "onset", "--set", "model.links=1")
    assert one["value"] is None
    assert "force_in" not in one
    assert "force_in" not in answered(ask, *COMMANDS["nothing"][0])


def test_two_links_are_straight_at_four_per_length_of_chain_and_spin_at_four_per_link() -> None:
    # Ling, Guo & Kanso (2018) show them spinning at F = 4 and name the unit K/L.
    assert isinstance(un.find(TWO.with_(load=un.TipLoad(4.0)), "spinning"), NotFound)
    assert max(un.spectrum(TWO.with_(load=un.TipLoad(4.0))).rates) < 0.0
    assert TWO.units.force_in(8.0)["K/l"] == 4.0
    spinning = un.find(TWO, "spinning")
    assert isinstance(spinning, Spinning)
    assert spinning.stable


def test_chains_tend_to_the_filament_of_their_further_units_as_one_over_links() -> None:
    links = np.array([50, 100, 200])
    chains = [un.Chain(int(count), un.TipLoad(1.0)) for count in links]
    onsets = [un.onset(chain) for chain in chains]
    filament = un.onset(FEW, method="spectral")
    forces = [
        chain.units.force_in(onset.force)["B/L^2"]
        for chain, onset in zip(chains, onsets, strict=True)
    ]
    frequencies = [
        chain.units.duration * onset.frequency for chain, onset in zip(chains, onsets, strict=True)
    ]
    for told, limit in ((forces, filament.force), (frequencies, filament.frequency)):
        away = np.log(np.abs(np.array(told) - limit))
        assert np.polyfit(np.log(links), away, 1)[0] == pytest.approx(-1.0, abs=0.15)


def test_a_filaments_answers_name_its_own_units_and_no_others(ask: Ask) -> None:
    for words in (["stability"], ["find", "spinning"], ["threshold", "onset"], ["run", *SHORT]):
        asked = [*words, "--set", "model.kind=filament", "--set", "model.segments=8"]
        found = text(ask(*asked, "--json"))
        assert json.loads(found)["units"] == FEW.units.names()
        assert "force_in" not in found
        assert not re.search("zeta|K/|B = K l", text(ask(*asked)))


# ---------------------------------------------------------------- stored runs


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Give a stored run of a chain and one of a filament, made once."""
    folder = tmp_path_factory.mktemp("runs")
    few = ["--set", "model.segments=8"]
    for name, model in (("chain", CHAIN), ("filament", few)):
        assert main(["run", *SHORT, *model, "--out", str(folder / name)]) == 0
    return {name: load_result(folder / name / "run.nc") for name in ("chain", "filament")}


def test_the_variables_of_a_stored_chain_carry_its_units(runs: dict[str, Any]) -> None:
    energies = ("bending_energy", "stretching_energy", "work", "loss")
    for name, time, energy, power in (
        ("chain", "zeta L^2/K", "K", "K^2/(zeta L^2)"),
        ("filament", "L^4 zeta_perp / B", "B/L", "B^2/(zeta_perp L^5)"),
    ):
        units = {key: one.attrs.get("units") for key, one in runs[name].variables.items()}
        assert units["time"] == time
        assert {units[key] for key in energies} == {energy}
        assert {units[key] for key in ("active_power", "dissipation")} == {power}
        assert (units["nodes"], units["arclength"]) == ("L", "L")


def test_the_portrait_of_a_stored_chain_names_its_units(runs: dict[str, Any]) -> None:
    said = words_of(portrait(runs["chain"]))
    for label in ("$E$  $[K]$", "$P$  $[K/T]$", r"$[T=\zeta L^2/K]$"):
        assert label in said
    assert "B" not in said
    assert r"$[T=\zeta_\perp L^4/B]$" in words_of(portrait(runs["filament"]))


# ---------------------------------------------------------------- figures


def words_of(figure: Figure) -> str:
    """Return all that is written on a figure."""
    figure.canvas.draw()
    said = [text.get_text() for text in figure.texts]
    for axes in figure.axes:
        said += [axes.get_xlabel(), axes.get_ylabel(), axes.get_title("left")]
    return "\n".join(said)


def branch(model: Any) -> Branch[Spinning]:
    state = un.find(model, "spinning")
    assert isinstance(state, Spinning)
    return Branch("load.force", np.array([state.force]), (state,), (), complete=True)


def drawn(name: str, model: Any) -> Figure:
    """Return a figure of a kind about a model."""
    told: dict[str, Any] = {"title": "", "units": model.units.names()}
    growth = un.growth_curve(model, [1.0, 5.0])
    curve = un.critical_curve(model, "model.drag_ratio", [1.0, 2.0])
    lines = [("onset", curve.values, curve.forces, curve.errors)]
    maps = {"parameter": "model.drag_ratio", "values": [1.0, 2.0]}
    draw: dict[str, Callable[[], Figure]] = {
        "growth": lambda: growth_figure(growth, **told),
        "maps": lambda: growth_figure(un.growth_curve(model, [1.0, 5.0], **maps), **told),
        "stability": lambda: stability_portrait(
            un.onset(model), growth, un.spectrum(model), **told
        ),
        "thresholds": lambda: threshold_figure(curve, **told),
        "several": lambda: threshold_curves(lines, parameter=curve.parameter, **told),
        "diagram": lambda: bifurcation_diagram([branch(model)], title=""),
    }
    return draw[name]()


@pytest.mark.parametrize(
    "name", ["growth", "maps", "stability", "thresholds", "several", "diagram"]
)
def test_every_figure_has_the_unit_of_its_model_on_the_axis_of_forces(name: str) -> None:
    for model, label, other in ((TWO, "[K/L]", "[B/L^2]"), (FEW, "[B/L^2]", "[K/L]")):
        said = words_of(drawn(name, model))
        assert f"$F$  ${label}$" in said
        assert other not in said


def test_the_energy_of_a_branch_of_chains_and_its_base_spring_have_their_units() -> None:
    assert "$E$  $[K]$" in words_of(drawn("diagram", TWO))
    curve = un.critical_curve(TWO, "model.base_spring", [1.0, 2.0])
    assert "$K_0$  $[K]$" in words_of(threshold_figure(curve, title=""))


def test_branches_and_runs_in_different_units_are_not_drawn_on_one_axis(
    runs: dict[str, Any],
) -> None:
    both = [branch(TWO), branch(FEW)]
    assert "in K/L and in B/L^2" in complaint(lambda: bifurcation_diagram(both, title=""))
    # Both end in a motion with a frequency, so that only their units tell them apart.
    for run in runs.values():
        run.attrs["summary"] = json.dumps(
            json.loads(run.attrs["summary"]) | {"verdict": "spinning", "frequency": 1.0}
        )
    for one, name in zip(both, ("chain", "filament"), strict=True):
        figure = bifurcation_diagram([one], title="", runs=list(runs.values()))
        (dots, *_) = [line for line in figure.axes[0].lines if line.get_gid() == "runs"]
        force = json.loads(runs[name].attrs["summary"])["force"]
        assert dots.get_xdata().tolist() == [force]
        assert "1 of 2 runs left out" in words_of(figure)
