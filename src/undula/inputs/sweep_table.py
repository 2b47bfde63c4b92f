"""The table ``[study]`` of an input file: axes, starts and stored results of a sweep.

All other tables of the file are those of a run; they hold for every point, except for the keys that
the axes vary.
"""

import math
from collections.abc import Mapping
from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, PlainSerializer, model_validator

from undula.inputs.table import OnlyWith, Table, conflict

Keep = Literal["verdict", "period", "run"]
Policy = Literal["same", "random", "neighbour"]
AxisValues = Annotated[
    tuple[int | float, ...], Field(strict=False, min_length=1), PlainSerializer(list)
]
_Amplitude = Annotated[float, Field(gt=0.0, le=math.pi)]
Amplitudes = Annotated[tuple[_Amplitude, _Amplitude], Field(strict=False), PlainSerializer(list)]

#: Largest number of points of a sweep; more count as a typing error.
MOST_POINTS = 1_000_000


class AxisTable(Table):
    """A table ``[[study.axes]]``: a key of the input and the values that it takes.

    Attributes
    ----------
    key
        Table and name of a key that takes numbers, such as ``"load.force"``.
    values
        The values in their order; alternatively a range is given:
    from, to
        Ends of the range, both included.
    count
        Number of values in the range, from 2 to 1000000.
    spacing
        Spacing of the range: ``"linear"``, or ``"log"`` between ends above 0.
    """

    key: str = Field(default="", description="a key of the input such as 'load.force'")
    values: AxisValues | None = Field(default=None, description="a list of numbers")
    start: float | None = Field(default=None, alias="from", description="a finite number")
    to: float | None = Field(default=None, description="a finite number")
    count: int | None = Field(
        default=None, ge=2, le=MOST_POINTS, description=f"a whole number from 2 to {MOST_POINTS}"
    )
    spacing: Literal["linear", "log"] = Field(default="linear", description="'linear' or 'log'")

    @model_validator(mode="after")
    def _says_what_it_varies(self) -> Self:
        if not self.key:
            raise conflict(
                "an axis of the study has no key; give each [[study.axes]] a key such as"
                " 'load.force'"
            )
        return self

    @model_validator(mode="after")
    def _has_values_or_a_range(self) -> Self:
        ends = {"from": self.start, "to": self.to, "count": self.count}
        given = [name for name, value in ends.items() if value is not None]
        if self.values is not None and (given or "spacing" in self.model_fields_set):
            raise conflict(
                f"the axis {self.key} has both values and {(given or ['spacing'])[0]}; give values,"
                " or from, to and count"
            )
        if self.values is None and len(given) < len(ends):
            missing = next(name for name in ends if name not in given)
            raise conflict(
                f"the axis {self.key} has neither values nor {missing}; give values, or from, to"
                " and count"
            )
        return self

    @model_validator(mode="after")
    def _values_are_finite_and_differ(self) -> Self:
        if self.spacing == "log" and min(self.start or 0.0, self.to or 0.0) <= 0.0:
            raise conflict(
                f"the axis {self.key} has spacing = 'log' between {self.start} and {self.to}; give"
                " ends above 0, or spacing = 'linear'"
            )
        if self.start is not None and not math.isfinite((self.to or 0.0) - self.start):
            raise conflict(f"the axis {self.key} spans more than a number can hold; shorten it")
        values = self.resolved
        if len(set(values)) < len(values):
            twice = next(value for k, value in enumerate(values) if value in values[:k])
            raise conflict(f"the axis {self.key} takes the value {twice} twice; leave one out")
        return self

    @property
    def resolved(self) -> tuple[int | float, ...]:
        """All values of the axis."""
        if self.values is not None:
            return self.values
        ends = self.start or 0.0, self.to or 0.0
        spaced = np.geomspace if self.spacing == "log" else np.linspace
        return tuple(spaced(*ends, self.count or 0).tolist())


class SweepTable(Table):
    """The table ``[study]``: settings of a sweep.

    Attributes
    ----------
    label
        Result of a point: the verdict on a run (``"runs"``), or the states that are solved for
        (``"solved"``).
    keep
        Stored part of a run: ``"verdict"`` and figures, also its last ``"period"``, or the whole
        ``"run"`` as a file.
    undecided
        Treatment of an undecided run: it stays undecided (``"keep"``), or states are solved for
        (``"solve"``), and the only stable one of them is the verdict.
    policy
        Start of a run: that of the input (``"same"``), a ``"random"`` shape, or the last shape of
        the ``"neighbour"`` before it along the last axis.
    tries
        Number of replicates of a point, with different random starts, from 1 to 1000000.
    seed
        Seed of random starts and kicks, from 0 to 2^63 - 1.
    amplitudes
        Least and largest inclination of random starts [rad], above 0 and at most pi; the
        inclinations are log-uniform in between.
    direction
        Direction along the last axis, for neighbours.
    kick
        Largest angle by which a neighbour's shape is turned at random before the run begins [rad],
        from 0 to pi/2. Without a kick, a run may stay in a state that has lost its stability.
    axes
        The axes, at least one; the last one varies fastest.
    """

    label: Literal["runs", "solved"] = Field(default="runs", description="'runs' or 'solved'")
    keep: Keep = Field(default="verdict", description="'verdict', 'period' or 'run'")
    policy: Policy = Field(default="same", description="'same', 'random' or 'neighbour'")
    undecided: Literal["keep", "solve"] = Field(default="keep", description="'keep' or 'solve'")
    tries: int = Field(
        default=1, ge=1, le=MOST_POINTS, description=f"a whole number from 1 to {MOST_POINTS}"
    )
    seed: int = Field(default=1, ge=0, lt=2**63, description="a whole number from 0 to 2^63 - 1")
    amplitudes: Amplitudes = Field(
        default=(1e-3, 1.0), description="two numbers above 0 and at most pi"
    )
    direction: Literal["up", "down"] = Field(default="up", description="'up' or 'down'")
    kick: float = Field(
        default=1e-3, ge=0.0, le=0.5 * math.pi, description="a number from 0 to pi/2"
    )
    axes: Annotated[tuple[AxisTable, ...], Field(strict=False)] = Field(
        default=(), description="a list of tables [[study.axes]], each with a key and values"
    )

    only_with: ClassVar[Mapping[str, OnlyWith]] = {
        "keep": OnlyWith("label", ("runs",)),
        "policy": OnlyWith("label", ("runs",)),
        "undecided": OnlyWith("label", ("runs",)),
        "tries": OnlyWith("policy", ("random",)),
        "seed": OnlyWith("policy", ("random", "neighbour")),
        "amplitudes": OnlyWith("policy", ("random",)),
        "direction": OnlyWith("policy", ("neighbour",)),
        "kick": OnlyWith("policy", ("neighbour",)),
    }

    @model_validator(mode="after")
    def _amplitudes_rise(self) -> Self:
        least, largest = self.amplitudes
        if least > largest:
            raise conflict(
                f"study.amplitudes = [{least}, {largest}] fall; give the least inclination first"
            )
        return self

    @model_validator(mode="after")
    def _axes_differ(self) -> Self:
        keys = [axis.key for axis in self.axes]
        if len(set(keys)) < len(keys):
            twice = next(key for key in keys if keys.count(key) > 1)
            raise conflict(f"two axes of the study vary {twice}; leave one of them out")
        return self
