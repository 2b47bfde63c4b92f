"""Accuracy of a run: errors of conserved quantities and effort, in every result."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from undula.analysis.observables.sample_sums import largest_imbalance
from undula.analysis.observables.shape_sums import largest_bend, link_squares
from undula.analysis.observables.trajectory import Motion
from undula.arrays import Array
from undula.models.model import Model
from undula.models.rod.joint import FOLDED
from undula.numerics.integration import stepper_state as names
from undula.numerics.integration.system import RATES

#: Energy put through by round-off alone [B/L]: positions to 1e-15 L under a force of 1000 B/L^2.
ROUND_OFF_ENERGY = 1e-12


@dataclass(frozen=True)
class Errors:
    """Errors of a run in its conserved quantities.

    Attributes
    ----------
    power_balance_error : float
        Largest |elastic energy gained + dissipated - put in| up to any sample, relative to the
        energy dissipated and put in over the run. Zero for the exact solution, and if the energy
        put through is round-off.
    length_error : float
        Largest relative change of length of a link at any sample; of extensible links, their
        strain.
    """

    power_balance_error: float
    length_error: float


@dataclass(frozen=True)
class Health:
    """Errors and effort of a run.

    Attributes
    ----------
    power_balance_error, length_error : float
        As in `Errors`.
    largest_joint_angle : float
        Largest angle between neighbouring links, or the axis of the clamp and the first link, at
        any sample [rad]; beyond pi for joints that wind up.
    folded : bool
        True if the angle of a joint reached pi, where its energy has a kink, at a sample or between
        two. Always False for joints that wind up.
    smallest_step, largest_step : float
        Lengths of the accepted steps [T].
    steps, rejected, failed : int
        Steps accepted, rejected for their error, and given up because Newton's method failed.
    factorisations, solves : int
        Newton matrices factored, and solves with them.
    frame : str
        The frame in which the run ended, "lab" or "co-rotating".
    frame_changes : int
        Number of changes of the frame.
    """

    power_balance_error: float
    length_error: float
    largest_joint_angle: float
    folded: bool
    smallest_step: float
    largest_step: float
    steps: int
    rejected: int
    failed: int
    factorisations: int
    solves: int
    frame: str
    frame_changes: int


def errors_of(motion: Motion) -> Errors:
    """Return the errors of a run.

    Parameters
    ----------
    motion : Motion
        Trajectory of the run.
    """
    return Errors(power_balance_error(motion), length_error(motion))


def health_of(
    model: Model, motion: Motion, errors: Errors, checkpoint: Mapping[str, Array]
) -> Health:
    """Return errors and effort of a run.

    Parameters
    ----------
    model : Model
        Model of the filament or chain.
    motion : Motion
        Trajectory of the whole run.
    errors : Errors
        From `errors_of`.
    checkpoint : mapping of str to ndarray
        Checkpoint at the end of the run.

    Returns
    -------
    Health
    """
    real, count = checkpoint["memory_real"], checkpoint["memory_count"]
    steps = int(count[names.STEPS])
    angle = 2.0 * math.atan(math.sqrt(largest_bend(motion.nodes)))
    folds = False
    if model.unwrapped or angle > 0.5 * np.pi:
        angles = np.abs(model.joint_angles(checkpoint["states"][:, :-RATES]))
        angle = float(angles.max())
        folds = not model.unwrapped and folded(motion, angles)
    return Health(
        power_balance_error=errors.power_balance_error,
        length_error=errors.length_error,
        largest_joint_angle=angle,
        folded=folds,
        smallest_step=float(real[names.SMALLEST_STEP]) if steps else 0.0,
        largest_step=float(real[names.LARGEST_STEP]),
        steps=steps,
        rejected=int(count[names.REJECTED]),
        failed=int(count[names.FAILED]),
        factorisations=int(count[names.FACTORISATIONS]),
        solves=int(count[names.SOLVES]),
        frame="co-rotating" if count[names.IN_FRAME] else "lab",
        frame_changes=int(count[names.FRAME_CHANGES]),
    )


def power_balance_error(motion: Motion) -> float:
    """Return the error of the energy balance, relative to the energy put through.

    Parameters
    ----------
    motion : Motion
        Trajectory of the run.

    Returns
    -------
    float
        At least 0, as in `Errors`.
    """
    stored = motion.energetics.bending_energy, motion.energetics.stretching_energy
    throughput = float(motion.loss[-1] + abs(motion.work[-1]))
    imbalance: float = largest_imbalance(*stored, motion.work, motion.loss)
    return imbalance / throughput if throughput > ROUND_OFF_ENERGY else 0.0


def length_error(motion: Motion) -> float:
    """Return the largest relative deviation of a link's length from 1/N at any sample.

    Parameters
    ----------
    motion : Motion
        Trajectory of the run.

    Returns
    -------
    float
        At least 0.
    """
    links: int = motion.nodes.shape[1] - 1
    squares: tuple[float, float] = link_squares(motion.nodes)
    return max(abs(math.sqrt(square) * links - 1.0) for square in squares)


def folded(motion: Motion, angles: Array) -> bool:
    """Return True if the angle of a joint reaches pi during a motion.

    It does if it is within `FOLDED` of pi at a sample, or between two samples on the shortest path
    in the frame of the inner link. In a plane that is the path through pi if the angles on either
    side of it add up to more than half a turn.

    Parameters
    ----------
    motion : Motion
        Trajectory of the run.
    angles : ndarray, shape (m, N)
        Angles of the joints at the samples [rad].
    """
    if (angles > np.pi - FOLDED).any():
        return True
    sample, joint = np.nonzero(angles[:-1] + angles[1:] > np.pi)
    (inner, first), (later, second) = (_tangents(motion, k, joint) for k in (sample, sample + 1))
    start, end = _product(inner, first), _product(later, second)
    across = _transported(first - start[:, None] * inner, inner, later)
    change = second - end[:, None] * later - across
    square = np.maximum(_product(change, change), np.finfo(float).tiny)
    # The point of the chord between both directions that is nearest to the line of the inner link.
    part = np.clip(-_product(across, change) / square, 0.0, 1.0)
    distance = np.linalg.norm(across + part[:, None] * change, axis=1)
    return bool((np.arctan2(distance, -(start + part * (end - start))) < FOLDED).any())


def _tangents(motion: Motion, sample: Any, joint: Any) -> tuple[Array, Array]:
    """Return unit vectors (k, 3) along the links before and behind joints (k,) at samples (k,).

    They are given in a frame that rotates with the motion.
    """
    nodes, angle = motion.nodes, motion.rotation_angle[sample]
    links = [nodes[sample, joint] - nodes[sample, joint - 1]]
    links[0][joint == 0] = [0.0, 0.0, 1.0]
    links += [nodes[sample, joint + 1] - nodes[sample, joint]]
    cosine, sine = np.cos(angle), np.sin(angle)
    x, y, z = np.moveaxis(np.stack(links), 2, 0)
    turned = np.stack([cosine * x + sine * y, cosine * y - sine * x, z], axis=2)
    inner, outer = turned / np.linalg.norm(turned, axis=2, keepdims=True)
    return inner, outer


def _transported(vectors: Array, start: Array, end: Array) -> Array:
    """Return vectors across unit vectors `start`, rotated with these to `end` on a shortest path.

    Between opposite unit vectors no path is the shortest, and the vectors are not rotated.
    """
    lever = 1.0 + _product(start, end)
    share = np.divide(_product(end, vectors), lever, out=np.zeros_like(lever), where=lever > 0.0)
    return vectors - share[:, None] * (start + end)


def _product(a: Array, b: Array) -> Array:
    return np.asarray((a * b).sum(axis=1))
