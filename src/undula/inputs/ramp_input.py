"""Input of a quasi-static ramp: that of a run, until the motion has settled by default."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from undula.inputs.input import RunInput, read_input
from undula.inputs.overrides import apply_overrides, read_toml

_SETTLE = 'time.until="settled"'


def read_ramp_input(path: Path | None = None, overrides: Sequence[str] = ()) -> RunInput:
    """Read the input of a quasi-static ramp.

    Parameters
    ----------
    path
        A TOML file in UTF-8; None for the defaults.
    overrides
        Changes such as ``"load.force=80"``, applied in order.

    Returns
    -------
    RunInput
        The checked input. Without ``time.until`` in file and overrides, each step runs until it has
        settled.

    Raises
    ------
    InputError
        As for `undula.inputs.input.read_input`.
    """
    tables = apply_overrides({} if path is None else read_toml(path), overrides)
    table = tables.get("time", {})
    chosen = not isinstance(table, Mapping) or "until" in table
    return read_input(path, overrides if chosen else (_SETTLE, *overrides))
