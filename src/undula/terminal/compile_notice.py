"""A word to the user while kernels are compiled, and none when they come from the cache."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from numba.core import event

from undula.jit.cache import trouble

_COMPILE = "numba:compile"
_TEXT = "compiling the kernels, once per installation; this takes about half a minute"


class _FirstCompilation(event.Listener):
    """Says its sentence at the first compilation; loading from the cache is none."""

    def __init__(self, say: Callable[[str], None]) -> None:
        self._say = say
        self._said: set[str] = set()

    def on_start(self, event: event.Event) -> None:  # noqa: ARG002
        if not self._said:
            self.tell(trouble() or _TEXT)

    def on_end(self, event: event.Event) -> None:
        """Ignore the end: progress of the run follows at once."""

    def tell(self, text: str | None) -> None:
        """Say a sentence that has not been said."""
        if text is not None and text not in self._said:
            self._said.add(text)
            self._say(text)

    @property
    def heard(self) -> bool:
        """Whether anything was compiled."""
        return bool(self._said)


@contextmanager
def compilation_announced(say: Callable[[str], None]) -> Iterator[None]:
    """Call `say` with one sentence as soon as something has to be compiled in the block.

    Then with another if what was compiled could not be kept, as on a full disk.
    """
    listener = _FirstCompilation(say)
    event.register(_COMPILE, listener)
    try:
        yield
    finally:
        event.unregister(_COMPILE, listener)
        if listener.heard:
            listener.tell(trouble())
