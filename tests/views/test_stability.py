"""Figures of linear stability, drawn from a pair of eigenvalues known in closed form.

Below F = 20 + 10 p it is two real ones, -(30 + 10 p - F) +- 5 sqrt(20 + 10 p - F); they meet there
and cross the imaginary axis at F = 30 + 10 p, p being the parameter, 0 if there is none.
"""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure

from refusal import complaint
from undula.analysis.linear.curves import CriticalCurve, GrowthCurve
from undula.analysis.linear.results import Crossing, Onset, Spectrum
from undula.views import growth_figure, stability_portrait, threshold_figure
from undula.views.linear.mode_shapes import leading_shapes

ARC = np.linspace(0.0, 1.0, 41)
TRAVELLING = ARC**2 * np.exp(1j * (3.0 * ARC - 3.0))
STANDING = ARC**2 + 0j
NOTHING = np.full(4, np.nan)


def leading(forces: np.ndarray | float, parameter: np.ndarray | float = 0.0) -> np.ndarray:
    ahead = np.asarray(forces) - 10.0 * np.asarray(parameter)
    return ahead - 30.0 + 5.0 * np.sqrt(20.0 - ahead + 0j)


def curve(forces: np.ndarray, **changes) -> GrowthCurve:
    sigma = leading(forces)
    beats = np.abs(sigma.imag) / (2 * np.pi)
    return replace(GrowthCurve(forces, sigma.real, beats, 0 * beats, "spectral"), **changes)


def plane(values: np.ndarray, forces: np.ndarray, **changes) -> GrowthCurve:
    sigma = leading(forces, values[:, None])
    beats = np.abs(sigma.imag) / (2 * np.pi)
    whole = GrowthCurve(
        forces, sigma.real, beats, 0 * beats, "spectral", parameter="load.slope", values=values
    )
    return replace(whole, **changes)


def onset_at(parameter: float = 0.0) -> Onset:
    force = 30.0 + 10.0 * parameter
    crossing = Crossing(force, 1e-9, 5 * np.sqrt(10.0) / (2 * np.pi), 1e-9, 1.0)
    return Onset(crossing, force - 10.0, 1e-9, (), 100.0, "spectral")


STABLE = Onset(None, None, None, (), 80.0, "spectral")


def spectrum_at(force: float, mode: np.ndarray = TRAVELLING) -> Spectrum:
    first = complex(leading(force))
    values = np.array([first, first.conjugate(), -400.0])
    modes = np.array([mode, mode.conj(), ARC**3 + 0j])
    return Spectrum(force, values, np.full(3, 1e-9), ARC, modes, "spectral")


def thresholds(values: np.ndarray, without: tuple[int, ...] = ()) -> CriticalCurve:
    onsets = (STABLE if k in without else onset_at(p) for k, p in enumerate(values))
    return CriticalCurve("load.slope", values, tuple(onsets))


FORCES = np.linspace(0.0, 50.0, 101)
SLOPES = np.linspace(-1.0, 1.0, 21)
FIGURES = {
    "portrait": lambda: stability_portrait(
        onset_at(), curve(FORCES), spectrum_at(40.0), title="Tip load"
    ),
    "growth": lambda: growth_figure(curve(FORCES), title="Tip load"),
    "maps": lambda: growth_figure(plane(SLOPES, FORCES), title="Linear loads"),
    "thresholds": lambda: threshold_figure(thresholds(SLOPES), title="Linear loads"),
}


def marked(figure: Figure, name: str) -> list:
    """Everything that has this group identity."""
    return [a for axes in figure.axes for a in axes.get_children() if a.get_gid() == name]


