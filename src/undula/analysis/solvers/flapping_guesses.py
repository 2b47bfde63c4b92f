"""Guesses of a planar beat: its first shape and half its period, from a run or a similar beat."""

import numpy as np

from undula.analysis.linear.onset import first_pair
from undula.analysis.linear.pencils import linearised
from undula.analysis.run_settings import Ending
from undula.analysis.runs.integrate import integrate
from undula.analysis.runs.run import Run
from undula.analysis.states.not_found import NotFound, SearchStatus
from undula.analysis.states.records import Flapping
from undula.arrays import Array
from undula.models.initial_states import from_state, planar
from undula.models.model import Model

# Amplitude [rad] of the start of the run that gives a guess, large enough to settle soon.
_START_AMPLITUDE = 0.3
# Longest such run [beats]; the period is scaled down as the force exceeds the onset.
_MOST_BEATS = 200.0


def start_and_half_period(
    flat: Model, guess: Run | Flapping | None
) -> tuple[Array, float] | NotFound:
    """Return a shape of a beat, as a state of the confined model, and half the period.

    Parameters
    ----------
    flat : Model
        Confined to the plane of the beat.
    guess : Run, Flapping or None
        A run that beats, or the beat of a similar model; without one a run is made.

    Returns
    -------
    tuple of ndarray of shape (size,) and float, or NotFound
        The latter if the run does not beat. The time is in [T].
    """
    if isinstance(guess, Flapping):
        energies = guess.planar.observe(guess.unknowns).bending_energy
        return _positions(flat, _beginning(flat, guess.nodes, energies)), 0.5 * guess.period
    run = guess or _settled_run(flat)
    if run.frequency is None or run.frequency.value == 0.0 or run.verdict.name == "windmilling":
        origin = "given" if guess else "confined"
        return _no_beat(flat, f"the {origin} run does not beat ({run.verdict.name})")
    half = 0.5 / abs(run.frequency.value)
    last = run.motion.late(run.motion.time[-1] - 2.0 * half)
    return _positions(flat, _beginning(flat, last.nodes, last.energetics.bending_energy)), half


def _settled_run(flat: Model) -> Run:
    """Return a run from a planar start until it has settled.

    Raises
    ------
    KeyboardInterrupt
        The run was interrupted, which a run itself only notes as its ending.
    """
    start = planar(flat, _START_AMPLITUDE)
    run = integrate(flat, start, until="settled", limit=_longest(flat))
    if run.ending is Ending.INTERRUPTED:
        raise KeyboardInterrupt
    return run


def _longest(flat: Model) -> float:
    """Return the longest time in which a beat is to settle [T]; it falls as the force grows."""
    pair = first_pair(linearised(flat, "discrete"))
    if pair is None:
        return _MOST_BEATS
    return _MOST_BEATS * 2.0 * np.pi / pair.omega * pair.p / max(pair.p, flat.load.force)


def _no_beat(flat: Model, finding: str) -> NotFound:
    """Return the outcome for a run without a beat, explained by the onset of flapping."""
    pair = first_pair(linearised(flat, "discrete"))
    if pair is None:
        why = "the straight state stays stable, so that no beat begins at it"
        return NotFound(SearchStatus.NO_ONSET, f"{finding}: {why}")
    if flat.load.force > pair.p:
        return NotFound(
            SearchStatus.NO_GUESS,
            f"{finding}: it settles to no beat",
            "follow the branch from a smaller force, or give the beat found there as a guess",
        )
    why = f"planar flapping begins at force {pair.p:.6g}, and this one is {flat.load.force:.6g}"
    return NotFound(SearchStatus.BELOW_ONSET, f"{finding}: {why}")


def _beginning(flat: Model, nodes: Array, energies: Array) -> Array:
    """Return the shape of a beat (m, N + 1, 3) to begin at.

    Positions fix angles of unwrapped joints best where the energy is least.
    """
    return np.asarray(nodes[np.argmin(energies) if flat.unwrapped else -1])


def _positions(flat: Model, nodes: Array) -> Array:
    return flat.admissible(from_state(flat, nodes))
