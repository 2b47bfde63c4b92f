"""What the README tells a reader to type does what it says."""

import re
from pathlib import Path

import pytest

README = Path(__file__).parents[1] / "README.md"


def test_the_lines_of_python_run_and_draw_a_figure(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (lines,) = re.findall(r"```python\n(.*?)```", README.read_text(), flags=re.DOTALL)
    monkeypatch.chdir(tmp_path)
    exec(compile(lines, "README.md", "exec"), {})
    said = capsys.readouterr().out
    promised = re.search(r"# (spinning at \S+) \+-", lines)
    assert promised is not None
    assert said.startswith(promised.group(1))
    assert (tmp_path / "spinning.pdf").stat().st_size > 10_000
