"""Signals that ask a program to end: Ctrl-C, and what batch systems and closed terminals send."""

import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

#: Ctrl-C, the polite request of `kill`, of time limits and batch systems, and a terminal's end.
ENDINGS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
#: Seconds in which a signal that comes again is the same request: some are sent to a process and
#: once more to its group.
_SAME = 1.0


@contextmanager
def endings_heard() -> Iterator[None]:
    """Have all these signals raise KeyboardInterrupt in this block, as Ctrl-C does by itself.

    One that was to be ignored when the program was started, as by ``nohup``, stays ignored; so does
    one for which the program has done something of its own.
    """
    changed = []
    if threading.current_thread() is threading.main_thread():
        changed = [one for one in ENDINGS if signal.getsignal(one) is signal.SIG_DFL]
    for one in changed:
        signal.signal(one, signal.default_int_handler)
    try:
        yield
    finally:
        for one in changed:
            signal.signal(one, signal.SIG_DFL)


class _Note:
    """Notes a signal; one that comes later, too, raises KeyboardInterrupt."""

    def __init__(self, since: float | None) -> None:
        self.since = since

    def __call__(self, signum: int, frame: FrameType | None) -> None:
        now = time.monotonic()
        if self.since is None:
            self.since = now
        elif now - self.since > _SAME:
            signal.default_int_handler(signum, frame)


@contextmanager
def interruptible() -> Iterator[Callable[[], bool]]:
    """Note a signal instead of raising KeyboardInterrupt amid a step; a second one does raise.

    Of the signals these are noted that would raise it: Ctrl-C, and in a program that is within
    `endings_heard` the others. A block within another knows what that
    one has noted, and tells it at its end what it has noted itself.
    """
    if threading.current_thread() is not threading.main_thread():
        yield lambda: False
        return
    before = {one: signal.getsignal(one) for one in ENDINGS}
    outer = [handler for handler in before.values() if isinstance(handler, _Note)]
    note = _Note(next((one.since for one in outer if one.since is not None), None))
    heard = {one: handler for one, handler in before.items() if _raises(handler)}
    for one in heard:
        signal.signal(one, note)
    try:
        yield lambda: note.since is not None
    finally:
        for one, handler in heard.items():
            signal.signal(one, handler)
            if isinstance(handler, _Note) and handler.since is None:
                handler.since = note.since


def _raises(handler: Any) -> bool:
    return handler is signal.default_int_handler or isinstance(handler, _Note)
