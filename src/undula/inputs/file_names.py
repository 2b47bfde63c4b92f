"""Checks of file and folder names that users give."""

import errno
import os
from pathlib import Path

from undula.errors import InputError

#: Longest part of a path on usual file systems [bytes]; longest name shown [characters].
_LONGEST_PART, _LONGEST_SHOWN = 255, 60
_CURES = {
    errno.EACCES: "give a name in a folder that is open to you",
    errno.ENAMETOOLONG: "give a shorter name",
    errno.ELOOP: "mend the links on the way, or give another name",
}


def any_name(text: str) -> Path:
    """Return the name of a file or folder as a path, whether it exists or not.

    Raises
    ------
    InputError
        No file can have this name, or this process has no access to its folder.
    """
    if not text:
        raise InputError("an empty text is no name; give the name of a file or folder")
    if "\0" in text:
        raise InputError(f"{text!r} holds the character NUL, which no name can; leave it out")
    try:
        # The system checks this only if all folders of the path exist.
        if any(len(os.fsencode(part)) > _LONGEST_PART for part in Path(text).parts):
            raise OSError(errno.ENAMETOOLONG, os.strerror(errno.ENAMETOOLONG))
        os.lstat(text)
    except (FileNotFoundError, NotADirectoryError):
        pass  # reported where the file is read or written
    except OSError as error:
        shown = text if len(text) <= _LONGEST_SHOWN else f"{text[:_LONGEST_SHOWN]}..."
        cure = _CURES.get(error.errno or 0, "give another name")
        raise InputError(f"{shown} cannot be used ({error.strerror}); {cure}") from None
    return Path(text)


def file_name(text: str) -> Path:
    """Return the name of a file as a path, as `any_name` does.

    Raises
    ------
    InputError
        No file can have this name, or it names a folder.
    """
    path = any_name(text)
    if path.name in ("", ".."):
        raise InputError(f"{text} is a folder; give the name of a file")
    return path
