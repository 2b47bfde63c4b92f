"""Warnings on stored results that a command has read, given with its answer."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from undula.errors import InputError
from undula.storage.unchecked import StoredWarning


@contextmanager
def stored_warnings_noticed() -> Iterator[None]:
    """Give notice of each different `StoredWarning` once, at the end of the context.

    After an `InputError` no notice is given, since the error is reported in a single sentence.
    """
    show, sentences = warnings.showwarning, dict[str, None]()

    def keep(message: Warning | str, category: type[Warning], *rest: Any, **named: Any) -> None:
        if issubclass(category, StoredWarning):
            sentences[str(message)] = None
        else:
            show(message, category, *rest, **named)

    with warnings.catch_warnings():
        warnings.simplefilter("always", StoredWarning)
        warnings.showwarning = keep
        try:
            yield
        except InputError:
            sentences.clear()
            raise
        finally:
            _notify(tuple(sentences))


def _notify(sentences: tuple[str, ...]) -> None:
    from undula.terminal.output import notice

    for sentence in sentences:
        notice(sentence)
