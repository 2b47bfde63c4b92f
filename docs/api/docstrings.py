"""How the pages of the Python interface read docstrings, as an extension of griffe."""

import re
from typing import Any

import griffe

#: What griffe would take for a tuple, and marks of another renderer that it would show.
_REWRITTEN = ((r"ndarray, shape \(", "ndarray of shape ("), (r":(func|meth|class):`", "`"))


class AsWritten(griffe.Extension):
    """Types told in words stay as they are written, and each name has the default of its own."""

    def on_object(self, *, obj: griffe.Object, **_: Any) -> None:
        """Put what griffe would misread into words that it reads."""
        if obj.docstring:
            for misread, words in _REWRITTEN:
                obj.docstring.value = re.sub(misread, words, obj.docstring.value)

    def on_function(self, *, func: griffe.Function, **_: Any) -> None:
        """Give parameters that share a line their own defaults; griffe gives all the first's."""
        for section in func.docstring.parsed if func.docstring else ():
            if isinstance(section, griffe.DocstringSectionParameters):
                for one in section.value:
                    if one.name in func.parameters:
                        one.value = func.parameters[one.name].default
