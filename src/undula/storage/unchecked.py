"""Warnings on stored results that carry no checksum or are damaged."""

import warnings
from pathlib import Path


class StoredWarning(UserWarning):
    """Warning on a stored result that carries no checksum, or that is damaged in part.

    Examples
    --------
    >>> import warnings
    >>> import undula as un
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("error", un.StoredWarning)  # unchecked results are refused here
    """


def warn_unchecked(path: Path) -> None:
    """Warn that damage of a file or a store would not be detected."""
    _warn(
        f"{path} carries no checksum, since other software or an earlier version stored it: it is"
        " taken as it is, and damage would not be seen"
    )


def warn_damaged(path: Path, points: int) -> None:
    """Warn that points of a store are damaged.

    Parameters
    ----------
    path
        The store.
    points
        Number of damaged points.
    """
    _warn(
        f"{path} is damaged: {points} of its points count as not done; undula sweep does them again"
    )


def _warn(sentence: str) -> None:
    # The level of the line that called a reader of sweeps, such as `undula.load_sweep`.
    warnings.warn(sentence, StoredWarning, stacklevel=5)
