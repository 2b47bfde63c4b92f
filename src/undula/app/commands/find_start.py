"""What the search for a state begins with: nothing, a stored run, or the seed of a run to make."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import xarray as xr

from undula.analysis.solvers.periodic_search import find_periodic
from undula.analysis.states.not_found import NotFound
from undula.analysis.states.periodic_record import Periodic
from undula.errors import InputError
from undula.inputs.build import build_model
from undula.inputs.input import ModelInput, changed_tables, read_model_input
from undula.models.model import Model
from undula.storage.run_file import load_result


@dataclass(frozen=True)
class Beginning:
    """A model, what it is in words, and what the search for its state begins with.

    Attributes
    ----------
    model : Model
    title : str
    run : (Model, Dataset) or None
        A stored run with its own model, of which `model` may differ in numbers.
    seed : int or None
        Seed of the run that is made for want of one.
    """

    model: Model
    title: str
    run: tuple[Model, xr.Dataset] | None = None
    seed: int | None = None

    def first(self) -> Periodic | NotFound | None:
        """Return the motion that the run or the seed leads to, None if neither was given."""
        if self.run is None:
            return None if self.seed is None else find_periodic(self.model, seed=self.seed)
        own, stored = self.run
        found = find_periodic(own, stored)
        if own == self.model or isinstance(found, NotFound):
            return found
        return find_periodic(self.model, found)


def beginning_of(
    kind: str, file: Path | None, changes: Sequence[str], run: Path | None, seed: int | None
) -> Beginning:
    """Return what is asked: of the model of an input, or of that of a stored run with changes.

    Raises
    ------
    InputError
        The input is wrong, or the options do not go together.
    """
    if kind != "periodic" and (run is not None or seed is not None):
        option = "--seed" if run is None else "--run"
        raise InputError(f"{option} is for periodic motions; leave it out for {kind}")
    if run is None:
        wanted = read_model_input(file, changes)
        return Beginning(build_model(wanted), wanted.load_text, seed=seed)
    if file is not None or seed is not None:
        other = f"--seed {seed}" if file is None else file
        raise InputError(f"--run and {other} both say what to begin with; leave one of them out")
    stored = load_result(run)
    tables = json.loads(stored.attrs["input"])
    mine = {name: tables[name] for name in ModelInput.model_fields if name in tables}
    try:
        own = build_model(changed_tables(ModelInput, mine, ())[1])
    except InputError as error:
        raise InputError(f"{run} holds no input that a command could read: {error}") from error
    wanted = changed_tables(ModelInput, mine, changes)[1]
    return Beginning(build_model(wanted), wanted.load_text, run=(own, stored))
