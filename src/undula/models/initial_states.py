"""Shapes that a motion starts from.

Every shape is made from the inclination of the filament to its axis, a vector (a_x, a_y)(s) in
radians, whose largest value is the amplitude; the tangent is the axis turned by it. So links have
their exact length whatever the amplitude, and all starts meet the clamp.
"""

from functools import lru_cache

import numpy as np

from undula.arrays import Array, Nodes, State
from undula.errors import InputError, is_number
from undula.models.given_shapes import fits, inclinations, numbers
from undula.models.model import Model

#: Modes of the inclination in a random kick, and the decay of their size with their number.
_KICK_MODES = 4


def straight(model: Model) -> State:
    """Return the straight state, which is an equilibrium."""
    return model.straight()


def kicked(model: Model, amplitude: float = 1e-2, *, seed: int = 1) -> State:
    """Return a small random smooth shape, non-planar unless the model is confined.

    Parameters
    ----------
    model : Model
    amplitude : float
        Largest inclination to the axis [rad].
    seed : int
        Seed of the random numbers: the same seed gives the same shape at any number of links.
    """
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
        raise InputError(f"seed = {seed!r} has to be a whole number, at least 0")
    s, modes = _link_midpoints(model), np.arange(1, _KICK_MODES + 1)
    inclination = np.sin(np.pi * (modes - 0.5) * s[:, None]) @ _kick_sizes(int(seed))
    return _inclined(model, inclination, amplitude)


def planar(model: Model, amplitude: float = 1e-2, *, angle: float = 0.0) -> State:
    """Return a smooth bend in the plane through the axis at azimuth `angle` [rad]."""
    _check_angle(model, angle)
    bend = np.sin(0.5 * np.pi * _link_midpoints(model))
    return _inclined(model, bend[:, None] * _direction(angle), amplitude)


def helix(model: Model, amplitude: float = 1e-2, *, right_handed: bool = True) -> State:
    """Return a helix of one turn whose inclination grows from the clamp to the tip."""
    if model.dimension == 2:
        raise InputError("a confined model cannot start as a helix; take the planar start")
    s = _link_midpoints(model)
    azimuth = 2.0 * np.pi * s * (1.0 if right_handed else -1.0)
    bend = np.sin(0.5 * np.pi * s)
    inclination = bend[:, None] * np.stack([np.cos(azimuth), np.sin(azimuth)], axis=-1)
    return _inclined(model, inclination, amplitude)


def mode(model: Model, amplitude: float = 1e-2, *, angle: float = 0.0) -> State:
    """Return the leading linear mode of the straight state, in the plane at azimuth `angle` [rad].

    The leading eigenvalue is the one with the largest real part; of a complex mode, whose phase is
    free, the real part is taken where its imaginary part vanishes at the tip.
    """
    _check_angle(model, angle)
    deflection = leading_mode(model)[1]
    shape = np.real(deflection / deflection[-1])
    slope = np.diff(shape, prepend=0.0)
    return _inclined(model, slope[:, None] * _direction(angle), amplitude)


def leading_mode(model: Model) -> tuple[complex, Array]:
    """Return the leading eigenvalue of the straight state and its transverse mode (links,)."""
    stiffness, drag = model.linearised()
    values, vectors = np.linalg.eig(-np.linalg.solve(drag, stiffness))
    first = max(range(values.size), key=lambda k: (values[k].real, values[k].imag))
    return complex(values[first]), vectors[:, first]


def from_state(model: Model, nodes: Nodes, amplitude: float = 1.0) -> State:
    """Return the shape with the given nodes (M + 1, 3), carried over to the model's links.

    The nodes go from the base, at the origin, to the tip, in any unit: their own arc length counts
    as L. The inclinations of their pieces are interpolated at the links of the model and, if an
    amplitude other than 1 is asked, multiplied by it. Nodes of the model's own links are kept.

    Raises
    ------
    InputError
        The nodes are no finite numbers of this shape, coincide, or do not begin at the clamp; the
        amplitude is not above 0; or the shape leaves the plane of a confined model.
    """
    nodes = numbers(nodes, "nodes")
    if nodes.ndim != 2 or nodes.shape[0] < 2 or nodes.shape[1] != 3:
        raise InputError(
            f"nodes of shape {nodes.shape} are no shape; give finite values (M + 1, 3)"
        )
    if not (is_number(amplitude) and amplitude > 0.0):
        raise InputError(f"amplitude = {amplitude!r} has to be a number above 0")
    own = len(nodes) - 1 == model.links and amplitude == 1.0
    if own and fits(nodes, extensible=model.extensible):
        return _in_plane(model, nodes)
    return _bent(model, amplitude * inclinations(nodes, model.links))


