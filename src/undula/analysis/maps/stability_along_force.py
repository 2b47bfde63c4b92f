"""Stability of solved states at points of a diagram, without runs in time.

Three states are solved for: the straight one, spinning and planar flapping. Where one of them is
stable a run can end there; where all are unstable or do not exist, only runs show the motion.
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

#: Verdicts by kind of state; the first that is stable is the verdict.
VERDICTS: Mapping[str, str] = {
    "straight": "straight",
    "spinning": "spinning",
    "flapping": "planar flapping",
}
#: Status of a kind of state in a record.
STABLE, UNSTABLE, NONE, MISSED = "stable", "unstable", "none", "not found"
_MOVING = ("spinning", "flapping")
# Number of instants of a turn at which the planarity of a spinning shape is computed.
_INSTANTS = 32


def solved_record(model: Model) -> dict[str, Any]:
    """Return the stability of the states of a model under its own force.

    Parameters
    ----------
    model : Model
        Model of the filament or chain; its own force is used.

    Returns
    -------
    dict
        The keys of a stored sweep: `verdict`, the stable state, or "undecided" if all three are
        unstable or missing; `also`, other stable ones, with commas between them; `margin`, the
        largest growth rate of a disturbance of the state [1/T], negative; `frequency` and
        `frequency_error` [cycles per T]; `energy_min`, `energy_max`, `energy_mean`;
        `tip_radius_min`, `tip_radius_max` [L]; `planarity`. And of each kind, as `spinning`, its
        status: "stable", "unstable", "none" (it does not exist) or "not found" (it may), with its
        `spinning_rate` [1/T] and `spinning_frequency`. Numbers that do not exist are NaN.
    """
    rest = spectrum(model, method="discrete", count=1)
    force = model.load.force
    if rest.rates[0] <= 0.0:
        # Only a subcritical branch reaches forces below the onset.
        states = {kind: states_along(model, kind, [force]).get(force) for kind in _kinds(model)}
    else:
        states = {kind: kind_by_name(kind).find(model) for kind in _kinds(model)}
    return _record(rest, states)


def stability_along_force(
    model: Model, forces: Sequence[float], *, progress: Callable[[float], None] | None = None
) -> list[dict[str, Any]]:
    """Return the stability of the states of a model at many forces, following each branch once.

    Parameters
    ----------
    model : Model
        Its own force does not matter.
    forces : sequence of float
        Total follower forces in the model's unit, at least 0, in any order.
    progress : callable, optional
        Called with each force that was reached.

    Returns
    -------
    list of dict
        For each force the record of `solved_record`. More states may be found: a branch that folds
        back below the onset is followed around its fold.

    Raises
    ------
    InputError
        A force is out of range.

    Examples
    --------
    >>> import undula as un
    >>> model = un.Filament(8, un.TipLoad(75.0))
    >>> [record["verdict"] for record in un.stability_along_force(model, [20.0, 30.0])]
    ['straight', 'straight']
    """
    states = {kind: states_along(model, kind, forces, progress) for kind in _kinds(model)}
    return [
        _record(
            spectrum(model, force, method="discrete", count=1),
            {kind: at_forces.get(force) for kind, at_forces in states.items()},
        )
        for force in forces
    ]


def _kinds(model: Model) -> tuple[str, ...]:
    """Return the kinds of moving states that a model can have; in a plane nothing spins."""
    return _MOVING if model.dimension == 3 else ("flapping",)


def _record(rest: Spectrum, states: Mapping[str, Any]) -> dict[str, Any]:
    """Return the record of the straight state's spectrum and of the moving states."""
    status = {"straight": STABLE if rest.rates[0] < 0.0 else UNSTABLE}
    status |= {kind: _status(states.get(kind)) for kind in _MOVING}
    stable = [kind for kind, word in status.items() if word == STABLE]
    first, others = (stable[0], stable[1:]) if stable else (None, [])
    record: dict[str, Any] = {
        "verdict": VERDICTS[first] if first else "undecided",
        "also": ", ".join(VERDICTS[kind] for kind in others),
    }
    record |= _at_rest(rest) if first == "straight" else _moving(states.get(first or ""))
    rates = {"straight": float(rest.rates[0])} | {kind: _rate(states.get(kind)) for kind in _MOVING}
    for kind, word in status.items():
        record |= {kind: word, f"{kind}_rate": rates[kind]}
    return record | {
        f"{kind}_frequency": getattr(states.get(kind), "frequency", np.nan) for kind in _MOVING
    }


def _status(state: Any) -> str:
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
    """Return the quantities of a stable state, NaN without one."""
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
    """Return the error of the frequency by the steps in time, which a branch does not compute."""
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
