"""A claim is computed at the values that it is about, or not judged, and every gap is told."""

import json
import re
from html.parser import HTMLParser
from pathlib import Path

import pytest

from refusal import complaint
from small_catalogue import small_catalogue
from undula.app.cli import main
from undula.reproduction.claims.catalogue import CATALOGUE, Claim, Item, catalogue, task_of
from undula.reproduction.claims.evaluate import ClaimAnswer
from undula.reproduction.claims.stated_values import Values, other_values, values_of, values_of_call
from undula.reproduction.report.claim_table import NOT_JUDGED, row_of
from undula.reproduction.tasks.task import ReproductionTask, tasks_of

ITEMS = catalogue()
CLAIMS = [(name, claim) for name, item in ITEMS.items() for claim in item.claims]
every_claim = pytest.mark.parametrize(
    ("name", "claim"), CLAIMS, ids=[f"{name}-{claim.name}" for name, claim in CLAIMS]
)
#: Of one text of the paper or of a note: the letters of a key, and the numbers that follow.
STATED = {
    "load.force": r"\bF = ([\d.]+)",
    "load.exponent": r"\bp = ([\d.]+)",
    "load.position": r"\bs = ([\d.]+)",
    "load.slope": r"\bslopes? of ([−\d.]+)",
}
NUMBERS_OF_LINKS = {"one": 1, "two": 2, "three": 3, "four": 4, "five": 5, "six": 6, "eight": 8}
#: Keys that make no other body and no other load, but a finer or a coarser picture of the same.
RESOLUTION = {"model.segments"}


def computed(name: str, claim: Claim, *, quick: bool) -> dict[str, Values]:
    """What the commands are about that a claim is judged by, as far as there are any."""
    item, found = ITEMS[name], {}
    for local in claim.judged_by & {*item.tasks, *item.uses}:
        call = task_of(name, item, ITEMS, local).command(quick=quick)
        if call is not None:
            found[local] = values_of_call(call, CATALOGUE / "inputs")
    return found


@every_claim
def test_a_claim_names_every_value_that_its_words_do(name: str, claim: Claim) -> None:
    told = claim.published if claim.over is None else claim.over
    # A number that is compared with the computed one, or stands in an expression, is no place.
    compared = {float(one) for one in re.findall(r"\d+\.?\d*", " ".join(claim.expressions))}
    compared |= set(told) if isinstance(told, list) else {told}
    at = {key: {*value} if isinstance(value, list) else {value} for key, value in claim.at.items()}
    for text in (claim.says, claim.note.partition(";")[0]):
        for key, pattern in STATED.items():
            known = set().union(*(some for other, some in at.items() if other.startswith(key)))
            for found in re.findall(pattern, text):
                value = float(found.rstrip(".").replace("−", "-"))
                assert value in known | compared, f"{text!r} is about {key} = {value}"
        for word in re.findall(r"(?<!More than )\b(\w+) links?\b", text):
            if word.lower() in NUMBERS_OF_LINKS and not ITEMS[name].title.startswith("Slips"):
                assert NUMBERS_OF_LINKS[word.lower()] in at.get("model.links", set()), text


@every_claim
@pytest.mark.parametrize("quick", [False, True])
def test_a_claim_is_computed_at_its_own_values(name: str, claim: Claim, quick: bool) -> None:
    known = computed(name, claim, quick=quick)
    if known and not (quick and claim.only_full):
        assert other_values(claim.at, known) == ""


@every_claim
def test_the_quick_report_has_the_same_bodies_and_loads(name: str, claim: Claim) -> None:
    # A difference would have to be stated by the claim, and the test above would find it.
    full, quick = (computed(name, claim, quick=one) for one in (False, True))
    for local, values in quick.items():
        for key in values.fixed.keys() - RESOLUTION:
            assert values.fixed[key] == full[local].fixed[key] or key in claim.at, (local, key)


# ------------------------------------------------------------------------ what is compared


@pytest.mark.parametrize(
    ("command", "fixed", "swept"),
    [
        ("run --set load.force=60 --out x", {"load.force": 60.0, "model.drag_ratio": 2.0}, {}),
        ("find spinning --converge", {"load.force": 75.0}, {}),
        ("follow spinning --along load.force=onset:300", {}, {"load.force": (0.0, 300.0)}),
        ("step --along load.force=60:0:0.5", {}, {"load.force": (0.0, 60.0)}),
        (
            "stability --along load.slope=-1:1:5 --set load.profile=linear",
            {},
            {"load.slope": (-1, 1)},
        ),
        ("stability --forces 0:250:101", {}, {"load.force": (0.0, 250.0)}),
        (
            "run --set model.kind=chain --set model.links=2 --set load.force=8",
            {"model.links": 2, "load.force": 8.0, "load.force [K/l]": 4.0},
            {},
        ),
        (f"sweep {CATALOGUE}/inputs/basins.toml --out x", {}, {"load.force": (42.0, 300.0)}),
        ("units --force 3", {}, {}),
    ],
)
def test_what_a_command_is_about_is_read_from_its_words(command, fixed, swept) -> None:
    values = values_of(command.split())
    assert {key: values.fixed[key] for key in fixed} == fixed
    assert values.swept == swept
    assert not values.fixed.keys() & values.swept.keys()


