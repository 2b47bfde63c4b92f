"""A quasi-static ramp: a parameter changed step by step, as in an experiment.

The model settles at a value of the parameter; the value is changed, and the model settles again
from its last shape. Its final motion may thus depend on the direction of the ramp. Before each run
all links are turned a little at random, smoothly along the filament: a state that has lost its
stability would otherwise be kept until round-off has grown.

Source: the continuation of Ling, Guo & Kanso (2018) for their bead-spring chains.
"""

import math
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, fields
from typing import Any

import numpy as np

from undula.analysis.observables.shapes import Range
from undula.analysis.parameters import changed, value_of
from undula.analysis.run_settings import Ending, Schedule
from undula.analysis.runs.integrate import integrate
from undula.analysis.runs.last_period import last_period
from undula.analysis.runs.progress import Progress
from undula.analysis.runs.run import Run
from undula.arrays import Instants, Nodes, Shapes, State
from undula.errors import InputError, is_number
from undula.models.model import Model
from undula.models.perturbation import perturbed

#: Largest number of steps of a ramp; each step is a run of its own.
MOST_STEPS = 10_000


@dataclass(frozen=True)
class Ramp:
    """The values that a parameter takes in turn, and the kick before each run.

    Attributes
    ----------
    parameter : str
        Such as "load.force"; not a whole number, see `parameters.value_of`.
    values : tuple of float
        Of the forward ramp, from 1 to 10,000, in their order.
    back : bool
        True if the ramp returns through the same values.
    kick : float
        Largest angle by which a link is turned before a run [rad], from 0 to pi/2.
    seed : int
        Seed of all kicks, at least 0.
    """

    parameter: str
    values: tuple[float, ...]
    back: bool = False
    kick: float = 1e-3
    seed: int = 1

    def __post_init__(self) -> None:
        """Refuse values that do not make a ramp."""
        if len(self.values) > MOST_STEPS:
            raise InputError(
                f"values are {len(self.values)} steps, each a run of its own, and {MOST_STEPS} are"
                " the most; give fewer"
            )
        if not (self.values and all(map(is_number, self.values))):
            raise InputError(f"values = {self.values!r} have to be finite numbers, at least one")
        if not (is_number(self.kick) and 0.0 <= self.kick <= 0.5 * math.pi):
            raise InputError(
                f"kick = {self.kick!r} is out of range; give an angle from 0 to pi/2 (radians)"
            )
        if isinstance(self.seed, bool) or not isinstance(self.seed, int) or self.seed < 0:
            raise InputError(f"seed = {self.seed!r} has to be a whole number, at least 0")

    @property
    def targets(self) -> tuple[tuple[float, str], ...]:
        """The values in the order in which they are taken, each with its direction."""
        forward, back = ("up", "down") if self.values[-1] >= self.values[0] else ("down", "up")
        returning = self.values[-2::-1] if self.back else ()
        return (*((v, forward) for v in self.values), *((v, back) for v in returning))

    def models(self, model: Model) -> list[Model]:
        """Return the model at each of the values.

        Parameters
        ----------
        model : Model
            Its own value of the parameter does not matter.

        Returns
        -------
        list of Model

        Raises
        ------
        InputError
            There is no such parameter, it is a whole number, or a value is out of its range; or the
            springs count full turns, which would be lost between two steps.
        """
        if model.unwrapped:
            raise InputError(
                "joints that wind up lose their full turns between two steps; use"
                " model.spring = 'angle', which is the same as long as none turns beyond pi"
            )
        value_of(model, self.parameter)
        models = [changed(model, self.parameter, value) for value, _ in self.targets]
        for model in models:
            model.straight()  # fails if the load exceeds the tensile stiffness of the links
        return models


