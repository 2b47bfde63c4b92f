"""Linearised motion of a rod as dense matrices: about any state, and across the straight one."""

import numpy as np

from undula.arrays import Array
from undula.models.rod.dae import RodFlow
from undula.numerics.linalg.banded import to_dense


def rate_jacobian(equations: RodFlow, y: Array, v: Array) -> Array:
    """Return the derivative of the rates of positions by positions, from R v = f and g = 0.

    Parameters
    ----------
    equations : RodFlow
        The equations.
    y, v : ndarray of shape (n,)
        Positions with their multipliers, and the rates of change there.

    Returns
    -------
    ndarray of shape (k, k)
        The derivative, for k positions.
    """
    layout, moving = equations.layout, equations.differential
    lengths = np.arange(y.size) % layout.stride == layout.dimension
    change, drag = (to_dense(band) for band in equations.parts(y, v, 0.0))
    implicit, right = np.where(moving, drag, change), -change[:, moving]
    if not equations.system.extensible:
        implicit[np.ix_(lengths, moving)] = change[np.ix_(lengths, moving)]
        right[lengths] = -_tangent_change(equations, v)[:, moving]
    return np.asarray(np.linalg.solve(implicit, right)[moving])


def _tangent_change(equations: RodFlow, v: Array) -> Array:
    """Return the derivative (N, n) of e_i . (v_i - v_{i-1}) / h^2 by positions, at fixed v."""
    layout = equations.layout
    d, m = layout.dimension, layout.stride
    change = np.zeros((layout.links, layout.size))
    stretching = np.diff(layout.by_node(v)[:, :d], axis=0, prepend=0.0)
    stretching /= equations.system.link**2
    for i in range(layout.links):
        change[i, m * i : m * i + d] = stretching[i]
        if i > 0:
            change[i, m * (i - 1) : m * (i - 1) + d] = -stretching[i]
    return change


def transverse_matrices(equations: RodFlow, y: Array) -> tuple[Array, Array]:
    """Return stiffness and drag (N, N) of displacements of the straight state y along x.

    Displacements obey drag y' = -stiffness y; to first order they are independent of all others.
    """
    stiffness, drag = equations.parts(y, np.zeros(y.size), 0.0)
    m = equations.layout.stride
    # Band entry b + k m belongs to x of the node that is k nodes farther. With b = 3 m - 1 the
    # first such entry is m - 1, for k = -2.
    across = slice(m - 1, None, m)
    return to_dense(stiffness[::m, across]), to_dense(drag[::m, across])
