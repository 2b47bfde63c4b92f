"""The table of claims in the documentation against the catalogue that it is made from."""

import importlib.util
import json

from pages import ROOT
from undula.reproduction.claims.catalogue import catalogue

DOCS = ROOT / "docs"
TOLD = json.loads((DOCS / "claims.json").read_text("utf-8"))
ROWS = {(row["item"], row["claim"]): row for row in TOLD["claims"]}
CLAIMS = {(name, told.name): told for name, item in catalogue().items() for told in item.claims}


def page() -> str:
    spec = importlib.util.spec_from_file_location("claims_table", DOCS / "claims_table.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.on_page_markdown("<!-- claims -->")


def test_it_is_that_of_a_whole_report_without_surprises() -> None:
    assert not TOLD["quick"]
    assert all(row["as_expected"] for row in ROWS.values())


def test_it_has_a_row_for_each_claim_as_it_is_now() -> None:
    assert ROWS.keys() == CLAIMS.keys()
    for key, row in ROWS.items():
        told = CLAIMS[key]
        assert row["published"] == (told.over if told.over is not None else told.published), key
        assert (row["says"], row["expected"]) == (told.says, told.expected), key


def test_its_commands_hold_on_any_machine() -> None:
    # A report that was written elsewhere than to the default folder names that folder.
    commands = [step for row in ROWS.values() for step in (row["command"], *row["steps"])]
    assert not [one for one in commands if "--out /" in one or "--plot /" in one]


def test_every_row_is_a_line_of_the_page() -> None:
    text = page()
    lines = [line for line in text.splitlines() if line.startswith("| ")]
    headings = [line for line in lines if line.startswith(("| the paper", "| ---"))]
    assert len(lines) - len(headings) == len(ROWS)
    assert all(line.count(" | ") == 3 for line in lines)
    assert all(f"`undula reproduce {item}`" in text for item, _ in ROWS)
