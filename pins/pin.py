"""Pins what the commands answer, for a change that is to change no answer.

    python pins/pin.py record     before the change: runs all commands and keeps what they gave
    python pins/pin.py check      after it: runs them again and tells each difference

Pinned are exit status, the JSON and the text of every answer, the messages, and what the files hold
that commands write: variables and attributes of results, pixels of figures, images of movies, data
of pages. Not pinned are wall times, versions, and the name of the command. Numbers are compared to
the last bit, so that both have to run on one kind of processor, with the same libraries.
"""
# ruff: noqa: T201

import argparse
import hashlib
import json
import os
import platform
import shlex
import subprocess
import sys
import tempfile
import time
import tomllib
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext
from importlib.metadata import version
from pathlib import Path
from typing import Any

from contents import contents
from differences import differences
from normal import NAME, messages, steady_lines, steady_value

HERE = Path(__file__).resolve().parent
COMMAND = Path(sys.executable).parent / NAME
#: Commands that run at a time.
AT_ONCE = 2
#: Differences that are told of one command or file.
TOLD = 12
_LIBRARIES = ("numpy", "scipy", "numba", "matplotlib")
_ENVIRONMENT = os.environ | {"COLUMNS": "100", "LC_ALL": "C.UTF-8"}


def run(call: str, folder: Path, *, as_json: bool) -> dict[str, Any]:
    """Run a command in a folder; return what it answered."""
    done = subprocess.run(
        [COMMAND, *shlex.split(call), *(["--json"] if as_json else [])],
        cwd=folder,
        env=_ENVIRONMENT,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
    )
    out: Any = steady_lines(done.stdout)
    if as_json and done.stdout.startswith("{"):
        out = steady_value(json.loads(done.stdout))
    return {"exit": done.returncode, "out": out, "err": messages(done.stderr)}


def answers(group: dict[str, Any], inputs: dict[str, str], folder: Path, *, as_json: bool) -> Any:
    """Return what the commands of a group answered in one folder, and what they left there."""
    folder.mkdir(parents=True)
    for name, text in inputs.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    told = {call: run(call, folder, as_json=as_json) for call in group["calls"]}
    if not as_json:
        return told
    left = {name: held for name, held in contents(folder).items() if name not in inputs}
    if full := group.get("in_full"):
        told = {call: one | {"out": digest_of(one["out"])} for call, one in told.items()}
        left = {name: held if name in full else digest_of(held) for name, held in left.items()}
    return {"calls": told, "files": left}


def digest_of(value: Any) -> str:
    """Return the digest of a JSON value, for what is too long to keep."""
    return hashlib.sha256(json.dumps(value).encode()).hexdigest()[:16]


def pinned(cases: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Return the answers of all groups of commands, as JSON and, unless too slow, as text."""
    with ThreadPoolExecutor(AT_ONCE) as pool:
        futures = {}
        for name, group in cases["groups"].items():
            inputs = cases.get("inputs", {}).get(group.get("inputs"), {})
            for form in ("json",) if group.get("json_only") else ("json", "text"):
                as_json, place = form == "json", folder / name / form
                futures[f"{name} {form}"] = pool.submit(
                    answers, group, inputs, place, as_json=as_json
                )
        return {name: future.result() for name, future in sorted(futures.items())}


def machine() -> dict[str, str]:
    """Return what numbers depend on besides the sources."""
    versions = {name: version(name) for name in _LIBRARIES}
    return {"python": platform.python_version(), "processor": _processor(), **versions}


def _processor() -> str:
    lines = (
        Path("/proc/cpuinfo").read_text().splitlines() if os.path.exists("/proc/cpuinfo") else []
    )
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()


def compare(before: dict[str, Any], now: dict[str, Any]) -> int:
    """Print where answers differ from the pinned ones; return in how many groups they do."""
    wrong = 0
    for name in before.keys() | now.keys():
        found = list(differences(before.get(name), now.get(name)))
        if found:
            wrong += 1
            print(f"\n{name}: {len(found)} differences")
            print(*(f"  {line}" for line in found[:TOLD]), sep="\n")
            if len(found) > TOLD:
                print(f"  and {len(found) - TOLD} more")
    return wrong


def main() -> int:
    """Record or check; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("what", choices=("record", "check"))
    parser.add_argument("--whole", action="store_true", help="`reproduce --quick` instead; minutes")
    parser.add_argument("--only", nargs="+", metavar="GROUP", help="these groups alone")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="a new folder that stays")
    asked = parser.parse_args()
    kind = "whole" if asked.whole else "cases"
    kept = HERE / ("recorded-whole.json" if asked.whole else "recorded.json")
    cases = tomllib.loads((HERE / f"{kind}.toml").read_text("utf-8"))
    if asked.only:
        cases["groups"] = {name: cases["groups"][name] for name in asked.only}
    began = time.monotonic()
    place: Any = nullcontext(asked.keep) if asked.keep else tempfile.TemporaryDirectory()
    with place as folder:
        now = pinned(cases, Path(folder).resolve())
    seconds = time.monotonic() - began
    if asked.what == "record":
        write(kept, now, added=bool(asked.only))
        print(f"{len(now)} groups of answers are in {kept.name}, {seconds:.0f} s")
        return 0
    recorded = json.loads(kept.read_text("utf-8"))
    if recorded["machine"] != machine():
        print(f"recorded on {recorded['machine']}, now on {machine()}: digits may differ")
    before = {
        name: held for name, held in recorded["answers"].items() if not asked.only or name in now
    }
    wrong = compare(before, now)
    print(f"{len(now) - wrong} of {len(now)} groups of answers are as recorded, {seconds:.0f} s")
    return 1 if wrong else 0


def write(path: Path, now: dict[str, Any], *, added: bool) -> None:
    """Write what was recorded, instead of all before or, of some groups, instead of theirs."""
    before = json.loads(path.read_text("utf-8"))["answers"] if added and path.exists() else {}
    content = {"machine": machine(), "answers": before | now}
    path.write_text(json.dumps(content, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main())
