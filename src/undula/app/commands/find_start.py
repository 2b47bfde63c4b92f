"""Start of the search for a state: none, a stored run, or the seed of a new run."""

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
from undula.models.scales import Scales
from undula.storage.run_file import load_result


@dataclass(frozen=True)
class SearchStart:
    """A model and the start of the search for one of its states.

    Attributes
    ----------
    model : Model
    title : str
        Model and load in a few words.
    run : (Model, Dataset) or None
        A stored run with its own model, from which `model` may differ in numbers.
    seed : int or None
        Seed of the run that is made without a stored one.
    scales : Scales or None
        SI values of the dimensionless units, None without ``[units]``.
    """

    model: Model
    title: str
    run: tuple[Model, xr.Dataset] | None = None
    seed: int | None = None
    scales: Scales | None = None

    def motion(self) -> Periodic | NotFound | None:
        """Return the periodic motion that the run or the seed leads to, None without both."""
        if self.run is None:
            return None if self.seed is None else find_periodic(self.model, seed=self.seed)
        run_model, stored = self.run
        motion = find_periodic(run_model, stored)
        if run_model == self.model or isinstance(motion, NotFound):
            return motion
        return find_periodic(self.model, motion)


def start_of_search(
    kind: str, file: Path | None, changes: Sequence[str], run: Path | None, seed: int | None
) -> SearchStart:
    """Return the start of a search in the model of an input, or in that of a stored run.

    Parameters
    ----------
    kind
        Name of the kind of state.
    file, changes
        The input file, None for the defaults, and changes of single keys.
    run
        File of a stored run; its model takes the place of the input.
    seed
        Seed of a new run.

    Raises
    ------
    InputError
        The input is wrong, or the options exclude each other.
    """
    if kind != "periodic" and (run is not None or seed is not None):
        option = "--seed" if run is None else "--run"
        raise InputError(f"{option} is for periodic motions; leave it out for {kind}")
    if run is None:
        wanted = read_model_input(file, changes)
        return SearchStart(build_model(wanted), wanted.load_text, seed=seed, scales=wanted.scales)
    if file is not None or seed is not None:
        other = f"--seed {seed}" if file is None else file
        raise InputError(f"--run and {other} both say what to begin with; leave one of them out")
    stored = load_result(run)
    tables = json.loads(stored.attrs["input"])
    read = {name: tables[name] for name in ModelInput.model_fields if name in tables}
    try:
        run_model = build_model(changed_tables(ModelInput, read, ())[1])
    except InputError as error:
        raise InputError(f"{run} holds no input that a command could read: {error}") from error
    wanted = changed_tables(ModelInput, read, changes)[1]
    model = build_model(wanted)
    return SearchStart(model, wanted.load_text, run=(run_model, stored), scales=wanted.scales)
