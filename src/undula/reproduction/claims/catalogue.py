"""Catalogue of claims: items with statements of the paper, tasks that check them, and figures.

Each item is a TOML file in the folder `items`. It holds inputs and published values, and nothing
that this package has computed. The folder also holds `paper.toml`, which names the paper, and the
folder `inputs` with input files of commands, such as sweeps.
"""

import ast
import re
import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Annotated, Literal, TypeVar

from pydantic import Field, ValidationError, model_validator

from undula.errors import InputError
from undula.inputs.messages import nearest
from undula.inputs.table import Table, conflict
from undula.reproduction.claims.stated_values import other_values, values_of_call

#: The catalogue of this package.
CATALOGUE = Path(__file__).parent / "items"
_PAPER = "paper.toml"

CONFIRMED = "confirmed"
WITHIN_RANGE = "confirmed within a stated range"
CORRECTED = "corrected"
NOT_REPRODUCIBLE = "not reproducible as stated"

Verdict = Literal[
    "confirmed", "confirmed within a stated range", "corrected", "not reproducible as stated"
]
Value = bool | float | str
Read = TypeVar("Read", bound=Table)
_PLACE = re.compile(r"\{([\w-]+)\}")
_BUILT_IN = ("out", "inputs")


class TaskEntry(Table):
    """A task of an item: a command of `undula`, whose JSON answer is stored.

    In the command, `{out}` stands for the folder of its files, `{inputs}` for that of the
    catalogue's inputs, and `{name}` for the folder of another task of the item, which is then
    computed before.
    """

    call: str = Field(description="a command without `undula`")
    quick: str | None = Field(None, description="a shorter command for the quick report")
    only_full: bool = Field(False, description="true if the quick report does without it")
    all_cores: bool = Field(False, description="true if the command uses all processors itself")
    cost: float = Field(3.0, gt=0.0, description="roughly how many seconds it takes")

    def command(self, *, quick: bool) -> str | None:
        """Return the command in the full or the quick report; None if the quick one omits it."""
        if quick and self.only_full:
            return None
        return self.quick if quick and self.quick is not None else self.call

    def needs(self, *, quick: bool) -> tuple[str, ...]:
        """Return the names of the tasks that have to be computed before."""
        names = _PLACE.findall(self.command(quick=quick) or "")
        return tuple(name for name in names if name not in _BUILT_IN)


class Claim(Table):
    """A claim: a statement of the paper, and an expression on answers of tasks that checks it.

    A claim on one value, or on several in a list, is confirmed if they differ from the published
    ones by at most `within`. For a claim on a range of a parameter, `over`, the expression gives
    the ends of the range over which the statement holds.
    """

    name: str = Field(pattern=r"^[a-z0-9-]+$", description="a name, unique within the item")
    says: str = Field(description="what the paper says, in our words")
    where: str = Field(description="the place in the paper")
    value: str = Field(description="an expression on the answers of tasks")
    error: str | None = Field(None, description="an expression for the error of the value")
    unit: str = Field("", description="the unit of the value")
    published: Value | list[float] | None = Field(None, description="the published value")
    over: Annotated[list[float], Field(min_length=2, max_length=2)] | None = Field(
        None, description="the range for which the paper states it"
    )
    within: float = Field(0.0, ge=0.0, description="the largest difference that confirms it")
    because: str = Field("", description="the reason for that difference")
    agrees_with: str | None = Field(
        None, description="an expression that gives the same by another way"
    )
    agrees_within: float = Field(0.0, ge=0.0, description="by how much the two ways may differ")
    silent: str = Field("", description="what the paper does not say that would be needed")
    note: str = Field("", description="what is to be said of the outcome")
    expected: Verdict = Field("confirmed", description="the verdict that is known to hold")
    figure: str | None = Field(None, description="the name of a figure that shows it")
    at: dict[str, Value | list[Value]] = Field(
        {}, description="keys of the input with the value, or the values, that it is about"
    )
    only_full: bool = Field(False, description="true if coarser grids do not show it")
    erratum: bool = Field(False, description="true for a slip of the paper")

    @model_validator(mode="after")
    def _one_thing(self) -> "Claim":
        if (self.published is None) == (self.over is None):
            raise conflict(f"claim {self.name} needs either `published` or `over`, not both")
        if self.within > 0.0 and not self.because:
            raise conflict(f"claim {self.name} has a tolerance without `because`, its reason")
        return self

    @property
    def expressions(self) -> tuple[str, ...]:
        """All expressions of the claim."""
        return tuple(text for text in (self.value, self.error, self.agrees_with) if text)

    @property
    def asks(self) -> frozenset[str]:
        """Names in all expressions."""
        return _names(self.expressions)

    @property
    def judged_by(self) -> frozenset[str]:
        """Names in the expressions that determine the verdict, thus without that of the error."""
        return _names(text for text in (self.value, self.agrees_with) if text)


class Figure(Table):
    """A figure: a file that a task writes, or a view drawn from answers of tasks."""

    name: str = Field(pattern=r"^[a-z0-9-]+$", description="a name, unique within the item")
    shows: str = Field(description="the figure of the paper, or what it adds to the paper")
    caption: str = Field(description="what is to be seen")
    file: str | None = Field(None, description="a file in the folder of a task, as {task}/run.png")
    view: str | None = Field(None, description="the name of a view of answers")
    of: list[str] = Field([], description="the tasks whose answers the view draws")
    page: str | None = Field(None, description="a page for the mouse, as {task}/page.html")

    @model_validator(mode="after")
    def _one_source(self) -> "Figure":
        if (self.file is None) == (self.view is None):
            raise conflict(f"figure {self.name} needs either `file` or `view`, not both")
        return self

    @property
    def asks(self) -> frozenset[str]:
        """Names of the tasks that the figure needs."""
        return frozenset(self.of if self.file is None else _PLACE.findall(self.file))

    @property
    def asks_for_page(self) -> frozenset[str]:
        """Names of the tasks that the page needs."""
        return frozenset(_PLACE.findall(self.page or ""))


