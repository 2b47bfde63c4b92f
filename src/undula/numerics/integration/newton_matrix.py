"""The matrix of the simplified Newton method, used for several steps as it was once made.

It goes stale because the system turns rather than because time passes. It is therefore used in the
orientation that it was made in: a residual is turned back, the solution forth. In the co-rotating
frame nothing turns.

The matrix of a motion in a plane is made in the orientation of this plane, without what would be
zero there. A motion is in a plane where it is off it by less than a step may be in error.
"""

import math
from typing import Any

from undula.jit.compilation import kernel, overwrite
from undula.numerics.integration.stepper_state import (
    DISPLACEMENT,
    FACTORED_ANGLE,
    FACTORED_C,
    FACTORISATIONS,
    IN_FRAME,
    PLANAR,
    SOLVES,
)
from undula.numerics.integration.system import (
    apply_drag,
    factor,
    matrix,
    planar_factor,
    planar_matrix,
    planar_solve,
    plane,
    rotate,
    solve,
)


@kernel
def turned_by(memory: Any, work: Any) -> Any:
    """Return the angle from the matrix's orientation to that of the step at hand."""
    if memory.count[IN_FRAME] == 1:
        return 0.0
    return work.predicted[work.y.shape[0]] - memory.real[FACTORED_ANGLE]


@kernel
def is_stale(system: Any, memory: Any, options: Any, work: Any, c: Any) -> Any:
    """Tell whether the factored matrix is no longer fit for the step at hand.

    In the frame it comes with a border proportional to the displacement, which has to be fresh in
    proportion.
    """
    farthest = options.stale_after
    if memory.count[IN_FRAME] == 1:
        farthest *= min(1.0, memory.real[DISPLACEMENT])
    if abs(c / memory.real[FACTORED_C] - 1.0) > 1e-12:
        return True
    turned, angle = work.y, turned_by(memory, work)
    if angle != 0.0:
        turned = work.correction
        rotate(system, work.y, -angle, turned)
    for i in range(work.y.shape[0] - 1, -1, -1):  # a free end, which moves farthest, comes last
        moved = abs(turned[i] - memory.factored_at[i]) * options.mask[i]
        if not moved <= farthest:
            return True
    return False


@kernel
def reassemble(system: Any, memory: Any, work: Any, c: Any, scale: Any, turn: Any) -> Any:
    """Make and factor the Newton matrix at the state in `work`; False where it is singular."""
    in_frame, azimuth, off = memory.count[IN_FRAME] == 1, 0.0, math.inf
    if not in_frame:
        azimuth, off = plane(system, work.y, work.w)
    memory.real[FACTORED_C] = c
    memory.real[FACTORED_ANGLE] = work.predicted[work.y.shape[0]]
    memory.count[FACTORISATIONS] += 1
    if off <= scale:
        memory.count[PLANAR] = 1
        memory.real[FACTORED_ANGLE] -= azimuth
        if azimuth == 0.0:
            overwrite(memory.factored_at, work.y)
        else:
            rotate(system, work.y, -azimuth, memory.factored_at)
        planar_matrix(system, work.y, work.w, azimuth, c, memory.factors)
        regular = planar_factor(system, memory.factors)
    else:
        memory.count[PLANAR] = 0
        overwrite(memory.factored_at, work.y)
        matrix(system, work.y, work.w, c, turn if in_frame else 0.0, memory.factors)
        regular = factor(system, memory.factors)
    if not regular:
        memory.real[FACTORED_C] = 0.0
        return False
    if in_frame:
        apply_drag(system, work.y, work.turning, memory.border)
        solve(system, memory.factors, memory.border)
        memory.count[SOLVES] += 1
    return True


@kernel
def solve_frozen(system: Any, memory: Any, work: Any, x: Any) -> None:
    """Overwrite x (n,) by the solution, in the orientation that the system has by now."""
    angle = turned_by(memory, work)
    if angle != 0.0:
        rotate(system, x, -angle, x)
    if memory.count[PLANAR] == 1:
        planar_solve(system, memory.factors, x)
    else:
        solve(system, memory.factors, x)
    memory.count[SOLVES] += 1
    if angle != 0.0:
        rotate(system, x, angle, x)
