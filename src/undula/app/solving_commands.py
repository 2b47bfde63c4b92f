"""The commands that solve for states: stability, find, follow and threshold."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from undula.app.options import (
    Changes,
    Converge,
    Derivatives,
    EndOfSearch,
    FollowedKind,
    Input,
    Json,
    Overwrite,
    Plot,
    RunsToDraw,
    SecondParameter,
    ThresholdName,
    Way,
    a_file,
)
from undula.errors import InputError

if TYPE_CHECKING:
    from undula.storage.outputs import Claim
    from undula.terminal.output import Answer


def stability(
    file: Input = None,
    changes: Changes = None,
    forces: Annotated[
        str | None,
        typer.Option(metavar="RANGE", help="Leading eigenvalue at these forces, as 0:60:121."),
    ] = None,
    along: Annotated[
        str | None,
        typer.Option(metavar="KEY=RANGE", help="Along a parameter, as load.slope=-1:1:41."),
    ] = None,
    method: Annotated[
        str | None,
        typer.Option(help="spectral, modes or discrete; short for --set stability.method=."),
    ] = None,
    plot: Plot = None,
    overwrite: Overwrite = False,
    as_json: Json = False,
) -> int:
    """Tell when the straight filament begins to ring and to oscillate, and how fast.

    With --forces the leading eigenvalue at each force, with --along thresholds along a parameter,
    with both a map.
    """
    from undula.app.commands.stability import StabilityRequest, analyse
    from undula.inputs.input import read_stability_input
    from undula.inputs.ranges import parse_axis, parse_values

    overrides = [*(changes or ()), *([f"stability.method={method}"] if method is not None else [])]
    request = StabilityRequest(
        wanted=read_stability_input(file, overrides),
        forces=None if forces is None else parse_values("--forces", forces),
        along=None if along is None else parse_axis("--along", along),
    )
    with _figure_claimed(plot, overwrite=overwrite, reads=[file]) as claim:
        answer, draw = analyse(request)

        def save(path: Path) -> None:
            from undula.app.commands.drawing import save_figure

            save_figure(draw(), path, claim)

        return _reply(answer, plot, save, as_json=as_json)


def find(
    kind: Annotated[
        str, typer.Argument(metavar="KIND", help="spinning, flapping, equilibrium or periodic.")
    ],
    file: Input = None,
    changes: Changes = None,
    converge: Converge = False,
    run: Annotated[
        Path | None,
        typer.Option(
            "--run",
            metavar="RESULT.nc",
            parser=a_file,
            help="Of periodic: what this run has come to.",
        ),
    ] = None,
    seed: Annotated[
        int | None,
        typer.Option(min=0, help="Of periodic: the seed of the run that is made without --run."),
    ] = None,
    sensitivities: Derivatives = False,
    as_json: Json = False,
) -> int:
    """Solve for a state of a kind and report its stability.

    A periodic motion is the one that a run reaches: the run of --run, whose model it has, or a new
    run from a small kick.
    """
    from undula.app.commands.find import find_state
    from undula.app.commands.find_start import start_of_search
    from undula.terminal.compile_notice import compilation_announced
    from undula.terminal.output import DONE, notice, reply

    start = start_of_search(kind, file, changes or (), run, seed)
    with compilation_announced(notice):
        answer = find_state(start, kind, converge=converge, derivatives=sensitivities)
    reply(answer.answer, answer.text, as_json=as_json)
    return DONE


def follow(
    kind: FollowedKind,
    along: Way,
    file: Input = None,
    changes: Changes = None,
    converge: Converge = False,
    plot: Plot = None,
    runs: RunsToDraw = None,
    overwrite: Overwrite = False,
    as_json: Json = False,
) -> int:
    """Follow a state along a parameter, with its stability and its bifurcations."""
    from undula.analysis.linear.straight_branch import StraightBranch
    from undula.app.commands.follow import ParameterInterval, follow_along
    from undula.inputs.build import build_model
    from undula.inputs.input import read_model_input
    from undula.inputs.ranges import parse_way
    from undula.terminal.compile_notice import compilation_announced
    from undula.terminal.output import notice

    wanted = read_model_input(file, changes or ())
    interval = ParameterInterval(*parse_way("--along", along))
    with _figure_claimed(plot, overwrite=overwrite, reads=[file, *(runs or ())]) as claim:
        stored = _runs_to_draw(kind, interval.parameter, plot, runs or ())
        model, title = build_model(wanted), wanted.describe({interval.parameter})
        with compilation_announced(notice):
            answer, branch = follow_along(model, kind, interval, converge=converge, title=title)

        def save(path: Path) -> None:
            from undula.app.commands.drawing import draw_branch, draw_straight

            if isinstance(branch, StraightBranch):
                draw_straight(branch, path, claim, title=title, units=model.units.names())
            elif branch is not None:
                draw_branch(branch, stored, path, claim, title=title)

        return _reply(answer, None if branch is None else plot, save, as_json=as_json)


def threshold(
    name: ThresholdName,
    file: Input = None,
    changes: Changes = None,
    along: SecondParameter = None,
    converge: Converge = False,
    up_to: EndOfSearch = None,
    plot: Plot = None,
    sensitivities: Derivatives = False,
    overwrite: Overwrite = False,
    as_json: Json = False,
) -> int:
    """Find the force at which a state gains or loses stability, also along a parameter."""
    from undula.analysis.parameters import FORCE
    from undula.app.commands.threshold import answer_threshold, answer_threshold_curve
    from undula.inputs.build import build_model
    from undula.inputs.input import read_model_input
    from undula.inputs.ranges import parse_axis
    from undula.terminal.compile_notice import compilation_announced
    from undula.terminal.output import notice

    wanted = read_model_input(file, changes or ())
    model, end = build_model(wanted), _end_of_search(up_to)
    if along is None:
        if plot is not None:
            raise InputError("--plot draws a curve; give --along as well")
        title = wanted.describe({FORCE})
        with compilation_announced(notice):
            answer = answer_threshold(
                model, name, converge=converge, up_to=end, title=title, derivatives=sensitivities
            )
        return _reply(answer, None, as_json=as_json)
    if sensitivities:
        raise InputError("--sensitivities is of one threshold; leave out --along")
    axis = parse_axis("--along", along)
    with _figure_claimed(plot, overwrite=overwrite, reads=[file]) as claim:
        title = wanted.describe({FORCE, axis[0]})
        with compilation_announced(notice):
            answer, thresholds = answer_threshold_curve(
                model, name, axis, converge=converge, up_to=end, title=title
            )

        def save(path: Path) -> None:
            _save_curve(path, claim, (name, axis, thresholds), title, model.units.names())

        return _reply(answer, plot, save, as_json=as_json)


def _save_curve(
    path: Path, claim: "Claim", curve: tuple[Any, ...], title: str, units: Mapping[str, str]
) -> None:
    """Draw a curve: a threshold's name, the axis of the parameter, and those that were found."""
    from undula.app.commands.drawing import draw_thresholds

    name, (parameter, values), thresholds = curve
    done = parameter, values[: len(thresholds)]
    draw_thresholds(name, done, thresholds, path, claim, title=title, units=units)


