"""Answers that may come with a figure of their own: its name, its file and the exit status."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from undula.errors import InputError

if TYPE_CHECKING:
    from undula.storage.outputs import Claim
    from undula.terminal.output import Answer, Form

#: The function that makes the table of an answer.
Table = Callable[[Mapping[str, Any]], str]


@contextmanager
def figure_claimed(
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


def reply_drawn(
    answer: "Answer",
    figure: Path | None,
    save: Callable[[Path], None] | None,
    form: "Form",
    table: Table,
) -> int:
    """Draw the figure, if it has a name, and answer; return the exit status.

    A figure that cannot be drawn does not suppress the answer.
    """
    from undula.terminal.output import STOPPED_EARLY, notice

    status = exit_status(answer)
    try:
        if figure is not None and save is not None:
            save(figure)
    except InputError as error:
        notice(f"there is no figure: {error}")
        figure, status = None, STOPPED_EARLY
    answer = _with_figure(answer, figure)
    reply_in(form, answer, table)
    return status


def reply_in(form: "Form", answer: "Answer", table: Table) -> None:
    """Write an answer to standard output in a form."""
    from undula.terminal.output import Form, reply

    text = table(answer.answer) if form is Form.CSV else answer.text
    reply(answer.answer, text, as_json=form is Form.JSON)


def exit_status(answer: "Answer") -> int:
    """Return the exit status; give notice of a search that Ctrl-C has ended early."""
    from undula.terminal.output import DONE, STOPPED_EARLY, notice

    if answer.answer["status"] != "interrupted":
        return DONE
    notice("interrupted; what was found until then is told, the same command begins anew")
    return STOPPED_EARLY


def _with_figure(answer: "Answer", figure: Path | None) -> "Answer":
    """Return an answer with the name of its figure, null without one."""
    text = answer.text if figure is None else f"{answer.text}\n  figure  {figure}"
    named = answer.answer | {"figure": None if figure is None else str(figure)}
    return replace(answer, answer=named, text=text)