def words(figure: Figure) -> str:
    said = [text.get_text() for text in figure.texts]
    for axes in figure.axes:
        said += [axes.get_xlabel(), axes.get_ylabel(), axes.get_title("left")]
        said += [axes.get_title("right"), *(text.get_text() for text in axes.texts)]
        legend = axes.get_legend()
        said += [text.get_text() for text in legend.get_texts()] if legend else []
    said += [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    return "\n".join(said)


def finite_points(line) -> np.ndarray:
    points = np.column_stack([np.asarray(line.get_xdata()), np.asarray(line.get_ydata())])
    return points[np.all(np.isfinite(points), axis=1)]


def is_inside(figure: Figure, region: str, point: tuple[float, float]) -> bool:
    paths = [path for area in marked(figure, region) for path in area.get_paths()]
    return any(path.contains_point(point) for path in paths)


@pytest.mark.parametrize(
    ("name", "labels"),
    [
        ("portrait", ["$s$  $[L]$", "arbitrary scale", "phase  [cycles]", r"\sigma$  $[1/T]$"]),
        ("growth", [r"\sigma$  $[1/T]$", "frequency  [cycles per $T$]"]),
        ("maps", [r"\sigma$  $[1/T]$", "frequency  [cycles per $T$]", r"slope $\alpha$"]),
        ("thresholds", ["frequency at onset\n[cycles per $T$]", r"slope $\alpha$"]),
    ],
)
def test_every_figure_of_stability_has_a_title_symbols_and_units(
    name: str, labels: list[str]
) -> None:
    figure = FIGURES[name]()
    figure.canvas.draw()
    for label in ["load", "$F$  $[B/L^2]$", *labels]:
        assert label in words(figure)


def test_the_oscillatory_and_the_hopf_force_are_marked_in_both_panels_with_their_values() -> None:
    figure = FIGURES["portrait"]()
    for name, force in (("oscillatory force", 20.0), ("Hopf force", 30.0)):
        assert [list(line.get_xdata()) for line in marked(figure, name)] == [[force, force]] * 2
        assert f"$F$ = {force:.4g}" in words(figure)
    assert "2.516 cycles per $T$" in words(figure)  # 5 sqrt(10) / (2 pi)


@pytest.mark.parametrize("force", [10.0, 40.0, 90.0])
def test_the_force_of_the_spectrum_is_marked_on_both_curves_and_seen(force: float) -> None:
    spectrum = spectrum_at(force)
    figure = stability_portrait(onset_at(), curve(FORCES), spectrum, title="")
    points = [line.get_xydata()[0] for line in marked(figure, "spectrum")]
    expected = [(force, spectrum.rates[0]), (force, spectrum.frequencies[0])]
    np.testing.assert_array_equal(points, expected)
    for axes, point in zip(figure.axes, points, strict=False):
        assert axes.viewLim.contains(*point)


def test_a_load_that_never_destabilises_is_said_to_be_stable_up_to_the_force_searched() -> None:
    figure = stability_portrait(STABLE, curve(FORCES[:40]), spectrum_at(10.0), title="")
    assert "no loss of stability up to $F$ = 80" in words(figure)
    assert not marked(figure, "Hopf force")
    assert "decays" in words(figure)
    assert "grows" not in words(figure)


def test_decay_and_growth_are_drawn_apart_and_meet_where_the_rate_is_zero() -> None:
    # Steps of 3 miss the crossing at 30, between 28 and 31, where the rate is F - 30 exactly.
    figure = growth_figure(curve(np.arange(1.0, 50.0, 3.0)), title="")
    (decays,), (grows,) = marked(figure, "decays"), marked(figure, "grows")
    low, high = finite_points(decays), finite_points(grows)
    assert np.all(low[:, 1] <= 0)
    assert np.all(high[:, 1] >= 0)
    np.testing.assert_allclose([low[-1], high[0]], [[30.0, 0.0]] * 2, atol=1e-12)  # round-off


def test_the_shapes_of_a_mode_divide_one_cycle_evenly_and_follow_the_time() -> None:
    figure = FIGURES["portrait"]()
    lines = marked(figure, "shape")
    phases = 2 * np.pi * np.arange(len(lines)) / len(lines)
    expected = [np.real(TRAVELLING * np.exp(1j * phase)) for phase in phases]
    assert spectrum_at(40.0).values[0].imag > 0
    assert len(lines) > 8
    np.testing.assert_allclose([line.get_xdata() for line in lines], expected, atol=1e-12)
    assert all(np.array_equal(line.get_ydata(), ARC) for line in lines)


def test_both_eigenvalues_of_a_pair_give_the_same_motion() -> None:
    spectrum = spectrum_at(40.0)
    other = replace(spectrum, values=spectrum.values[[1, 0, 2]], modes=spectrum.modes[[1, 0, 2]])
    np.testing.assert_allclose(leading_shapes(spectrum), leading_shapes(other), atol=1e-12)


def test_a_mode_that_does_not_oscillate_is_one_curve_with_the_next_ones_behind() -> None:
    spectrum = spectrum_at(10.0, STANDING)
    slower = replace(spectrum, values=np.array([-20.0, -30.0 + 5j, -30.0 - 5j]))
    figure = stability_portrait(onset_at(), curve(FORCES), slower, title="")
    assert len(marked(figure, "shape")) == 1
    assert len(marked(figure, "other mode")) == 1
    assert "phase" not in words(figure)


def test_an_imaginary_part_within_its_error_is_not_shown_as_an_oscillation() -> None:
    spectrum = spectrum_at(40.0)
    vague = replace(spectrum, errors=1.01 * np.abs(spectrum.values.imag))
    assert len(leading_shapes(vague)) == 1


@pytest.mark.parametrize(
    ("name", "start"), [("growth rate 0: Hopf curve", 30.0), ("edge of oscillation", 20.0)]
)
def test_both_maps_carry_the_curves_where_the_rate_and_the_frequency_leave_zero(
    name: str, start: float
) -> None:
    figure = FIGURES["maps"]()
    panels = figure.axes[:2]
    drawn = [
        [child for child in axes.get_children() if (child.get_gid() or "").startswith(name)]
        for axes in panels
    ]
    for (contour,) in drawn:
        points = np.concatenate([path.vertices for path in contour.get_paths()])
        assert np.ptp(points[:, 0]) == pytest.approx(2.0)
        # Rate and squared frequency are linear near these curves, so that only round-off remains.
        np.testing.assert_allclose(points[:, 1], start + 10 * points[:, 0], atol=1e-9)


def test_an_oscillation_that_sets_in_with_a_jump_has_its_edge_halfway_between_two_values() -> None:
    jump = np.tile(np.where(FORCES < 20.2, 0.0, 3.0), (21, 1))
    figure = growth_figure(plane(SLOPES, FORCES, frequencies=jump), title="")
    contour = next(
        child for child in figure.axes[1].collections if "edge" in (child.get_gid() or "")
    )
    points = np.concatenate([path.vertices for path in contour.get_paths()])
    np.testing.assert_allclose(points[:, 1], 20.25, atol=1e-9)  # between 20 and 20.5


def test_the_colours_of_the_growth_rate_are_centred_on_zero_and_fine_around_it() -> None:
    tame = plane(SLOPES, FORCES)
    wild = replace(tame, rates=np.where(tame.rates > 15, 1e4, tame.rates))
    norm = growth_figure(wild, title="").axes[0].collections[0].norm
    assert norm(0.0) == pytest.approx(0.5)
    # Of 256 colours a linear scale up to 1e4 would leave none between these.
    assert norm(10.0) - norm(-10.0) > 10 / 256


def test_an_unknown_parameter_is_named_as_it_is() -> None:
    figure = growth_figure(plane(SLOPES, FORCES, parameter="load.tilt"), title="")
    assert "load.tilt" in words(figure)


def test_values_in_any_order_give_the_same_map() -> None:
    ordered, mixed = plane(SLOPES, FORCES), plane(SLOPES[::-1], FORCES[::-1])
    meshes = [growth_figure(g, title="").axes[0].collections[0] for g in (ordered, mixed)]
    np.testing.assert_array_equal(meshes[0].get_array(), meshes[1].get_array())


def test_the_time_unit_of_the_printed_equation_is_said() -> None:
    # What counts a rate of 2 in 1/T as 1 when the drag ratio is 2 is the rate gamma / T.
    printed = curve(FORCES, paper_time=True)
    said = words(growth_figure(printed, title=""))
    assert r"$[\gamma/T]$" in said
    assert r"cycles per $T/\gamma$" in said
    assert "printed equation" in said
    onsets = tuple(replace(onset, paper_time=True) for onset in thresholds(SLOPES).onsets)
    figure = threshold_figure(replace(thresholds(SLOPES), onsets=onsets), title="")
    assert r"cycles per $T/\gamma$" in words(figure)


def test_results_in_two_time_units_are_not_drawn_in_one_figure() -> None:
    printed = curve(FORCES, paper_time=True)
    said = complaint(lambda: stability_portrait(onset_at(), printed, spectrum_at(40.0), title=""))
    assert "paper_time is False in onset, True in growth" in said


def test_a_portrait_of_a_curve_with_a_parameter_is_refused() -> None:
    growth = plane(SLOPES, FORCES)
    said = complaint(lambda: stability_portrait(onset_at(), growth, spectrum_at(40.0), title=""))
    assert "load.slope" in said


def test_the_regions_lie_between_the_thresholds() -> None:
    figure = threshold_figure(thresholds(SLOPES), title="")
    for slope in (-0.73, 0.0, 0.88):
        edge = 10.0 * slope
        assert is_inside(figure, "straight, monotone decay", (slope, edge + 19.9))
        assert is_inside(figure, "straight, rings", (slope, edge + 20.1))
        assert is_inside(figure, "straight, rings", (slope, edge + 29.9))
        assert is_inside(figure, "oscillates", (slope, edge + 30.1))
    for name in ("straight, monotone decay", "straight, rings", "oscillates"):
        assert name in words(figure)


def test_lines_break_where_there_is_no_threshold_and_a_lone_value_is_a_dot() -> None:
    figure = threshold_figure(thresholds(SLOPES, without=(3, 5)), title="")
    (line,) = marked(figure, "Hopf force")
    assert np.flatnonzero(np.isnan(line.get_ydata())).tolist() == [3, 5]
    dots = [dot.get_xydata() for dot in figure.axes[0].lines if dot.get_marker() == "o"]
    np.testing.assert_allclose(dots[0], [[SLOPES[4], 30.0 + 10 * SLOPES[4]]])
    assert "gaps: no loss of stability up to $F$ = 80" in words(figure)
    for slope in SLOPES[3:6:2]:
        assert not is_inside(figure, "oscillates", (slope, 35.0))


def test_thresholds_of_several_decades_have_a_logarithmic_axis() -> None:
    values = np.array([0.0, 50.0, 500.0])
    axes = threshold_figure(thresholds(values), title="").axes[0]
    assert axes.get_yscale() == "log"
    assert axes.viewLim.y0 < 20.0
    assert axes.viewLim.y1 > 5030.0


ZERO = np.zeros(4)
SOME = np.linspace(0.0, 3.0, 4)
GAPPY = np.where(FORCES % 10 < 5, np.nan, leading(FORCES).real)
ODD = {
    "one force": curve(np.array([12.0])),
    "a constant": curve(SOME, rates=ZERO, frequencies=ZERO),
    "nothing": curve(SOME, rates=NOTHING, frequencies=NOTHING),
    "gaps": curve(FORCES, rates=GAPPY),
    "one value": plane(SLOPES[:1], FORCES),
    "one value and force": plane(np.zeros(1), np.zeros(1)),
    "a constant map": plane(SOME, SOME, rates=np.zeros((4, 4)), frequencies=np.zeros((4, 4))),
    "no map": plane(SOME, SOME, rates=np.full((4, 4), np.nan), frequencies=np.full((4, 4), np.nan)),
    "a map with gaps": plane(SLOPES, FORCES, rates=np.tile(GAPPY, (21, 1))),
    "only growth": plane(SLOPES, FORCES, rates=np.full((21, 101), 7.0)),
}


@pytest.mark.parametrize("name", ODD)
def test_growth_that_is_short_flat_or_missing_is_drawn(name: str) -> None:
    growth_figure(ODD[name], title="").canvas.draw()


@pytest.mark.parametrize("name", [name for name, odd in ODD.items() if odd.parameter is None])
@pytest.mark.parametrize("onset", [onset_at(), STABLE])
@pytest.mark.parametrize("mode", [0 * TRAVELLING, STANDING, np.nan * TRAVELLING])
@pytest.mark.parametrize("force", [0.0, 12.0, 40.0])
def test_every_combination_of_odd_results_has_a_portrait(
    name: str, onset: Onset, mode: np.ndarray, force: float
) -> None:
    stability_portrait(onset, ODD[name], spectrum_at(force, mode), title="").canvas.draw()


@pytest.mark.parametrize("without", [(), (0,), (0, 1), (0, 1, 2)])
@pytest.mark.parametrize("values", [np.array([-1.0, 0.5, 1.0]), np.array([0.5]), np.ones(3)])
def test_short_flat_and_missing_thresholds_are_drawn(
    values: np.ndarray, without: tuple[int, ...]
) -> None:
    threshold_figure(thresholds(values, without), title="").canvas.draw()
