"""Stability boundaries over a parameter and the force, solved for without runs in time.

| boundary | change there |
| --- | --- |
| onset | the straight state loses stability, for the links as they are |
| spinning-fold | the least force with spinning, if it is subcritical |
| spinning-lost | spinning loses stability |
| flapping-fold | the least force with planar flapping, if it is subcritical |
| flapping-gained | planar flapping becomes stable |
| flapping-lost | planar flapping ceases to be stable |
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from undula.analysis.linear.stability import onset
from undula.analysis.maps.stability_intervals import (
    Change,
    StabilityIntervals,
    moving_intervals,
    straight_intervals,
    unknown_intervals,
)
from undula.analysis.parameters import FORCE, changed
from undula.arrays import Array
from undula.errors import InputError
from undula.models.model import Model

#: Boundaries by name: kind of state, and name of its change.
BOUNDARIES: Mapping[str, tuple[str, str]] = {
    "onset": ("straight", "lost"),
    "spinning-fold": ("spinning", "fold"),
    "spinning-lost": ("spinning", "lost"),
    "flapping-fold": ("flapping", "fold"),
    "flapping-gained": ("flapping", "gained"),
    "flapping-lost": ("flapping", "lost"),
}
_MOVING = ("spinning", "flapping")
# Number of crossings of the straight state after the first: it may become stable again.
_LATER = 2


@dataclass(frozen=True)
class StabilityBoundaries:
    """Stability of states along the force, at each value of a parameter.

    Attributes
    ----------
    parameter : str or None
        Its name; None for a single model.
    values : tuple of float
        Its values, in its unit; a single NaN for a single model.
    up_to : float
        The largest force of interest, in the model's unit.
    columns : tuple of mapping of str to StabilityIntervals
        For each value the intervals of "straight", "spinning" and "flapping".
    """

    parameter: str | None
    values: tuple[float, ...]
    up_to: float
    columns: tuple[Mapping[str, StabilityIntervals], ...]

    def curve(self, name: str) -> tuple[Array, Array]:
        """Return the forces of a boundary over the values, and their errors.

        Parameters
        ----------
        name : str
            One of `BOUNDARIES`.

        Returns
        -------
        tuple of two ndarray of shape (k,)
            Forces and errors [B/L^2], NaN at values without such a boundary.

        Raises
        ------
        InputError
            There is no such boundary.
        """
        if name not in BOUNDARIES:
            raise InputError(f"border {name!r} is not known; take {', '.join(BOUNDARIES)}")
        kind, attribute = BOUNDARIES[name]
        changes: list[Change | None] = [getattr(column[kind], attribute) for column in self.columns]
        return (
            np.array([np.nan if change is None else change.force for change in changes]),
            np.array([np.nan if change is None else change.error for change in changes]),
        )

    def why_no_boundary(self, name: str, index: int) -> str | None:
        """Return why a boundary has no force at a value, None if it has one.

        Parameters
        ----------
        name : str
            One of `BOUNDARIES`.
        index : int
            Of the value, from 0.
        """
        kind, change = BOUNDARIES[name]
        state = self.columns[index][kind]
        if getattr(state, change) is not None:
            return None
        if state.reason is not None:
            return state.reason
        if change == "fold":
            return f"{kind} is born upwards"
        word = "become stable" if change == "gained" else "lose stability"
        return f"{kind} does not {word} up to force {state.searched_to:.6g}"


def stability_boundaries(
    model: Model,
    parameter: str | None,
    values: Sequence[float],
    up_to: float,
    *,
    progress: Callable[[int, int], None] | None = None,
) -> StabilityBoundaries:
    """Return the stability boundaries of the states of a model, over values of a parameter.

    Parameters
    ----------
    model : Model
        Its own force does not matter.
    parameter : str or None
        Name of the parameter, such as "load.exponent"; None for the model as it is, whose values
        then do not matter.
    values : sequence of float
        Values of the parameter, in its unit.
    up_to : float
        The largest force of interest, in the model's unit, above 0.
    progress : callable, optional
        Called with the number of values done and of all.

    Returns
    -------
    StabilityBoundaries
        Values at which a search fails have no boundary, with the reason.

    Raises
    ------
    InputError
        The parameter is the force, or `up_to` is out of range.

    Examples
    --------
    Below the onset no branch has to be followed:

    >>> import undula as un
    >>> model = un.Filament(8, un.TipLoad(75.0))
    >>> boundaries = un.stability_boundaries(model, None, (), 30.0)
    >>> forces, errors = boundaries.curve("onset")
    >>> forces.round(4)
    array([35.193])
    """
    if parameter == FORCE:
        raise InputError(f"borders are values of {FORCE}; take another parameter, or none")
    if not 0.0 < up_to < np.inf:
        raise InputError(f"up_to = {up_to!r} has to be a force above 0")
    taken = (float("nan"),) if parameter is None else tuple(float(value) for value in values)
    columns = []
    for done, value in enumerate(taken, start=1):
        columns.append(intervals_at(model, parameter, value, up_to))
        if progress:
            progress(done, len(taken))
    return StabilityBoundaries(parameter, taken, float(up_to), tuple(columns))


def intervals_at(
    model: Model, parameter: str | None, value: float, up_to: float
) -> dict[str, StabilityIntervals]:
    """Return the intervals of "straight", "spinning" and "flapping" at one value of a parameter.

    Parameters are those of `stability_boundaries`.
    """
    try:
        here = model if parameter is None else changed(model, parameter, value)
        # On the links as they are, like the runs of a diagram and the other boundaries.
        straight_onset = onset(here, method="discrete", later=_LATER)
    except (InputError, ArithmeticError, np.linalg.LinAlgError) as error:
        return {kind: unknown_intervals(kind, str(error)) for kind in ("straight", *_MOVING)}
    column = {"straight": straight_intervals(straight_onset)}
    return column | {kind: _moving(here, kind, straight_onset.force, up_to) for kind in _MOVING}


def _moving(model: Model, kind: str, onset_force: float | None, up_to: float) -> StabilityIntervals:
    """Return the intervals of spinning or flapping, or the reason why they are not known."""
    if kind == "spinning" and model.dimension != 3:
        return unknown_intervals(kind, "a confined model cannot spin")
    if onset_force is None:
        return unknown_intervals(kind, "the straight state stays stable")
    try:
        return moving_intervals(model, kind, onset_force, up_to)
    except (InputError, ArithmeticError, np.linalg.LinAlgError) as error:
        return unknown_intervals(kind, str(error))
