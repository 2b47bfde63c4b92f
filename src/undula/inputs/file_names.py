"""Names of files and folders as users give them: refused where no file can have them."""

import errno
import os
from pathlib import Path

from undula.errors import InputError

#: Bytes of a file's name without its folder, on all usual file systems; letters of one when told.
_LONGEST_PART, _LONGEST_SHOWN = 255, 60
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
        # The system sees this only where the folders on the way are there.
        if any(len(os.fsencode(part)) > _LONGEST_PART for part in Path(text).parts):
            raise OSError(errno.ENAMETOOLONG, os.strerror(errno.ENAMETOOLONG))
        os.lstat(text)
    except (FileNotFoundError, NotADirectoryError):
        pass  # told by whoever looks for it, or is to make it
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
        Nothing can have this name, or only a folder can.
    """
    path = any_name(text)
    if path.name in ("", ".."):
        raise InputError(f"{text} is a folder; give the name of a file")
    return path
