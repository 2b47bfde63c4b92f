"""Systems with exact solutions or exponents, all of one type so that time loops compile once.

Follower (Prothero & Robinson), unknowns (u, s):

    u' = -K (u - cos s) - sin s,    s' = 1;    u = cos t.

Bead drawn along the unit circle after a moving point, unknowns (x, y, T, s), with p = sin s:

    x' = K (cos p, sin p) + (cos s) J x + T x,    |x| = 1,    s' = 1;    x = (cos p, sin p), T = -K.

Spinner (Stuart & Landau's normal form with a stable mode u), unknowns (x, y, u):

    r' = r (m - r^2),    angle' = W + b r^2,    u' = -K (u - r^2) + 2 r^2 (m - r^2);    u = r^2.

Lorenz's system and a torus, see `attractors`.
"""
# ruff: noqa: ARG001
# (what is registered for a generic function has its arguments, used or not)

import math
from typing import Any, NamedTuple

import numpy as np

from attractors import attractor_matrix, attractor_residual
from uncached import uncached
from undula.jit.compilation import kernel
from undula.numerics.integration.schemes import NDF, BackwardDifferentiation
from undula.numerics.integration.status import Status
from undula.numerics.integration.step import Options, options
from undula.numerics.integration.stepper_state import (
    EQUAL_STEPS,
    IN_FRAME,
    ORDER,
    PLANNED_ORDER,
    StepperState,
    start,
)
from undula.numerics.integration.system import (
    RATES,
    apply_drag,
    constraint_error,
    generator,
    implements,
    matrix,
    rates,
    residual,
    rotate,
)
from undula.numerics.integration.time_loop import advance
from undula.numerics.integration.variational import advance_with_changes

FOLLOWER, BEAD, SPINNER, LORENZ, TORUS = range(5)

#: The time loops for the systems of this file.
run = uncached(advance.py_func)
carry_changes = uncached(advance_with_changes.py_func)

ALL_STEPS = 2**62


class Known(NamedTuple):
    """A system with a known solution."""

    problem: int
    stiffness: float = 1.0  # K
    growth: float = 1.0  # m
    turning: float = 0.0  # W
    twist: float = 0.0  # b
    ends: float = math.inf  # time s from which on the follower's equation is not a number
    growths: tuple[float, float] = (1.0, 2.0)  # m1, m2 of the torus
    half_bandwidth = 3


@kernel
def follower_residual(system: Any, y: Any, w: Any, c: Any, out: Any) -> None:
    forward = math.nan if y[1] > system.ends else 1.0
    out[0] = w[0] + c * (system.stiffness * (y[0] - math.cos(y[1])) + math.sin(y[1]))
    out[1] = w[1] - c * forward


@kernel
def follower_matrix(system: Any, y: Any, c: Any, band: Any) -> None:
    band[0, 3] = 1.0 + c * system.stiffness
    band[0, 4] = c * (system.stiffness * math.sin(y[1]) + math.cos(y[1]))
    band[1, 3] = 1.0


@kernel
def bead_residual(system: Any, y: Any, w: Any, c: Any, out: Any) -> None:
    goal, speed = math.sin(y[3]), math.cos(y[3])
    out[0] = w[0] - c * (system.stiffness * math.cos(goal) - speed * y[1] + y[2] * y[0])
    out[1] = w[1] - c * (system.stiffness * math.sin(goal) + speed * y[0] + y[2] * y[1])
    out[2] = 0.5 * (y[0] * y[0] + y[1] * y[1] - 1.0)
    out[3] = w[3] - c


@kernel
def bead_matrix(system: Any, y: Any, c: Any, band: Any) -> None:
    goal, speed, gain = math.sin(y[3]), math.cos(y[3]), -math.sin(y[3])
    band[0, 3] = band[1, 3] = 1.0 - c * y[2]
    band[0, 4], band[1, 2] = c * speed, -c * speed
    band[0, 5], band[1, 4] = -c * y[0], -c * y[1]
    band[0, 6] = c * (system.stiffness * math.sin(goal) * speed + gain * y[1])
    band[1, 5] = -c * (system.stiffness * math.cos(goal) * speed + gain * y[0])
    band[2, 1], band[2, 2] = y[0], y[1]
    band[3, 3] = 1.0


