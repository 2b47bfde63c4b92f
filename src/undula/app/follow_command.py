"""The command that follows states along a parameter: follow."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from undula.app.drawn_answer import figure_claimed, reply_drawn
from undula.app.options import (
    Along,
    Changes,
    Converge,
    Csv,
    FollowedKinds,
    Json,
    Overwrite,
    Plot,
    RunsToDraw,
    a_file,
)
from undula.errors import InputError

_STRAIGHT = "straight"


def follow(
    kinds: FollowedKinds,
    along: Along,
    changes: Changes = None,
    converge: Converge = False,
    plot: Plot = None,
    runs: RunsToDraw = None,
    overwrite: Overwrite = False,
    as_json: Json = False,
    as_csv: Csv = False,
) -> int:
    """Follow states along a parameter, with their stability and their bifurcations.

    Several kinds are drawn in one diagram. FILE.toml is the input; without it, the defaults.
    """
    from undula.app.commands.follow import follow_kinds
    from undula.app.tables import branch_table
    from undula.inputs.build import build_model
    from undula.inputs.input import read_model_input
    from undula.inputs.ranges import parse_way
    from undula.terminal.compile_notice import compilation_announced
    from undula.terminal.output import answer_form, notice

    form = answer_form(as_json=as_json, as_csv=as_csv)
    names, file = _kinds_and_file(kinds)
    wanted, way = read_model_input(file, changes or ()), parse_way("--along", along)
    with figure_claimed(plot, overwrite=overwrite, reads=[file, *(runs or ())]) as claim:
        stored = _runs_to_draw(names, way.parameter, plot, runs or ())
        model = build_model(wanted)
        labels: Any = {"title": wanted.describe({way.parameter}), "scales": wanted.scales}
        with compilation_announced(notice):
            answer, branches = follow_kinds(model, names, way, converge=converge, **labels)
        if as_csv:
            _notice_missing(answer.answer)

        def save(path: Path) -> None:
            from undula.app.commands.drawing import draw_branches, draw_straight

            if names == [_STRAIGHT]:
                draw_straight(branches[0], path, claim, units=model.units.names(), **labels)
            else:
                draw_branches(branches, stored, path, claim, **labels)

        return reply_drawn(answer, plot if branches else None, save, form, branch_table)


def _notice_missing(answer: Mapping[str, Any]) -> None:
    """Give notice of the kinds without a state to begin at, which a table does not show."""
    from undula.terminal.output import notice

    for part in answer.get("branches", [answer]):
        if part["status"] == "not found":
            notice(f"{part.get('kind', 'the state')} is not found: {part['reason']}")


def _kinds_and_file(words: Sequence[str]) -> tuple[list[str], Path | None]:
    """Return the kinds and the input file that the words of the command name."""
    from undula.analysis.solvers.state_kinds import KINDS
    from undula.inputs.messages import nearest

    known = [_STRAIGHT, *KINDS]
    *kinds, last = words
    # A mistyped kind is no file.
    if not kinds or last in known or (nearest(last, known) and not Path(last).exists()):
        kinds, file = [*words], None
    else:
        file = a_file(last)
    unknown = [kind for kind in kinds if kind not in known]
    if unknown:
        raise InputError(f"{unknown[0]!r} is no kind of state; take {' or '.join(known)}")
    twice = [kind for kind in kinds if kinds.count(kind) > 1]
    if twice:
        raise InputError(f"{twice[0]} is given twice; leave one out")
    return kinds, file


def _runs_to_draw(
    kinds: Sequence[str], parameter: str, plot: Path | None, runs: Sequence[Path]
) -> list[Any]:
    """Return the stored runs; refuse a figure that cannot be drawn before anything is computed."""
    if runs and (plot is None or _STRAIGHT in kinds):
        raise InputError("--run draws a dot beside spinning or flapping; give --plot for these")
    if plot is not None and _STRAIGHT in kinds:
        from undula.app.commands.drawing import check_straight

        check_straight(parameter)
        if len(kinds) > 1:
            raise InputError(
                "the straight state has a figure of its own, of growth rates; leave it out, or"
                " leave out --plot"
            )
    if not runs:
        return []
    from undula.storage.run_file import load_result

    return [load_result(run) for run in runs]
