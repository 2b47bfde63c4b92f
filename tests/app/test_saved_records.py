"""Records that Python has saved, as commands read them."""

from pathlib import Path

import undula as un
from commands import Ask, answer, refused

MODEL = un.Filament(4, un.TipLoad(75.0))


def test_a_saved_state_is_drawn(own_folder: Path, ask: Ask) -> None:
    state = un.find(MODEL, "spinning")
    assert isinstance(state, un.Spinning)
    state.save("state.nc")
    assert answer(ask("plot", "state.nc", "--json"))["figure"] == "state.png"
    assert (own_folder / "state.png").read_bytes().startswith(b"\x89PNG")


def test_what_cannot_be_done_with_a_record_is_said_with_the_cure(
    own_folder: Path, ask: Ask
) -> None:
    un.onset(MODEL).save(own_folder / "onset.nc")
    assert "no figure" in refused(ask("plot", "onset.nc"))
    assert "undula plot draws it" in refused(ask("movie", "onset.nc"))
    assert "undula.load" in refused(ask("resume", "onset.nc", "--until", "2"))
