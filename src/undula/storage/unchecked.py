"""What is said of stored results that are not known to be whole."""

import warnings
from pathlib import Path


class StoredWarning(UserWarning):
    """A stored result is read that carries no checksum, or of which some parts are damaged."""


def warn_unchecked(path: Path) -> None:
    """Say of a file or a store that damage would not be seen."""
    _warn(
        f"{path} carries no checksum, since other software or an earlier version stored it: it is"
        " taken as it is, and damage would not be seen"
    )


def warn_damaged(path: Path, points: int) -> None:
    """Say of a store that some of its points are damaged."""
    _warn(
        f"{path} is damaged: {points} of its points count as not done; undula sweep does them again"
    )


def _warn(sentence: str) -> None:
    # As of the line that called a reader of studies, which calls these functions.
    warnings.warn(sentence, StoredWarning, stacklevel=5)
