"""Estimate of the disk space that a stored sweep needs, checked before the sweep begins."""

import shutil
from pathlib import Path

import numpy as np

from undula.analysis.runs.last_period import INSTANTS, SHAPES
from undula.analysis.runs.memory_needed import size_text
from undula.errors import InputError
from undula.inputs.build import build_model
from undula.inputs.input import parse_input
from undula.schema.sweep_variables import columns_of
from undula.sweeps.sweep import Sweep

#: Compressed over original size of the numbers of a motion, at best.
BEST_COMPRESSION = 0.5


def refuse_too_large_a_store(path: Path, sweep: Sweep) -> None:
    """Refuse a sweep whose results cannot fit on the disk.

    Parameters
    ----------
    path
        Folder of the store, which need not exist.
    sweep
        The sweep.

    Raises
    ------
    InputError
        They need more than the free space.
    """
    needed, free = needed_room(sweep), _free(path)
    if free is not None and needed > free:
        cure = "study.keep = 'verdict' or " if sweep.keep != "verdict" else ""
        raise InputError(
            f"{sweep.count} points with study.keep = '{sweep.keep}' take {size_text(needed)} on the"
            f" disk, and {size_text(free)} are free at {path}; use {cure}fewer points"
        )


def needed_room(sweep: Sweep) -> int:
    """Return the least disk space that a sweep needs [bytes]."""
    columns = columns_of(sweep.label, "verdict", sweep.undecided)
    # Texts repeat themselves and compress to little.
    point = sum(np.dtype(column.dtype).itemsize for column in columns if column.dtype == "float64")
    return int(BEST_COMPRESSION * sweep.count * (point + 8 * _numbers_kept(sweep)))


def _numbers_kept(sweep: Sweep) -> int:
    """Return how many numbers of a motion are stored for each point."""
    if sweep.keep == "verdict":
        return 0
    wanted = parse_input(sweep.tables(0))
    nodes = 3 * (build_model(wanted).links + 1)
    return wanted.time.samples * nodes if sweep.keep == "run" else SHAPES * nodes + 3 * INSTANTS


def _free(path: Path) -> int | None:
    """Return the free space at the place of a store [bytes], None where it is unknown."""
    folders = (path.absolute(), *path.absolute().parents)
    existing = next((folder for folder in folders if folder.exists()), None)
    try:
        return None if existing is None else shutil.disk_usage(existing).free
    except OSError:
        return None
