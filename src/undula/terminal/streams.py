"""Guarded standard streams, which may be missing, closed, full or not Unicode.

Writing to a guarded stream never fails, so that no result is lost with its output. Characters that
an encoding lacks are replaced by plain letters, an answer without standard output is written to
standard error, and a standard output that refuses its content is reported at the end.
"""

import errno
import io
import os
import sys
import unicodedata
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import TextIO

#: Replacements of characters that an encoding lacks; accents are removed without a table.
_REPLACEMENTS = {
    "±": "+-", "×": "x", "·": "*", "−": "-", "–": "-", "—": "-", "…": "...", "°": " deg",
    "²": "^2", "³": "^3", "⁴": "^4", "⁵": "^5", "⁶": "^6", "⁰": "^0", "¹": "^1", "⁻": "^-",
    "≤": "<=", "≥": ">=", "≈": "~", "≠": "!=", "→": "->", "←": "<-", "∞": "inf", "√": "sqrt",
    "⊥": "perp", "∥": "par", "\u2018": "'", "\u2019": "'", "“": '"', "”": '"', "µ": "u", "│": "|",
    "─": "-", "━": "-", "╭": "+", "╮": "+", "╰": "+", "╯": "+", "•": "*",
    "\N{NO-BREAK SPACE}": " ", "\N{THIN SPACE}": " ", "\N{NARROW NO-BREAK SPACE}": " ",
}  # fmt: skip
#: Greek letters are replaced by their names.
_GREEK = "GREEK SMALL LETTER ", "GREEK CAPITAL LETTER "
_CLOSED_PIPE = (errno.EPIPE, errno.ESHUTDOWN)


class Guarded(io.TextIOBase):
    """A text stream whose writing never fails.

    Parameters
    ----------
    stream
        The underlying stream; None to discard all output.

    Attributes
    ----------
    trouble
        Error with which the stream refused its content; None without an error, and for a pipe that
        its reader has closed.
    """

    def __init__(self, stream: TextIO | None) -> None:
        self._stream = stream
        self.trouble: OSError | None = None

    @property
    def encoding(self) -> str:  # type: ignore[override]
        """The encoding of the underlying stream."""
        return getattr(self._stream, "encoding", None) or "utf-8"

    def writable(self) -> bool:
        """Return True, since writing never fails."""
        return True

    def isatty(self) -> bool:
        """Return True if the underlying stream is a terminal."""
        try:
            return self._stream is not None and self._stream.isatty()
        except (OSError, ValueError):
            return False

    def fileno(self) -> int:
        """Return the file descriptor of the underlying stream."""
        if self._stream is None:
            raise io.UnsupportedOperation("there is no file behind this stream")
        return self._stream.fileno()

    def write(self, text: str) -> int:
        """Write a text; characters that the encoding lacks are replaced."""
        encodable = printable(text, self.encoding)
        self._attempt(lambda stream: stream.write(encodable))
        return len(text)

    def flush(self) -> None:
        """Flush the underlying stream."""
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
            # The caller has closed the stream.
            self._stream = None


def printable(text: str, encoding: str) -> str:
    """Return a text with plain letters in place of characters that an encoding lacks.

    Parameters
    ----------
    text
        The text.
    encoding
        Name of the encoding.
    """
    try:
        text.encode(encoding)
    except UnicodeEncodeError:
        return "".join(_plain(letter, encoding) for letter in text)
    return text


def out() -> Guarded:
    """Return standard output, guarded; standard error if standard output is closed."""
    return _guarded(sys.stdout if _is_open(sys.stdout) else sys.stderr)


def err() -> Guarded:
    """Return standard error, guarded; a stream that discards all output if it is closed."""
    return _guarded(sys.stderr)


@contextmanager
def guarded_streams() -> Iterator[Guarded]:
    """Replace standard output and standard error by guarded streams.

    Yields
    ------
    Guarded
        Standard output; its `trouble` is set if it refused its content.
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
        plain = _REPLACEMENTS.get(letter) or _greek(letter) or unicodedata.normalize("NFKD", letter)
        return plain.encode(encoding, "ignore").decode(encoding) or "?"
    return letter


def _greek(letter: str) -> str:
    name = unicodedata.name(letter, "")
    return name.removeprefix(_GREEK[0]).lower() if name.startswith(_GREEK) else ""


def _discard_the_rest(stream: TextIO) -> None:
    """Redirect buffered output to the null device; Python would fail on it again at its end."""
    with suppress(OSError, ValueError):
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, stream.fileno())
        os.close(null)


def _occupy_the_first_files() -> None:
    """Open the null device in place of closed standard streams.

    Otherwise the next opened file would get the descriptor of standard error, and messages of
    libraries would be written into it.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            with suppress(OSError):
                os.set_inheritable(os.open(os.devnull, os.O_RDWR), True)
