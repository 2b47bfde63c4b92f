"""Views: what a figure and a movie of a run must show, on motions known in closed form."""

import json
import subprocess
from collections.abc import Callable
from pathlib import Path

import imageio_ffmpeg
import matplotlib as mpl
import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure

from undula.errors import InputError
from undula.views import movie, portrait
from undula.views.run.movie import frame_times
from undula.views.run.reading import read_scene
from undula.views.run.resample import nodes_at
from undula.views.run.traces import band
from undula.views.run.video_file import write_video

NODES = 21
ARC = np.linspace(0.0, 1.0, NODES)
Shape = Callable[[np.ndarray], np.ndarray]


def helix(times: np.ndarray, rate: float = 20.0) -> np.ndarray:
    """A curve that turns about z without change, `rate` turns in a unit time."""
    phase = 2 * np.pi * rate * times[:, None] + 3.0 * ARC
    radius = 0.5 * ARC**2
    return np.stack(
        [radius * np.cos(phase), radius * np.sin(phase), 0 * phase + 0.7 * ARC], axis=-1
    )


def wave(times: np.ndarray, rate: float = 30.0) -> np.ndarray:
    """A wave that travels up the curve in the plane y = x / 2."""
    side = 0.4 * ARC * np.sin(2 * np.pi * rate * times[:, None] - 4.0 * ARC)
    return np.stack([side, 0.5 * side, 0 * side + 0.8 * ARC], axis=-1)


def fading(times: np.ndarray) -> np.ndarray:
    """A curve that swings back to the straight one."""
    side = 0.3 * np.exp(-5 * times[:, None]) * np.cos(25 * times[:, None]) * ARC**2
    return np.stack([side, 0 * side, 0 * side + ARC], axis=-1)


def record(
    shape: Shape, samples: int, end: float = 1.0, *, turns: float = 0, **summary
) -> xr.Dataset:
    times = np.linspace(0.0, end, samples)
    nodes = shape(times)
    energy = np.sum(np.diff(nodes, 2, axis=1) ** 2, axis=(1, 2)) * NODES**3
    known = {"verdict": "undecided", "frequency": None, "shape_frequency": None}
    known |= {"settled_from": None, "load": "tip force 75"}
    return xr.Dataset(
        {
            "nodes": (("time", "node", "axis"), nodes),
            "bending_energy": ("time", energy),
            "active_power": ("time", 3 * energy + 1),
            "dissipation": ("time", 3 * energy + 1),
            "rotation_angle": ("time", 2 * np.pi * turns * times),
        },
        coords={"time": times, "arclength": ("node", ARC), "axis": ["x", "y", "z"]},
        attrs={"summary": json.dumps(known | summary)},
    )


def spinning(samples: int = 601) -> xr.Dataset:
    return record(helix, samples, turns=20.0, verdict="spinning", frequency=20.0, settled_from=0.3)


def flapping(samples: int = 901) -> xr.Dataset:
    return record(wave, samples, verdict="planar flapping", frequency=30.0, shape_frequency=30.0)


def straight() -> xr.Dataset:
    return record(fading, 201, verdict="straight", frequency=4.0, shape_frequency=4.0)


def two_samples() -> xr.Dataset:
    return record(helix, 2, 1e-3, turns=20.0)


RUNS = {"spinning": spinning, "flapping": flapping, "straight": straight, "two": two_samples}


def marked(figure: Figure, name: str) -> list:
    return [line for axes in figure.axes for line in axes.lines if line.get_gid() == name]


def words(figure: Figure) -> str:
    labels = [text.get_text() for text in figure.texts]
    for axes in figure.axes:
        labels += [axes.get_xlabel(), axes.get_ylabel(), axes.get_title("left")]
        labels += [axes.get_zlabel()] if hasattr(axes, "get_zlabel") else []
    return "\n".join(labels)


def images(path: Path) -> np.ndarray:
    decoder = [imageio_ffmpeg.get_ffmpeg_exe(), "-loglevel", "error", "-i", str(path)]
    done = subprocess.run(
        [*decoder, "-f", "rawvideo", "-pix_fmt", "rgb24", "-"], capture_output=True, check=True
    )
    return np.frombuffer(done.stdout, np.uint8).reshape(-1, 720, 1280, 3)


@pytest.mark.parametrize("name", RUNS)
def test_every_kind_of_run_has_a_portrait_with_symbols_and_units(name: str) -> None:
    figure = portrait(RUNS[name]())
    figure.canvas.draw()
    said = words(figure)
    for label in (
        "$x$  $[L]$",
        "$z$  $[L]$",
        "$E$  $[B/L]$",
        "$P$  $[B/(LT)]$",
        r"\zeta_\perp L^4/B",
    ):
        assert label in said


