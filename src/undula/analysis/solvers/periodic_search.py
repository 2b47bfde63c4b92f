"""The search for a motion that is periodic up to a turn: what a run has come to."""

from dataclasses import replace

import numpy as np
import xarray as xr

from undula.analysis.observables.alignment import comparison
from undula.analysis.parameters import FORCE
from undula.analysis.regimes.recurrence import RECURRENT
from undula.analysis.run_settings import Ending
from undula.analysis.runs.integrate import integrate
from undula.analysis.runs.run import Run
from undula.analysis.solvers.flapping import INTERVALS
from undula.analysis.solvers.periodic_guesses import Guess, Seen, guesses_of
from undula.analysis.solvers.periodic_orbits import periodic_shooting, periodic_state
from undula.analysis.solvers.symmetry import require_space
from undula.analysis.states.periodic_record import Periodic
from undula.analysis.states.records import NotFound
from undula.arrays import Nodes
from undula.errors import InputError
from undula.models.initial_states import from_state, kicked
from undula.models.model import Model
from undula.numerics.orbits.periodic_orbit import Orbit, find_orbit, with_shorter_steps

# A solution is what a run came to if it begins so near to the run's last shape, relative to the
# displacement: ten times what counts as coming back, as a run may still be on its way.
_NEAR = 10.0 * RECURRENT
# And if it takes so nearly as long, which those of a settled run agree to 1e-4 in.
_AS_LONG = 1e-2


def find_periodic(
    model: Model | Run, guess: Run | xr.Dataset | Periodic | None = None, *, seed: int | None = None
) -> Periodic | NotFound:
    """Solve for a motion that is periodic, up to a turn about the axis if that is a symmetry.

    Parameters
    ----------
    model : Model or Run
        In space; a run stands for its model, with itself as the guess.
    guess : Run, Dataset or Periodic, optional
        A run whose shape repeats itself, also as it was stored, or the state of a similar model.
        Without one a run from a small kick until it has settled is taken.
    seed : int, optional
        Seed of that kick, at least 0; by default 1.

    Returns
    -------
    Periodic or NotFound
        From a run what the run comes to: the solution begins at its last shape and has its period.

    Raises
    ------
    InputError
        The model is confined to a plane, or both a guess and a seed are given.
    """
    if isinstance(model, Run):
        guess, model = model if guess is None else guess, model.model
    require_space(model)
    if guess is not None and seed is not None:
        raise InputError("seed is that of a run that is made for want of a guess; leave one out")
    if isinstance(guess, Periodic):
        own = Guess(guess.duration, guess.angle, 0)
        found = _solved(model, guess.nodes[-1], own, len(guess.unknowns))
        return found if isinstance(found, NotFound) else _confirmed(model, found)
    if guess is None:
        guess = integrate(model, kicked(model, seed=1 if seed is None else seed), until="settled")
        if guess.ending is Ending.INTERRUPTED:
            raise KeyboardInterrupt  # which a run takes as its end, with what there is
    return reached(model, Seen.of(guess))


def reached(model: Model, seen: Seen) -> Periodic | NotFound:
    """Return the motion that a run has come to: a stable one if there is one at its end."""
    failed = NotFound(
        f"the run does not repeat itself ({seen.verdict}); run until it has settled, or look for"
        " spinning, flapping or rest"
    )
    left: Orbit | None = None
    for guess in guesses_of(seen, axisymmetric=model.axisymmetric):
        found = _solved(model, seen.last, guess, INTERVALS * max(guess.maxima, _fewest(model)))
        if isinstance(found, NotFound):
            failed = found
        elif (away := _away(model, found, seen, guess)) is not None:
            failed = NotFound(away)
        elif periodic_state(model, found).stable:
            return _confirmed(model, found)
        else:
            left = left or found
    # What a run has come near to and leaves again, if there is nothing that it stays at.
    return failed if left is None else _confirmed(model, left)


def _fewest(model: Model) -> int:
    """Return how many half beats' steps an orbit takes at least."""
    # Half a beat takes as many as are enough for a shape that comes back turned.
    return 1 if model.axisymmetric else 3


def _solved(model: Model, nodes: Nodes, guess: Guess, intervals: int) -> Orbit | NotFound:
    start = model.admissible(from_state(model, nodes))
    last = [guess.duration, guess.angle] if model.axisymmetric else [guess.duration]
    shooting = periodic_shooting(model, FORCE, intervals)
    search = find_orbit(shooting, np.concatenate([start, last]), model.load.force)
    if search.orbit is None:
        residual = search.solution.residual if search.solution else None
        return NotFound(f"no such motion was found from the guess: {search.advice}", residual)
    return search.orbit


def _away(model: Model, orbit: Orbit, seen: Seen, guess: Guess) -> str | None:
    """Tell how an orbit is another motion than the run ends with; None if it is the same."""
    duration, shape = orbit.shot.duration, model.nodes(model.positions(orbit.shot.y))
    apart = comparison(axisymmetric=model.axisymmetric)(seen.last, shape).distance / seen.size
    if apart <= _NEAR and abs(duration - guess.duration) <= _AS_LONG * guess.duration:
        return None
    return (
        f"the motion found from the run's end is another one: its period is {duration:.6g} T and"
        f" the run's {guess.duration:.6g} T, their shapes are apart by {apart:.2g} of the"
        " displacement; let the run settle longer"
    )


def _confirmed(model: Model, orbit: Orbit) -> Periodic | NotFound:
    """Return the motion with the error that its steps in time leave."""
    finer = with_shorter_steps(orbit)
    if finer is None:
        return NotFound("what was found is no motion that shorter steps confirm")
    found, same = periodic_state(model, orbit), periodic_state(model, finer)
    return replace(found, time_error=abs(same.frequency - found.frequency))
