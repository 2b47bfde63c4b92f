"""Claims on the joint's function psi / sin(psi) and its slope, against eighty-digit arithmetic."""

from decimal import Decimal, localcontext

import pytest

from undula.models.rod.joint import stiffening, stiffening_curvature, stiffening_slope

# Both sides of the switch at c = 0.94 between series and closed form, the folded end, and the far
# side of aligned, c > 1, which iterates reach whose links are too long.
COSINES = [-0.999, -0.9, -0.3, 0.0, 0.5, 0.9, 0.93, 0.94 - 1e-9, 0.94 + 1e-9, 0.95, 0.99]
NEARLY_ALIGNED = [1.0 - 1e-6, 1.0 - 1e-12, 1.0 + 1e-12, 1.0 + 1e-6, 1.01, 1.05, 1.1]
every_cosine = pytest.mark.parametrize("cosine", COSINES + NEARLY_ALIGNED)


def exact(cosine: float) -> tuple[Decimal, Decimal, Decimal]:
    """Return g = psi / sin(psi) and its first two derivatives by c.

    The angle is halved until its chord is the angle. The chord of an angle is sqrt(2 (1 - cos));
    beyond c = 1 angle and sine are both imaginary.
    """
    with localcontext() as context:
        context.prec = 80
        c = half = Decimal(cosine)
        halvings = 45
        for _ in range(halvings):
            half = ((1 + half) / 2).sqrt()
        g = (2 * (1 - half) / (1 - c * c)).sqrt() * 2**halvings
        slope = (c * g - 1) / (1 - c * c)
        return g, slope, (g + 3 * c * slope) / (1 - c * c)


@every_cosine
def test_the_stiffening_is_exact_to_round_off(cosine: float) -> None:
    # A sine near a folded joint loses what 1 - c^2 loses: 1e-16 over 2e-3.
    tolerance = 1e-13 if cosine < -0.9 else 2e-15
    assert stiffening(cosine) == pytest.approx(float(exact(cosine)[0]), rel=tolerance, abs=0.0)


@every_cosine
def test_its_slope_is_exact_to_round_off(cosine: float) -> None:
    # The closed form divides a difference of terms near 1 by 1 - c^2 > 0.1: round-off grows
    # thirtyfold. So does the series' own, where its terms end, at c = 1.1. A folded joint as above.
    tolerance = 1e-12 if cosine < -0.9 else 1e-13
    assert stiffening_slope(cosine) == pytest.approx(
        float(exact(cosine)[1]), rel=tolerance, abs=0.0
    )


@every_cosine
def test_its_curvature_is_exact_to_round_off(cosine: float) -> None:
    # A difference of terms near 1 by 1 - c^2 > 0.1 once more: thirtyfold again. A folded joint and
    # the far end of the series, at c = 1.1, as above.
    tolerance = 1e-11 if cosine < -0.9 else 3e-12
    assert stiffening_curvature(cosine) == pytest.approx(
        float(exact(cosine)[2]), rel=tolerance, abs=0.0
    )


def test_aligned_links_have_the_stiffness_of_the_joint_itself() -> None:
    assert stiffening(1.0) == 1.0
    # psi / sin psi = 1 + psi^2 / 6 and c = 1 - psi^2 / 2 near 0; the third is rounded once.
    assert stiffening_slope(1.0) == pytest.approx(-1.0 / 3.0, rel=1e-15, abs=0.0)
    # The next term of both: g = 1 + psi^2 / 6 + 7 psi^4 / 360.
    assert stiffening_curvature(1.0) == pytest.approx(4.0 / 15.0, rel=1e-15, abs=0.0)