@kernel
def spinner_residual(system: Any, y: Any, w: Any, c: Any, out: Any) -> None:
    square = y[0] * y[0] + y[1] * y[1]
    grow, turn = system.growth - square, system.turning + system.twist * square
    out[0] = w[0] - c * (grow * y[0] - turn * y[1])
    out[1] = w[1] - c * (grow * y[1] + turn * y[0])
    out[2] = w[2] + c * (system.stiffness * (y[2] - square) - 2.0 * square * grow)


@kernel
def spinner_matrix(system: Any, y: Any, c: Any, turn: Any, band: Any) -> None:
    square, b = y[0] * y[0] + y[1] * y[1], system.twist
    grow, rate = system.growth - square, system.turning + b * square
    band[0, 3] = 1.0 - c * (grow - 2.0 * y[0] * y[0] - 2.0 * b * y[0] * y[1])
    band[0, 4] = -turn - c * (-2.0 * y[0] * y[1] - rate - 2.0 * b * y[1] * y[1])
    band[1, 2] = turn - c * (-2.0 * y[0] * y[1] + rate + 2.0 * b * y[0] * y[0])
    band[1, 3] = 1.0 - c * (grow - 2.0 * y[1] * y[1] + 2.0 * b * y[0] * y[1])
    slope = -2.0 * c * (system.stiffness + 2.0 * system.growth - 4.0 * square)
    band[2, 1], band[2, 2], band[2, 3] = slope * y[0], slope * y[1], 1.0 + c * system.stiffness


@implements(residual, Known)
def known_residual(system: Any, y: Any, w: Any, c: Any, out: Any) -> None:
    if system.problem == FOLLOWER:
        follower_residual(system, y, w, c, out)
    elif system.problem == BEAD:
        bead_residual(system, y, w, c, out)
    elif system.problem == SPINNER:
        spinner_residual(system, y, w, c, out)
    else:
        attractor_residual(system, y, w, c, out)


@implements(matrix, Known)
def known_matrix(system: Any, y: Any, w: Any, c: Any, turn: Any, band: Any) -> None:
    band[:] = 0.0
    if system.problem == FOLLOWER:
        follower_matrix(system, y, c, band)
    elif system.problem == BEAD:
        bead_matrix(system, y, c, band)
    elif system.problem == SPINNER:
        spinner_matrix(system, y, c, turn, band)
    else:
        attractor_matrix(system, y, c, band)


@implements(apply_drag, Known)
def known_weigh(system: Any, y: Any, u: Any, out: Any) -> None:
    out[:] = u
    if system.problem == BEAD:
        out[2] = 0.0


@implements(constraint_error, Known)
def known_constraint_error(system: Any, y: Any) -> Any:
    return abs(math.hypot(y[0], y[1]) - 1.0) if system.problem == BEAD else 0.0


@implements(rates, Known)
def known_rates(system: Any, y: Any, v: Any, out: Any) -> None:
    """Let the energy be u, or x of the bead, and be lost at rate 1."""
    if system.problem > SPINNER:
        out[:] = 0.0
        return
    spinning = system.problem == SPINNER
    spin, inertia = y[0] * v[1] - y[1] * v[0], y[0] * y[0] + y[1] * y[1]
    out[0] = spin / inertia if spinning and inertia > 0.0 else 0.0
    out[1] = 1.0 + (v[2] if spinning else v[0])
    out[2] = 1.0


@implements(generator, Known)
def known_generator(system: Any, y: Any, out: Any) -> None:
    x = y[0]
    out[:] = 0.0
    if system.problem == SPINNER:
        out[0], out[1] = -y[1], x


@implements(rotate, Known)
def known_rotate(system: Any, y: Any, angle: Any, out: Any) -> None:
    cosine, sine = math.cos(angle), math.sin(angle)
    a, b = y[0], y[1]
    out[:] = y
    if system.problem == SPINNER:
        out[0], out[1] = cosine * a - sine * b, sine * a + cosine * b


