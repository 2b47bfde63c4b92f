"""Links with directors: natural curvature, unequal stiffnesses, twist; forces and matrices."""

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import framed_twin
import naive
import undula as un
from cases import every_load, random_state
from refusal import complaint
from undula.arrays import Array, Points
from undula.models.filament import Filament
from undula.models.loads.analytic import Load
from undula.numerics.integration.system import RATES
from undula.numerics.linalg.banded import factor_kernel, full, solve_kernel, to_dense

TWISTS = ["paper", "rigid", "elastic"]


def uneven(s: Points) -> tuple[Array, Array]:
    """Return a natural curvature that changes along the filament."""
    return 6.0 * np.cos(2.0 * s), 5.0 * s - 1.0


FORMS: list[dict[str, Any]] = [
    {"natural_curvature": (2.0 * np.pi, 0.0)},
    {"natural_curvature": (3.0, -2.0), "bending_ratio": 1.7},
    {"natural_curvature": uneven, "bending_ratio": 0.6},
    {"bending_ratio": 0.4},
]
every_twist = pytest.mark.parametrize("twist", TWISTS)
every_variational_twist = pytest.mark.parametrize("twist", ["rigid", "elastic"])
every_form = pytest.mark.parametrize("form", FORMS, ids=range(len(FORMS)))


class Framed(Filament):
    """A filament that is computed with directors whether it needs them or not."""

    @property
    def material_frame(self) -> bool:
        return True


def framed(
    form: dict[str, Any],
    twist: Any,
    *,
    load: Load | None = None,
    segments: int = 6,
    stiff: float = 0.4,
) -> Filament:
    load = un.TipLoad(75.0) if load is None else load
    return Filament(segments, load, twist=twist, twist_stiffness=stiff, **form)


def state(model: Filament, seed: int) -> Array:
    return model.admissible(random_state(model, seed, bend=0.9))


def off_balance(model: Filament, seed: int) -> tuple[Array, Array]:
    """Return unknowns whose multipliers are off, and velocities that have nothing to do with it."""
    random, moves = np.random.default_rng(seed), model.equations.differential
    y = model.unknowns(state(model, seed))
    y[~moves] += 0.3 * random.normal(size=np.count_nonzero(~moves))
    return y, np.where(moves, random.normal(size=y.size), 0.0)


def along_the_motion(model: Filament, x: Array, velocity: Array) -> float:
    """Return dE/dt by differences of the energy."""
    step = 1e-4 / np.abs(velocity).max()

    def energy(time: Array) -> Array:
        return np.array([model.energy(model.admissible(x + time[0] * velocity))])

    return float(naive.differences(energy, np.zeros(1), step)[0, 0])


# ------------------------------------------------------------------ forces


@every_twist
@every_load
def test_a_straight_isotropic_filament_moves_as_without_directors(load: Load, twist: Any) -> None:
    plain = Filament(12, load)
    for seed in range(3):
        x = random_state(plain, seed)
        model, expected = Framed(12, load, twist=twist), plain.rhs(x)
        # Round-off of forces of joints up to 1 rad.
        np.testing.assert_allclose(model.rhs(x), expected, atol=1e-13 * np.abs(expected).max())
        assert model.energy(x) == pytest.approx(plain.energy(x), rel=1e-13)
        # Round-off of moments of some tens.
        np.testing.assert_allclose(model.twist_moments(model.unknowns(x)), 0.0, atol=1e-13)


@every_variational_twist
@every_form
def test_forces_are_the_slopes_of_the_energy_of_frames_as_rotations(form: Any, twist: Any) -> None:
    model = framed(form, twist, load=un.TipLoad(0.0), segments=4)
    x = state(model, 1)
    y = model.unknowns(x)
    twists = model.twist_moments(y)[:-1] / (model.twist_stiffness * model.segments)
    if twist == "rigid":
        twists = 0.0 * twists
    expected = framed_twin.velocity(model, x, twists)
    # Fourth power of a step of 2e-3 of a link, and the minimiser's 1e-9 over that step.
    np.testing.assert_allclose(model.rhs(x), expected, atol=3e-6 * np.abs(expected).max())
    assert model.energy(x) == pytest.approx(framed_twin.energy(model, x, twists), rel=1e-12)


