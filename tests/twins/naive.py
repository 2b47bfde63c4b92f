"""The linked rod once more, slow and obvious: dense linear algebra on the theory page's equations.

Nothing is shared with the kernels. The elastic force is the energy's gradient, taken by complex
steps, so it has no step error; the shares of a load are integrals done numerically; tensions of
rigid links are the multipliers of |r_i - r_{i-1}| = h in one dense system.
"""

from collections.abc import Callable
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.integrate import quad

from undula.arrays import Array, Links, State
from undula.models.filament import Filament
from undula.models.loads.analytic import LinearLoad, Load, PointLoad
from undula.models.loads.power import PowerLoad
from undula.models.loads.user_density import ProfileLoad, TableLoad

#: A complex step whose square is lost to round-off beside any length.
_STEP = 1e-30


def density(load: Load, s: float) -> float:
    """Return the force per length f_a(s) of a spread load."""
    if isinstance(load, LinearLoad):
        return load.force * (1.0 + load.slope * (2.0 * s - 1.0))
    if isinstance(load, PowerLoad):
        return load.force * (load.exponent + 1.0) * float(s**load.exponent)
    if isinstance(load, TableLoad | ProfileLoad):
        return load.force * _shape(load, s) / _total(load)
    raise TypeError(f"{load} is not spread over the filament")


def _shape(load: TableLoad | ProfileLoad, s: float) -> float:
    if isinstance(load, TableLoad):
        return float(np.interp(s, load.s, load.density))
    return float(load.density(np.array([s]))[0])


@cache
def _total(load: TableLoad | ProfileLoad) -> float:
    smooth = pairwise([0.0, *_rough_places(load), 1.0])
    return sum(quad(lambda s: _shape(load, s), a, b, epsabs=0.0)[0] for a, b in smooth)


def _rough_places(load: Load) -> tuple[float, ...]:
    if isinstance(load, TableLoad):
        return load.s[1:-1]
    return load.kinks if isinstance(load, ProfileLoad) else ()


@cache
def shares(load: Load, links: int) -> tuple[Links, Links]:
    """Return the forces of each link on its outer and on its inner node."""
    if isinstance(load, PointLoad):
        return _point_shares(load, links)
    ends = np.linspace(0.0, 1.0, links + 1)
    head, foot = np.zeros(links), np.zeros(links)
    wanted = {"epsabs": 1e-12 * load.force, "epsrel": 1e-9}
    for i, (a, b) in enumerate(pairwise(ends)):
        for low, high in pairwise([a, *(s for s in _rough_places(load) if a < s < b), b]):
            part = (low, high)
            head[i] += quad(lambda s, a=a: density(load, s) * (s - a) * links, *part, **wanted)[0]
            foot[i] += quad(lambda s, b=b: density(load, s) * (b - s) * links, *part, **wanted)[0]
    return head, foot


def _point_shares(load: PointLoad, links: int) -> tuple[Links, Links]:
    middles = (np.arange(links) + 0.5) / links
    # Interpolation between the middles, constant beyond the first and the last of them.
    part = np.array([np.interp(load.position, middles, unit) for unit in np.eye(links)])
    if middles[0] <= load.position <= middles[-1]:
        return 0.5 * load.force * part, 0.5 * load.force * part
    along = load.position * links - np.arange(links)
    return load.force * part * along, load.force * part * (1.0 - along)


def links_of(model: Filament, x: Any) -> Any:
    """Return the vectors r_i - r_{i-1} (N, d); x may be complex."""
    nodes = np.reshape(x, (model.segments, -1))
    return np.diff(nodes, axis=0, prepend=np.zeros((1, nodes.shape[1])))


def lengths(links: Any) -> Any:
    """Return |e| of each row, without the conjugate that a complex step must not see."""
    return np.sqrt((links * links).sum(axis=1))


def energy(model: Filament, x: Any) -> Any:
    """Return the energy of bending and, of extensible links, stretching; x may be complex."""
    links, n = links_of(model, x), model.segments
    length = lengths(links)
    tangents = np.concatenate([np.eye(links.shape[1])[-1:], links / length[:, None]])
    angles = 2.0 * np.arctan(
        lengths(tangents[1:] - tangents[:-1]) / lengths(tangents[1:] + tangents[:-1])
    )
    stiffness = np.array([2.0 * n] + [float(n)] * (n - 1))
    total = (0.5 * stiffness * angles**2).sum()
    if model.inextensibility == "weak":
        total = total + (0.5 * model.tensile_stiffness / n * (length * n - 1.0) ** 2).sum()
    return total


def slope(model: Filament, x: State, direction: Array) -> float:
    """Return the derivative of the energy along a direction."""
    return float(np.imag(energy(model, x + 1j * _STEP * direction)) / _STEP)


def active_force(model: Filament, x: State) -> Array:
    """Return the load's force on every node, (size,)."""
    links = links_of(model, x)
    tangents = links / lengths(links)[:, None]
    head, foot = shares(model.load, model.segments)
    force: Array = -head[:, None] * tangents
    force[:-1] -= foot[1:, None] * tangents[1:]
    return force.ravel()


def force(model: Filament, x: State) -> Array:
    """Return the force of load and elasticity on every node, tensions of rigid links left out."""
    elastic = np.array([-slope(model, x, unit) for unit in np.eye(model.size)])
    return elastic + active_force(model, x)


def drag(model: Filament, x: State) -> Array:
    """Return the drag matrix (size, size)."""
    links = links_of(model, x)
    tangents, (n, d) = links / lengths(links)[:, None], links.shape
    matrix = np.zeros((n * d, n * d))
    for i in range(n):
        mean = tangents[i] + (tangents[i + 1] if i + 1 < n else 0.0)
        mean = mean / np.linalg.norm(mean)
        weight = (0.5 if i + 1 == n else 1.0) / n
        along = (1.0 - 1.0 / model.drag_ratio) * np.outer(mean, mean)
        matrix[d * i : d * i + d, d * i : d * i + d] = weight * (np.eye(d) - along)
    return matrix


def stretching(model: Filament, x: State) -> Array:
    """Return the matrix (N, size) that gives the rate of each link's length from the velocity."""
    links = links_of(model, x)
    tangents, (n, d) = links / lengths(links)[:, None], links.shape
    matrix = np.zeros((n, n * d))
    for i in range(n):
        matrix[i, d * i : d * i + d] = tangents[i]
        if i > 0:
            matrix[i, d * (i - 1) : d * i] = -tangents[i]
    return matrix


def motion(model: Filament, x: State) -> tuple[State, Links]:
    """Return velocity and tensions: R v = f - G^T T, with G v = 0 for rigid links."""
    resistance, pull = drag(model, x), force(model, x)
    if model.inextensibility == "weak":
        strain = lengths(links_of(model, x)) * model.segments - 1.0
        velocity = np.asarray(np.linalg.solve(resistance, pull), dtype=float)
        return velocity, model.tensile_stiffness * strain
    rates = stretching(model, x)
    n = len(rates)
    saddle = np.block([[resistance, rates.T], [rates, np.zeros((n, n))]])
    solved = np.linalg.solve(saddle, np.concatenate([pull, np.zeros(n)]))
    return solved[:-n], solved[-n:]


def differences(function: Callable[[Array], Array], x: Array, step: float) -> Array:
    """Return the Jacobian of `function` at x by central differences of fourth order."""
    columns = []
    for unit in np.eye(x.size) * step:
        near = function(x + unit) - function(x - unit)
        far = function(x + 2.0 * unit) - function(x - 2.0 * unit)
        columns.append((8.0 * near - far) / (12.0 * step))
    return np.stack(columns, axis=-1)
