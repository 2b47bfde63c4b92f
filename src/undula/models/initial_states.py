"""Initial states of a motion.

Each shape is defined by the inclination of the filament to its axis, a vector (a_x, a_y)(s) in
radians, whose largest value is the amplitude. The tangent is the axis rotated by the inclination.
Links therefore have their exact length at any amplitude, and all shapes satisfy the clamp.
"""

from functools import lru_cache

import numpy as np

from undula.arrays import Array, Nodes, State
from undula.errors import InputError, is_number
from undula.models.given_shapes import finite_array, fits, inclinations
from undula.models.inclined_states import from_inclination, in_plane, link_midpoints, with_amplitude
from undula.models.model import Model

#: Number of modes of the inclination in a random kick, with amplitudes that decay as 1/number.
_KICK_MODES = 4


def straight(model: Model) -> State:
    """Return the straight state, an equilibrium of models without natural curvature.

    Parameters
    ----------
    model : Model
        The model.

    Returns
    -------
    ndarray, shape (model.size,)
        The state [L].

    Raises
    ------
    InputError
        The load is not below the tensile stiffness of extensible links.

    Examples
    --------
    >>> import undula as un
    >>> model = un.Filament(4, un.TipLoad(75.0), confined=True)
    >>> un.straight(model)
    array([0.  , 0.25, 0.  , 0.5 , 0.  , 0.75, 0.  , 1.  ])
    """
    return model.straight()


def kicked(model: Model, amplitude: float = 1e-2, *, seed: int = 1) -> State:
    """Return a random smooth shape, non-planar unless the model is confined.

    Parameters
    ----------
    model : Model
        The model.
    amplitude : float
        Largest inclination to the axis [rad], in (0, pi].
    seed : int
        Seed of the random numbers, at least 0; a seed gives the same shape at any number of links.

    Returns
    -------
    ndarray, shape (model.size,)
        The state [L].

    Raises
    ------
    InputError
        A value is out of its range.

    Examples
    --------
    >>> import undula as un
    >>> un.kicked(un.Filament(20, un.TipLoad(75.0)), 1e-3, seed=7).shape
    (60,)
    """
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
        raise InputError(f"seed = {seed!r} has to be a whole number, at least 0")
    s, modes = link_midpoints(model), np.arange(1, _KICK_MODES + 1)
    inclination = np.sin(np.pi * (modes - 0.5) * s[:, None]) @ _kick_amplitudes(int(seed))
    return with_amplitude(model, inclination, amplitude)


def planar(model: Model, amplitude: float = 1e-2, *, angle: float = 0.0) -> State:
    """Return a smooth bend in a plane through the axis.

    Its inclination is amplitude sin(pi s / 2).

    Parameters
    ----------
    model : Model
        The model.
    amplitude : float
        Inclination at the tip [rad], in (0, pi].
    angle : float
        Azimuth of the plane [rad], 0 for a confined model.

    Returns
    -------
    ndarray, shape (model.size,)
        The state [L].

    Raises
    ------
    InputError
        A value is out of its range.

    Examples
    --------
    >>> import undula as un
    >>> model = un.Filament(40, un.TipLoad(75.0), confined=True)
    >>> x = un.planar(model, 0.5)
    >>> print(un.observables.tip_radius(model.nodes(x)).round(3))
    0.31
    """
    _check_angle(model, angle)
    bend = np.sin(0.5 * np.pi * link_midpoints(model))
    return with_amplitude(model, bend[:, None] * _direction(angle), amplitude)


def helix(model: Model, amplitude: float = 1e-2, *, right_handed: bool = True) -> State:
    """Return a helix of one turn with increasing inclination.

    Its inclination is amplitude sin(pi s / 2), its azimuth +-2 pi s.

    Parameters
    ----------
    model : Model
        A model that is not confined.
    amplitude : float
        Inclination at the tip [rad], in (0, pi].
    right_handed : bool
        Handedness of the helix.

    Returns
    -------
    ndarray, shape (model.size,)
        The state [L].

    Raises
    ------
    InputError
        The amplitude is out of its range, or the model is confined.

    Examples
    --------
    >>> import undula as un
    >>> left = un.helix(un.Filament(20, un.TipLoad(75.0)), 0.2, right_handed=False)
    """
    if model.dimension == 2:
        raise InputError("a confined model cannot start as a helix; take the planar start")
    s = link_midpoints(model)
    azimuth = 2.0 * np.pi * s * (1.0 if right_handed else -1.0)
    bend = np.sin(0.5 * np.pi * s)
    inclination = bend[:, None] * np.stack([np.cos(azimuth), np.sin(azimuth)], axis=-1)
    return with_amplitude(model, inclination, amplitude)


