"""Bytes of figure files, with the mark of undula and independent of the time."""

from collections.abc import Mapping
from io import BytesIO
from typing import Any

import matplotlib as mpl

_DOTS_PER_INCH = 150
_MARK = "undula"
_METADATA: Mapping[str, Mapping[str, str | None]] = {
    "png": {"Software": _MARK},
    "pdf": {"Creator": _MARK, "CreationDate": None},
    "svg": {"Creator": _MARK, "Date": None},
}


def figure_bytes(figure: Any, ending: str) -> bytes:
    """Return the content of a file of a matplotlib figure.

    Parameters
    ----------
    figure
        The figure.
    ending
        Ending of the file: .png, .pdf or .svg.
    """
    image, kind = BytesIO(), ending[1:].lower()
    # With a fixed salt, the names of parts in an SVG file are not random.
    with mpl.rc_context({"svg.hashsalt": _MARK}):
        figure.savefig(image, format=kind, dpi=_DOTS_PER_INCH, metadata=dict(_METADATA[kind]))
    return image.getvalue()
