"""Distinction between mistakes that a user can correct and faults of the program."""

import errno
import os

from undula.errors import InputError

#: Errors of files that depend on their folder, not on the program.
_CLOSED = (errno.EACCES, errno.EPERM, errno.EROFS, errno.ENAMETOOLONG, errno.ELOOP)


def sentence_of(error: Exception) -> str | None:
    """Return the sentence for the user on an error; None for a fault of the program.

    Parameters
    ----------
    error
        The error that ended a command: bad input, a wrong option, a file without permission, or
        equations without a unique solution.
    """
    # The class of wrong options has no public name in some versions of typer.
    format_message = getattr(error, "format_message", None)
    if format_message is not None:
        if getattr(error, "option_name", None) == "--csv":
            command = getattr(getattr(error, "ctx", None), "info_name", None)
            return f"undula {command} answers with no table; leave out --csv, or use --json"
        return str(format_message())
    if isinstance(error, OSError) and error.filename is not None and error.errno in _CLOSED:
        return (
            f"cannot use {os.fsdecode(error.filename)} ({error.strerror}); open it to yourself, or"
            " give another place"
        )
    if type(error).__name__ == "LinAlgError":  # of numpy, which is not imported only for this check
        return (
            f"a system of equations has no unique solution for this model ({error}); change its"
            " numbers a little, or take more links"
        )
    return str(error) if isinstance(error, InputError) else None
