"""The mark of undula in files that it makes: by it they are known for ours, and may be replaced.

Results are marked by `undula_format`, figures, movies and pages by the views that write them.
"""

import mmap
import os
import stat
from pathlib import Path

#: How the mark reads in the bytes of a file, by its ending.
_MARKS = {
    ".nc": b"undula_format",
    ".png": b"tEXtSoftware\0undula",
    ".pdf": b"/Creator (undula)",
    ".svg": b"<dc:title>undula</dc:title>",
    ".mp4": b"\xa9cmt\0\0\0\x16data\0\0\0\1\0\0\0\0undula",
    ".html": b'<meta name="generator" content="undula">',
}


def carries_mark(path: Path) -> bool:
    """Tell whether a file is one that undula has made, as its content tells.

    A link never is, wherever it leads.

    Parameters
    ----------
    path
        Its name, whose ending tells what it would be.
    """
    mark = _MARKS.get(path.suffix.lower(), _MARKS[".nc"])  # results may be called anything
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