@every_variational_twist
@every_form
@every_load
def test_energy_gained_and_dissipated_is_what_the_load_puts_in(
    load: Load, form: Any, twist: Any
) -> None:
    model = framed(form, twist, load=load)
    for seed in range(2):
        x = state(model, seed)
        rates = model.rates(x)
        gained = along_the_motion(model, x, model.positions(rates[:-RATES]))
        put_in, dissipated = rates[-2:]
        # Differences over steps of 1e-4 of the length lose four digits, their fourth order more.
        assert abs(gained + dissipated - put_in) < 1e-9 * (abs(put_in) + dissipated)


@pytest.mark.parametrize("form", FORMS[:3], ids=range(3))
def test_the_paper_s_equations_do_not_balance_energy(form: Any) -> None:
    model = framed(form, "paper")
    x = state(model, 1)
    rates = model.rates(x)
    gained = along_the_motion(model, x, model.positions(rates[:-RATES]))
    # A thousandth is a million times what is left where the moment is kept.
    assert abs(gained + rates[-1] - rates[-2]) > 1e-3 * (abs(rates[-2]) + rates[-1])


@pytest.mark.parametrize(("ratio", "plane", "stiffness"), [(1.6, 0, 1.6), (1.6, 1, 1.0)])
@every_twist
def test_each_plane_bends_with_its_own_stiffness(
    twist: Any, ratio: float, plane: int, stiffness: float
) -> None:
    model = framed({"bending_ratio": ratio}, twist, load=un.TipLoad(60.0), segments=12)
    plain = Filament(12, un.TipLoad(60.0 / stiffness))
    x = plain.admissible(random_state(plain, 5)).reshape(-1, 3)
    radius = np.hypot(x[:, 0], x[:, 1])
    flat = np.zeros_like(x)
    flat[:, plane], flat[:, 2] = radius, x[:, 2]
    flat = plain.admissible(flat.ravel())
    # Times are in zeta L^4 / B, forces in B / L^2.
    expected = stiffness * plain.rhs(flat)
    np.testing.assert_allclose(model.rhs(flat), expected, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("twist", ["paper", "rigid"])
def test_forces_along_links_are_those_of_the_continuum_to_second_order(twist: Any) -> None:
    ratio, errors, counts = 1.6, [], [20, 40, 80]
    continuum_load = _forces_of_the_continuum(ratio, twist == "rigid")
    for n in counts:
        model = framed({"natural_curvature": uneven, "bending_ratio": ratio}, twist, segments=n)
        model = model.with_(load=un.TipLoad(0.0))
        nodes, middles = (
            continuum_load(np.arange(n + 1) / n),
            continuum_load((np.arange(n) + 0.5) / n),
        )
        y = model.unknowns(model.admissible(nodes[0][1:].ravel())).reshape(n, -1)
        y[:, 3] = 0.0
        net = -model.equations.residual(y.ravel(), np.zeros(y.size)).reshape(n, -1)[:, :3]
        force = -np.cumsum(net[::-1], axis=0)[::-1]
        t = framed_twin.tangents(model, model.positions(y.ravel()))
        force -= np.sum(force * t, axis=1, keepdims=True) * t
        apart = force - middles[1]
        errors.append(np.abs(apart[1:-1]).max())
    slopes = np.diff(np.log(errors)) / np.diff(np.log(counts))
    np.testing.assert_allclose(slopes, -2.0, atol=0.15)


def _forces_of_the_continuum(ratio: float, keeps_twist_moment: bool) -> Any:
    """Return positions and forces across the tangent (n, 3) at arc lengths of a given curve.

    N = t x M' with M = sum of B_a (kappa_a - k_a) d_a, and m t where the twist moment m is kept:
    m' = B_1 (kappa_1 - k_1) kappa_2 - B_2 (kappa_2 - k_2) kappa_1. As at a free end, M(1) = 0.
    """

    def bend(s: Points) -> tuple[Array, Array]:
        n1, n2 = uneven(s)
        return n1 + (1.0 - s) * (2.0 * np.sin(3.0 * s) + 1.0), n2 + 4.0 * (1.0 - s) * np.cos(s)

    def moments(s: Points) -> tuple[Array, Array]:
        (k1, k2), (n1, n2) = bend(s), uneven(s)
        return k1 - n1, ratio * (k2 - n2)

    def along(s: float, state: Array) -> Array:
        d1, t = state[3:6], state[6:9]
        d2, (k1, k2), (m1, m2) = np.cross(t, d1), bend(np.array(s)), moments(np.array(s))
        turn = k1 * d1 + k2 * d2
        return np.concatenate([t, np.cross(turn, d1), np.cross(turn, t), [m1 * k2 - m2 * k1]])

    start = np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0])
    solved = solve_ivp(along, (0.0, 1.0), start, rtol=1e-12, atol=1e-13, dense_output=True)

    def at(s: Array) -> tuple[Array, Array]:
        y = solved.sol(s).T
        d1, t = y[:, 3:6], y[:, 6:9]
        d2, (k1, k2), step = np.cross(t, d1), bend(s), 1e-4
        slope = [
            (a - b) / (2.0 * step)
            for a, b in zip(moments(s + step), moments(s - step), strict=True)
        ]
        # t x (m1' d1 + m2' d2), and m t x t' of the twist moment, which vanishes at the tip
        force = slope[0][:, None] * d2 - slope[1][:, None] * d1
        if keeps_twist_moment:
            moment = y[:, 9] - solved.y[9, -1]
            force += moment[:, None] * (k1[:, None] * d1 + k2[:, None] * d2)
        return y[:, :3], force

    return at


