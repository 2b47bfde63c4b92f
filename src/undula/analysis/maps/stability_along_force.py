"""What a filament does at a point of a diagram, told by solved states alone, without a run.

Three states are asked: is the straight one stable, does spinning exist and is it stable, and so for
planar flapping. Where one of them is stable a run can end there; where none is, what runs do is
left to runs.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from undula.analysis.linear.results import Spectrum
from undula.analysis.linear.spectrum import spectrum
from undula.analysis.maps.states_at_forces import states_along
from undula.analysis.observables.planarity import planarity
from undula.analysis.observables.shapes import Range
from undula.analysis.parameters import FORCE
from undula.analysis.solvers.flapping import flapping_family, flapping_unknowns
from undula.analysis.solvers.state_kinds import kind_by_name
from undula.analysis.states.not_found import NotFound
from undula.analysis.states.records import Flapping, Spinning
from undula.arrays import Shapes
from undula.models.model import Model
from undula.numerics.orbits.periodic_orbit import OrbitProblem, orbit_at, time_error

#: Verdicts by kind of state, the one that is told first where several are stable.
VERDICTS: Mapping[str, str] = {
    "straight": "straight",
    "spinning": "spinning",
    "flapping": "planar flapping",
}
#: What a record tells of each kind.
STABLE, UNSTABLE, NONE, MISSED = "stable", "unstable", "none", "not found"
_MOVING = ("spinning", "flapping")
# Instants of a turn at which a spinning shape is looked at.
_INSTANTS = 32


def solved_record(model: Model) -> dict[str, Any]:
    """Return what a model does under its own force, as far as solved states tell.

    Parameters
    ----------
    model : Model

    Returns
    -------
    dict
        The keys of a stored sweep: `verdict`, the stable state, or "undecided" if none of the three
        is; `also`, other stable ones, with commas between them; `margin`, the largest
        growth rate of a disturbance of the state [1/T], negative; `frequency` and `frequency_error`
        [cycles per T]; `energy_min`, `energy_max`, `energy_mean`; `tip_radius_min`,
        `tip_radius_max` [L]; `planarity`. And of each kind, as `spinning`, whether it is "stable",
        "unstable", "none" (it does not exist) or "not found" (it may), with its `spinning_rate`
        [1/T] and `spinning_frequency`. Numbers that do not exist are NaN.
    """
    rest = spectrum(model, method="discrete", count=1)
    force = model.load.force
    if rest.rates[0] <= 0.0:
        # Only a branch that is born downwards comes here.
        found = {kind: states_along(model, kind, [force]).get(force) for kind in _kinds(model)}
    else:
        found = {kind: kind_by_name(kind).find(model) for kind in _kinds(model)}
    return _record(rest, found)


def stability_along_force(
    model: Model, forces: Sequence[float], *, progress: Callable[[float], None] | None = None
) -> list[dict[str, Any]]:
    """Return what a model does at each of many forces, from branches that are followed once.

    Parameters
    ----------
    model : Model
        Its own force does not matter.
    forces : sequence of float
        In the model's unit of force and in any order, none below 0.
    progress : callable, optional
        Called with each force that a branch has reached.

    Returns
    -------
    list of dict
        For each force what `solved_record` tells. It may know more: a branch that folds back below
        the onset is followed around its fold.
    """
    found = {kind: states_along(model, kind, forces, progress) for kind in _kinds(model)}
    return [
        _record(
            spectrum(model, force, method="discrete", count=1),
            {kind: states.get(force) for kind, states in found.items()},
        )
        for force in forces
    ]


def _kinds(model: Model) -> tuple[str, ...]:
    """Return the kinds of states that a model can have; in a plane nothing spins."""
    return _MOVING if model.dimension == 3 else ("flapping",)


def _record(rest: Spectrum, found: Mapping[str, Any]) -> dict[str, Any]:
    """Return the record of the straight state's spectrum, and of the states beside it."""
    status = {"straight": STABLE if rest.rates[0] < 0.0 else UNSTABLE}
    status |= {kind: _standing(found.get(kind)) for kind in _MOVING}
    stable = [kind for kind, told in status.items() if told == STABLE]
    first, others = (stable[0], stable[1:]) if stable else (None, [])
    record: dict[str, Any] = {
        "verdict": VERDICTS[first] if first else "undecided",
        "also": ", ".join(VERDICTS[kind] for kind in others),
    }
    record |= _at_rest(rest) if first == "straight" else _moving(found.get(first or ""))
    rates = {"straight": float(rest.rates[0])} | {kind: _rate(found.get(kind)) for kind in _MOVING}
    for kind, told in status.items():
        record |= {kind: told, f"{kind}_rate": rates[kind]}
    return record | {
        f"{kind}_frequency": getattr(found.get(kind), "frequency", np.nan) for kind in _MOVING
    }


def _standing(state: Any) -> str:
    if state is None:
        return NONE
    if isinstance(state, NotFound):
        return MISSED
    return STABLE if state.stable else UNSTABLE


def _rate(state: Any) -> float:
    return float(getattr(state, "leading_rate", np.nan))


def _at_rest(rest: Spectrum) -> dict[str, float]:
    still = Range(0.0, 0.0, 0.0)
    return _quantities(float(rest.rates[0]), (0.0, 0.0), still, still, 0.0)


def _moving(state: Spinning | Flapping | None) -> dict[str, float]:
    """Return the quantities of a stable state, without numbers if there is none."""
    if state is None:
        missing = Range(np.nan, np.nan, np.nan)
        return _quantities(np.nan, (np.nan, np.nan), missing, missing, np.nan)
    if isinstance(state, Flapping):
        error = state.time_error if np.isfinite(state.time_error) else _time_error(state)
        return _quantities(
            state.leading_rate,
            (state.frequency, error),
            state.bending_energy,
            state.tip_radius,
            0.0,
        )
    # The rate of turning is as exact as the balance of the forces that drive it.
    error = state.residual * state.frequency
    flat = planarity(_over_a_turn(state))
    return _quantities(
        state.leading_rate, (state.frequency, error), state.bending_energy, state.tip_radius, flat
    )


def _time_error(state: Flapping) -> float:
    """Return the error of the frequency by the steps in time, which a branch does not tell."""
    problem = flapping_family(state, FORCE, 1.0).problem
    assert isinstance(problem, OrbitProblem)  # as beats have it
    orbit = orbit_at(problem, flapping_unknowns(state), state.force)
    return np.nan if orbit is None else 2.0 * state.frequency**2 * time_error(orbit)


def _quantities(
    margin: float, frequency: tuple[float, float], energy: Range, radius: Range, flat: float
) -> dict[str, float]:
    return {
        "margin": margin,
        "frequency": frequency[0],
        "frequency_error": frequency[1],
        "energy_min": energy.min,
        "energy_max": energy.max,
        "energy_mean": energy.mean,
        "tip_radius_min": radius.min,
        "tip_radius_max": radius.max,
        "planarity": flat,
    }


def _over_a_turn(state: Spinning) -> Shapes:
    """Return a spinning shape at instants of a turn, shape (m, N + 1, 3)."""
    turned = np.exp(2j * np.pi * np.arange(_INSTANTS) / _INSTANTS)[:, None]
    x, y, z = state.nodes.T
    plane = (x + 1j * y) * turned
    return np.stack([plane.real, plane.imag, np.broadcast_to(z, plane.shape)], axis=-1)
