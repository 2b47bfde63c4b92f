"""Standard output and standard error as they really are: missing, closed, full, or not Unicode.

Nothing that is computed is lost for want of a place to tell it: writing to a guarded stream never
fails. What a stream cannot print is told in plain letters, an answer without standard output goes
to standard error, and a standard output that refuses its content is told of at the end.
"""

import errno
import io
import os
import sys
import unicodedata
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import TextIO

#: What stands for characters that an encoding lacks; accents are taken off without a table.
_PLAIN = {
    "±": "+-", "×": "x", "·": "*", "−": "-", "–": "-", "—": "-", "…": "...", "°": " deg",
    "²": "^2", "³": "^3", "⁴": "^4", "⁵": "^5", "⁶": "^6", "⁰": "^0", "¹": "^1", "⁻": "^-",
    "≤": "<=", "≥": ">=", "≈": "~", "≠": "!=", "→": "->", "←": "<-", "∞": "inf", "√": "sqrt",
    "⊥": "perp", "∥": "par", "\u2018": "'", "\u2019": "'", "“": '"', "”": '"', "µ": "u", "│": "|",
    "─": "-", "━": "-", "╭": "+", "╮": "+", "╰": "+", "╯": "+", "•": "*",
    "\N{NO-BREAK SPACE}": " ", "\N{THIN SPACE}": " ", "\N{NARROW NO-BREAK SPACE}": " ",
}  # fmt: skip
#: Greek letters have their names as their plain letters.
_GREEK = "GREEK SMALL LETTER ", "GREEK CAPITAL LETTER "
_CLOSED_PIPE = (errno.EPIPE, errno.ESHUTDOWN)


class Guarded(io.TextIOBase):
    """A text stream whose writing never fails.

    Parameters
    ----------
    stream
        The stream behind it; None for none, which swallows everything.

    Attributes
    ----------
    trouble
        Why the stream refused its content; None if it did not, or if its reader had enough.
    """

    def __init__(self, stream: TextIO | None) -> None:
        self._stream = stream
        self.trouble: OSError | None = None

    @property
    def encoding(self) -> str:  # type: ignore[override]
        """The encoding of the stream behind it."""
        return getattr(self._stream, "encoding", None) or "utf-8"

    def writable(self) -> bool:
        """Return True: it takes everything."""
        return True

    def isatty(self) -> bool:
        """Return whether a terminal is behind it."""
        try:
            return self._stream is not None and self._stream.isatty()
        except (OSError, ValueError):
            return False

    def fileno(self) -> int:
        """Return the number of the file behind it."""
        if self._stream is None:
            raise io.UnsupportedOperation("there is no file behind this stream")
        return self._stream.fileno()

    def write(self, text: str) -> int:
        """Write a text, in plain letters where the encoding lacks others."""
        told = printable(text, self.encoding)
        self._attempt(lambda stream: stream.write(told))
        return len(text)

    def flush(self) -> None:
        """Hand on what is buffered."""
        self._attempt(lambda stream: stream.flush())

    def _attempt(self, act: Callable[[TextIO], object]) -> None:
        if self._stream is None:
            return
        try:
            act(self._stream)
        except OSError as error:
            if error.errno not in _CLOSED_PIPE:
                self.trouble = error
            _discard_the_rest(self._stream)
            self._stream = None
        except ValueError:
            # Closed by whoever has called us.
            self._stream = None


def printable(text: str, encoding: str) -> str:
    """Return a text with plain letters in place of those that an encoding does not have."""
    try:
        text.encode(encoding)
    except UnicodeEncodeError:
        return "".join(_plain(letter, encoding) for letter in text)
    return text


def out() -> Guarded:
    """Return standard output; standard error in its place if there is none."""
    return _guarded(sys.stdout if _is_open(sys.stdout) else sys.stderr)


def err() -> Guarded:
    """Return standard error; what swallows everything if there is none."""
    return _guarded(sys.stderr)


@contextmanager
def guarded_streams() -> Iterator[Guarded]:
    """Guard standard output and standard error for all who write to them.

    Yields
    ------
    Guarded
        Standard output, whose `trouble` tells at the end whether it took its content.
    """
    _occupy_the_first_files()
    before = sys.stdout, sys.stderr
    answers = out()
    sys.stdout, sys.stderr = answers, err()
    try:
        yield answers
    finally:
        answers.flush()
        sys.stderr.flush()
        sys.stdout, sys.stderr = before


def _guarded(stream: TextIO | None) -> Guarded:
    return stream if isinstance(stream, Guarded) else Guarded(stream)


def _is_open(stream: TextIO | None) -> bool:
    return stream is not None and not stream.closed


def _plain(letter: str, encoding: str) -> str:
    try:
        letter.encode(encoding)
    except UnicodeEncodeError:
        plain = _PLAIN.get(letter) or _greek(letter) or unicodedata.normalize("NFKD", letter)
        return plain.encode(encoding, "ignore").decode(encoding) or "?"
    return letter


def _greek(letter: str) -> str:
    name = unicodedata.name(letter, "")
    return name.removeprefix(_GREEK[0]).lower() if name.startswith(_GREEK) else ""


def _discard_the_rest(stream: TextIO) -> None:
    """Send what is left in a buffer nowhere: Python would complain of it again at its end."""
    with suppress(OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)


def _occupy_the_first_files() -> None:
    """Open nothing in the place of streams that are closed.

    The next file that is opened would get the number of standard error, and whatever a library
    complains of would be written into it.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            with suppress(OSError):
                os.set_inheritable(os.open(os.devnull, os.O_RDWR), True)
