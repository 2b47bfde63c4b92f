"""The commands that solve for states: stability, find and threshold."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from undula.app.drawn_answer import figure_claimed, reply_drawn
from undula.app.options import (
    Changes,
    Converge,
    Csv,
    Derivatives,
    EndOfSearch,
    Input,
    Json,
    LinearMethod,
    Overwrite,
    Plot,
    SecondParameter,
    ThresholdName,
    a_file,
    end_of_search,
)
from undula.errors import InputError

if TYPE_CHECKING:
    from undula.inputs.input import ModelInput
    from undula.storage.outputs import Claim
    from undula.terminal.output import Form


def stability(
    file: Input = None,
    changes: Changes = None,
    forces: Annotated[
        str | None,
        typer.Option(metavar="RANGE", help="Leading eigenvalue at these forces, as 0:60:121."),
    ] = None,
    along: SecondParameter = None,
    method: LinearMethod = None,
    plot: Plot = None,
    overwrite: Overwrite = False,
    as_json: Json = False,
    as_csv: Csv = False,
) -> int:
    """Tell when the straight filament begins to ring and to oscillate, and how fast.

    With --forces the leading eigenvalue at each, with --along thresholds, with both a map.
    """
    from undula.app.commands.stability import StabilityRequest, analyse
    from undula.app.tables import stability_table
    from undula.inputs.input import read_stability_input
    from undula.inputs.ranges import parse_axis, parse_values
    from undula.terminal.output import answer_form

    form = answer_form(as_json=as_json, as_csv=as_csv)
    if as_csv and forces is None and along is None:
        raise InputError("--csv writes a table; give --forces or --along as well")
    overrides = [*(changes or ()), *([f"stability.method={method}"] * (method is not None))]
    request = StabilityRequest(
        wanted=read_stability_input(file, overrides),
        forces=None if forces is None else parse_values("--forces", forces),
        along=None if along is None else parse_axis("--along", along),
    )
    with figure_claimed(plot, overwrite=overwrite, reads=[file]) as claim:
        answer, draw = analyse(request)

        def save(path: Path) -> None:
            from undula.app.commands.drawing import save_figure

            save_figure(draw(), path, claim)

        return reply_drawn(answer, plot, save, form, stability_table)


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
    as_csv: Csv = False,
) -> int:
    """Find the force at which a state gains or loses stability, also along a parameter."""
    from undula.inputs.input import read_model_input
    from undula.inputs.ranges import parse_axis
    from undula.terminal.output import answer_form

    form = answer_form(as_json=as_json, as_csv=as_csv)
    wanted, end = read_model_input(file, changes or ()), end_of_search(up_to)
    if along is not None:
        if sensitivities:
            raise InputError("--sensitivities is of one threshold; leave out --along")
        axis = parse_axis("--along", along)
        with figure_claimed(plot, overwrite=overwrite, reads=[file]) as claim:
            return _threshold_curve(name, wanted, axis, converge, end, (plot, claim), form)
    if plot is not None:
        raise InputError("--plot draws a curve; give --along as well")
    if as_csv:
        raise InputError("--csv writes a table; give --along as well")
    return _single_threshold(name, wanted, converge, end, sensitivities, form)


def _single_threshold(
    name: str,
    wanted: "ModelInput",
    converge: bool,
    end: float | None,
    sensitivities: bool,
    form: "Form",
) -> int:
    from undula.analysis.parameters import FORCE
    from undula.app.commands.threshold import answer_threshold
    from undula.app.tables import threshold_table
    from undula.inputs.build import build_model
    from undula.terminal.compile_notice import compilation_announced
    from undula.terminal.output import notice

    model, title = build_model(wanted), wanted.describe({FORCE})
    with compilation_announced(notice):
        answer = answer_threshold(
            model,
            name,
            converge=converge,
            up_to=end,
            title=title,
            derivatives=sensitivities,
            scales=wanted.scales,
        )
    return reply_drawn(answer, None, None, form, threshold_table)


def _threshold_curve(
    name: str,
    wanted: "ModelInput",
    axis: tuple[str, tuple[float, ...]],
    converge: bool,
    end: float | None,
    figure: tuple[Path | None, "Claim"],
    form: "Form",
) -> int:
    """Answer with a threshold along a parameter, and draw it under a claimed name."""
    from undula.analysis.parameters import FORCE
    from undula.app.commands.threshold import answer_threshold_curve
    from undula.app.tables import threshold_table
    from undula.inputs.build import build_model
    from undula.terminal.compile_notice import compilation_announced
    from undula.terminal.output import notice

    (parameter, values), (plot, claim) = axis, figure
    model, title = build_model(wanted), wanted.describe({FORCE, parameter})
    with compilation_announced(notice):
        answer, thresholds = answer_threshold_curve(
            model, name, axis, converge=converge, up_to=end, title=title, scales=wanted.scales
        )

    def save(path: Path) -> None:
        from undula.app.commands.drawing import draw_thresholds

        labels: Any = {"units": model.units.names(), "scales": wanted.scales}
        done = parameter, values[: len(thresholds)]
        draw_thresholds(name, done, [*thresholds], path, claim, title=title, **labels)

    return reply_drawn(answer, plot, save, form, threshold_table)