def _reply(
    answer: "Answer",
    figure: Path | None,
    save: Callable[[Path], None] | None = None,
    *,
    as_json: bool,
) -> int:
    """Draw the figure, if it has a name, and answer; return the exit status.

    A figure that cannot be drawn does not suppress the answer.
    """
    from undula.terminal.output import STOPPED_EARLY, notice, reply

    status = _exit_status(answer)
    try:
        if figure is not None and save is not None:
            save(figure)
    except InputError as error:
        notice(f"there is no figure: {error}")
        figure, status = None, STOPPED_EARLY
    answer = _with_figure(answer, figure)
    reply(answer.answer, answer.text, as_json=as_json)
    return status


def _exit_status(answer: "Answer") -> int:
    """Return the exit status; give notice of a search that Ctrl-C has ended early."""
    from undula.terminal.output import DONE, STOPPED_EARLY, notice

    if answer.answer["status"] != "interrupted":
        return DONE
    notice("interrupted; what was found until then is told, the same command begins anew")
    return STOPPED_EARLY


def _end_of_search(up_to: float | None) -> float | None:
    """Return the force at which a search ends; refuse a value that is not a positive number."""
    # This form of the condition also refuses NaN.
    if up_to is not None and not 0.0 < up_to < float("inf"):
        raise InputError(f"--up-to {up_to} is out of range; give a finite force above 0")
    return up_to


def _with_figure(answer: "Answer", figure: Path | None) -> "Answer":
    """Return an answer with the name of its figure, null without one."""
    text = answer.text if figure is None else f"{answer.text}\n  figure  {figure}"
    named = answer.answer | {"figure": None if figure is None else str(figure)}
    return replace(answer, answer=named, text=text)


def _runs_to_draw(kind: str, parameter: str, plot: Path | None, runs: Sequence[Path]) -> list[Any]:
    """Return the stored runs; refuse a figure that cannot be drawn before anything is computed."""
    if runs and (plot is None or kind == "straight"):
        raise InputError("--run draws a dot beside spinning or flapping; give --plot for these")
    if plot is not None and kind == "straight":
        from undula.app.commands.drawing import check_straight

        check_straight(parameter)
    if not runs:
        return []
    from undula.storage.run_file import load_result

    return [load_result(run) for run in runs]


@contextmanager
def _figure_claimed(
    path: Path | None, *, overwrite: bool, reads: Sequence[Path | None]
) -> Iterator["Claim"]:
    """Claim the name of a figure, if it has one, before anything is computed."""
    from undula.storage.outputs import claimed

    names = [] if path is None else [path]
    if path is not None:
        from undula.app.commands.drawing import check_figure_name

        check_figure_name("--plot", path)
    files = [file for file in reads if file is not None]
    with claimed(*names, overwrite=overwrite, reads=files) as claim:
        yield claim