class Movie(Table):
    """A movie that a task writes."""

    shows: str = Field(description="the movie of the paper")
    caption: str = Field(description="what is to be seen")
    file: str = Field(description="a file in the folder of a task, as {task}/run.mp4")

    @property
    def asks(self) -> frozenset[str]:
        """Names of the tasks that the movie needs."""
        return frozenset(_PLACE.findall(self.file))


class Item(Table):
    """An item: a figure, a table or a group of claims of the paper, or an addition to it."""

    order: int = Field(description="its place in the report")
    title: str = Field(description="what it is about")
    paper: str = Field(description="where it is in the paper; empty for what goes beyond it")
    about: str = Field(description="what was done")
    uses: dict[str, str] = Field({}, description="tasks of other items, by the names used here")
    tasks: dict[str, TaskEntry] = Field({}, description="commands by name")
    claims: list[Claim] = Field([], description="statements")
    figures: list[Figure] = Field([], description="figures")
    movies: list[Movie] = Field([], description="movies")


class Paper(Table):
    """The paper of a catalogue."""

    title: str = Field(description="the title of the report")
    about: str = Field(description="which paper, and what was done with it")


def paper_of(folder: Path) -> Paper:
    """Return the paper of a catalogue.

    Raises
    ------
    InputError
        The file `paper.toml` is missing or wrong.
    """
    return _read(folder / _PAPER, Paper)


def catalogue(folder: Path = CATALOGUE) -> dict[str, Item]:
    """Return all items by name, in the order of the report.

    Raises
    ------
    InputError
        The folder holds no items, or a file is not an item or refers to something missing.
    """
    files = sorted(path for path in folder.glob("*.toml") if path.name != _PAPER)
    if not files:
        raise InputError(f"there is no catalogue in {folder}; give a folder with items as .toml")
    items = {path.stem: _read(path, Item) for path in files}
    ordered = dict(sorted(items.items(), key=lambda entry: entry[1].order))
    for name, item in ordered.items():
        _check(name, item, ordered)
        _check_values(folder, name, item, ordered)
    return ordered


def chosen(items: dict[str, Item], names: tuple[str, ...]) -> dict[str, Item]:
    """Return the items of given names in the order of the report; all items without names.

    Raises
    ------
    InputError
        An item is unknown.
    """
    for name in names:
        if name not in items:
            meant = nearest(name, items)
            cure = f"did you mean {meant}?" if meant else f"take {', '.join(items)}"
            raise InputError(f"there is no item {name} to reproduce; {cure}")
    return {name: item for name, item in items.items() if not names or name in names}


def _read(path: Path, record: type[Read]) -> Read:
    try:
        return record.model_validate(tomllib.loads(path.read_text("utf-8")))
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"])) or "the file"
        raise InputError(
            f"{path.name}: {place}: {first['msg']}; mend it as"
            " undula/reproduction/claims/catalogue.py tells"
        ) from error
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise InputError(f"{path.name} cannot be read as TOML ({error}); mend the file") from error


def _names(expressions: Iterable[str]) -> frozenset[str]:
    nodes = (node for text in expressions for node in ast.walk(ast.parse(text.strip())))
    return frozenset(node.id for node in nodes if isinstance(node, ast.Name))


def task_of(name: str, item: Item, items: Mapping[str, Item], local: str) -> TaskEntry:
    """Return a task by the name that an item uses for it, which may belong to another item."""
    owner, _, task = item.uses.get(local, f"{name}/{local}").partition("/")
    return items[owner].tasks[task]


def _check_values(folder: Path, name: str, item: Item, items: Mapping[str, Item]) -> None:
    """Refuse claims that the full report would compute at other values than the claim's."""
    tasks = {*item.tasks, *item.uses}
    for claim in item.claims:
        computed = {
            local: values_of_call(task_of(name, item, items, local).call, folder / "inputs")
            for local in (claim.judged_by & tasks if claim.at else ())
        }
        trouble = other_values(claim.at, computed)
        if trouble:
            raise InputError(
                f"{name}.toml: claim {claim.name}: {trouble}; mend the one or the other"
            )


def _check(name: str, item: Item, items: dict[str, Item]) -> None:
    for local, place in item.uses.items():
        owner, _, task = place.partition("/")
        if owner not in items or task not in items[owner].tasks:
            raise InputError(f"{name}.toml: uses.{local} = {place!r} is no task of an item")
    tasks = {*item.tasks, *item.uses}
    figures = {figure.name for figure in item.figures}
    needed = [(f"task {local}", task.needs(quick=False)) for local, task in item.tasks.items()]
    needed += [
        (f"figure {figure.name}", (*figure.asks, *figure.asks_for_page)) for figure in item.figures
    ]
    needed += [("a movie", tuple(movie.asks)) for movie in item.movies]
    for user, names in needed:
        for missing in set(names) - tasks:
            raise InputError(f"{name}.toml: {user} needs {missing}, which is no task of the item")
    for claim in item.claims:
        if claim.figure is not None and claim.figure not in figures:
            raise InputError(f"{name}.toml: claim {claim.name} names no figure {claim.figure}")
    names_of_claims = [claim.name for claim in item.claims]
    if len(set(names_of_claims)) != len(names_of_claims):
        raise InputError(f"{name}.toml: two claims have one name; give each its own")
