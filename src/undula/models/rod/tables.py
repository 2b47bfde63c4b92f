"""The linked rod: equations of a clamped chain of rigid or slightly extensible links.

    R_i v_i = f_i = q_i - q_{i+1} - outer_i t_i - inner_{i+1} t_{i+1}      node i = 1..N
    q_j = (a_{j+1} - a_j) / l_j - T_j t_j                                  force along link j
    a_j = K_{j-1} g(c_j) (t_j - t_{j-1}),   c_j = t_{j-1} . t_j            joint below link j
    g = psi / sin psi,   cos psi = c,   t_0 = e_z,   K_N = 0
    R_i = w_i [I - beta m m],   m = (t_i + t_{i+1}) / |t_i + t_{i+1}|,   beta = 1 - 1/gamma

with links e_j = r_j - r_{j-1}. Rigid links: t = e / h, l = h, and |e_j| = h determines the
multiplier T_j. Extensible links: t = e / |e|, l = |e|, and T_j + S_j / l_j = EA (l_j / h - 1),
where S_j = K_{j-1} g (1 - c_j) + K_j g (1 - c_{j+1}) is the difference between multiplier and
tension (for rigid links the multiplier includes it). In code node i and link i count from 0;
`joint[i]` is the joint below link i, at its inner node.

The vector y interleaves (x_i, T_i) node by node: 4 numbers in space, 3 in a plane. Unwrapped links
have the angle psi of the joint below link i as a fourth (see `undula.models.rod.unwrapped`), and
links with directors have eight numbers (see `undula.models.rod.material_frame`). Source: the
discrete Kirchhoff rod of Ling, Guo & Kanso (2018), with half-cell ends; docs/theory.
"""

from typing import ClassVar, NamedTuple

from undula.arrays import Array, Links
from undula.numerics.linalg.banded import Structure


class Tables(NamedTuple):
    """The parameters of a linked rod of N links, in the units of its model.

    Each kind of rod adds the `dimension`, the number of coordinates of a node, and the `stride`,
    the number of entries of a node in y, coordinates first.

    Attributes
    ----------
    joint : ndarray, shape (N,)
        Stiffness K of the joint below each link.
    weight : ndarray, shape (N,)
        Drag weight w of each node.
    outer_force, inner_force : ndarray, shape (N,)
        Force of each link on its outer and on its inner node, along -t.
    link : float
        Length h of a link.
    anisotropy : float
        Anisotropy of the drag, beta = 1 - 1/gamma, in [0, 1).
    tensile : float
        Tensile stiffness EA; infinite for rigid links.
    """

    joint: Links
    weight: Links
    outer_force: Links
    inner_force: Links
    link: float
    anisotropy: float
    tensile: float


def small_angle_structure(dimension: int) -> Structure:
    """Return the sparsity of the Newton matrix of rigid links, see `newton_matrix`.

    The order of least fill-in is from the tip to the clamp, with a link after its outer node.

    Parameters
    ----------
    dimension : {2, 3}
        Coordinates of a node.

    Returns
    -------
    Structure
        The sparsity, with one block a node.
    """
    nodes, link = range(dimension), dimension
    whole = {(a, shift, b) for a in nodes for b in nodes for shift in (-1, 0, 1)}
    scalar = {(a, shift, a) for a in nodes for shift in (-2, 2)}
    tensions = {(a, shift, link) for a in nodes for shift in (-1, 0)}
    lengths = {(link, shift, a) for a in nodes for shift in (0, 1)}
    entries = frozenset(whole | scalar | tensions | lengths | {(link, 0, link)})
    return Structure(2 * dimension + 2, dimension + 1, entries, backwards=True)


def planar_structure() -> Structure:
    """Return the sparsity of that matrix for links in space that lie in the plane y = 0.

    To first order, motions in the plane and across it are decoupled.
    """
    whole, across = small_angle_structure(3), 1
    decoupled = frozenset(
        (row, shift, column)
        for row, shift, column in whole.entries
        if (row == across) == (column == across)
    )
    return whole._replace(entries=decoupled)


