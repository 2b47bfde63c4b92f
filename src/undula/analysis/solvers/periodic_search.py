"""Search for motions that are periodic up to a turn: the motion at the end of a run."""

from dataclasses import replace

import numpy as np
import xarray as xr

from undula.analysis.observables.alignment import comparison
from undula.analysis.parameters import FORCE
from undula.analysis.regimes.recurrence import MAX_RECURRENCE_DISTANCE
from undula.analysis.run_settings import Ending
from undula.analysis.runs.integrate import integrate
from undula.analysis.runs.run import Run
from undula.analysis.solvers.flapping import INTERVALS, no_orbit
from undula.analysis.solvers.periodic_guesses import Guess, Seen, guesses_of
from undula.analysis.solvers.periodic_orbits import periodic_shooting, periodic_state
from undula.analysis.solvers.symmetry import require_space
from undula.analysis.states.not_found import NotFound, SearchStatus
from undula.analysis.states.periodic_record import Periodic
from undula.arrays import Nodes
from undula.errors import InputError
from undula.models.initial_states import from_state, kicked
from undula.models.model import Model
from undula.numerics.orbits.periodic_orbit import Orbit, find_orbit, with_shorter_steps

# Largest distance of a solution from the last shape of the run, relative to the displacement: ten
# times that of a recurrence, as a run may not have settled yet.
_LARGEST_DISTANCE = 10.0 * MAX_RECURRENCE_DISTANCE
# Largest relative difference of their periods; those of a settled run agree to 1e-4.
_PERIOD_DIFFERENCE = 1e-2


def find_periodic(
    model: Model | Run, guess: Run | xr.Dataset | Periodic | None = None, *, seed: int | None = None
) -> Periodic | NotFound:
    """Solve for a motion that is periodic, up to a turn about the axis if that is a symmetry.

    Single shooting solves for shape, period and angle together (Keller 1968).

    Parameters
    ----------
    model : Model or Run
        In space; a run stands for its model, with itself as the guess.
    guess : Run, Dataset or Periodic, optional
        A run whose shape repeats itself, computed or stored, or the state of a similar model.
        Without one a run from a small kick is made, until it has settled.
    seed : int, optional
        Seed of that kick, at least 0; by default 1.

    Returns
    -------
    Periodic or NotFound
        From a run the motion that it settles to: the solution begins at the run's last shape and
        has its period. `NotFound` states how far the search got, and what to try.

    Raises
    ------
    InputError
        The model is confined to a plane, or both a guess and a seed are given.

    Examples
    --------
    A windmilling chain turns twice about the axis before its shape recurs:

    >>> import undula as un
    >>> state = un.find(un.Chain(3, un.TipLoad(100.0)), "periodic", seed=1)
    >>> state.stable, round(abs(state.turns), 6)
    (True, 2.0)
    """
    if isinstance(model, Run):
        guess, model = model if guess is None else guess, model.model
    require_space(model)
    if guess is not None and seed is not None:
        raise InputError("seed is that of a run that is made for want of a guess; leave one out")
    if isinstance(guess, Periodic):
        period = Guess(guess.period, guess.angle, 0)
        orbit = _solved(model, guess.nodes[-1], period, len(guess.unknowns))
        return orbit if isinstance(orbit, NotFound) else _confirmed(model, orbit)
    if guess is None:
        guess = integrate(model, kicked(model, seed=1 if seed is None else seed), until="settled")
        if guess.ending is Ending.INTERRUPTED:
            raise KeyboardInterrupt  # a run itself only notes this as its ending
    return reached(model, Seen.of(guess))


def reached(model: Model, seen: Seen) -> Periodic | NotFound:
    """Return the motion at the end of a run, a stable one if a period leads to it.

    Parameters
    ----------
    model : Model
        Of the run, in space.
    seen : Seen
        The late part of the run.
    """
    failure = NotFound(
        SearchStatus.NO_GUESS,
        f"the run does not repeat itself ({seen.verdict})",
        "run until it has settled, or look for spinning, flapping or rest",
    )
    unstable: Orbit | None = None
    for guess in guesses_of(seen, axisymmetric=model.axisymmetric):
        intervals = INTERVALS * max(guess.maxima, _fewest_half_beats(model))
        orbit = _solved(model, seen.last, guess, intervals)
        if isinstance(orbit, NotFound):
            failure = orbit
        elif (another := _another_motion(model, orbit, seen, guess)) is not None:
            failure = another
        elif periodic_state(model, orbit).stable:
            return _confirmed(model, orbit)
        else:
            unstable = unstable or orbit
    # A run may have approached an unstable motion that it leaves later.
    return failure if unstable is None else _confirmed(model, unstable)


def _fewest_half_beats(model: Model) -> int:
    """Return the fewest half beats whose steps an orbit takes.

    A shape that returns turned takes those of one; without rotational symmetry orbits are longer.
    """
    return 1 if model.axisymmetric else 3


def _solved(model: Model, nodes: Nodes, guess: Guess, intervals: int) -> Orbit | NotFound:
    start = model.admissible(from_state(model, nodes))
    last = [guess.duration, guess.angle] if model.axisymmetric else [guess.duration]
    shooting = periodic_shooting(model, FORCE, intervals)
    search = find_orbit(shooting, np.concatenate([start, last]), model.load.force)
    if search.orbit is None:
        return no_orbit(search, "no such motion was found from the guess")
    return search.orbit


def _another_motion(model: Model, orbit: Orbit, seen: Seen, guess: Guess) -> NotFound | None:
    """Return the differences of an orbit from the end of the run; None if it is the same motion."""
    duration, shape = orbit.shot.duration, model.nodes(model.positions(orbit.shot.y))
    apart = comparison(axisymmetric=model.axisymmetric)(seen.last, shape).distance / seen.size
    if (
        apart <= _LARGEST_DISTANCE
        and abs(duration - guess.duration) <= _PERIOD_DIFFERENCE * guess.duration
    ):
        return None
    return NotFound(
        SearchStatus.ANOTHER_MOTION,
        f"the motion found from the run's end is another one: its period is {duration:.6g} T and"
        f" the run's {guess.duration:.6g} T, their shapes are apart by {apart:.2g} of the"
        " displacement",
        "let the run settle longer",
    )


def _confirmed(model: Model, orbit: Orbit) -> Periodic | NotFound:
    """Return the record of an orbit with the error of its frequency by the steps in time."""
    finer = with_shorter_steps(orbit)
    if finer is None:
        return NotFound(
            SearchStatus.NOT_CONFIRMED, "what was found is no motion that shorter steps confirm"
        )
    state, finer_state = periodic_state(model, orbit), periodic_state(model, finer)
    return replace(state, time_error=abs(finer_state.frequency - state.frequency))
