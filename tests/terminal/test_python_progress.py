"""Progress of runs that Python starts."""

import pytest

import undula as un
from undula.terminal import meter

MODEL = un.Filament(4, un.TipLoad(20.0))


def test_true_shows_lines_where_there_is_no_terminal(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(meter, "SECONDS_BETWEEN_LINES", 0.0)
    un.integrate(MODEL, un.kicked(MODEL), until=0.01, samples=10, progress=True)
    shown = capsys.readouterr().err
    assert shown.startswith("integrating: t = ")
    un.ramp(MODEL, "load.force", [10.0], samples=50, limit=0.05, progress=True)
    assert "at most" in capsys.readouterr().err


def test_false_and_none_show_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    for progress in (False, None):
        un.integrate(MODEL, un.kicked(MODEL), until=0.01, samples=10, progress=progress)
    assert capsys.readouterr().err == ""
