"""The linked rod: equations of a clamped chain of rigid or slightly extensible links.

    R_i v_i = f_i = q_i - q_{i+1} - head_i t_i - foot_{i+1} t_{i+1}        node i = 1..N
    q_j = (a_{j+1} - a_j) / l_j - T_j t_j                                  force along link j
    a_j = K_{j-1} g(c_j) (t_j - t_{j-1}),   c_j = t_{j-1} . t_j         joint at the foot of link j
    g = psi / sin psi,   cos psi = c,   t_0 = e_z,   K_N = 0
    R_i = w_i [I - beta m m],   m = (t_i + t_{i+1}) / |t_i + t_{i+1}|,   beta = 1 - 1/gamma

with links e_j = r_j - r_{j-1}. Rigid links: t = e / h, l = h, and |e_j| = h fixes the multiplier
T_j. Extensible links: t = e / |e|, l = |e|, and T_j + S_j / l_j = EA (l_j / h - 1), where S_j =
K_{j-1} g (1 - c_j) + K_j g (1 - c_{j+1}) turns the multiplier into the tension (rigid links absorb
it). In code node i and link i count from 0; `joint[i]` sits at the foot of link i.

The vector y interleaves (x_i, T_i) node by node: 4 numbers in space, 3 in a plane. Links that wind
have the angle psi at the foot of link i for a fourth (see `undula.models.rod.unwrapped`), and links
with directors have eight (see `undula.models.rod.material_frame`). Source: the discrete Kirchhoff
rod of Ling, Guo & Kanso (2018), with half-cell ends; docs/theory.
"""

from typing import ClassVar, NamedTuple

from undula.arrays import Array, Links
from undula.numerics.linalg.banded import Structure


class Tables(NamedTuple):
    """The numbers that make a linked rod what it is; arrays of shape (N,).

    Each kind of rod adds the `dimension`, which is the number of coordinates of a node, and the
    `stride`, which is that of its entries in y, coordinates first.
    """

    joint: Links  # K: stiffness of the joint at the foot of each link
    weight: Links  # w: drag weight of each node
    outer_force: Links  # force that each link puts on its outer node, along -t
    inner_force: Links  # force that each link puts on its inner node, along -t
    link: float  # h: length of a link
    anisotropy: float  # beta = 1 - 1/gamma
    tensile: float  # EA; infinite for rigid links


def small_angle_structure(dimension: int) -> Structure:
    """Return where the matrix of `undula.models.rod.newton_matrix` for rigid links has entries.

    From the tip on, a link after its outer node, is the order that fills in least.
    """
    nodes, link = range(dimension), dimension
    whole = {(a, shift, b) for a in nodes for b in nodes for shift in (-1, 0, 1)}
    scalar = {(a, shift, a) for a in nodes for shift in (-2, 2)}
    tensions = {(a, shift, link) for a in nodes for shift in (-1, 0)}
    lengths = {(link, shift, a) for a in nodes for shift in (0, 1)}
    entries = frozenset(whole | scalar | tensions | lengths | {(link, 0, link)})
    return Structure(2 * dimension + 2, dimension + 1, entries, backwards=True)


def planar_structure() -> Structure:
    """Return where that matrix has entries for links that move in space but lie in a plane, y = 0.

    To first order what happens in the plane and what happens across it know nothing of each other.
    """
    whole, across = small_angle_structure(3), 1
    apart = frozenset(
        (row, shift, column)
        for row, shift, column in whole.entries
        if (row == across) == (column == across)
    )
    return whole._replace(entries=apart)


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
    """Rigid links in a plane that holds the axis."""

    dimension: ClassVar = 2
    stride: ClassVar = 3
    extensible: ClassVar = False
    half_bandwidth: ClassVar = 6
    structure: ClassVar = small_angle_structure(2)
    derivative_half_bandwidth: ClassVar = 8


class FoldingSpatialRod(Tables):
    """Rigid links in space that bend so sharply at joints that Newton's method wants all terms."""

    dimension: ClassVar = 3
    stride: ClassVar = 4
    extensible: ClassVar = False
    half_bandwidth: ClassVar = 11


class FoldingPlanarRod(Tables):
    """Such links in a plane that holds the axis."""

    dimension: ClassVar = 2
    stride: ClassVar = 3
    extensible: ClassVar = False
    half_bandwidth: ClassVar = 8


class UnwrappedRod(Tables):
    """Rigid links in a plane whose joints wind up beyond pi instead of folding."""

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
    """Extensible links in a plane that holds the axis."""

    dimension: ClassVar = 2
    stride: ClassVar = 3
    extensible: ClassVar = True
    half_bandwidth: ClassVar = 8


class FramedTables(NamedTuple):
    """The tables of a rod whose joints bend by a natural angle of their own, or not alike."""

    joint: Links
    weight: Links
    outer_force: Links
    inner_force: Links
    link: float
    anisotropy: float
    tensile: float
    natural: Array  # (N, 2) angle about each director by which a joint at rest is bent
    ratio: float  # stiffness of joints about the second director over that about the first
    compliance: float  # 1/C: twist per length and moment; 0 where links do not twist
    transmitted: float  # 1 where joints pass the twist moment on, 0 where it is dropped
    tip: Array  # (3,) components on a, b, t of the direction that opposes the last link's load


class DirectedRod(FramedTables):
    """Rigid links in space, each with directors (see `undula.models.rod.material_frame`)."""

    dimension: ClassVar = 3
    stride: ClassVar = 8
    extensible: ClassVar = False
    half_bandwidth: ClassVar = 18


GENTLE_RODS = (SpatialRod, PlanarRod)
RODS = (
    *GENTLE_RODS,
    FoldingSpatialRod,
    FoldingPlanarRod,
    ExtensibleSpatialRod,
    ExtensiblePlanarRod,
    UnwrappedRod,
    DirectedRod,
)
#: Rods whose joints have forces and energies of their own.
OTHER_JOINTS = (UnwrappedRod, DirectedRod)
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
