"""The command `undula`; heavy packages are imported by the commands that need them."""

import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from undula.app.follow_command import follow
from undula.app.help import Commands
from undula.app.options import (
    Budget,
    Changes,
    Csv,
    Folder,
    Input,
    Json,
    NoMovie,
    Overwrite,
    Result,
    WithLyapunov,
    seconds_of,
)
from undula.app.plot_commands import movie, plot
from undula.app.reproduce_command import reproduce
from undula.app.solve_command import solve
from undula.app.solving_commands import find, stability, threshold
from undula.app.sweep_commands import status, sweep
from undula.interrupts import end_signals_raise
from undula.terminal.output import BAD_INPUT, DONE, INTERRUPTED, interrupted, refuse

# The matrices are small: more threads of the linear algebra would slow it down.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# Status of typer for a shell without completion, which it has named on standard error.
_UNKNOWN_SHELL = 1
_COMPLETION = ("--install-completion", "--show-completion")

app = typer.Typer(
    name="undula",
    cls=Commands,
    pretty_exceptions_enable=False,
    # As mark-up, rich would take words in square brackets for commands and omit them.
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Parameters
    ----------
    arguments
        Words after `undula`; None for those of the shell.

    Returns
    -------
    int
        The exit status: 0 done, 2 bad input, 3 stopped early with results kept or an answer that
        standard output refused, 130 interrupted without a result.
    """
    from undula.terminal.output import STOPPED_EARLY, notice
    from undula.terminal.streams import guarded_streams

    words = list(sys.argv[1:] if arguments is None else arguments)
    with guarded_streams() as answers:
        status = _execute(words or ["--help"])
        answers.flush()
        if answers.trouble is not None:
            notice(
                f"the answer does not fit onto standard output ({answers.trouble.strerror}); make"
                " room or send it elsewhere; files that were written are kept"
            )
            status = status or STOPPED_EARLY
    return status


def _execute(words: Sequence[str]) -> int:
    """Run a command, report a mistake of the user in one sentence, and return the exit status."""
    from undula.terminal.warnings import stored_warnings_noticed

    try:
        with stored_warnings_noticed(), end_signals_raise():
            status = int(app(words, prog_name="undula", standalone_mode=False) or 0)
        # Typer turns KeyboardInterrupt into this status.
        if status == INTERRUPTED:
            return interrupted()
        completes = any(word.partition("=")[0] in _COMPLETION for word in words)
        return BAD_INPUT if completes and status == _UNKNOWN_SHELL else status
    except KeyboardInterrupt:
        return interrupted()
    except SystemExit as end:  # of typer's options on completion
        return int(end.code or DONE)
    except Exception as error:
        from undula.app.mistakes import sentence_of

        sentence = sentence_of(error)
        if sentence is None:
            raise
        return refuse(sentence, as_json="--json" in words)


def _version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(f"undula {version('undula')}")
        raise typer.Exit


@app.callback()
def undula(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Tell the version.")
    ] = False,
) -> None:
    """Elastic microfilaments in viscous fluid under follower forces: run, judge and draw them."""


@app.command()
def run(
    file: Input = None,
    changes: Changes = None,
    out: Folder = None,
    overwrite: Overwrite = False,
    no_movie: NoMovie = False,
    budget: Budget = None,
    lyapunov: WithLyapunov = False,
    as_json: Json = False,
) -> int:
    """Integrate a filament in time, judge its motion, store and draw it.

    Writes run.nc, run.png and run.mp4 into DIR, by default results/ and the name of FILE.
    """
    from undula.app.commands.run_end import finish, views_of
    from undula.app.commands.run_job import begin, reads_of
    from undula.inputs.input import read_input
    from undula.storage.outputs import claimed

    wanted, seconds = read_input(file, changes or ()), seconds_of(budget)
    result = (out or Path("results") / (file.stem if file else "run")) / "run.nc"
    views = views_of(result, with_movie=not no_movie)
    reads = reads_of(file, wanted)
    with claimed(result, *views, renewed=views, overwrite=overwrite, reads=reads) as claim:
        job = begin(wanted, result)
        return finish(job, claim, views, budget=seconds, lyapunov=lyapunov, as_json=as_json)


@app.command()
def resume(
    result: Result,
    until: Annotated[
        float | None,
        typer.Option(
            metavar="T", help="Time at which to end [T]; not needed by a run stopped early."
        ),
    ] = None,
    overwrite: Annotated[
        bool,
        typer.Option("--overwrite", help="Replace a figure or movie that is not undula's own."),
    ] = False,
    no_movie: NoMovie = False,
    budget: Budget = None,
    lyapunov: WithLyapunov = False,
    as_json: Json = False,
) -> int:
    """Go on where a run ended, in the same file; figure and movie are drawn anew."""
    from undula.app.commands.run_end import finish, views_of
    from undula.app.commands.run_job import resumed
    from undula.app.stored_files import RESUME, load_run_for
    from undula.storage.outputs import claimed

    seconds = seconds_of(budget)
    load_run_for(result, RESUME)  # refuses other files before anything is made or locked
    views = views_of(result, with_movie=not no_movie)
    with claimed(result, *views, renewed=views, continued=[result], overwrite=overwrite) as claim:
        job = resumed(result, until)
        return finish(job, claim, views, budget=seconds, lyapunov=lyapunov, as_json=as_json)


app.command()(plot)
app.command()(movie)
for _command in (stability, find, follow, threshold, solve):
    app.command()(_command)


@app.command()
def step(
    along: Annotated[
        str,
        typer.Option(
            metavar="KEY=RANGE",
            help="The values, as load.force=0:60:121, 0,20,60, or in steps as 0:60:0.5.",
        ),
    ],
    file: Input = None,
    changes: Changes = None,
    down: Annotated[bool, typer.Option("--down", help="Go back through the same values.")] = False,
    thresholds: Annotated[
        bool, typer.Option("--thresholds", help="Compare with the solved thresholds of the force.")
    ] = False,
    kick: Annotated[float, typer.Option(help="Largest turn of a link before a step, rad.")] = 1e-3,
    seed: Annotated[int, typer.Option(help="Seed of the random kicks.")] = 1,
    out: Folder = None,
    overwrite: Overwrite = False,
    budget: Budget = None,
    as_json: Json = False,
    as_csv: Csv = False,
) -> int:
    """Settle at a value of a parameter, change it, settle again from there, and so on.

    Writes steps.nc and steps.png into DIR, by default results/ and the name of FILE. A series that
    was stopped early goes on with the same command.
    """
    from undula.app.commands.run_job import reads_of
    from undula.app.commands.step import RampJob, plan, run_ramp
    from undula.inputs.ramp_input import read_ramp_input
    from undula.terminal.output import answer_form

    form, seconds = answer_form(as_json=as_json, as_csv=as_csv), seconds_of(budget)
    wanted = read_ramp_input(file, changes or ())
    series, remark = plan(wanted, along, back=down, kick=kick, seed=seed)
    result = (out or Path("results") / (file.stem if file else "step")) / "steps.nc"
    reads = reads_of(file, wanted)
    job = RampJob(wanted, series, result, reads, overwrite, thresholds, remark)
    return run_ramp(job, form, budget=seconds)


app.command()(sweep)
app.command()(status)
app.command()(reproduce)


@app.command()
def units(
    force: Annotated[float | None, typer.Option(help="A force in B/L^2, to pN.")] = None,
    time: Annotated[float | None, typer.Option(help="A time in T, to s.")] = None,
    frequency: Annotated[float | None, typer.Option(help="Cycles per T, to Hz.")] = None,
    energy: Annotated[float | None, typer.Option(help="An energy in B/L, to pN um.")] = None,
    force_pn: Annotated[float | None, typer.Option(help="A force in pN, to B/L^2.")] = None,
    time_s: Annotated[float | None, typer.Option(help="A time in s, to T.")] = None,
    frequency_hz: Annotated[float | None, typer.Option(help="Hz, to cycles per T.")] = None,
    energy_pn_um: Annotated[float | None, typer.Option(help="An energy in pN um, to B/L.")] = None,
    length: Annotated[float, typer.Option(help="Length L of the filament, um.")] = 20.0,
    stiffness: Annotated[float, typer.Option(help="Bending stiffness B, pN um^2.")] = 800.0,
    viscosity: Annotated[float, typer.Option(help="Viscosity of the fluid, mPa s.")] = 1.0,
    slenderness: Annotated[float, typer.Option(help="Radius over length.")] = 0.01,
    as_json: Json = False,
) -> int:
    """Convert dimensionless numbers of a filament to physical ones, and back."""
    from undula.app.commands.units import convert, scales_of, units_answer, units_text, without_none
    from undula.terminal.output import reply

    scales = scales_of(length, stiffness, viscosity, slenderness)
    converted = convert(
        scales,
        without_none(force=force, time=time, frequency=frequency, energy=energy),
        without_none(force=force_pn, time=time_s, frequency=frequency_hz, energy=energy_pn_um),
    )
    reply(units_answer(scales, converted), units_text(scales, converted), as_json=as_json)
    return DONE