# ------------------------------------------------------------------ twist and directors


@every_form
def test_stiff_twist_comes_near_to_rigid_as_one_over_its_stiffness(form: Any) -> None:
    rigid = framed(form, "rigid")
    x = state(rigid, 2)
    expected = rigid.rhs(x)
    apart = [
        np.abs(framed(form, "elastic", stiff=c).rhs(x) - expected).max() for c in (1e4, 1e5, 1e6)
    ]
    # The next term of the expansion is a thousandth of the first at 1e4.
    np.testing.assert_allclose(np.diff(np.log10(apart)), -1.0, atol=1e-2)


@every_twist
@every_form
def test_directors_are_orthonormal_and_carried_without_twist(form: Any, twist: Any) -> None:
    model = framed(form, twist)
    y = np.stack([model.unknowns(state(model, seed)) for seed in range(3)])
    frames = model.directors(y)
    assert frames.shape == (3, 6, 3, 3)
    np.testing.assert_allclose(
        frames @ np.swapaxes(frames, -1, -2), np.eye(3) + 0 * frames, atol=1e-15
    )
    np.testing.assert_allclose(np.linalg.det(frames), 1.0, atol=1e-15)
    # The integrator's own, above the joint at each node, and at the tip that of the last link.
    carried = y.reshape(3, 6, 8)[:, :, 4:7]
    np.testing.assert_allclose(carried[:, :-1], frames[:, 1:, 0], atol=1e-13)
    np.testing.assert_allclose(carried[:, -1], frames[:, -1, 0], atol=1e-13)
    first = framed_twin.least_turn(np.array([0.0, 0.0, 1.0]), frames[0, 0, 2]).apply(np.eye(3)[0])
    np.testing.assert_allclose(frames[0, 0, 0], first, atol=1e-15)


def test_the_twist_moment_of_a_bent_arc_is_the_integral_of_what_turns_its_directors() -> None:
    # A circle in the x-z plane of a filament that is curved about d1: kappa = (0, k), and
    # m' = -B k1 ... = -(k1)(k), so that m = k k1 (1 - s) with sign; in the middle of each link.
    n, k, k1 = 200, 2.0, 3.0
    model = framed({"natural_curvature": (k1, 0.0)}, "rigid", segments=n)
    s = np.arange(1, n + 1) / n
    x = np.stack([(1.0 - np.cos(k * s)) / k, 0.0 * s, np.sin(k * s) / k], axis=1)
    found = model.twist_moments(model.unknowns(model.admissible(x.ravel())))
    # Second order in the links.
    np.testing.assert_allclose(found, k * k1 * (1.0 - s), atol=2.0 * k * k1 / n)


# ------------------------------------------------------------------ matrices


@every_twist
@every_form
@every_load
def test_the_matrix_is_the_derivative_of_the_residual(load: Load, form: Any, twist: Any) -> None:
    model = framed(form, twist, load=load)
    y, w = off_balance(model, 3)
    found = to_dense(model.equations.parts(y, w, 0.0)[0])
    numerical = naive.differences(lambda at: model.equations.residual(at, w), y, 3e-5)
    scale = np.abs(numerical).max(axis=1, keepdims=True)
    # Fourth power of a step of 2e-4 of a link, and round-off over it, row by row.
    assert (np.abs(found - numerical) <= 1e-8 * scale).all()


