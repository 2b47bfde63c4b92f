"""The mark of undula in its output files, by which it recognises files that it may replace.

Results carry the attribute `undula_format`; figures, movies and pages are marked by their views.
"""

import mmap
import os
import stat
from pathlib import Path

#: Bytes of the mark in a file, by the ending of its name.
_MARKS = {
    ".nc": b"undula_format",
    ".png": b"tEXtSoftware\0undula",
    ".pdf": b"/Creator (undula)",
    ".svg": b"<dc:title>undula</dc:title>",
    ".mp4": b"\xa9cmt\0\0\0\x16data\0\0\0\1\0\0\0\0undula",
    ".html": b'<meta name="generator" content="undula">',
}


def carries_mark(path: Path) -> bool:
    """Return True if the content of a file carries the mark of undula.

    Links are not followed and never carry it.

    Parameters
    ----------
    path
        The file; the ending of its name determines its format.
    """
    mark = _MARKS.get(path.suffix.lower(), _MARKS[".nc"])  # results may have any ending
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    except OSError:
        return False
    with open(descriptor, "rb") as file:
        about = os.fstat(descriptor)
        if not stat.S_ISREG(about.st_mode) or about.st_size == 0:
            return False
        with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
            return content.find(mark) >= 0
