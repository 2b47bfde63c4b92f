"""The table of claims of the documentation, from the file that `undula reproduce` writes."""

import json
from collections import Counter
from pathlib import Path
from typing import Any

CLAIMS = Path(__file__).with_name("claims.json")
_PLACE = "<!-- claims -->"


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Put the table in its place; mkdocs calls this for every page."""
    return markdown.replace(_PLACE, table()) if _PLACE in markdown else markdown


def table() -> str:
    """Return all claims as tables in markdown, one for each item."""
    rows = json.loads(CLAIMS.read_text("utf-8"))["claims"]
    counts = Counter(row["verdict"] for row in rows)
    told = ", ".join(f"{count} {verdict}" for verdict, count in counts.most_common())
    parts = [f"{len(rows)} statements: {told}."]
    for item, title in dict.fromkeys((row["item"], row["title"]) for row in rows):
        parts += [
            f"\n## {title}\n\n`undula reproduce {item}`\n",
            "| the paper | says | here | verdict |\n| --- | --- | --- | --- |",
            *(_line(row) for row in rows if row["item"] == item),
        ]
    return "\n".join(parts)


def _line(row: dict[str, Any]) -> str:
    unit = f" {row['unit']}" if row["unit"] else ""
    verdict = row["verdict"] if row["verdict"] == "confirmed" else f"**{row['verdict']}**"
    note = f" {row['note']}" if row["verdict"] != "confirmed" and row["note"] else ""
    cells = (
        f"{row['says']} ({row['where']})",
        f"{_number(row['published'])}{unit}",
        f"{_number(row['value'], row['error'])}{unit}",
        f"{verdict}{'.' if note else ''}{note}",
    )
    return "| " + " | ".join(cell.replace("|", "\\|").replace("\n", " ") for cell in cells) + " |"


def _number(value: Any, error: Any = None) -> str:
    if isinstance(value, bool):
        return "holds" if value else "does not hold"
    if isinstance(value, list):
        errors = error if isinstance(error, list) else [None] * len(value)
        return " to ".join(map(_number, value, errors))
    if isinstance(value, float | int):
        return f"{value:.6g}" + (f" ± {error:.1g}" if error else "")
    return "none" if value is None else str(value)