def test_a_claim_is_held_against_every_command_behind_it() -> None:
    at = {"load.force": 180.0}
    right, wrong = Values({"load.force": 180.0}), Values({"load.force": 150.0})
    assert other_values(at, {"right": right, "without": Values()}) == ""
    assert "150" in other_values(at, {"right": right, "wrong": wrong})
    assert "180" in other_values(at, {"without": Values()})
    assert other_values(at, {"branch": Values({}, {"load.force": (0.0, 200.0)})}) == ""
    assert other_values(at, {"branch": Values({}, {"load.force": (0.0, 150.0)})}) != ""
    several = {"load.force": [150.0, 180.0]}
    assert other_values(several, {"right": right, "wrong": wrong}) == ""
    assert "150" in other_values(several, {"right": right})


def test_a_catalogue_that_computes_a_claim_elsewhere_is_refused(tmp_path: Path) -> None:
    changed = ('unit = "B/L²"\nfigure', 'unit = "B/L²"\nat = { "load.force" = 74 }\nfigure')
    folder = small_catalogue(tmp_path / "wrong", onset=changed)
    sentence = complaint(lambda: catalogue(folder))
    assert "onset.toml: claim hopf" in sentence
    assert "75" in sentence
    assert "74" in sentence


def test_a_task_that_was_changed_judges_nothing(tmp_path: Path) -> None:
    """The row looks at the command that was carried out, whatever the catalogue promises."""
    item: Item = ITEMS["transition"]
    claim = next(one for one in item.claims if one.name == "spins-below")
    answers = {"below": ClaimAnswer({"verdict": "spinning"})}
    jobs = tasks_of(ITEMS, CATALOGUE / "inputs", tmp_path, quick=True)
    options = {"quick": True, "wanted": True}
    row = row_of("transition", item, claim, answers, jobs, **options)
    assert (row["verdict"], row["as_expected"]) == ("confirmed", True)
    job = jobs["transition/below"]
    words = tuple(word.replace("load.force=180", "load.force=150") for word in job.command)
    jobs["transition/below"] = ReproductionTask(**{**vars(job), "command": words})
    row = row_of("transition", item, claim, answers, jobs, **options)
    assert (row["verdict"], row["as_expected"], row["value"]) == (NOT_JUDGED, None, None)
    assert "150" in row["reason"]
    assert row["command"] == "undula reproduce transition"


# ------------------------------------------------------------------------------- the report


class Page(HTMLParser):
    """Where the links of a page lead, and what is there."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.ids: list[str] = []
        self.links: list[str] = []
        self.words: list[str] = []
        self.feed(text)

    def handle_starttag(self, _, attrs) -> None:
        given = dict(attrs)
        self.ids += [given["id"]] if "id" in given else []
        self.links += [given[name] for name in ("href", "src", "data-page") if given.get(name)]

    def handle_data(self, data: str) -> None:
        self.words.append(data)


WHOLE = pytest.param((), id="whole", marks=pytest.mark.slow)


@pytest.mark.slow
@pytest.mark.parametrize(
    "words", [pytest.param(("--quick",), id="quick"), pytest.param(("onset",), id="part"), WHOLE]
)
def test_nothing_is_dropped_in_silence_and_every_link_leads_somewhere(
    tmp_path, monkeypatch, capsys, words
) -> None:
    monkeypatch.chdir(tmp_path)
    small_catalogue(
        tmp_path / "catalogue",
        onset=('figure = "onset"', 'figure = "onset"\nat = { "load.profile" = "tip" }'),
        study=(
            "[tasks.run]\ncall = '''\n",
            "[tasks.run]\nonly_full = true\ncall = '''\n",
        ),
    )
    status = main(["reproduce", *words, "--catalogue", "catalogue", "--workers", "1", "--json"])
    assert status == 0
    rows = json.loads(capsys.readouterr().out)["claims"]
    asked = {"onset": ["hopf", "spread"], "study": ["many", "all-forces"]}
    if "onset" in words:
        del asked["study"]
    assert [row["claim"] for row in rows] == [one for some in asked.values() for one in some]
    page = Page((tmp_path / "report" / "index.html").read_text("utf-8"))
    assert len(set(page.ids)) == len(page.ids)
    for link in page.links:
        if link.startswith("#") or ".page." in link:
            assert link.removeprefix("#") in page.ids
        elif not link.startswith("data:"):
            assert (tmp_path / "report" / link).exists(), link
    text = " ".join(page.words)
    for row in rows:
        assert f"{row['item']}.{row['claim']}" in page.ids
        if row["verdict"] == NOT_JUDGED:
            assert row["reason"] in text
            assert row["command"] in text
    unjudged = {row["claim"] for row in rows if row["verdict"] == NOT_JUDGED}
    assert unjudged == ({"spread"} if "--quick" in words else set())
    figures = {"onset.figure.onset"} | ({"study.figure.run"} if "study" in asked else set())
    assert figures <= set(page.ids)
    # Of a part, the other item is shown with what it shares, and its figures are missing.
    assert ("is left out here" in text) == bool(words)
