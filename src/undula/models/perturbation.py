"""Random perturbation of a given state."""

import numpy as np

from undula.arrays import Nodes, State
from undula.errors import InputError, is_number
from undula.models.initial_states import kicked
from undula.models.model import Model


def perturbed(model: Model, nodes: Nodes, amplitude: float, *, seed: int = 1) -> State:
    """Return a shape with random smooth rotations of its links.

    Each link is rotated by the rotation that takes the axis to the tangent of `kicked` with this
    amplitude and seed. Links keep their length, and a confined model stays in its plane.

    Parameters
    ----------
    model : Model
        The model.
    nodes : ndarray, shape (N + 1, 3)
        Nodes of the model's own links [L].
    amplitude : float
        Largest angle of rotation [rad], in (0, pi/2].
    seed : int
        Seed of the random numbers, at least 0.

    Returns
    -------
    ndarray, shape (model.size,)
        The state [L].

    Raises
    ------
    InputError
        A value is out of its range.
    """
    if not (is_number(amplitude) and 0.0 < amplitude <= 0.5 * np.pi):
        raise InputError(f"amplitude = {amplitude!r} has to be a number in (0, pi/2]")
    bend = np.diff(model.nodes(kicked(model, amplitude, seed=seed)), axis=0)
    tangents = bend / np.linalg.norm(bend, axis=1, keepdims=True)
    axis = np.cross([0.0, 0.0, 1.0], tangents)
    links = np.diff(nodes, axis=0)
    first_order = np.cross(axis, links)
    # Rodrigues' formula with the sine in the axis; tangents are at most pi/2 from upright.
    links = links + first_order + np.cross(axis, first_order) / (1.0 + tangents[:, 2:])
    return model.from_nodes(np.concatenate([nodes[:1], np.cumsum(links, axis=0)]))
