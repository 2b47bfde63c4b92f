"""Errors that a user can put right, told apart from faults of the program."""

import errno
import os

from undula.errors import InputError

#: Errors of files that lie in the place where they are, not in the program.
_CLOSED = (errno.EACCES, errno.EPERM, errno.EROFS, errno.ENAMETOOLONG, errno.ELOOP)


def sentence_of(error: Exception) -> str | None:
    """Return what to tell the user of an error, None of one that is a fault of the program.

    Parameters
    ----------
    error
        What ended a command: bad input, a wrong option, a file in a place that is closed, or
        equations without one solution.
    """
    # A wrong option, too, is bad input; its class has no public name in all versions of typer.
    told = getattr(error, "format_message", None)
    if told is not None:
        return str(told())
    if isinstance(error, OSError) and error.filename is not None and error.errno in _CLOSED:
        return (
            f"cannot use {os.fsdecode(error.filename)} ({error.strerror}); open it to yourself, or"
            " give another place"
        )
    if type(error).__name__ == "LinAlgError":  # numpy's, which is not imported for this
        return (
            f"a system of equations has no unique solution for this model ({error}); change its"
            " numbers a little, or take more links"
        )
    return str(error) if isinstance(error, InputError) else None
