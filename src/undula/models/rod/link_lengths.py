"""Lengths of the links of a rod: exact, or in balance between stretching and tension."""

from typing import Any

import numpy as np

from undula.arrays import Array, Links, State
from undula.errors import InputError
from undula.models.rod.tables import PlanarRod, SpatialRod
from undula.models.rod.velocity import rate_of_change
from undula.numerics.integration.system import RATES


def admissible(system: Any, x: State) -> State:
    """Return the shape of x with the lengths that the tables prescribe.

    Parameters
    ----------
    system : Rod
        The tables.
    x : ndarray, shape (size,)
        Positions of the nodes.

    Returns
    -------
    ndarray, shape (size,)
        Positions with the same tangents.
    """
    count, dimension = system.joint.size, system.dimension
    links = np.array(x, dtype=float).reshape(count, dimension)
    links[1:] -= links[:-1].copy()
    tangents = links / np.sqrt((links * links).sum(axis=1, keepdims=True))
    stretch = np.ones(count)
    if system.extensible:
        stretch += _rigid_tension(system, tangents) / system.tensile
    return np.asarray(np.cumsum(stretch[:, None] * tangents * system.link, axis=0).ravel())


def straight(system: Any) -> State:
    """Return the straight equilibrium along the axis, with compressed extensible links.

    Parameters
    ----------
    system : Rod
        The tables.

    Returns
    -------
    ndarray, shape (size,)
        Positions of the nodes.

    Raises
    ------
    InputError
        The load is as large as the stiffness of extensible links.
    """
    count: int = system.joint.size
    loads = system.outer_force.copy()
    loads[:-1] += system.inner_force[1:]
    carried = loads[::-1].cumsum()[::-1]
    if not carried.max() < system.tensile:
        raise InputError(
            f"tensile_stiffness = {system.tensile:g} does not exceed the force of"
            f" {carried.max():g} that links bear, which would push them to nothing; give a larger"
            " tensile_stiffness, or a smaller force"
        )
    x = np.zeros((count, system.dimension))
    x[:, -1] = np.arange(1, count + 1) / count
    x[:, -1] -= (system.link * carried / system.tensile).cumsum()
    return x.ravel()


def _rigid_tension(system: Any, tangents: Array) -> Links:
    """Return the tensions (N,) of rigid links with these tangents."""
    count, dimension = tangents.shape
    rigid = (PlanarRod if dimension == 2 else SpatialRod)(*system)
    unknowns = np.zeros((count, dimension + 1))
    unknowns[:, :-1] = np.cumsum(tangents * rigid.link, axis=0)
    flat = unknowns.ravel()
    rate_of_change(rigid, flat, np.zeros(flat.size + RATES))
    before = np.vstack([np.eye(dimension)[-1], tangents[:-1]])
    cosine = np.clip(np.sum(before * tangents, axis=1), -1.0, 1.0)
    angle = np.arccos(cosine)
    shortfall = rigid.joint * (1.0 - cosine) / np.sinc(angle / np.pi)
    shortfall[:-1] += shortfall[1:]
    return np.asarray(flat.reshape(unknowns.shape)[:, -1] + shortfall / rigid.link)