@pytest.mark.parametrize("count", [2, 28])
@pytest.mark.parametrize("run", [spinning, flapping, straight])
def test_as_many_shapes_are_drawn_as_asked_each_with_its_shadow(
    run: Callable[[], xr.Dataset], count: int
) -> None:
    figure = portrait(run(), shapes=count)
    assert len(marked(figure, "shape")) == len(marked(figure, "shadow")) == count


def test_a_run_of_two_samples_shows_its_two_shapes() -> None:
    run = two_samples()
    drawn = np.array([line.get_data_3d() for line in marked(portrait(run), "shape")])
    np.testing.assert_array_equal(drawn, run["nodes"].transpose("time", "axis", "node"))


def test_shapes_span_exactly_the_last_period() -> None:
    lines = marked(portrait(flapping(), shapes=10), "shape")
    drawn = np.array([np.transpose(line.get_data_3d()) for line in lines])
    expected = wave(1.0 - np.linspace(0, 1, 10, endpoint=False)[::-1] / 30.0)
    # 30 samples a period: six-point interpolation is good to 5e-3 (2 pi / 30)^6, about 4e-7.
    np.testing.assert_allclose(drawn, expected, atol=1e-6)


def test_the_axes_in_space_have_one_scale() -> None:
    axes = next(a for a in portrait(spinning()).axes if a.name == "3d")
    spans = np.ptp([axes.get_xlim(), axes.get_ylim(), axes.get_zlim()], axis=1)
    # The box scales unit lengths as shown, whatever the zoom: equal up to round-off.
    np.testing.assert_allclose(axes._box_aspect / axes._box_aspect[0], spans / spans[0])


def test_the_headline_tells_load_verdict_and_frequency_with_its_unit() -> None:
    said = words(portrait(spinning()))
    assert "tip force 75" in said
    assert "spinning" in said
    assert "20 cycles per $T$" in said


def test_a_title_replaces_the_headline() -> None:
    said = words(portrait(spinning(), title="My run"))
    assert "My run" in said
    assert "cycles per" not in said


def test_a_long_run_shows_its_last_periods_beside_the_whole() -> None:
    assert "last 4 periods" in words(portrait(spinning()))
    assert "last 4 periods" not in words(portrait(two_samples()))


def test_too_few_samples_a_period_are_said_and_not_joined() -> None:
    figure = portrait(flapping(151))
    assert "5 stored samples a cycle" in words(figure)
    drawn = np.array([line.get_data_3d() for line in marked(figure, "shape")])
    stored = flapping(151)["nodes"].transpose("time", "axis", "node").values
    np.testing.assert_array_equal(drawn, stored[-len(drawn) :])


def test_a_steady_rotation_is_followed_between_samples_three_turns_apart() -> None:
    scene = read_scene(record(helix, 7, turns=20.0, verdict="spinning", frequency=20.0))
    asked = np.linspace(0.0, 1.0, 57)
    # Nothing but the turn changes, so that only round-off remains.
    np.testing.assert_allclose(nodes_at(scene, asked), helix(asked), atol=1e-12)


def test_eight_samples_a_cycle_give_the_motion_to_a_thousandth() -> None:
    scene = read_scene(flapping(241))
    asked = np.linspace(0.1, 0.9, 500)
    # 0.0049 (2 pi / 8)^6 = 1.2e-3 of the amplitude 0.45 is the bound of six-point interpolation.
    np.testing.assert_allclose(nodes_at(scene, asked), wave(asked), atol=6e-4)


def test_a_band_reaches_the_extremes_of_every_cycle() -> None:
    times = np.linspace(0.0, 1.0, 4001)
    _, low, high = band(times, np.sin(2 * np.pi * 80 * times), 80)
    # 50 samples a cycle meet the crest within half a sample: 1 - cos(pi / 50) = 2e-3.
    np.testing.assert_allclose([-low, high], 1.0, atol=2e-3)


def test_a_portrait_leaves_the_users_settings_alone_and_does_not_heed_them() -> None:
    with mpl.rc_context({"font.size": 31.0, "lines.linewidth": 9.0, "text.usetex": True}):
        before = dict(mpl.rcParams)
        figure = portrait(spinning())
        assert dict(mpl.rcParams) == before
    assert figure.axes[1].xaxis.label.get_size() < 12
    assert not figure.texts[0].get_usetex()


def test_a_movie_has_the_asked_number_of_changing_images(tmp_path: Path) -> None:
    reported: list[tuple[int, int]] = []
    path = movie(
        spinning(), tmp_path / "run.mp4", frames=12, progress=lambda *p: reported.append(p)
    )
    shown = images(path)
    assert shown.shape == (12, 720, 1280, 3)
    # Left of the traces and below the clock only the filament is dark and moves: a line of 4 points
    # and half the picture's height covers over a thousand pixels.
    dark = shown[:, 120:, :560].sum(axis=3, dtype=int) < 250
    assert np.all(np.count_nonzero(dark[1:] != dark[:-1], axis=(1, 2)) > 500)
    assert reported == [(done, 12) for done in range(1, 13)]


