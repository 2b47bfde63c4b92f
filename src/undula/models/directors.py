"""Directors of a filament in space: the material frame of each link."""

import numpy as np

from undula.arrays import Array, Nodes


def directors_of(nodes: Nodes, turns: Array) -> Array:
    """Return the directors of each link.

    The first is e_x at the clamp, and is transported from link to link by the smallest rotation of
    the tangent. All are orthonormal to round-off.

    Parameters
    ----------
    nodes : ndarray, shape (..., N + 1, 3)
        Positions of the nodes, base first.
    turns : ndarray, shape (..., N)
        Angles about the tangent between the directors of each link and those transported without
        twist [rad].

    Returns
    -------
    ndarray, shape (..., N, 3, 3)
        The directors (d1, d2, t) as rows, right-handed.
    """
    links = np.diff(nodes, axis=-2)
    tangents = links / np.linalg.norm(links, axis=-1, keepdims=True)
    previous, carried = np.broadcast_to([0.0, 0.0, 1.0], tangents[..., 0, :].shape), []
    director = np.broadcast_to([1.0, 0.0, 0.0], previous.shape)
    for i in range(tangents.shape[-2]):
        tangent = tangents[..., i, :]
        lever = 1.0 + np.sum(previous * tangent, axis=-1, keepdims=True)
        share = np.sum(tangent * director, axis=-1, keepdims=True) / lever
        director = director - share * (previous + tangent)
        # A component along the tangent by round-off would grow from link to link.
        director = director - np.sum(director * tangent, axis=-1, keepdims=True) * tangent
        director = director / np.linalg.norm(director, axis=-1, keepdims=True)
        carried.append(director)
        previous = tangent
    first = np.stack(carried, axis=-2)
    second = np.cross(tangents, first)
    cosine, sine = np.cos(turns)[..., None], np.sin(turns)[..., None]
    turned = [cosine * first + sine * second, cosine * second - sine * first, tangents]
    return np.stack(turned, axis=-2)


def unbent_links(natural: Array) -> Array:
    """Return the tangents of links whose joints have their natural angles.

    Parameters
    ----------
    natural : ndarray, shape (N, 2)
        Angle [rad] of each joint about the directors below it, at the clamp e_x and e_y.

    Returns
    -------
    ndarray, shape (N, 3)
        The unit tangents.
    """
    frame, tangents = np.eye(3), []
    for first, second in natural:
        bend = first * frame[0] + second * frame[1]
        frame = _rotated(frame, bend)
        tangents.append(frame[2])
    return np.array(tangents)


def _rotated(vectors: Array, turn: Array) -> Array:
    """Return vectors (k, 3) rotated by a rotation vector (3,), by Rodrigues' formula."""
    angle = np.linalg.norm(turn)
    first_order = np.cross(turn, vectors)
    second_order = np.cross(turn, first_order)
    return np.asarray(
        vectors
        + np.sinc(angle / np.pi) * first_order
        + 0.5 * np.sinc(0.5 * angle / np.pi) ** 2 * second_order
    )
