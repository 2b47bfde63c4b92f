"""Small changes carried along a trajectory are the derivative of that very trajectory."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import undula as un
from cases import mostly_slow
from systems import (
    ALL_STEPS,
    BEAD,
    FOLLOWER,
    SPINNER,
    Known,
    always_accepting,
    begin,
    carry_changes,
    choices,
    copied,
    pinned,
)
from undula.analysis.run_settings import Schedule
from undula.arrays import Array
from undula.models.model import Model
from undula.numerics.integration.matrices import derivative_half_bandwidth
from undula.numerics.integration.schemes import NDF
from undula.numerics.integration.status import Status
from undula.numerics.integration.step import Options
from undula.numerics.integration.stepper_state import (
    FAILED,
    PLANNED_FACTOR,
    PLANNED_ORDER,
    REJECTED,
    STEPS,
    StepperState,
    start,
)
from undula.numerics.integration.variational import advance_with_changes

FOREVER = np.inf
#: Newton's method is taken to where differences of two runs still have six digits.
EXACTLY = {"rtol": 1e-11, "atol": 1e-11}


def take_steps(
    loop: Callable[..., int],
    system: Any,
    memory: StepperState,
    told: Options,
    changes: Array,
    count: int,
) -> None:
    n = changes.shape[2]
    band = np.zeros((n, 2 * derivative_half_bandwidth(type(system)) + 1))
    before = memory.count[[STEPS, FAILED, REJECTED]]
    code = loop(system, pinned(memory), told, changes, band, FOREVER, count)
    assert Status(code) is Status.PAUSED
    # A step that failed in one of two runs would make them incomparable.
    np.testing.assert_array_equal(memory.count[[STEPS, FAILED, REJECTED]] - before, [count, 0, 0])


def on_its_way(
    loop: Callable[..., int], system: Any, memory: StepperState, told: Options, changes: Array
) -> None:
    """Take some steps of one length and order, some of another length, some of a higher order."""
    take_steps(loop, system, memory, told, changes, 6)
    memory.real[PLANNED_FACTOR] = 1.6
    take_steps(loop, system, memory, told, changes, 1)
    take_steps(loop, system, memory, told, changes, 3)
    memory.real[PLANNED_FACTOR], memory.count[PLANNED_ORDER] = 0.7, 4
    take_steps(loop, system, memory, told, changes, 1)
    take_steps(loop, system, memory, told, changes, 5)


def difference_of_runs(
    loop: Callable[..., int], system: Any, memory: StepperState, told: Options, change: Array
) -> Array:
    """Return the change of all backward differences between two runs a small change apart."""
    n, ends, size = change.shape[1], [], 1e-5
    for sign in (1.0, -1.0):
        near = copied(memory)
        near.differences[:, :n] += sign * size * change
        on_its_way(loop, system, near, told, np.zeros((0, *change.shape)))
        ends.append(near.differences[:, :n])
    return (ends[0] - ends[1]) / (2.0 * size)


def disagreement(
    loop: Callable[..., int], system: Any, memory: StepperState, told: Options
) -> float:
    """Return by how much carried changes of positions differ from differences of runs, relative."""
    changes = np.zeros((2, memory.differences.shape[0], told.mask.size))
    # Any change of the past will do; its higher differences are the smaller ones.
    changes[:, :4] = np.random.default_rng(3).normal(size=changes[:, :4].shape)
    changes *= told.mask / 10.0 ** np.arange(changes.shape[1])[:, None]
    expected = np.stack([difference_of_runs(loop, system, memory, told, one) for one in changes])
    on_its_way(loop, system, memory, told, changes)
    apart = told.mask * np.abs(changes - expected)
    return float((apart.max(axis=(1, 2)) / (told.mask * np.abs(expected)).max(axis=(1, 2))).max())


@pytest.mark.parametrize(
    "system",
    [
        Known(FOLLOWER, 1e3),
        Known(BEAD, 5.0),
        Known(SPINNER, 30.0, growth=1.0, turning=5.0, twist=1.0),
    ],
    ids=["follower", "bead", "spinner"],
)
def test_changes_are_the_derivative_of_the_steps_of_known_systems(system: Known) -> None:
    told = always_accepting(choices(system, **EXACTLY))
    memory = begin(system, step=0.02, order=3, radius=0.8)
    # Newton's method leaves some 1e-12, and runs 1e-5 apart show that as some 1e-7.
    assert disagreement(carry_changes, system, memory, told) < 1e-6


@pytest.mark.parametrize(
    "model",
    # The first one only: each of the others takes kernels that no other fast test needs.
    mostly_slow(
        [
            un.Filament(12, un.TipLoad(75.0)),
            un.Filament(
                6, un.LinearLoad(200.0, 0.5), inextensibility="weak", tensile_stiffness=1e3
            ),
            un.Filament(6, un.TipLoad(75.0), confined=True),
            un.Chain(3, un.TipLoad(20.0), drag_ratio=1.5),
            un.Chain(2, un.TipLoad(20.0), confined=True, spring="unwrapped"),
        ],
        lambda model: model.links == 12,
    ),
    ids=["filament", "weak", "confined", "chain", "winding"],
)
def test_changes_are_the_derivative_of_the_steps_of_models(model: Model) -> None:
    memory, told = under_way(model)
    # As above.
    assert disagreement(advance_with_changes, model.system, memory, told) < 1e-6


def under_way(model: Model) -> tuple[StepperState, Options]:
    """Return the memory of a stepper of the third order that has come some way, and its options."""
    x = un.kicked(model, 0.5)
    told = Schedule(until=1.0, rtol=1e-5).options(model)._replace(frame=0)
    memory = start(model.system, NDF, model.unknowns(x), model.rates(x), 0.0, 1e-6)
    none = np.zeros((0, memory.differences.shape[0], told.mask.size))
    band = np.zeros((told.mask.size, 2 * derivative_half_bandwidth(type(model.system)) + 1))
    assert advance_with_changes(model.system, memory, told, none, band, FOREVER, 60) == 1
    memory.real[PLANNED_FACTOR], memory.count[PLANNED_ORDER] = 0.2, 3
    told = always_accepting(told._replace(**EXACTLY))
    take_steps(advance_with_changes, model.system, memory, told, none, 1)
    return memory, told


def test_the_loop_comes_back_after_the_asked_steps_and_at_the_asked_time() -> None:
    system = Known(SPINNER, 30.0)
    told, memory = choices(system), begin(system, step=1e-3)
    changes, band = np.zeros((1, memory.differences.shape[0], 3)), np.zeros((3, 7))
    assert Status(carry_changes(system, memory, told, changes, band, 1.0, 3)) is Status.PAUSED
    assert memory.count[STEPS] == 3
    assert Status(carry_changes(system, memory, told, changes, band, 1.0, ALL_STEPS)) is Status.DONE
    taken = memory.count[STEPS]
    assert Status(carry_changes(system, memory, told, changes, band, 1.0, ALL_STEPS)) is Status.DONE
    assert memory.count[STEPS] == taken


def test_a_trajectory_that_ends_is_told_so() -> None:
    system = Known(FOLLOWER, 10.0, ends=0.5)
    told, memory = choices(system), begin(system, step=1e-3)
    changes, band = np.zeros((1, memory.differences.shape[0], 2)), np.zeros((2, 7))
    code = carry_changes(system, memory, told, changes, band, 1.0, ALL_STEPS)
    assert Status(code) is Status.STEP_TOO_SHORT
