"""Directors of a filament in space: which way the material points, link by link."""

import numpy as np

from undula.arrays import Array, Nodes


def directors_of(nodes: Nodes, turns: Array) -> Array:
    """Return the directors (d1, d2, t) of each link as rows, shape (..., N, 3, 3), right-handed.

    The first is e_x at the clamp and is carried from link to link by the smallest rotation of the
    tangent, so that all are orthonormal to round-off.

    Parameters
    ----------
    nodes : ndarray, shape (..., N + 1, 3)
        Positions of the nodes, base first.
    turns : ndarray, shape (..., N)
        Angles about the tangent by which the directors of each link differ from those that are
        carried without twist [rad].
    """
    links = np.diff(nodes, axis=-2)
    tangents = links / np.linalg.norm(links, axis=-1, keepdims=True)
    before, carried = np.broadcast_to([0.0, 0.0, 1.0], tangents[..., 0, :].shape), []
    director = np.broadcast_to([1.0, 0.0, 0.0], before.shape)
    for i in range(tangents.shape[-2]):
        here = tangents[..., i, :]
        lever = 1.0 + np.sum(before * here, axis=-1, keepdims=True)
        share = np.sum(here * director, axis=-1, keepdims=True) / lever
        director = director - share * (before + here)
        # What round-off leaves along the tangent would grow from link to link.
        director = director - np.sum(director * here, axis=-1, keepdims=True) * here
        director = director / np.linalg.norm(director, axis=-1, keepdims=True)
        carried.append(director)
        before = here
    first = np.stack(carried, axis=-2)
    second = np.cross(tangents, first)
    cosine, sine = np.cos(turns)[..., None], np.sin(turns)[..., None]
    turned = [cosine * first + sine * second, cosine * second - sine * first, tangents]
    return np.stack(turned, axis=-2)


def unbent_links(natural: Array) -> Array:
    """Return the tangents (N, 3) of links whose joints have their natural bends (N, 2) [rad].

    The bends are about the directors below each joint, the first two at the clamp e_x and e_y.
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
    once = np.cross(turn, vectors)
    twice = np.cross(turn, once)
    return np.asarray(
        vectors + np.sinc(angle / np.pi) * once + 0.5 * np.sinc(0.5 * angle / np.pi) ** 2 * twice
    )