def mode(model: Model, amplitude: float = 1e-2, *, angle: float = 0.0) -> State:
    """Return the leading linear mode of the straight state, in a plane through the axis.

    The leading eigenvalue has the largest real part. A complex mode is taken at the phase at which
    its imaginary part vanishes at the tip.

    Parameters
    ----------
    model : Model
        A model with a straight equilibrium.
    amplitude : float
        Largest inclination to the axis [rad], in (0, pi].
    angle : float
        Azimuth of the plane [rad], 0 for a confined model.

    Returns
    -------
    ndarray, shape (model.size,)
        The state [L].

    Raises
    ------
    InputError
        A value is out of its range, or the model has natural curvature or anisotropic bending.

    Examples
    --------
    >>> import undula as un
    >>> x = un.mode(un.Filament(20, un.TipLoad(75.0), confined=True), 0.1)
    """
    _check_angle(model, angle)
    deflection = leading_mode(model)[1]
    shape = np.real(deflection / deflection[-1])
    slope = np.diff(shape, prepend=0.0)
    return with_amplitude(model, slope[:, None] * _direction(angle), amplitude)


def leading_mode(model: Model) -> tuple[complex, Array]:
    """Return the leading eigenvalue of the straight state with its mode.

    Parameters
    ----------
    model : Model
        A model with a straight equilibrium.

    Returns
    -------
    eigenvalue : complex
        The eigenvalue with the largest real part [1/T].
    mode : ndarray, shape (links,)
        Complex deflection of the nodes, with arbitrary amplitude and phase.
    """
    stiffness, drag = model.linearised()
    values, vectors = np.linalg.eig(-np.linalg.solve(drag, stiffness))
    first = max(range(values.size), key=lambda k: (values[k].real, values[k].imag))
    return complex(values[first]), vectors[:, first]


def from_state(model: Model, nodes: Nodes, amplitude: float = 1.0) -> State:
    """Return a given shape, transferred to the model's links.

    The inclinations of the pieces between nodes are interpolated at the links of the model and
    multiplied by the amplitude. Nodes of the model's own links are kept.

    Parameters
    ----------
    model : Model
        The model.
    nodes : array_like, shape (M + 1, 3)
        Nodes from the base, at the origin, to the tip, with the axis along z, in any unit: their
        arc length counts as L.
    amplitude : float
        Factor of the inclinations, above 0.

    Returns
    -------
    ndarray, shape (model.size,)
        The state [L].

    Raises
    ------
    InputError
        The nodes are not finite numbers of this shape, coincide, or do not begin at the clamp; the
        amplitude is not above 0; or the shape leaves the plane of a confined model.

    Examples
    --------
    >>> import numpy as np
    >>> import undula as un
    >>> angle = np.linspace(0.0, 1.0, 101)
    >>> arc = np.stack([1.0 - np.cos(angle), 0.0 * angle, np.sin(angle)], axis=1)
    >>> model = un.Filament(20, un.TipLoad(75.0))
    >>> x = un.from_state(model, arc)
    >>> print(un.observables.tip_radius(model.nodes(x)).round(3))
    0.46
    """
    nodes = finite_array(nodes, "nodes")
    if nodes.ndim != 2 or nodes.shape[0] < 2 or nodes.shape[1] != 3:
        raise InputError(
            f"nodes of shape {nodes.shape} are no shape; give finite values (M + 1, 3)"
        )
    if not (is_number(amplitude) and amplitude > 0.0):
        raise InputError(f"amplitude = {amplitude!r} has to be a number above 0")
    own = len(nodes) - 1 == model.links and amplitude == 1.0
    if own and fits(nodes, extensible=model.extensible):
        return in_plane(model, nodes)
    return from_inclination(model, amplitude * inclinations(nodes, model.links))


@lru_cache(maxsize=64)
def _kick_amplitudes(seed: int) -> Array:
    """Return the random amplitudes (modes, 2) of the modes of a kick, as a read-only array."""
    modes = np.arange(1, _KICK_MODES + 1)
    amplitudes = np.random.default_rng(seed).normal(size=(_KICK_MODES, 2)) / modes[:, None]
    amplitudes.setflags(write=False)
    return amplitudes


def _direction(angle: float) -> Array:
    return np.array([np.cos(angle), np.sin(angle)])


def _check_angle(model: Model, angle: float) -> None:
    if not is_number(angle):
        raise InputError(f"angle = {angle!r} has to be a finite number of radians")
    if model.dimension == 2 and angle != 0.0:
        raise InputError("a confined model moves in the x-z plane; leave the angle at 0")
