"""What benchmarks leave behind: JSON beside them, tables in docs/benchmarks.md, the machine."""

import json
import os
import platform
from importlib.metadata import version
from pathlib import Path
from typing import Any

PAGE = Path(__file__).parents[2] / "docs" / "benchmarks.md"
RESULTS = Path(__file__).parents[1] / "results"
_PACKAGES = ("numpy", "scipy", "numba", "scikit-sundae", "pyelastica")


def machine() -> str:
    """Name processor, cores and versions in one sentence."""
    told = Path("/proc/cpuinfo")
    lines = told.read_text(encoding="utf-8").splitlines() if told.exists() else []
    models = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    versions = ", ".join(f"{name} {version(name)}" for name in _PACKAGES)
    return (
        f"{models[0] if models else platform.machine()}, {os.cpu_count()} cores, one thread;"
        f" CPython {platform.python_version()}, {versions}."
    )


def table(heading: list[str], rows: list[list[str]]) -> str:
    """Return a table in Markdown."""
    lines = [heading, ["---"] * len(heading), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def write(mark: str, text: str, page: Path = PAGE) -> None:
    """Put a text between the two marks of a page, in place of what is there."""
    before, begins, rest = page.read_text(encoding="utf-8").partition(f"<!-- {mark} -->\n")
    _, ends, after = rest.partition(f"<!-- end of {mark} -->")
    if not (begins and ends):
        raise ValueError(f"{page} has no place for {mark}")
    page.write_text(f"{before}{begins}\n{text}\n\n{ends}{after}", encoding="utf-8")


def keep(name: str, results: Any) -> None:
    """Store results as JSON."""
    RESULTS.mkdir(exist_ok=True)
    (RESULTS / f"{name}.json").write_text(json.dumps(results, indent=1), encoding="utf-8")
