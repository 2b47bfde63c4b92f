"""The program itself: its help, its version and the completion of shells."""

import os
import re
import sys
from pathlib import Path

import pytest

from commands import UNDULA, Ask, in_process, text


def test_run_is_the_first_command_of_the_help(ask: Ask) -> None:
    listed = text(ask("--help")).partition("Commands:\n")[2]
    names = re.findall(r"^  (\w+) ", listed, re.MULTILINE)
    assert names[:4] == ["run", "resume", "plot", "movie"]
    assert len(names) == len(set(names)) == 14


def test_the_version_is_that_of_the_package(ask: Ask) -> None:
    from importlib.metadata import version

    assert text(ask("--version")) == f"undula {version('undula')}\n"


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_completion_of_a_shell_is_shown_and_completes_commands(shell: str, tmp_path: Path) -> None:
    shown = in_process(
        sys.executable, "-c", _CODE.format("--show-completion", shell), HOME=str(tmp_path)
    )
    assert (shown.status, shown.told) == (0, "")
    assert "_UNDULA_COMPLETE" in shown.said
    asked = {
        "_UNDULA_COMPLETE": f"complete_{shell}",
        **dict.fromkeys(("COMP_WORDS", "_TYPER_COMPLETE_ARGS"), "undula st"),
        "COMP_CWORD": "1",
        "_TYPER_COMPLETE_FISH_ACTION": "get-args",
    }
    completed = in_process(UNDULA, **asked)
    assert completed.status == 0
    assert all(name in completed.said for name in ("stability", "step", "status"))
    assert "threshold" not in completed.said


def test_completion_is_installed_for_the_shell_of_the_user(tmp_path: Path) -> None:
    code = _CODE.format("--install-completion", "bash")
    installed = in_process(sys.executable, "-c", code, HOME=str(tmp_path))
    assert (installed.status, installed.told) == (0, "")
    assert "undula" in (tmp_path / ".bashrc").read_text()


@pytest.mark.parametrize("option", ["--show-completion", "--install-completion"])
def test_a_shell_without_completion_is_bad_input(option: str, tmp_path: Path) -> None:
    refused = in_process(sys.executable, "-c", _CODE.format(option, "tcsh"), HOME=str(tmp_path))
    assert refused.status == 2
    assert "not supported" in refused.told + refused.said
    assert not os.listdir(tmp_path)


#: An option of completion in a process that believes to be run by a given shell.
_CODE = """
import shellingham, sys
shellingham.detect_shell = lambda *_: ({1!r}, {1!r})
from undula.app.cli import main
sys.exit(main([{0!r}]))
"""


def test_the_package_runs_as_a_module() -> None:
    asked = in_process(sys.executable, "-m", "undula", "--version")
    assert (asked.status, asked.told) == (0, "")
    assert asked.said.startswith("undula ")
    assert in_process(sys.executable, "-m", "undula", "run", "--set", "load.forc=1").status == 2
