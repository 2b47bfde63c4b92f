"""Commands as a user runs them, in this process and in processes of their own."""

import json
import os
import subprocess
import sysconfig
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

from undula.schema.key_kinds import PARAMETER, Named

SCRIPTS = Path(sysconfig.get_path("scripts"))
UNDULA = SCRIPTS / "undula"
#: Seconds that a process may take: it may have to compile the kernels first, on a busy machine.
PATIENCE = 300.0


class Asked(NamedTuple):
    """A command that has ended: its exit status, its output and its messages."""

    status: int
    said: str
    told: str


#: A function of the words of a command, which runs it.
Ask = Callable[..., Asked]


def answer(asked: Asked, status: int = 0) -> dict[str, Any]:
    """Return the one JSON object that a command has answered with."""
    assert asked.status == status, asked.told

    def refuse(constant: str) -> float:
        raise AssertionError(f"{constant} is no JSON")

    found = json.loads(asked.said, parse_constant=refuse)
    assert isinstance(found, dict)
    return found


def text(asked: Asked) -> str:
    """Return the text that a command has answered with."""
    assert asked.status == 0, asked.told
    return asked.said


def refused(asked: Asked) -> str:
    """Return the one sentence with which a command is refused."""
    assert (asked.status, asked.said, asked.told.count("\n")) == (2, "", 1), asked.told
    return asked.told.removeprefix("undula: ").rstrip()


def started(*command: str | Path, group: bool = True) -> subprocess.Popen[str]:
    """Start a command whose streams are read, in a process group of its own."""
    pipe = subprocess.PIPE
    return subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, start_new_session=group)


def ended(command: subprocess.Popen[str]) -> Asked:
    """Return what a command that was started ends with."""
    said, told = command.communicate(timeout=PATIENCE)
    return Asked(command.returncode, said, told)


def in_process(*command: str | Path, folder: Path | None = None, **environment: str) -> Asked:
    """Return what a command ends with, run in a process of its own."""
    done = subprocess.run(
        command,
        cwd=folder,
        env=os.environ | environment,
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=False,
    )
    return Asked(done.returncode, done.stdout, done.stderr)


def unknown_keys(answer: str, keys: Any) -> list[str]:
    """Return the places of an answer that its schema does not have; none for what is not JSON."""
    return list(_unknown(json.loads(answer), keys, "")) if answer.startswith("{") else []


def _unknown(value: Any, keys: Any, place: str) -> Iterator[str]:
    if isinstance(value, list):
        for part in value:
            yield from _unknown(part, keys, place)
    elif isinstance(value, dict):
        if isinstance(keys, str):
            yield f"{place}: an object in place of a number or word"
            return
        for name, part in value.items():
            inner = keys.values if isinstance(keys, Named) else _keys_of(name, keys)
            if inner is None:
                yield f"{place}.{name}"
            else:
                yield from _unknown(part, inner, f"{place}.{name}")


def _keys_of(name: str, keys: Any) -> Any:
    """Return what is known of a key; a parameter has a dot in its name, and no unit."""
    return keys.get(name, keys.get(PARAMETER) if "." in name else None)
