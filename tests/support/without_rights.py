"""Processes that a closed folder is closed to, also where the tests run as root."""

import ctypes
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

_PR_CAPBSET_DROP, _CAP_DAC_OVERRIDE, _CAP_DAC_READ_SEARCH = 24, 1, 2


def run_without_rights(
    program: str, words: Sequence[str] = (), timeout: float = 120.0
) -> subprocess.CompletedProcess[str]:
    """Run a Python program that has no rights beyond those that files and folders give.

    Parameters
    ----------
    program
        Its text.
    words
        What it is given.
    timeout
        Seconds that it may take.
    """
    return subprocess.run(
        [sys.executable, "-c", program, *words],
        preexec_fn=_give_up_rights if os.geteuid() == 0 else None,
        capture_output=True,
        text=True,
        timeout=timeout,
        check=False,
    )


def are_kept_out(closed: Path) -> bool:
    """Tell whether such a process is kept out of a folder that is closed."""
    look = "import os, sys; os.listdir(sys.argv[1])"
    return "PermissionError" in run_without_rights(look, [str(closed)]).stderr


def _give_up_rights() -> None:
    """Let the program that is started next, as root, have none of root's rights on files."""
    libc = ctypes.CDLL(None)
    for right in (_CAP_DAC_OVERRIDE, _CAP_DAC_READ_SEARCH):
        libc.prctl(_PR_CAPBSET_DROP, right, 0, 0, 0)
