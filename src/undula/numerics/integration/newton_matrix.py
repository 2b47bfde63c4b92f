"""The matrix of the simplified Newton method, factored once and used for several steps.

The main reason why it becomes stale is the rotation of the system. It is therefore used in the
orientation of its assembly: the residual is rotated back to that, and the solution forth. In the
co-rotating frame this rotation is 0.

The matrix of a planar motion is assembled in the orientation of its plane, without the entries that
vanish there. A motion counts as planar while its distance from the plane is below the error allowed
in a step.
"""

import math
from typing import Any

from undula.jit.compilation import kernel, overwrite
from undula.numerics.integration.matrices import factor, planar_factor, planar_solve, solve
from undula.numerics.integration.stepper_state import (
    DISPLACEMENT,
    FACTORED_ANGLE,
    FACTORED_C,
    FACTORISATIONS,
    IN_FRAME,
    PLANAR,
    SOLVES,
)
from undula.numerics.integration.system import apply_drag, matrix, planar_matrix, plane, rotate


@kernel
def rotation_since_assembly(stepper: Any, work: Any) -> Any:
    """Return the angle from the orientation of the matrix to that of the present step."""
    if stepper.count[IN_FRAME] == 1:
        return 0.0
    return work.predicted[work.y.shape[0]] - stepper.real[FACTORED_ANGLE]


@kernel
def is_stale(system: Any, stepper: Any, options: Any, work: Any, c: Any) -> Any:
    """Return whether the factored matrix is too old for the present step.

    In the co-rotating frame the matrix has a border proportional to the displacement from the
    reference; the tolerance is then proportional to that displacement too.
    """
    max_displacement = options.stale_after
    if stepper.count[IN_FRAME] == 1:
        max_displacement *= min(1.0, stepper.real[DISPLACEMENT])
    if abs(c / stepper.real[FACTORED_C] - 1.0) > 1e-12:
        return True
    rotated, angle = work.y, rotation_since_assembly(stepper, work)
    if angle != 0.0:
        rotated = work.correction
        rotate(system, work.y, -angle, rotated)
    for i in range(work.y.shape[0] - 1, -1, -1):  # from the free end, which moves farthest
        displacement = abs(rotated[i] - stepper.factored_at[i]) * options.mask[i]
        if not displacement <= max_displacement:
            return True
    return False


@kernel
def reassemble(system: Any, stepper: Any, work: Any, c: Any, scale: Any, turn: Any) -> Any:
    """Assemble and factor the matrix at the state in `work`; return False where it is singular."""
    in_frame, azimuth, off_plane = stepper.count[IN_FRAME] == 1, 0.0, math.inf
    if not in_frame:
        azimuth, off_plane = plane(system, work.y, work.w)
    stepper.real[FACTORED_C] = c
    stepper.real[FACTORED_ANGLE] = work.predicted[work.y.shape[0]]
    stepper.count[FACTORISATIONS] += 1
    if off_plane <= scale:
        stepper.count[PLANAR] = 1
        stepper.real[FACTORED_ANGLE] -= azimuth
        if azimuth == 0.0:
            overwrite(stepper.factored_at, work.y)
        else:
            rotate(system, work.y, -azimuth, stepper.factored_at)
        planar_matrix(system, work.y, work.w, azimuth, c, stepper.factors)
        regular = planar_factor(system, stepper.factors)
    else:
        stepper.count[PLANAR] = 0
        overwrite(stepper.factored_at, work.y)
        matrix(system, work.y, work.w, c, turn if in_frame else 0.0, stepper.factors)
        regular = factor(system, stepper.factors)
    if not regular:
        stepper.real[FACTORED_C] = 0.0
        return False
    if in_frame:
        apply_drag(system, work.y, work.turning, stepper.border)
        solve(system, stepper.factors, stepper.border)
        stepper.count[SOLVES] += 1
    return True


@kernel
def solve_frozen(system: Any, stepper: Any, work: Any, x: Any) -> None:
    """Overwrite x (n,) by the solution, in the present orientation of the system."""
    angle = rotation_since_assembly(stepper, work)
    if angle != 0.0:
        rotate(system, x, -angle, x)
    if stepper.count[PLANAR] == 1:
        planar_solve(system, stepper.factors, x)
    else:
        solve(system, stepper.factors, x)
    stepper.count[SOLVES] += 1
    if angle != 0.0:
        rotate(system, x, angle, x)