@dataclass(frozen=True)
class Step:
    """The settled motion at one value of the parameter.

    Numbers are in the model's units, NaN if the motion does not have them. They are measured in the
    late window of the run, see `undula.analysis.runs.run.Run`.

    Attributes
    ----------
    value : float
        The parameter.
    direction : {"up", "down"}
        Direction in which the parameter changes.
    status, cause : str
        Ending of the run; cause and remedy of a failure.
    verdict, reason : str
        Name of its final motion, and the reason in a sentence.
    frequency, rotation_frequency, shape_frequency : float
        As of a `Run`, each with its error in the next field [cycles per T]; the first one has no
        sign.
    bending_energy, tip_radius, tip_height : Range
    planarity : float
        Share of the motion out of its best plane.
    power_balance_error, length_error : float
        Relative errors of the energy balance and of the lengths of the links.
    steps : int
        Steps of the integrator.
    time : float
        Time at which the run ended [T].
    seconds : float
        Wall time of the run.
    nodes : ndarray, shape (N + 1, 3)
        Its last shape [L].
    shape_times : ndarray, shape (m,)
        Times of the shapes [T].
    shapes : ndarray, shape (m, N + 1, 3)
        Nodes at times spread evenly over the last period [L]; without a period, over that of the
        strongest line of the spectrum; of a straight filament, over the whole late window.
    """

    value: float
    direction: str
    status: str
    cause: str
    verdict: str
    reason: str
    frequency: float
    frequency_error: float
    rotation_frequency: float
    rotation_frequency_error: float
    shape_frequency: float
    shape_frequency_error: float
    bending_energy: Range
    tip_radius: Range
    tip_height: Range
    planarity: float
    power_balance_error: float
    length_error: float
    steps: int
    time: float
    seconds: float
    nodes: Nodes
    shape_times: Instants
    shapes: Shapes


def ramp_steps(
    model: Model,
    course: Ramp,
    start: State,
    schedule: Schedule,
    *,
    before: Sequence[Step] = (),
    budget: float = math.inf,
    progress: Callable[[Progress], None] | None = None,
) -> Iterator[Step]:
    """Yield each step of a ramp as soon as it has been run.

    Parameters
    ----------
    model : Model
        Its own value of the parameter does not matter.
    course : Ramp
        Parameter, values and kicks of the ramp.
    start : ndarray, shape (model.size,)
        The state that the first run begins with, once it has been kicked.
    schedule : Schedule
        Of each run.
    before : sequence of Step
        Steps that have been run already. Those that follow are the same as without interruption.
    budget : float
        Time [s] after which no further step is yielded; a run under way is dropped.
    progress : callable, optional
        Called with a `Progress` of the run under way every few milliseconds.

    Yields
    ------
    Step

    Raises
    ------
    InputError
        As in `Ramp.models`.
    KeyboardInterrupt
        Ctrl-C came during a run, which is dropped.
    """
    models = course.models(model)
    nodes = before[-1].nodes if before else model.nodes(start)
    end = time.monotonic() + budget
    for number in range(len(before), len(models)):
        model, began = models[number], time.monotonic()
        x = _turned(model, nodes, course, number)
        run = integrate(model, x, **asdict(schedule), budget=end - began, progress=progress)
        if run.ending is Ending.INTERRUPTED:
            raise KeyboardInterrupt
        if run.ending is Ending.OUT_OF_TIME:
            return
        value, direction = course.targets[number]
        step = _step(run, value, direction, began)
        nodes = step.nodes
        yield step


def _turned(model: Model, nodes: Nodes, course: Ramp, number: int) -> State:
    """Return the state with these nodes after the kick of a step."""
    if course.kick == 0.0:
        return model.from_nodes(nodes)
    # A seed of its own for each step, so that a ramp can be continued at any of them.
    own = np.random.SeedSequence((course.seed, number)).generate_state(1, np.uint64)[0]
    return perturbed(model, nodes, course.kick, seed=int(own))


def _step(run: Run, value: float, direction: str, began: float) -> Step:
    """Return the record of a run that began at a wall time [s]."""
    summary, (times, shapes) = run.summary(), last_period(run)
    # A step has the numbers of a run's summary under the same names.
    same = {field.name: summary[field.name] for field in fields(Step) if field.name in summary}
    absent = {name: math.nan for name, number in same.items() if number is None}
    names = ("bending_energy", "tip_radius", "tip_height")
    ranges = {name: Range(**summary[name]) for name in names}
    own: dict[str, Any] = {
        "value": value,
        "direction": direction,
        "cause": run.cause,
        "seconds": time.monotonic() - began,
        "nodes": run.last_shape,
        "shape_times": times,
        "shapes": shapes,
    }
    return Step(**(same | absent | ranges | own))
