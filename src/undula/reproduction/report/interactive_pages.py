"""Interactive pages inside the report: compressed, with their common library only once."""

import base64
import gzip
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from undula.errors import InputError
from undula.reproduction.claims.catalogue import Item
from undula.views.sweep.page import plotting_library

#: Placeholder of the library in a page until the page is opened.
_MARK = "/*the plotting library*/"


def packed_pages(item: Item, answers: Mapping[str, Any]) -> dict[str, str]:
    """Return the pages of an item by name of the figure, compressed without their library.

    Parameters
    ----------
    item
        The item.
    answers
        Stored answers of its tasks.

    Raises
    ------
    InputError
        The file of a page is missing.
    """
    pages = {}
    for figure in item.figures:
        if figure.page is None or not figure.asks_for_page <= answers.keys():
            continue
        folders = {name: answer.folder for name, answer in answers.items()}
        path = Path(figure.page.format_map(folders))
        try:
            page = path.read_text("utf-8")
        except OSError as error:
            raise InputError(f"{path} is gone; run the same command with --fresh") from error
        pages[figure.name] = _packed(page.replace(plotting_library(), _MARK))
    return pages


def packed_library() -> str:
    """Return the library of all pages, compressed."""
    return _packed(plotting_library())


def _packed(text: str) -> str:
    """Return a text compressed, in letters and independent of the time."""
    return base64.b64encode(gzip.compress(text.encode(), mtime=0)).decode("ascii")