def turned(model: Model, nodes: Nodes, amplitude: float, *, seed: int = 1) -> State:
    """Return the shape with the given nodes, its links turned a little at random.

    The turns are smooth: each link is turned as the axis is to become the tangent of a kicked start
    of this amplitude and seed. So links keep their length, and a plane is not left.

    Parameters
    ----------
    model : Model
    nodes : ndarray, shape (N + 1, 3)
        Of the model's own links.
    amplitude : float
        Largest angle of a turn [rad], above 0 and at most pi/2.
    seed : int
        Seed of the random numbers.
    """
    if not (is_number(amplitude) and 0.0 < amplitude <= 0.5 * np.pi):
        raise InputError(f"amplitude = {amplitude!r} has to be a number in (0, pi/2]")
    bend = np.diff(model.nodes(kicked(model, amplitude, seed=seed)), axis=0)
    tangents = bend / np.linalg.norm(bend, axis=1, keepdims=True)
    axis = np.cross([0.0, 0.0, 1.0], tangents)
    links = np.diff(nodes, axis=0)
    once = np.cross(axis, links)
    # Rodrigues' formula with the sine in the axis; tangents are at most pi/2 from upright.
    links = links + once + np.cross(axis, once) / (1.0 + tangents[:, 2:])
    return model.from_nodes(np.concatenate([nodes[:1], np.cumsum(links, axis=0)]))


@lru_cache(maxsize=64)
def _kick_sizes(seed: int) -> Array:
    """Return the random sizes (modes, 2) of the modes in a kick; they cannot be written to."""
    modes = np.arange(1, _KICK_MODES + 1)
    sizes = np.random.default_rng(seed).normal(size=(_KICK_MODES, 2)) / modes[:, None]
    sizes.setflags(write=False)
    return sizes


def _link_midpoints(model: Model) -> Array:
    links = model.size // model.dimension
    return (np.arange(links) + 0.5) / links


def _direction(angle: float) -> Array:
    return np.array([np.cos(angle), np.sin(angle)])


def _check_angle(model: Model, angle: float) -> None:
    if not is_number(angle):
        raise InputError(f"angle = {angle!r} has to be a finite number of radians")
    if model.dimension == 2 and angle != 0.0:
        raise InputError("a confined model moves in the x-z plane; leave the angle at 0")


def _inclined(model: Model, inclination: Array, amplitude: float) -> State:
    """Return the shape with the given inclination (links, 2), scaled to its largest value."""
    if not (is_number(amplitude) and 0.0 < amplitude <= np.pi):
        raise InputError(f"amplitude = {amplitude!r} has to be a number in (0, pi]")
    if model.dimension == 2:
        inclination = inclination * [1.0, 0.0]
    return _bent(model, amplitude * inclination / np.linalg.norm(inclination, axis=1).max())


def _bent(model: Model, inclination: Array) -> State:
    size = np.linalg.norm(inclination, axis=1, keepdims=True)
    tangents = np.concatenate([np.sinc(size / np.pi) * inclination, np.cos(size)], axis=1)
    nodes = np.cumsum(tangents, axis=0) / tangents.shape[0]
    return _in_plane(model, np.concatenate([np.zeros((1, 3)), nodes]))


def _in_plane(model: Model, nodes: Nodes) -> State:
    """Return the state with these nodes; a confined model takes only planar ones, turned to x-z."""
    if model.dimension == 3:
        return model.from_nodes(nodes)
    far = nodes[np.argmax(np.linalg.norm(nodes[:, :2], axis=1)), :2]
    direction = far / np.linalg.norm(far) if far.any() else np.array([1.0, 0.0])
    across = nodes[:, 1] * direction[0] - nodes[:, 0] * direction[1]
    if np.abs(across).max() > 1e-6:  # a millionth of the length: beyond the error of any run
        raise InputError("a confined model cannot start from a shape that is not planar")
    flat = np.stack([nodes[:, :2] @ direction, np.zeros(len(nodes)), nodes[:, 2]], axis=1)
    return model.from_nodes(flat)
