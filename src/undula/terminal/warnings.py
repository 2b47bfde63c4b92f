"""Doubts about stored results that a command has read, told beside its answer."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from undula.errors import InputError
from undula.storage.unchecked import StoredWarning


@contextmanager
def warnings_told() -> Iterator[None]:
    """Tell in the end of each stored result that it is not known to be whole, once.

    Where a command is refused, its one sentence is all that is told.
    """
    show, told = warnings.showwarning, dict[str, None]()

    def keep(message: Warning | str, category: type[Warning], *rest: Any, **named: Any) -> None:
        if issubclass(category, StoredWarning):
            told[str(message)] = None
        else:
            show(message, category, *rest, **named)

    with warnings.catch_warnings():
        warnings.simplefilter("always", StoredWarning)
        warnings.showwarning = keep
        try:
            yield
        except InputError:
            told.clear()
            raise
        finally:
            _tell(tuple(told))


def _tell(sentences: tuple[str, ...]) -> None:
    from undula.terminal.output import notice

    for sentence in sentences:
        notice(sentence)
