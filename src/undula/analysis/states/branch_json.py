"""A branch in plain JSON types, and read back from them."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from undula.analysis.observables.shapes import Range
from undula.analysis.states.branch import Bifurcation, Bifurcations, Branch
from undula.analysis.states.records import Flapping
from undula.analysis.states.state import State
from undula.arrays import ComplexArray
from undula.errors import InputError

_UNKNOWN = Range(np.nan, np.nan, np.nan)
# Least numbers of growing disturbances before and after a bifurcation, by its change of stability.
_GROWING = {"lost": (0, 1), "gained": (1, 0), "unchanged": (1, 1)}


@dataclass(frozen=True)
class StateNumbers:
    """A state as JSON keeps it: its numbers without its shape.

    Attributes
    ----------
    frequency : float
        Cycles per T.
    bending_energy : Range
        Bending energy over a cycle [B/L], NaN where it is not kept.
    exponents : ndarray of shape (k,)
        Leading growth rates of disturbances [1/T], by falling real part: one, or one in the plane
        and one out of it; none where they are not kept.
    stable : bool
        True if all disturbances decay.
    """

    frequency: float
    bending_energy: Range
    exponents: ComplexArray
    stable: bool


def points_as_json(branch: Branch[Any]) -> list[dict[str, Any]]:
    """Return the states of a branch, each with the value of the parameter.

    Parameters
    ----------
    branch : Branch
        Of states with their models.

    Returns
    -------
    list of dict
        The parameter by its name, `frequency`, `bending_energy`, `tip_radius` and `tip_height` as
        in `extents_as_json`, `stable` and `leading_rate`; of a planar beat also
        `leading_rate_in_plane` and `leading_rate_out_of_plane`, None if confined.
    """
    points = []
    for value, state in zip(branch.values, branch.states, strict=True):
        point = {branch.parameter: float(value), "frequency": state.frequency}
        point |= extents_as_json(state)
        point |= {"stable": state.stable, "leading_rate": state.leading_rate}
        if isinstance(state, Flapping):
            point |= {
                "leading_rate_in_plane": state.leading_rate_in_plane,
                "leading_rate_out_of_plane": state.leading_rate_out_of_plane,
            }
        points.append(point)
    return points


def extents_as_json(state: State) -> dict[str, Any]:
    """Return bending energy [B/L], radius and height of the tip [L] of a state, by name.

    Of a shape that changes each is a dict of its `min`, `max` and `mean` over a cycle.
    """
    ranges = {
        "bending_energy": state.bending_energy,
        "tip_radius": state.tip_radius,
        "tip_height": state.tip_height,
    }
    return {name: own.mean if state.steady else asdict(own) for name, own in ranges.items()}


def bifurcation_as_json(
    parameter: str, bifurcation: Bifurcation[Any], *, error_of: str
) -> dict[str, Any]:
    """Return a bifurcation by its kind, its value, its frequencies and its change of stability.

    Parameters
    ----------
    parameter : str
        Name of the parameter, under which the value stands a second time.
    bifurcation : Bifurcation
        Of states with their models.
    error_of : str
        The body or the links that the error is of.
    """
    return {
        "kind": bifurcation.kind,
        "value": bifurcation.value,
        parameter: bifurcation.value,
        "error": bifurcation.error,
        "error_of": error_of,
        "links": bifurcation.state.model.links,
        "frequency": bifurcation.frequency,
        "second_frequency": bifurcation.second_frequency,
        "stability": bifurcation.stability,
    }


def read_branch(answer: Mapping[str, Any], parameter: str) -> Branch[Any]:
    """Return the branch of states that move which an answer holds.

    Parameters
    ----------
    answer : mapping
        With the keys `status`, `parameter`, `points`, as of `points_as_json`, and `bifurcations`;
        with `onset`, if the branch was followed from there.
    parameter : str
        Name of the parameter that it has to be along.

    Returns
    -------
    Branch
        Of at least two `StateNumbers`. Its bifurcations have no energy and no exponents, and their
        numbers of growing disturbances are the least that their change of stability allows.

    Raises
    ------
    InputError
        The answer has fewer than two states, or they are along another parameter or at rest.
    """
    points: Sequence[Mapping[str, Any]] = answer.get("points") or ()
    if len(points) < 2:
        why = answer.get("reason", f"it has {len(points)} state(s)")
        raise InputError(f"the answer holds no branch ({why}); follow states along {parameter}")
    if answer.get("parameter") != parameter or "bending_energy" not in points[0]:
        raise InputError(
            f"the answer is not of spinning or flapping states along {parameter}, but along"
            f" {answer.get('parameter')}; give another"
        )
    return Branch(
        parameter,
        np.array([float(point[parameter]) for point in points]),
        tuple(map(_state, points)),
        Bifurcations(map(_bifurcation, answer.get("bifurcations", ()))),
        complete=answer["status"] == "done",
        onset=answer.get("onset"),
    )


def _state(point: Mapping[str, Any]) -> StateNumbers:
    energy = point["bending_energy"]
    if not isinstance(energy, Mapping):
        energy = dict.fromkeys(("min", "max", "mean"), energy)
    both = [point.get(f"leading_rate_{side}_plane") for side in ("in", "out_of")]
    rates = [rate for rate in both if rate is not None] or [point["leading_rate"]]
    exponents = np.sort(np.array(rates, dtype=complex))[::-1]
    return StateNumbers(point["frequency"], Range(**energy), exponents, bool(point["stable"]))


def _bifurcation(stored: Mapping[str, Any]) -> Bifurcation[Any]:
    before, after = _GROWING[stored["stability"]]
    state = StateNumbers(stored["frequency"], _UNKNOWN, np.empty(0, dtype=complex), stable=False)
    return Bifurcation(
        kind=stored["kind"],
        value=float(stored["value"]),
        error=stored["error"],
        state=state,
        frequency=stored["frequency"],
        second_frequency=stored["second_frequency"],
        unstable_before=before,
        unstable_after=after,
    )
