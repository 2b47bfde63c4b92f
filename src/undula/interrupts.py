"""Signals that ask a program to end: Ctrl-C, and those of batch systems and closed terminals."""

import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

#: Signals of Ctrl-C, of `kill`, time limits and batch systems, and of a closed terminal.
END_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
#: Time in which a repeated signal is the same request [s]: some signals are sent to a process and
#: again to its group.
_SAME_REQUEST = 1.0


@contextmanager
def end_signals_raise() -> Iterator[None]:
    """Let all `END_SIGNALS` raise KeyboardInterrupt in a block, as Ctrl-C does by default.

    A signal that is ignored, as by ``nohup``, or that has another handler, is left alone.
    """
    changed = []
    if threading.current_thread() is threading.main_thread():
        changed = [signum for signum in END_SIGNALS if signal.getsignal(signum) is signal.SIG_DFL]
    for signum in changed:
        signal.signal(signum, signal.default_int_handler)
    try:
        yield
    finally:
        for signum in changed:
            signal.signal(signum, signal.SIG_DFL)


class _Recorder:
    """Handler that records the first signal, and raises KeyboardInterrupt at a later one."""

    def __init__(self, since: float | None) -> None:
        self.since = since

    def __call__(self, signum: int, frame: FrameType | None) -> None:
        now = time.monotonic()
        if self.since is None:
            self.since = now
        elif now - self.since > _SAME_REQUEST:
            signal.default_int_handler(signum, frame)


@contextmanager
def interruptible() -> Iterator[Callable[[], bool]]:
    """Record a signal in a block instead of raising KeyboardInterrupt; a second signal raises it.

    Recorded are the signals that would raise it: Ctrl-C, and the others within `end_signals_raise`.
    Nested blocks share what they have recorded. In threads other than the main thread nothing is
    recorded.

    Yields
    ------
    callable
        Returns True once a signal was recorded.
    """
    if threading.current_thread() is not threading.main_thread():
        yield lambda: False
        return
    before = {signum: signal.getsignal(signum) for signum in END_SIGNALS}
    outer = [handler for handler in before.values() if isinstance(handler, _Recorder)]
    recorder = _Recorder(
        next((handler.since for handler in outer if handler.since is not None), None)
    )
    recorded = {signum: handler for signum, handler in before.items() if _raises(handler)}
    for signum in recorded:
        signal.signal(signum, recorder)
    try:
        yield lambda: recorder.since is not None
    finally:
        for signum, handler in recorded.items():
            signal.signal(signum, handler)
            if isinstance(handler, _Recorder) and handler.since is None:
                handler.since = recorder.since


def _raises(handler: Any) -> bool:
    return handler is signal.default_int_handler or isinstance(handler, _Recorder)
