"""Records: the common face of all results, in a shell, in a notebook and for other tools.

A record is shown in one line. It states its numbers as facts, each with unit and error, of which
the table in a notebook and the labelled dataset are made. Figures and files belong to packages that
know records, not the other way round: a record names the function that draws or stores it.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import xarray as xr

from undula.errors import InputError


@dataclass(frozen=True)
class Fact:
    """A number or a word that a record states.

    Attributes
    ----------
    value : float, int, bool, str or None
        Its value, None without one.
    unit : str
        Its unit, empty for none.
    error : float or None
        Its estimated error, in the same unit; None without one.
    on_links : int or None
        Number of links, if the error is on these links alone and not against the body.
    """

    value: Any
    unit: str = ""
    error: float | None = None
    on_links: int | None = None

    def __str__(self) -> str:
        """Return value, error and unit; an error on given links alone is no ±."""
        if not isinstance(self.value, float):
            return "none" if self.value is None else str(self.value)
        error = "" if self.error is None else f" ± {self.error:.1g}"
        if self.error is not None and self.on_links is not None:
            known = f"({self.on_links} links, to {self.error:.1g})"
            return " ".join(filter(None, (f"{self.value:.8g}", self.unit, known)))
        return f"{self.value:.8g}{error} {self.unit}".rstrip()


class Record:
    """The common face of results.

    A record implements `__str__` (one line) and `facts`, and names its figure.
    """

    #: The function that draws it, as "module:function"; empty for a record without a figure.
    _figure: ClassVar[str] = ""

    @property
    def has_figure(self) -> bool:
        """True if `plot` draws something."""
        return bool(self._figure)

    def facts(self) -> Mapping[str, Fact]:
        """Return the numbers of the record by name."""
        raise NotImplementedError

    def __repr__(self) -> str:
        """Return the record in one line."""
        return str(self)

    def _repr_html_(self) -> str:
        """Return a table of the facts and a figure, for notebooks."""
        return str(function_by_name("undula.views.records.html:as_html")(self))

    def plot(self, ax: Any = None) -> Any:
        """Draw the record.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            The axes to draw into; a new figure without them.

        Returns
        -------
        matplotlib Figure or Axes
            The figure, or the axes that were given. A notebook shows a figure by itself.

        Raises
        ------
        InputError
            The record has no figure, or it cannot be drawn into axes.
        """
        if not self._figure:
            raise InputError(f"{type(self).__name__} has no figure; print it, or take to_xarray()")
        return function_by_name(self._figure)(self, ax)

    def to_xarray(self) -> xr.Dataset:
        """Return the facts as a labelled dataset: a variable each, with `units` and `error`."""
        variables = {}
        for name, fact in self.facts().items():
            value = np.nan if fact.value is None else fact.value
            about: dict[str, Any] = {"units": fact.unit} if fact.unit else {}
            if fact.error is not None:
                about["error"] = fact.error
            variables[name] = xr.Variable((), value, about)
        return xr.Dataset(variables)

    def save(self, path: Path | str, *, overwrite: bool = False) -> None:
        """Store the record in a file, from which `undula.load` reads it.

        Parameters
        ----------
        path : path
            Name of the file; missing folders are made.
        overwrite : bool
            True to replace an earlier file.

        Raises
        ------
        InputError
            The file exists, its folder cannot be written, or the model holds a function, which no
            file can keep.
        """
        function_by_name("undula.storage.record_file:save_record")(
            Path(path), self, overwrite=overwrite
        )


def function_by_name(name: str) -> Any:
    """Return a function of a package above this one, by "module:function"."""
    module, _, function = name.partition(":")
    return getattr(import_module(module), function)