@every_twist
@every_form
def test_the_jacobian_is_the_derivative_of_the_velocity(form: Any, twist: Any) -> None:
    model = framed(form, twist)
    x = state(model, 4)
    numerical = naive.differences(model.rhs, x, 1e-5)
    # As above, through tensions that a hundredth of a link's length changes by hundreds.
    np.testing.assert_allclose(
        model.jacobian(x), numerical, atol=1e-7 * float(np.abs(numerical).max())
    )


@every_twist
def test_displacements_keep_the_lengths_and_the_drag_is_that_of_the_plain_rod(twist: Any) -> None:
    model, plain = framed(FORMS[1], twist), Filament(6, un.TipLoad(75.0))
    y, w = off_balance(model, 1)
    moves, basis = model.equations.differential, model.equations.displacements(y)
    assert basis.shape == (48, 12)
    lengths = to_dense(model.equations.parts(y, w, 0.0)[0])[3::8]
    assert np.abs(lengths @ basis).max() < 1e-13
    drag = to_dense(model.equations.parts(y, w, 0.0)[1])
    other = plain.unknowns(model.positions(y))
    expected = to_dense(plain.equations.parts(other, 0.0 * other, 0.0)[1])
    keep = plain.equations.differential
    np.testing.assert_array_equal(drag[np.ix_(moves, moves)], expected[np.ix_(keep, keep)])
    assert not drag[~moves].any()


@every_twist
def test_the_matrix_needs_no_pivoting(twist: Any) -> None:
    model = framed(FORMS[0], twist, segments=40, load=un.TipLoad(200.0))
    y, random = model.unknowns(un.helix(model, 1.5)), np.random.default_rng(0)
    wanted = random.normal(size=y.size)
    for c in (1e-8, 1e-5, 1e-2):
        stiff, drag = model.equations.parts(y, 0.0 * y, 0.0)
        band = drag.copy()
        moves = model.equations.differential
        band[moves] += c * stiff[moves]
        band[~moves] = stiff[~moves]
        right, dense = to_dense(band) @ wanted, to_dense(band)
        assert factor_kernel(full(18))(band)
        found = right.copy()
        solve_kernel(full(18))(band, found)
        with_pivots = np.abs(np.linalg.solve(dense, right) - wanted).max()
        # Ten times what a method with pivots leaves, and round-off where that has luck.
        assert np.abs(found - wanted).max() < 30.0 * with_pivots + 1e-10


# ------------------------------------------------------------------ symmetry


@every_twist
@pytest.mark.parametrize("form", [FORMS[0], FORMS[3]], ids=["curved", "anisotropic"])
def test_curvature_about_the_first_director_leaves_the_mirror_through_it(
    form: Any, twist: Any
) -> None:
    model = framed(form, twist)
    x = state(model, 2)
    velocity = model.rhs(x)
    np.testing.assert_allclose(
        model.rhs(model.reflect(x)), model.reflect(velocity), atol=1e-12 * np.abs(velocity).max()
    )
    equations, (y, w) = model.equations, off_balance(model, 2)
    one, mirrored = equations.residual(y, w), equations.mirrored
    np.testing.assert_allclose(
        equations.residual(mirrored(y), mirrored(w)), mirrored(one), atol=1e-12 * np.abs(one).max()
    )


@every_twist
@pytest.mark.parametrize("form", [{"natural_curvature": (0.0, 4.0)}, FORMS[3]], ids=range(2))
def test_curvature_about_the_second_director_leaves_the_other_mirror(form: Any, twist: Any) -> None:
    model = framed(form, twist)
    x, signs = state(model, 2), np.tile([1.0, -1.0, 1.0], 6)
    velocity = model.rhs(x)
    np.testing.assert_allclose(
        model.rhs(signs * x), signs * velocity, atol=1e-12 * np.abs(velocity).max()
    )


def test_there_is_no_mirror_for_other_curvatures() -> None:
    model = framed(FORMS[1], "rigid")
    assert "no mirror image" in complaint(lambda: model.reflect(model.straight()))
    y = model.unknowns(model.straight())
    assert "no mirror image" in complaint(lambda: model.equations.mirrored(y))


@every_form
def test_nothing_turns_about_the_axis(form: Any) -> None:
    model = framed(form, "rigid")
    x = state(model, 1)
    assert not model.axisymmetric
    assert not model.rotation_generator(x).any()
    assert not model.equations.turning(model.unknowns(x))[0].any()
    assert "cannot be rotated" in complaint(lambda: model.rotate(x, 0.3))
    assert Filament(6, un.TipLoad(75.0), twist="elastic").axisymmetric
