"""A record as HTML, for notebooks: a table of its facts and a picture of its figure."""

import base64
from html import escape
from io import BytesIO

from matplotlib.figure import Figure

from undula.analysis.record import Fact, Record

#: Resolution of the picture, and pixels of the page for an inch of it: type stays readable.
_DPI, _PIXELS = 140, 80
_NAME = "text-align:left;vertical-align:top;padding:2px 10px 2px 0"
_VALUE = "text-align:left;padding:2px 0;overflow-wrap:anywhere;white-space:normal"


def as_html(record: Record) -> str:
    """Return a record as HTML without scripts: its line, a table and a picture.

    Parameters
    ----------
    record : Record
        Any result.
    """
    rows = "".join(_row(name, fact) for name, fact in record.facts().items() if _is_shown(fact))
    table = f'<table style="border-collapse:collapse">{rows}</table>'
    kind = escape(type(record).__name__)
    return (
        '<div style="display:flex;flex-wrap:wrap;gap:12px;align-items:flex-start;max-width:100%">'
        f'<div style="min-width:0"><b>{kind}</b>{table}</div>{_picture(record)}</div>'
    )


def _is_shown(fact: Fact) -> bool:
    return fact.value is not None and fact.value != ""


def _row(name: str, fact: Fact) -> str:
    words = escape(name.replace("_", " "))
    return f'<tr><td style="{_NAME}">{words}</td><td style="{_VALUE}">{escape(str(fact))}</td></tr>'


def _picture(record: Record) -> str:
    if not record.has_figure:
        return ""
    figure = record.plot()
    if not isinstance(figure, Figure):
        return ""
    image = BytesIO()
    figure.savefig(image, format="png", dpi=_DPI)
    content = base64.b64encode(image.getvalue()).decode("ascii")
    label, width = escape(str(record)), _PIXELS * figure.get_figwidth()
    return (
        f'<img src="data:image/png;base64,{content}" alt="{label}"'
        f' style="width:{round(width)}px;max-width:100%;height:auto">'
    )
