"""A quasi-static ramp from Python: all steps at once, as a record."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import pandas as pd
import xarray as xr

from undula.analysis.arguments import require_model
from undula.analysis.one_thread import on_one_thread
from undula.analysis.ramps.ramp import Ramp, Step, ramp_steps
from undula.analysis.record import Fact, Record
from undula.analysis.run_settings import Schedule
from undula.analysis.runs.progress import Progress, displayed
from undula.arrays import Array, State
from undula.models.initial_states import kicked
from undula.models.model import Model

#: Numbers of a step that make columns of a table.
_COLUMNS = (
    *("value", "direction", "status", "verdict", "frequency", "frequency_error"),
    *("rotation_frequency", "shape_frequency", "planarity", "power_balance_error", "time"),
)
_RANGES = ("bending_energy", "tip_radius", "tip_height")


@dataclass(frozen=True, repr=False)
class RampResult(Record):
    """The steps of a ramp, in their order; a sequence of them.

    Attributes
    ----------
    model : Model
        The model; its own value of the parameter does not matter.
    ramp : Ramp
        Parameter, values and kicks.
    steps : tuple of Step
        The settled motion at each value; fewer than asked for if the ramp was cut short.
    """

    model: Model
    ramp: Ramp
    steps: tuple[Step, ...]

    _figure: ClassVar[str] = "undula.views.records.runs:ramp_figure"

    @property
    def parameter(self) -> str:
        """Name of the parameter."""
        return self.ramp.parameter

    @property
    def values(self) -> Array:
        """Value of the parameter at each step, shape (m,)."""
        return np.array([step.value for step in self.steps])

    @property
    def verdicts(self) -> tuple[str, ...]:
        """Name of the motion at each step."""
        return tuple(step.verdict for step in self.steps)

    def __len__(self) -> int:
        """Return the number of steps."""
        return len(self.steps)

    def __getitem__(self, index: int) -> Step:
        """Return a step by its number."""
        return self.steps[index]

    def __iter__(self) -> Iterator[Step]:
        """Return the steps in their order."""
        return iter(self.steps)

    def facts(self) -> dict[str, Fact]:
        """Return parameter, ends and the verdicts in their order, by name."""
        order = [
            verdict
            for number, verdict in enumerate(self.verdicts)
            if number == 0 or self.verdicts[number - 1] != verdict
        ]
        return {
            "parameter": Fact(self.parameter),
            "from": Fact(float(self.values[0])),
            "to": Fact(float(self.values[-1])),
            "steps": Fact(len(self)),
            "verdicts": Fact(", ".join(order)),
        }

    def to_dataframe(self) -> pd.DataFrame:
        """Return a row for each step: value, direction, verdict and numbers."""
        rows = []
        for step in self.steps:
            row = {name: getattr(step, name) for name in _COLUMNS}
            for name in _RANGES:
                own = getattr(step, name)
                row |= {f"{name}_{part}": getattr(own, part) for part in ("min", "max", "mean")}
            rows.append(row)
        return pd.DataFrame(rows)

    def to_xarray(self) -> xr.Dataset:
        """Return the numbers of all steps as a dataset over the dimension step."""
        return xr.Dataset.from_dataframe(self.to_dataframe().rename_axis("step"))

    def __str__(self) -> str:
        """Return parameter, ends and verdicts in one line."""
        facts = self.facts()
        return (
            f"ramp of {self.parameter} from {facts['from']} to {facts['to']} in {len(self)} steps:"
            f" {str(facts['verdicts'])[:100]}"
        )


@on_one_thread
def ramp(
    model: Model,
    parameter: str,
    values: Sequence[float],
    *,
    back: bool = False,
    kick: float = 1e-3,
    seed: int = 1,
    start: State | None = None,
    limit: float = 10.0,
    samples: int = 4000,
    rtol: float = 1e-6,
    budget: float = float("inf"),
    progress: Callable[[Progress], None] | bool | None = None,
) -> RampResult:
    """Change a parameter step by step; let the model settle at each value from its last shape.

    Parameters
    ----------
    model : Model
        Its own value of the parameter does not matter.
    parameter : str
        Such as "load.force".
    values : sequence of float
        From 1 to 10,000 values, in their order.
    back : bool
        True to return through the same values.
    kick : float
        Largest angle by which a link is turned before each run [rad], from 0 to pi/2.
    seed : int
        Seed of all kicks, at least 0.
    start : ndarray, shape (model.size,), optional
        State that the first run begins with; by default a small kick of the straight state.
    limit : float
        Longest time of a step [T].
    samples : int
        Number of samples of a step, from 2 to 10^9.
    rtol : float
        Relative error tolerance, from 1e-12 to 1e-2.
    budget : float
        Largest elapsed time [s]; the ramp then ends with the steps it has.
    progress : callable or True, optional
        Called with a `Progress` of the present run every few milliseconds; True shows it.

    Returns
    -------
    RampResult
        A sequence of steps.

    Raises
    ------
    InputError
        An argument is out of its range, or the model has no such parameter.

    Examples
    --------
    >>> import undula as un
    >>> model = un.Filament(4, un.TipLoad(0.0))
    >>> steps = un.ramp(model, "load.force", [10.0, 60.0], samples=400)
    >>> steps.verdicts
    ('straight', 'spinning')
    """
    require_model(model, "ramp")
    course = Ramp(parameter, tuple(map(float, values)), back=back, kick=kick, seed=seed)
    schedule = Schedule(until="settled", limit=limit, samples=samples, rtol=rtol)
    begin: Any = kicked(course.models(model)[0]) if start is None else start
    with displayed(progress, settling=True) as show:
        steps = tuple(ramp_steps(model, course, begin, schedule, budget=budget, progress=show))
    return RampResult(model, course, steps)