def spinner_polar(system: Known, times: np.ndarray, radius: float) -> tuple[Any, Any]:
    """Return radius and angle of the spinner that starts at this radius with angle 0."""
    m = system.growth
    r = np.sqrt(m / (1.0 + (m / radius**2 - 1.0) * np.exp(-2.0 * m * times)))
    return r, system.turning * times + system.twist * (m * times - np.log(r / radius))


def exact(system: Known, times: Any, radius: float = 1.0, in_frame: bool = False) -> np.ndarray:
    """Return the exact unknowns and integrals at `times` (m,), shape (m, n + RATES)."""
    t = np.asarray(times, dtype=float)
    angle = np.zeros_like(t)
    if system.problem == FOLLOWER:
        unknowns = [np.cos(t), t]
    elif system.problem == BEAD:
        p = np.sin(t)
        unknowns = [np.cos(p), np.sin(p), np.full_like(t, -system.stiffness), t]
    else:
        r, angle = spinner_polar(system, t, radius)
        seen = 0.0 if in_frame else angle
        unknowns = [r * np.cos(seen), r * np.sin(seen), r**2]
    gained = unknowns[2] - radius**2 if system.problem == SPINNER else unknowns[0] - 1.0
    return np.stack([*unknowns, angle, t + gained, t], axis=1)


def choices(system: Known, **changes: Any) -> Options:
    """Return tight options for `system`, with changes: `scheme`, `rtol`, `frame` and others."""
    scheme = changes.pop("scheme", NDF)
    mask = [[1.0, 0.0], [1.0, 1.0, 0.0, 0.0], [1.0, 1.0, 1.0]][system.problem]
    given = {"rtol": 1e-6, "stale_after": 0.1, "longest_step": math.inf, "frame": False} | changes
    given.setdefault("atol", given["rtol"])
    return options(scheme, np.array(mask), np.zeros(len(mask)), **given)


def begin(
    system: Known,
    scheme: BackwardDifferentiation = NDF,
    *,
    step: float = 1e-7,
    order: int = 1,
    radius: float = 1.0,
    in_frame: bool = False,
) -> StepperState:
    """Return the memory of a stepper of this step and order on the exact solution at time 0."""
    past = exact(system, -step * np.arange(order + 1), radius, in_frame)
    memory = start(system, scheme, past[0, :-RATES], np.zeros(past.shape[1]), 0.0, step)
    for j in range(order + 1):
        memory.differences[j] = past[0]
        past = past[:-1] - past[1:]
    memory.count[[ORDER, PLANNED_ORDER]] = order
    memory.count[IN_FRAME] = int(in_frame)
    return memory


def pinned(memory: StepperState) -> StepperState:
    """Return the memory, made to keep its step and order as long as no step fails.

    Too few equal steps have been taken, it thinks, to choose others.
    """
    memory.count[EQUAL_STEPS] = -ALL_STEPS
    return memory


def always_accepting(told: Options) -> Options:
    """Return the options, made to find no error in any step."""
    return told._replace(error=np.zeros_like(told.error))


def copied(memory: StepperState) -> StepperState:
    """Return an independent copy."""
    return StepperState(*(array.copy() for array in memory))


def follow(
    system: Known, memory: StepperState, told: Options, times: Any, most_steps: int = ALL_STEPS
) -> tuple[Status, np.ndarray]:
    """Go on to `times`; return how it ended and the rows that were reached."""
    width = memory.differences.shape[1]
    rows, none = np.empty((len(times), width)), np.empty((0, 1 + width))
    code, filled, _ = run(system, memory, told, np.asarray(times, float), rows, none, most_steps)
    return Status(code), rows[:filled]


def sections_of(system: Known, memory: StepperState, told: Options, until: float) -> np.ndarray:
    """Go on to a time; return the sections found, time and row each, shape (s, 1 + n + RATES)."""
    width = memory.differences.shape[1]
    found = np.empty((100, 1 + width))
    end, row = np.array([until]), np.empty((1, width))
    _, _, count = run(system, memory, told, end, row, found, ALL_STEPS)
    return found[:count]
