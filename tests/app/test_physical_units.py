"""Commands whose input has a table `[units]`: answers, texts, files and figures in its units."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import undula as un
from commands import Ask, answer, refused, text
from undula.schema.physical_units import UNITS_PHYSICAL

FILAMENT = ["--set", "units.length=12 um", "--set", "units.stiffness=25 pN um^2"]
SCALES = un.Scales(12e-6, 25e-24)
HEAD = "  L = 12 um, T = 2.263 s, B/L^2 = 0.1736 pN, B/L = 2.083 pN um, 1 cycle per T = 0.4418 Hz"
FEW = ["--set", "model.segments=6", *FILAMENT]
SHORT = ["--set", "time.until=0.02", "--set", "time.samples=5", "--no-movie"]
COMMANDS = {
    "run": ["run", *SHORT],
    "onset": ["stability"],
    "growth": ["stability", "--forces", "20,40"],
    "curve": ["stability", "--along", "load.position=0.5,1", "--set", "load.profile=point"],
    "find": ["find", "spinning"],
    "follow": ["follow", "spinning", "--along", "load.force=60:70"],
    "straight": ["follow", "straight", "--along", "load.force=20:50"],
    "threshold": ["threshold", "onset"],
    "thresholds": ["threshold", "onset", "--along", "model.drag_ratio=1,2"],
    "step": ["step", "--along", "load.force=0:5:5.0", "--set", "time.until=0.02"],
    "nothing": ["find", "spinning", "--set", "load.force=4"],
}

pytestmark = pytest.mark.usefixtures("own_folder")


def hertz(frequency: float) -> dict[str, Any]:
    return {"value": pytest.approx(frequency * SCALES.frequency, rel=1e-13), "unit": "Hz"}


def piconewton(force: float) -> dict[str, Any]:
    return {"value": pytest.approx(force * 25 / 144, rel=1e-13), "unit": "pN"}


@pytest.mark.parametrize("name", COMMANDS)
def test_every_answer_and_text_carries_physical_units(name: str, ask: Ask) -> None:
    words = [*COMMANDS[name], *FEW]
    plain = answer(ask(*COMMANDS[name], *FEW[:2], "--json"))
    again = ["--overwrite"] if words[0] in ("run", "step") else []
    found = answer(ask(*words, *again, "--json"))
    physical = found.pop("physical")
    # Of what is computed nothing changes but the wall time.
    varying = {"seconds", "steps"}
    assert {k: found[k] for k in found.keys() - varying} == {
        k: plain[k] for k in plain.keys() - varying
    }
    assert bool(physical) == (name != "nothing")
    assert name == "nothing" or HEAD in text(ask(*words, *again)).splitlines()


def test_numbers_of_an_answer_are_those_of_the_scales(ask: Ask) -> None:
    found = answer(ask("find", "spinning", *FEW, "--json"))
    physical = found["physical"]
    assert physical["frequency"] == hertz(found["frequency"])
    assert physical["force"] == piconewton(75.0)
    assert physical["tip_radius"]["unit"] == "um"
    (line,) = (
        line
        for line in text(ask("find", "spinning", *FEW)).splitlines()
        if line.startswith("  frequency")
    )
    assert f" cycles per T ({found['frequency'] * SCALES.frequency:.3g} Hz)" in line


def test_a_threshold_is_told_in_piconewtons(ask: Ask) -> None:
    # 37.69543 B/L^2 of 25 pN um^2 over (12 um)^2.
    assert " B/L^2 (6.544 pN) (Hopf)" in text(ask("threshold", "onset", *FEW))


def test_a_force_and_a_time_are_given_in_their_units(ask: Ask) -> None:
    given = ["--set", "load.force=8 pN", "--set", "time.until=0.02 s", "--no-movie", "--json"]
    found = answer(ask("run", *FEW, *given))
    assert found["force"] == 46.08
    assert found["physical"]["force"] == {"value": pytest.approx(8.0), "unit": "pN"}
    assert found["physical"]["time"] == {"value": pytest.approx(0.02), "unit": "s"}


@pytest.mark.slow
def test_a_stored_run_keeps_its_units_when_it_is_resumed(ask: Ask, own_folder: Path) -> None:
    text(ask("run", *FEW, *SHORT))
    file = own_folder / "results" / "run" / "run.nc"
    found = answer(ask("resume", file, "--until", "0.03", "--no-movie", "--json"))
    assert found["physical"]["time"] == {"value": pytest.approx(0.03 * SCALES.time), "unit": "s"}
    stored = un.load(file)
    assert json.loads(stored.attrs[UNITS_PHYSICAL]) == SCALES.units()
    assert json.loads(stored.attrs["input"])["units"]["length"] == "12 um"
    energy = stored["bending_energy"]
    assert energy.attrs["physical_unit"] == "pN um"
    assert np.isclose(energy.attrs["physical_factor"], 25 / 12)


def test_another_filament_goes_on_with_no_series_of_this_one(ask: Ask) -> None:
    text(ask(*COMMANDS["step"], *FEW))
    other = ask(*COMMANDS["step"], *FEW, "--set", "units.length=13 um")
    assert 'with units.length = "12 um" instead of "13 um"' in refused(other)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ("units.length=12", "units.length = 12 is a whole number"),
        ("units.length=12 s", "units.length = '12 s' has a unit that is not that of a length"),
        ("units.lenght=12 um", "units.lenght is not a known key; did you mean units.length?"),
        ("load.force=8 s", "load.force = '8 s' has a unit that is not that of a force"),
        ("model.kind=chain", "[units] are those of a filament"),
    ],
)
@pytest.mark.parametrize("command", [["run"], ["find", "spinning"], ["stability"]])
def test_wrong_units_are_refused_in_a_sentence(
    command: list[str], change: str, sentence: str, ask: Ask
) -> None:
    assert refused(ask(*command, *FILAMENT, "--set", change)).startswith(sentence)
