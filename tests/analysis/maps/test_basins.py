"""Shares of starts that end in each verdict, against counts that are known."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import undula as un
from refusal import complaint
from small_sweeps import done, sweep_of
from sweeps import coded, made_up
from undula.analysis.maps.basins import basins, wilson_interval
from undula.views import basin_diagram

FORCES = (50.0, 100.0, 200.0, 400.0)
EXPONENTS = (1.0, 2.0, 4.0)
#: How many of ten starts flap at each force; the others spin.
FLAPPING = {50.0: 0, 100.0: 1, 200.0: 6, 400.0: 10}


def ends(force: float, number: int) -> str:
    return "planar flapping" if number < FLAPPING[force] else "spinning"


def of_one_axis() -> xr.Dataset:
    return made_up({"load.force": FORCES}, ends, tries=10)


def of_two_axes() -> xr.Dataset:
    axes = {"load.exponent": EXPONENTS, "load.force": FORCES}
    return made_up(axes, lambda _, force, number: ends(force, number), tries=10)


@pytest.mark.parametrize(
    ("hits", "tries", "low", "high"),
    [
        (81, 263, 0.2553, 0.3662),
        (15, 148, 0.0624, 0.1605),
        (0, 20, 0.0, 0.1611),
        (1, 29, 0.0061, 0.1718),
    ],
)
def test_intervals_are_those_of_the_literature(
    hits: int, tries: int, low: float, high: float
) -> None:
    # R. G. Newcombe, Stat. Med. 17 (1998) 857, table I, method 3, to the four digits printed there.
    found = wilson_interval(np.array(hits), np.array(tries))
    assert found == pytest.approx((low, high), abs=5.1e-5)


def test_an_interval_is_where_the_observed_share_is_within_so_many_deviations() -> None:
    tries = np.array([4.0, 10.0, 200.0])
    hits = np.array([1.0, 9.0, 60.0])
    for end in wilson_interval(hits, tries, 0.9):
        away = np.abs(hits / tries - end) / np.sqrt(end * (1.0 - end) / tries)
        # The 95th percentile of a normal distribution.
        assert away == pytest.approx(1.6448536, rel=1e-7)


def test_nothing_tried_leaves_all_shares_possible() -> None:
    assert wilson_interval(np.array(0), np.array(0)) == (0.0, 1.0)


@pytest.mark.parametrize("confidence", [0.0, 1.0, float("nan")])
def test_a_confidence_out_of_range_is_refused(confidence: float) -> None:
    sentence = complaint(lambda: basins(of_one_axis(), confidence=confidence))
    assert f"confidence = {confidence}" in sentence


@pytest.mark.parametrize("form", [lambda store: store, coded])
def test_shares_are_those_of_the_tries(form) -> None:
    found = basins(form(of_two_axes()))
    assert found["verdict"].values.tolist() == ["spinning", "planar flapping"]
    assert found["fraction"].dims == ("load.exponent", "load.force", "verdict")
    shares = found["fraction"].sel({"verdict": "planar flapping", "load.exponent": 2.0})
    assert shares.values.tolist() == [FLAPPING[force] / 10 for force in FORCES]
    assert found["fraction"].sum("verdict").values == pytest.approx(1.0)
    inside = (found["low"] <= found["fraction"]) & (found["fraction"] <= found["high"])
    assert bool(inside.all())


def test_runs_without_an_answer_do_not_count() -> None:
    def rule(force: float, number: int) -> str:
        return ("failed", "", "spinning", "spinning")[number] if force == 100.0 else ""

    found = basins(made_up({"load.force": FORCES}, rule, tries=4))
    assert found["tries"].values.tolist() == [0, 2, 0, 0]
    assert found["fraction"].sel(verdict="spinning").values[1] == 1.0
    assert np.isnan(found["fraction"].values[[0, 2, 3]]).all()
    assert np.isnan(found["low"].values[[0, 2, 3]]).all()


def test_pies_have_slices_in_proportion() -> None:
    figure = basin_diagram(basins(of_two_axes()))
    axes = figure.axes[0]
    slices: dict[str, int] = {}
    for drawn in axes.collections:
        slices[drawn.get_gid()] = slices.get(drawn.get_gid(), 0) + 1
    # Spinning is seen at all forces but the last, flapping at all but the first.
    assert slices == {"spinning": 9, "planar flapping": 9}
    at = [d for d in axes.collections if np.allclose(d.get_offsets()[0], (2.0, 200.0))]
    areas = {drawn.get_gid(): _area(drawn.get_paths()[0].vertices) for drawn in at}
    assert areas["planar flapping"] / sum(areas.values()) == pytest.approx(0.6, rel=1e-2)


def test_slices_of_a_pie_have_one_radius() -> None:
    figure = basin_diagram(basins(of_two_axes()))
    reach = [
        np.abs(drawn.get_paths()[0].vertices).max() ** -2 * drawn.get_sizes()[0]
        for drawn in figure.axes[0].collections
    ]
    # matplotlib divides a marker by its farthest corner; sizes are areas.
    assert np.array(reach) == pytest.approx(reach[0], rel=1e-9)


def test_bars_are_stacked_to_one_and_shares_carry_their_intervals() -> None:
    shares = basins(of_one_axis())
    upper, lower = basin_diagram(shares).axes
    heights = {bars[0].get_gid(): [bar.get_height() for bar in bars] for bars in upper.containers}
    assert heights["planar flapping"] == pytest.approx([0.0, 0.1, 0.6, 1.0])
    tops = [bar.get_y() + bar.get_height() for bar in upper.containers[-1]]
    assert tops == pytest.approx([1.0] * 4)
    drawn = sorted(
        tuple(segment[:, 1]) for bars in lower.collections for segment in bars.get_segments()
    )
    seen = shares["hits"].values > 0
    expected = sorted(zip(shares["low"].values[seen], shares["high"].values[seen], strict=True))
    assert np.array(drawn) == pytest.approx(np.array(expected))


def test_a_sweep_without_answers_has_no_shares_to_draw() -> None:
    shares = basins(made_up({"load.force": FORCES}, lambda *_: "", tries=2))
    assert "no shares" in complaint(lambda: basin_diagram(shares))


def _area(corners: np.ndarray) -> float:
    x, y = corners.T
    return 0.5 * abs(float(x @ np.roll(y, 1) - y @ np.roll(x, 1)))


#: From next to straight to links that point backwards.
OF_TWENTY = """
[model]
segments = 20
[time]
until = "settled"
limit = 20.0
[study]
policy = "random"
tries = 16
amplitudes = [1e-3, 2.0]
[[study.axes]]
key = "load.force"
values = [100, 177, 250]
"""


@pytest.mark.slow
def test_where_starts_end_is_what_the_paper_says_except_where_two_states_are_stable(
    tmp_path: Path,
) -> None:
    # Ling, Guo & Kanso (2018), section on the tip force: below the second transition every start
    # out of a plane comes to spin, beyond it every start comes to flap.
    found = basins(done(sweep_of(tmp_path, OF_TWENTY), tmp_path / "s.zarr"))["fraction"]
    assert found.sel({"load.force": 100.0, "verdict": "spinning"}) == 1.0
    assert found.sel({"load.force": 250.0, "verdict": "planar flapping"}) == 1.0
    # Between the forces at which flapping is gained and spinning is lost it depends on the start.
    model = un.Filament(20, un.TipLoad(177.0))
    assert un.find(model, "spinning").stable
    assert un.find(model, "flapping").stable
    both = found.sel({"load.force": 177.0, "verdict": ["spinning", "planar flapping"]})
    assert (both > 0.0).all()
    assert both.sum() == 1.0
