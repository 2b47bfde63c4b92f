"""The command for inverse questions: solve."""

from typing import Annotated

import typer

from undula.app.drawn_answer import exit_status
from undula.app.options import Changes, Input, Json

SolvedKind = Annotated[
    str,
    typer.Argument(
        metavar="KIND",
        help="spinning, flapping, equilibrium or periodic, or a threshold, as spinning-lost.",
    ),
]
TargetText = Annotated[
    str,
    typer.Argument(
        metavar="NAME=NUMBER", help="The target, as frequency=120, or value=200 of a threshold."
    ),
]
By = Annotated[
    str, typer.Option("--by", metavar="KEY", help="The parameter, as load.force or load.slope.")
]
Between = Annotated[
    str | None,
    typer.Option(
        "--between",
        metavar="LOW:HIGH",
        help="Its range; by default up to 8 times the force of the onset, or a quarter of the"
        " input's own value to 4 times that.",
    ),
]


def solve(
    kind: SolvedKind,
    target: TargetText,
    by: By,
    file: Input = None,
    changes: Changes = None,
    between: Between = None,
    as_json: Json = False,
) -> int:
    """Solve for the values of a parameter at which a state or a threshold has a target."""
    from undula.app.commands.solve import answer_solve
    from undula.inputs.build import build_model
    from undula.inputs.input import read_model_input
    from undula.inputs.targets import parse_between, parse_target
    from undula.terminal.compile_notice import compilation_announced
    from undula.terminal.output import notice, reply

    wanted = read_model_input(file, changes or ())
    ends = None if between is None else parse_between("--between", between)
    quantity, model = parse_target(target, wanted.scales), build_model(wanted)
    with compilation_announced(notice):
        title, scales = wanted.describe({by}), wanted.scales
        answer = answer_solve(model, kind, quantity, by, ends, title=title, scales=scales)
    reply(answer.answer, answer.text, as_json=as_json)
    return exit_status(answer)
