"""States defined by the inclination of their links to the axis."""

import numpy as np

from undula.arrays import Array, Nodes, State
from undula.errors import InputError, is_number
from undula.models.model import Model


def link_midpoints(model: Model) -> Array:
    """Return the arc lengths (links,) [L] of the middles of links."""
    links = model.size // model.dimension
    return (np.arange(links) + 0.5) / links


def with_amplitude(model: Model, inclination: Array, amplitude: float) -> State:
    """Return the state of an inclination (links, 2), scaled to its largest value."""
    if not (is_number(amplitude) and 0.0 < amplitude <= np.pi):
        raise InputError(f"amplitude = {amplitude!r} has to be a number in (0, pi]")
    if model.dimension == 2:
        inclination = inclination * [1.0, 0.0]
    return from_inclination(
        model, amplitude * inclination / np.linalg.norm(inclination, axis=1).max()
    )


def from_inclination(model: Model, inclination: Array) -> State:
    """Return the state whose tangents are the axis rotated by an inclination (links, 2) [rad]."""
    size = np.linalg.norm(inclination, axis=1, keepdims=True)
    tangents = np.concatenate([np.sinc(size / np.pi) * inclination, np.cos(size)], axis=1)
    nodes = np.cumsum(tangents, axis=0) / tangents.shape[0]
    return in_plane(model, np.concatenate([np.zeros((1, 3)), nodes]))


def in_plane(model: Model, nodes: Nodes) -> State:
    """Return the state of given nodes; for a confined model they are rotated to the x-z plane."""
    if model.dimension == 3:
        return model.from_nodes(nodes)
    far = nodes[np.argmax(np.linalg.norm(nodes[:, :2], axis=1)), :2]
    direction = far / np.linalg.norm(far) if far.any() else np.array([1.0, 0.0])
    across = nodes[:, 1] * direction[0] - nodes[:, 0] * direction[1]
    if np.abs(across).max() > 1e-6:  # a millionth of the length: beyond the error of any run
        raise InputError("a confined model cannot start from a shape that is not planar")
    flat = np.stack([nodes[:, :2] @ direction, np.zeros(len(nodes)), nodes[:, 2]], axis=1)
    return model.from_nodes(flat)
