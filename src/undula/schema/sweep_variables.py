"""Variables of a stored sweep: names, types, units and meanings."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

#: Longest stored text of a point in characters; longer ones are cut off.
LONGEST_TEXT = 300


@dataclass(frozen=True)
class Column:
    """A variable of a stored sweep.

    Attributes
    ----------
    name
        Name in the store and in the record of a point.
    dtype
        Type, by its name in numpy.
    meaning
        Meaning in words, stored as ``long_name``.
    quantity
        Physical quantity, which determines the unit; empty for a number without a unit.
    rest
        Value at points that are not done.
    """

    name: str
    dtype: str
    meaning: str
    quantity: str = ""
    rest: Any = np.nan


def _number(name: str, meaning: str, quantity: str = "") -> Column:
    return Column(name, "float64", meaning, quantity)


def _text(name: str, meaning: str, length: int) -> Column:
    return Column(name, f"<U{length}", meaning, rest="")


STATUS = Column("status", "int8", "whether the point is done", rest=0)
#: The words for the values of `STATUS`, from 0 on.
STATUS_WORDS = ("not_done", "done", "failed")
SEED = Column("seed", "int64", "seed of what is random in the start, -1 without", rest=-1)

#: Variables of every sweep.
FIGURES = (
    _text("verdict", "what the motion is", 24),
    _number("margin", "factor by which the verdict's criteria are met"),
    _number("frequency", "frequency of the whole motion", "frequency"),
    _number("frequency_error", "error of the frequency", "frequency"),
    _number("rotation_frequency", "frequency of turning about z", "frequency"),
    _number("shape_frequency", "frequency of the shape up to turns", "frequency"),
    _number("energy_min", "least bending energy", "energy"),
    _number("energy_max", "largest bending energy", "energy"),
    _number("energy_mean", "mean bending energy", "energy"),
    _number("tip_radius_min", "least distance of the tip from the axis", "length"),
    _number("tip_radius_max", "largest distance of the tip from the axis", "length"),
    _number("tip_height_min", "least height of the tip", "length"),
    _number("tip_height_max", "largest height of the tip", "length"),
    _number("planarity", "share of the motion out of its best plane"),
    _number("lyapunov", "largest Lyapunov exponent", "rate"),
    _number("lyapunov_error", "error of the Lyapunov exponent", "rate"),
    _number("power_balance_error", "error of the energy balance"),
    _number("length_error", "largest change of a link's length"),
    _number("time", "time that the run has reached", "time"),
    _number("seconds", "wall time of the point"),
    _text("ending", "how the run has ended", 24),
    _text("reason", "why it has this verdict, or why it failed", LONGEST_TEXT),
)
#: Further variables of a sweep of solved states.
SOLVED = (
    _text("also", "other verdicts whose states are stable too", 48),
    *(
        column
        for kind in ("straight", "spinning", "flapping")
        for column in (
            _text(kind, f"whether the {kind} state is stable", 12),
            _number(f"{kind}_rate", f"leading growth rate of the {kind} state", "rate"),
        )
    ),
    _number("spinning_frequency", "frequency of the spinning state", "frequency"),
    _number("flapping_frequency", "frequency of the flapping state", "frequency"),
)
#: Further variable of a sweep whose undecided runs are decided by solved states.
DECIDED = _text("decided_by", "what the verdict is from: 'run' or 'solved states'", 16)
#: Further dimensions of the variables of a sweep that stores the last period.
INNER: Mapping[str, tuple[str, ...]] = {
    "shape_times": ("shape",),
    "shapes": ("shape", "node", "axis"),
    "path": ("instant", "axis"),
}
_OF_SHAPES = (
    _number("shape_times", "times of the shapes", "time"),
    _number("shapes", "nodes over the last period", "length"),
    _number("path", "mean position over the last periods", "length"),
)


def columns_of(label: str, keep: str, undecided: str) -> tuple[Column, ...]:
    """Return the variables of a sweep, without its seeds.

    Parameters
    ----------
    label, keep, undecided
        Settings of the sweep, as in the table ``[study]`` of its input.
    """
    solved = SOLVED if label == "solved" else ()
    decided = (DECIDED,) if undecided == "solve" else ()
    return (STATUS, *FIGURES, *solved, *decided, *(_OF_SHAPES if keep == "period" else ()))
