"""Notice to the user while kernels are compiled; silent when they come from the cache."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from numba.core import event

from undula.jit.cache import why_not_kept

_COMPILE = "numba:compile"
_TEXT = "compiling the kernels, once per installation; this takes about half a minute"


class _FirstCompilation(event.Listener):
    """Gives notice of the first compilation; loading from the cache does not count."""

    def __init__(self, say: Callable[[str], None]) -> None:
        self._say = say
        self._said: set[str] = set()

    def on_start(self, event: event.Event) -> None:  # noqa: ARG002
        if not self._said:
            self.give_notice(why_not_kept() or _TEXT)

    def on_end(self, event: event.Event) -> None:
        """Ignore the end, after which the progress of the run follows at once."""

    def give_notice(self, text: str | None) -> None:
        """Give notice with a sentence, once."""
        if text is not None and text not in self._said:
            self._said.add(text)
            self._say(text)

    @property
    def has_compiled(self) -> bool:
        """True if anything was compiled."""
        return bool(self._said)


@contextmanager
def compilation_announced(say: Callable[[str], None]) -> Iterator[None]:
    """Give notice of the first compilation in the context.

    A second notice follows if the compiled kernels cannot be cached, as on a full disk.

    Parameters
    ----------
    say
        Called with each sentence.
    """
    listener = _FirstCompilation(say)
    event.register(_COMPILE, listener)
    try:
        yield
    finally:
        event.unregister(_COMPILE, listener)
        if listener.has_compiled:
            listener.give_notice(why_not_kept())
