"""What a stored study takes of a disk, told before it begins."""

import shutil
from pathlib import Path

import numpy as np

from undula.analysis.runs.last_period import INSTANTS, SHAPES
from undula.analysis.runs.memory_needed import size_text
from undula.errors import InputError
from undula.inputs.build import build_model
from undula.inputs.input import parse_input
from undula.schema.sweep_variables import columns_of
from undula.sweeps.sweep import Study

#: Part of their size to which numbers of a motion shrink at best when they are compressed.
PACKED = 0.5


def refuse_too_large_a_store(path: Path, study: Study) -> None:
    """Refuse a study whose results cannot fit on the disk.

    Raises
    ------
    InputError
        They would take more than is free.
    """
    needed, free = needed_room(study), _free(path)
    if free is not None and needed > free:
        cure = "study.keep = 'verdict' or " if study.keep != "verdict" else ""
        raise InputError(
            f"{study.count} points with study.keep = '{study.keep}' take {size_text(needed)} on the"
            f" disk, and {size_text(free)} are free at {path}; use {cure}fewer points"
        )


def needed_room(study: Study) -> int:
    """Return the bytes that a study takes on a disk at least."""
    columns = columns_of(study.label, "verdict", study.undecided)
    # Texts repeat themselves and shrink to little.
    point = sum(np.dtype(column.dtype).itemsize for column in columns if column.dtype == "float64")
    return int(PACKED * study.count * (point + 8 * _numbers_kept(study)))


def _numbers_kept(study: Study) -> int:
    """Return how many numbers of a motion are kept of each point."""
    if study.keep == "verdict":
        return 0
    wanted = parse_input(study.tables(0))
    nodes = 3 * (build_model(wanted).links + 1)
    return wanted.time.samples * nodes if study.keep == "run" else SHAPES * nodes + 3 * INSTANTS


def _free(path: Path) -> int | None:
    """Return the bytes that are free where a store is to be, None where that is not known."""
    there = next((one for one in (path.absolute(), *path.absolute().parents) if one.exists()), None)
    try:
        return None if there is None else shutil.disk_usage(there).free
    except OSError:
        return None
