"""The order of coordinates and multipliers in a rod's vectors: node by node, base first.

A node has `stride` entries: its coordinates, then its multipliers. A state x holds the coordinates
alone, so that its stride is the dimension.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from undula.arrays import Array

# The first coordinate is x and the last one z, in space as in the plane.
_X, _Y = 0, 1


@dataclass(frozen=True)
class Layout:
    """Places of coordinates and multipliers in vectors (..., n) of a rod, n = links * stride.

    Attributes
    ----------
    links : int
        Number of links N, and of nodes that move.
    dimension : {2, 3}
        Coordinates of a node: x, z in a plane, or x, y, z.
    stride : int
        Entries of a node, at least its dimension.
    """

    links: int
    dimension: int
    stride: int

    @property
    def size(self) -> int:
        """Number of entries n of a vector."""
        return self.links * self.stride

    @cached_property
    def differential(self) -> Any:
        """True at coordinates, False at multipliers, shape (n,)."""
        return np.arange(self.size) % self.stride < self.dimension

    @cached_property
    def across(self) -> Any:
        """True at the y coordinates of nodes, which are 0 in the x-z plane, shape (n,)."""
        entries = np.arange(self.size) % self.stride
        return entries == _Y if self.dimension == 3 else np.zeros(self.size, dtype=bool)

    def by_node(self, vectors: Array) -> Array:
        """Return vectors (..., n) as a view of shape (..., links, stride)."""
        return vectors.reshape(*vectors.shape[:-1], self.links, self.stride)

    def positions(self, vectors: Array) -> Array:
        """Return the coordinates (..., links * dimension) in vectors (..., n)."""
        coordinates = self.by_node(vectors)[..., : self.dimension]
        return coordinates.reshape(*vectors.shape[:-1], self.links * self.dimension)

    def with_multipliers(self, x: Array) -> Array:
        """Return the vector (n,) with coordinates x (links * dimension,) and multipliers of 0."""
        by_node = np.zeros((self.links, self.stride))
        by_node[:, : self.dimension] = np.asarray(x, dtype=float).reshape(self.links, -1)
        return by_node.ravel()

    def nodes(self, x: Array) -> Array:
        """Return the nodes (..., links + 1, 3) of coordinates x, the base at the origin first."""
        nodes = np.zeros((*x.shape[:-1], self.links + 1, 3))
        nodes[..., 1:, self._axes] = x.reshape(*x.shape[:-1], self.links, self.dimension)
        return nodes

    def coordinates(self, nodes: Array) -> Array:
        """Return the coordinates (links * dimension,) of nodes (links + 1, 3)."""
        return nodes[1:, self._axes].ravel()

    @property
    def _axes(self) -> slice:
        return slice(None, None, 1 if self.dimension == 3 else 2)

    def displaced(self, along_x: Array, along_y: Array | None) -> Array:
        """Return the vector (n,) of displacements (links,) along x and along y, 0 elsewhere."""
        by_node = np.zeros((self.links, self.stride))
        by_node[:, _X] = along_x
        if along_y is not None:
            by_node[:, _Y] = along_y
        return by_node.ravel()

    def rotated(self, vector: Array, angle: float) -> Array:
        """Return a vector (n,) in space rotated about the axis by an angle [rad], from x to y."""
        by_node = np.array(vector, dtype=float).reshape(self.links, self.stride)
        cosine, sine = np.cos(angle), np.sin(angle)
        by_node[:, :2] = by_node[:, :2] @ np.array([[cosine, sine], [-sine, cosine]])
        return by_node.ravel()

    def rotation_generator(self, vector: Array) -> Array:
        """Return the derivative (n,) of a rotated vector in space by the angle, at angle 0."""
        by_node, velocity = self.by_node(vector), np.zeros((self.links, self.stride))
        velocity[:, _X], velocity[:, _Y] = -by_node[:, _Y], by_node[:, _X]
        return velocity.ravel()

    def reflected(self, vector: Array) -> Array:
        """Return a vector (n,) with x reflected to -x."""
        by_node = np.array(vector, dtype=float).reshape(self.links, self.stride)
        by_node[:, _X] *= -1.0
        return by_node.ravel()

    def from_plane(self, vectors: Array) -> Array:
        """Return vectors (..., links * (stride - 1)) of the same rod confined to the x-z plane.

        Confined rods have no coordinate y and all other entries in the same order.
        """
        by_node = vectors.reshape(*vectors.shape[:-1], self.links, self.stride - 1)
        return np.insert(by_node, _Y, 0.0, axis=-1).reshape(*vectors.shape[:-1], self.size)
