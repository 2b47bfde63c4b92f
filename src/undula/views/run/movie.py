"""Movie of a run: the filament with its shadow and trail, next to its history.

A short overview of the whole run is followed by its last few periods in slow motion. The static
parts are drawn once, and the moving parts over them in each image.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from undula.analysis.runs.run import Run
from undula.errors import InputError
from undula.views.common import style
from undula.views.common.physical_labels import in_physical
from undula.views.run.portrait import headline
from undula.views.run.quantities import energy_row, tip_row
from undula.views.run.reading import read_scene, run_dataset
from undula.views.run.resample import nodes_at, tip_at
from undula.views.run.scene import Floats, Scene
from undula.views.run.space import fading_trail, ground, space_axes
from undula.views.run.traces import draw_traces
from undula.views.run.video_file import check_video_path, write_video

_SIZE, _DOTS_PER_INCH = (10.0, 5.625), 128.0
_OVERVIEW = 0.25
_TRAIL_PIECES = 80
_TRAIL_WITHOUT_PERIOD = 0.1


@dataclass(frozen=True)
class Stage:
    """The static picture and the moving parts."""

    canvas: Any
    filament: Any
    shadow: Any
    tip: Any
    trail: Any
    trail_shadow: Any
    clock: Any
    markers: tuple[Any, ...]

    @property
    def moving(self) -> tuple[Any, ...]:
        """The moving parts, from back to front."""
        front = (self.trail, self.filament, self.tip, self.clock, *self.markers)
        return (self.trail_shadow, self.shadow, *front)


def movie(
    run: xr.Dataset | Run,
    path: Path | str,
    *,
    frames: int = 240,
    fps: int = 30,
    progress: Callable[[int, int], None] | None = None,
) -> Path:
    """Make an MP4 movie of a stored run.

    Parameters
    ----------
    run : xarray.Dataset or Run
        A run, stored or as `undula.integrate` returns it.
    path : Path or str
        The file, ending in .mp4; an older file is replaced when the new one is complete.
    frames : int
        Number of images, at least 2; a quarter of them shows the overview.
    fps : int
        Images per second, at least 1.
    progress : callable, optional
        Called after each image with the number of images done and their total.

    Returns
    -------
    Path
        The file: H.264, 1280 by 720 pixels.

    Raises
    ------
    InputError
        The run has too few samples, a number is out of range, or the folder cannot be written.

    Examples
    --------
    >>> import undula
    >>> from undula.views import movie
    >>> stored = undula.load("results/spinning/run.nc")
    >>> movie(stored, "spinning.mp4", frames=12).name
    'spinning.mp4'
    """
    if frames < 2 or fps < 1:
        raise InputError(f"frames = {frames}, fps = {fps}: ask for at least 2 frames and 1 fps")
    path = Path(path)
    check_video_path(path)
    dataset = run_dataset(run)
    scene = read_scene(dataset)
    with style.figure_style(dataset):
        times = frame_times(scene, frames)
        stage = _build(scene, times)
        size = stage.canvas.get_width_height()
        write_video(path, _images(scene, stage, times, progress), size, fps)
    return path


def frame_times(scene: Scene, frames: int) -> Floats:
    """Return the time of each image [T]: fast up to the last periods, then in slow motion.

    Parameters
    ----------
    scene
        The run.
    frames
        Number of images.
    """
    if scene.focus is None:
        return np.linspace(scene.start, scene.end, frames)
    quick = max(1, round(_OVERVIEW * frames))
    overview = np.linspace(scene.start, scene.focus[0], quick, endpoint=False)
    return np.concatenate([overview, np.linspace(*scene.focus, frames - quick)])


def _build(scene: Scene, times: Floats) -> Stage:
    figure = Figure(figsize=_SIZE, dpi=_DOTS_PER_INCH)
    canvas: Any = FigureCanvasAgg(figure)
    style.write_title(figure, headline(scene), (0.022, 0.95))
    clock = figure.text(0.022, 0.905, "", color=style.QUIET, animated=True)
    rows = draw_traces(figure, scene, (tip_row, energy_row), left=0.555, right=0.975, top=0.88)
    markers = tuple(
        axes.axvline(scene.start, color=style.INK, lw=1.2, animated=True)
        for row in rows
        for axes in row
    )
    points = np.concatenate([nodes_at(scene, times), nodes_at(scene, scene.times[-1:])])
    axes = space_axes(figure, (0.025, 0.12, 0.395, 0.74), points)
    axes.plot([0], [0], [0], "s", ms=6, color=style.INK)
    return Stage(canvas, clock=clock, markers=markers, **_moving_parts(axes))


def _moving_parts(axes: Any) -> dict[str, Any]:
    """Return empty artists for filament, shadow, tip, trail and the trail's shadow."""
    dark = style.shape_colours(1)[0]
    parts = {
        "filament": axes.plot([], [], [], color=dark, lw=4.0)[0],
        "shadow": axes.plot([], [], [], color=style.SHADOW, lw=3.0)[0],
        "tip": axes.plot([], [], [], "o", color=style.Y_COLOUR, ms=7)[0],
        "trail": fading_trail(axes, _TRAIL_PIECES),
        "trail_shadow": axes.plot([], [], [], color=style.SHADOW, lw=1.0)[0],
    }
    for part in parts.values():
        part.set_animated(True)
    return parts


def _images(
    scene: Scene,
    stage: Stage,
    times: Floats,
    progress: Callable[[int, int], None] | None,
) -> Iterator[memoryview]:
    stage.canvas.draw()
    still = stage.canvas.copy_from_bbox(stage.canvas.figure.bbox)
    shapes, trails = nodes_at(scene, times), _trails(scene, times)
    for done, (time, shape, trail) in enumerate(zip(times, shapes, trails, strict=True), start=1):
        stage.canvas.restore_region(still)
        _move(scene, stage, float(time), shape, trail)
        yield stage.canvas.buffer_rgba()
        if progress is not None:
            progress(done, len(times))


def _trails(scene: Scene, times: Floats) -> Floats:
    """Return the tip's path (k, pieces + 1, 3) over the last period before each image."""
    length = scene.period or _TRAIL_WITHOUT_PERIOD * scene.duration
    back = length * np.linspace(1, 0, _TRAIL_PIECES + 1)
    instants = np.maximum(times[:, None] - back, scene.start)
    return tip_at(scene, instants.ravel()).reshape(*instants.shape, 3)


def _move(scene: Scene, stage: Stage, time: float, shape: Floats, trail: Floats) -> None:
    """Move all parts to their places in one image, and draw them."""
    floor = ground(stage.filament.axes)
    stage.filament.set_data_3d(*shape.T)
    stage.shadow.set_data_3d(shape[:, 0], shape[:, 1], np.full(len(shape), floor))
    stage.tip.set_data_3d(*shape[-1:].T)
    stage.trail.set_segments(np.stack([trail[:-1], trail[1:]], axis=1))
    stage.trail.do_3d_projection()
    stage.trail_shadow.set_data_3d(trail[:, 0], trail[:, 1], np.full(len(trail), floor))
    speed = "" if scene.focus is None or time < scene.focus[0] else "   ·   in slow motion"
    stage.clock.set_text(f"$t$ = {time:.4f} $T${in_physical('time', time)}{speed}")
    for marker in stage.markers:
        marker.set_xdata([time, time])
    for part in stage.moving:
        (part.axes or stage.canvas.figure).draw_artist(part)