@pytest.mark.parametrize("name", ["flapping", "straight", "two"])
def test_every_kind_of_run_has_a_movie(name: str, tmp_path: Path) -> None:
    assert len(images(movie(RUNS[name](), tmp_path / "run.mp4", frames=4))) == 4


def test_a_movie_spends_most_images_on_the_last_four_periods() -> None:
    times = frame_times(read_scene(spinning()), 100)
    assert len(times) == 100
    assert np.count_nonzero(times >= 1.0 - 4 / 20.0) == 75
    assert times[0] == 0.0
    assert times[-1] == 1.0


@pytest.mark.parametrize("failure", [RuntimeError, KeyboardInterrupt])
def test_a_broken_off_movie_leaves_no_file_and_keeps_the_older_one(
    failure: type[BaseException], tmp_path: Path
) -> None:
    old = tmp_path / "run.mp4"
    old.write_bytes(b"older")

    def stop(done: int, _total: int) -> None:
        if done == 3:
            raise failure

    with pytest.raises(failure):
        movie(spinning(), old, frames=6, progress=stop)
    assert list(tmp_path.iterdir()) == [old]
    assert old.read_bytes() == b"older"


def test_an_encoder_that_fails_is_an_error_and_leaves_no_file(tmp_path: Path) -> None:
    image = memoryview(bytes(4 * 3 * 3))
    # H.264 in this colour format has no images of odd size.
    with pytest.raises(OSError, match="encoder failed"):
        write_video(tmp_path / "run.mp4", [image] * 3, (3, 3), 30)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["missing/run.mp4", "file/run.mp4", "run.gif", "folder.mp4"])
def test_a_place_where_no_movie_can_be_written_is_refused(name: str, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    (tmp_path / "folder.mp4").mkdir()
    with pytest.raises(InputError, match="movie"):
        movie(spinning(), tmp_path / name, frames=4)
    assert len(list(tmp_path.iterdir())) == 2


def test_one_sample_is_refused_with_the_cure(tmp_path: Path) -> None:
    run = spinning().isel(time=slice(1))
    with pytest.raises(InputError, match="at least 2: run longer"):
        movie(run, tmp_path / "run.mp4")
    with pytest.raises(InputError, match="at least 2: run longer"):
        portrait(run)


def test_a_dataset_that_is_not_a_run_is_refused_by_what_it_lacks() -> None:
    with pytest.raises(InputError, match="lacks dissipation"):
        portrait(spinning().drop_vars("dissipation"))


@pytest.mark.parametrize("bad", [{"frames": 1}, {"fps": 0}])
def test_impossible_numbers_are_named(bad: dict[str, int], tmp_path: Path) -> None:
    with pytest.raises(InputError, match=next(iter(bad))):
        movie(spinning(), tmp_path / "run.mp4", **bad)
    assert not list(tmp_path.iterdir())


def seen_closely(shape: Shape, samples: int, since: float, **summary) -> xr.Dataset:
    """A run with sparse samples, and its last part once more with 40 samples a period of 1/30."""
    run = record(shape, samples, **summary)
    fine = record(shape, 1201, **summary).sel(time=slice(since, None))
    names = {name: f"close_{name}" for name in ("time", *fine.data_vars)}
    return run.merge(fine.drop_vars(["arclength", "axis"]).rename(names), combine_attrs="override")


def sparse_flapping(since: float = 0.5) -> xr.Dataset:
    return seen_closely(wave, 101, since, verdict="planar flapping", frequency=30.0)


def test_the_close_up_of_a_sparsely_sampled_run_gives_the_shapes_of_its_last_period() -> None:
    figure = portrait(sparse_flapping(), shapes=10)
    drawn = np.array([np.transpose(line.get_data_3d()) for line in marked(figure, "shape")])
    expected = wave(1.0 - np.linspace(0, 1, 10, endpoint=False)[::-1] / 30.0)
    # 40 samples a period: 0.0049 (2 pi / 40)^6 is below 1e-7; the run alone has 3.3 a period.
    np.testing.assert_allclose(drawn, expected, atol=1e-6)
    assert "too few to join" not in words(figure)
    assert "last 4 periods" in words(figure)


def test_a_movie_takes_its_slow_part_from_the_close_up() -> None:
    scene = read_scene(sparse_flapping())
    slow = frame_times(scene, 100)[25:]
    assert slow[0] == pytest.approx(1.0 - 4 / 30.0)
    np.testing.assert_allclose(nodes_at(scene, slow), wave(slow), atol=1e-6)  # as above


def test_a_close_up_shorter_than_four_periods_is_not_gone_beyond() -> None:
    run = sparse_flapping(since=0.95)
    scene = read_scene(run)
    assert scene.focus is not None
    assert scene.focus[0] == pytest.approx(float(run["close_time"][0]))
    assert "last part" in words(portrait(run))
