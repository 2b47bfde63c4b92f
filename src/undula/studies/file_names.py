"""Names of files and folders as users give them: refused where no file can have them."""

import errno
import os
from pathlib import Path

from undula.errors import InputError

_LONGEST = 60
_CURES = {
    errno.EACCES: "give a name in a folder that is open to you",
    errno.ENAMETOOLONG: "give a shorter name",
    errno.ELOOP: "mend the links on the way, or give another name",
}


def any_name(text: str) -> Path:
    """Return a name as a path, of a file or a folder that is there or is to be made.

    Raises
    ------
    InputError
        Nothing can have this name, or it lies where this process cannot look.
    """
    if not text:
        raise InputError("an empty text is no name; give the name of a file or folder")
    if "\0" in text:
        raise InputError(f"{text!r} holds the character NUL, which no name can; leave it out")
    try:
        os.lstat(text)
    except (FileNotFoundError, NotADirectoryError):
        pass  # told by whoever looks for it, or is to make it
    except OSError as error:
        shown = text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."
        cure = _CURES.get(error.errno or 0, "give another name")
        raise InputError(f"{shown} cannot be used ({error.strerror}); {cure}") from None
    return Path(text)


def file_name(text: str) -> Path:
    """Return the name of a file as a path, as `any_name` does.

    Raises
    ------
    InputError
        Nothing can have this name, or only a folder can.
    """
    path = any_name(text)
    if path.name in ("", ".."):
        raise InputError(f"{text} is a folder; give the name of a file")
    return path