class SpatialRod(Tables):
    """Rigid links in space."""

    dimension: ClassVar = 3
    stride: ClassVar = 4
    extensible: ClassVar = False
    half_bandwidth: ClassVar = 8
    structure: ClassVar = small_angle_structure(3)
    planar_structure: ClassVar = planar_structure()
    derivative_half_bandwidth: ClassVar = 11


class PlanarRod(Tables):
    """Rigid links in a plane through the axis."""

    dimension: ClassVar = 2
    stride: ClassVar = 3
    extensible: ClassVar = False
    half_bandwidth: ClassVar = 6
    structure: ClassVar = small_angle_structure(2)
    derivative_half_bandwidth: ClassVar = 8


class FoldingSpatialRod(Tables):
    """Rigid links in space with large joint angles, which take the exact Newton matrix."""

    dimension: ClassVar = 3
    stride: ClassVar = 4
    extensible: ClassVar = False
    half_bandwidth: ClassVar = 11


class FoldingPlanarRod(Tables):
    """Rigid links with large joint angles in a plane through the axis."""

    dimension: ClassVar = 2
    stride: ClassVar = 3
    extensible: ClassVar = False
    half_bandwidth: ClassVar = 8


class UnwrappedRod(Tables):
    """Rigid links in a plane with unwrapped joint angles, which may exceed pi."""

    dimension: ClassVar = 2
    stride: ClassVar = 4
    extensible: ClassVar = False
    half_bandwidth: ClassVar = 11


class ExtensibleSpatialRod(Tables):
    """Extensible links in space."""

    dimension: ClassVar = 3
    stride: ClassVar = 4
    extensible: ClassVar = True
    half_bandwidth: ClassVar = 11


class ExtensiblePlanarRod(Tables):
    """Extensible links in a plane through the axis."""

    dimension: ClassVar = 2
    stride: ClassVar = 3
    extensible: ClassVar = True
    half_bandwidth: ClassVar = 8


class DirectedTables(NamedTuple):
    """The parameters of a rod with natural joint angles or anisotropic bending.

    Attributes
    ----------
    joint, weight, outer_force, inner_force, link, anisotropy, tensile
        As in `Tables`.
    natural : ndarray, shape (N, 2)
        Natural angle of each joint about either director [rad].
    ratio : float
        Stiffness of joints about the second director over that about the first.
    compliance : float
        Twist per length and moment, 1/C; 0 for links that do not twist.
    transmitted : float
        1 if joints transmit the twist moment, 0 if it is dropped.
    tip : ndarray, shape (3,)
        Components on a, b, t of the direction opposite to the last link's load.
    """

    joint: Links
    weight: Links
    outer_force: Links
    inner_force: Links
    link: float
    anisotropy: float
    tensile: float
    natural: Array
    ratio: float
    compliance: float
    transmitted: float
    tip: Array


class DirectedRod(DirectedTables):
    """Rigid links in space, each with directors (see `undula.models.rod.material_frame`)."""

    dimension: ClassVar = 3
    stride: ClassVar = 8
    extensible: ClassVar = False
    half_bandwidth: ClassVar = 18


SMALL_ANGLE_RODS = (SpatialRod, PlanarRod)
RODS = (
    *SMALL_ANGLE_RODS,
    FoldingSpatialRod,
    FoldingPlanarRod,
    ExtensibleSpatialRod,
    ExtensiblePlanarRod,
    UnwrappedRod,
    DirectedRod,
)
#: Rods whose joints have their own forces and energies.
RODS_WITH_OWN_JOINTS = (UnwrappedRod, DirectedRod)
PlainRod = (
    SpatialRod
    | PlanarRod
    | FoldingSpatialRod
    | FoldingPlanarRod
    | ExtensibleSpatialRod
    | ExtensiblePlanarRod
    | UnwrappedRod
)
Rod = PlainRod | DirectedRod
