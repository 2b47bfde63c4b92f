"""Borders of a diagram over a parameter and the force, solved for instead of run across.

| border | what happens there |
| --- | --- |
| onset | the straight state loses stability, for the links as they are |
| spinning-fold | the least force with spinning, where it is born downwards |
| spinning-lost | spinning loses stability |
| flapping-fold | the least force with planar flapping, where it is born downwards |
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
    moving_stretches,
    nothing_known,
    straight_stretches,
)
from undula.analysis.parameters import FORCE, changed
from undula.arrays import Array
from undula.errors import InputError
from undula.models.model import Model

#: Borders by name: of which kind of state they are, and which change of it.
BORDERS: Mapping[str, tuple[str, str]] = {
    "onset": ("straight", "lost"),
    "spinning-fold": ("spinning", "fold"),
    "spinning-lost": ("spinning", "lost"),
    "flapping-fold": ("flapping", "fold"),
    "flapping-gained": ("flapping", "gained"),
    "flapping-lost": ("flapping", "lost"),
}
_MOVING = ("spinning", "flapping")
# Crossings of the straight state after the first that are looked for: it may come to rest again.
_LATER = 2


@dataclass(frozen=True)
class StabilityBoundaries:
    """Where states begin and are stable, at each value of a parameter.

    Attributes
    ----------
    parameter : str or None
        Its name; None for the borders of a single model.
    values : tuple of float
        Its values; of a single model one, which is NaN.
    up_to : float
        Forces of interest end here.
    columns : tuple of mapping of str to Stretches
        For each value what is known of "straight", "spinning" and "flapping".
    """

    parameter: str | None
    values: tuple[float, ...]
    up_to: float
    columns: tuple[Mapping[str, StabilityIntervals], ...]

    def curve(self, name: str) -> tuple[Array, Array]:
        """Return the forces (k,) of a border over the values, NaN where it has none, and errors.

        Raises
        ------
        InputError
            There is no such border.
        """
        if name not in BORDERS:
            raise InputError(f"border {name!r} is not known; take {', '.join(BORDERS)}")
        kind, change = BORDERS[name]
        found: list[Change | None] = [getattr(column[kind], change) for column in self.columns]
        return (
            np.array([np.nan if one is None else one.force for one in found]),
            np.array([np.nan if one is None else one.error for one in found]),
        )

    def gap(self, name: str, index: int) -> str | None:
        """Return why a border has no force at a value, None if it has one."""
        kind, change = BORDERS[name]
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
    """Return the borders between the motions of a model, over values of a parameter.

    Parameters
    ----------
    model : Model
        Its own force does not matter.
    parameter : str or None
        Name of the parameter, such as "load.exponent"; None for the model as it is, whose values
        then do not matter.
    values : sequence of float
    up_to : float
        The largest force of interest, in the model's unit, above 0.
    progress : callable, optional
        Called with the number of values done and of all.

    Returns
    -------
    Borders
        Values at which a search fails have gaps with their reasons.

    Raises
    ------
    InputError
        The parameter is the force, or `up_to` is out of range.
    """
    if parameter == FORCE:
        raise InputError(f"borders are values of {FORCE}; take another parameter, or none")
    if not 0.0 < up_to < np.inf:
        raise InputError(f"up_to = {up_to!r} has to be a force above 0")
    taken = (float("nan"),) if parameter is None else tuple(float(value) for value in values)
    columns = []
    for done, value in enumerate(taken, start=1):
        columns.append(border_column(model, parameter, value, up_to))
        if progress:
            progress(done, len(taken))
    return StabilityBoundaries(parameter, taken, float(up_to), tuple(columns))


def border_column(
    model: Model, parameter: str | None, value: float, up_to: float
) -> dict[str, StabilityIntervals]:
    """Return what is known of "straight", "spinning" and "flapping" at one value of a parameter.

    Arguments are those of `stability_boundaries`.
    """
    try:
        there = model if parameter is None else changed(model, parameter, value)
        # The runs of a diagram are of links as they are, and so are the other borders.
        straight_onset = onset(there, method="discrete", later=_LATER)
    except (InputError, ArithmeticError, np.linalg.LinAlgError) as error:
        return {kind: nothing_known(kind, str(error)) for kind in ("straight", *_MOVING)}
    column = {"straight": straight_stretches(straight_onset)}
    return column | {kind: _moving(there, kind, straight_onset.force, up_to) for kind in _MOVING}


def _moving(model: Model, kind: str, onset: float | None, up_to: float) -> StabilityIntervals:
    if kind == "spinning" and model.dimension != 3:
        return nothing_known(kind, "a confined model cannot spin")
    if onset is None:
        return nothing_known(kind, "the straight state stays stable")
    try:
        return moving_stretches(model, kind, onset, up_to)
    except (InputError, ArithmeticError, np.linalg.LinAlgError) as error:
        return nothing_known(kind, str(error))
