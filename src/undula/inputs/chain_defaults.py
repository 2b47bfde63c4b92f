"""Defaults of a chain: force and times that correspond to those of a filament."""

from collections.abc import Collection, Mapping
from typing import Any

from undula.inputs.model_tables import LoadTable, ModelTable
from undula.inputs.run_tables import TimeTable
from undula.models.units import FILAMENT_UNITS, chain_units


def with_chain_defaults(given: Any, tables: Collection[str]) -> Any:
    """Return the tables of an input with the defaults of a chain; of other models unchanged.

    Parameters
    ----------
    given
        The input before its check.
    tables
        Names of the tables of this type of input.
    """
    table = given.get("model") if isinstance(given, Mapping) else None
    if not (isinstance(table, Mapping) and table.get("kind") == "chain"):
        return given
    links = table.get("links", ModelTable.model_fields["links"].default)
    if not isinstance(links, int) or links < 1:
        return given  # refused by the check of this key
    units = chain_units(links)
    corresponding = {
        "load": {"force": LoadTable().force / units.forces[FILAMENT_UNITS.force]},
        "time": {key: value * units.duration for key, value in _times(given).items()},
    }
    return dict(given) | {
        name: defaults | dict(given.get(name, {}))
        for name, defaults in corresponding.items()
        if name in tables and isinstance(given.get(name, {}), Mapping)
    }


def _times(given: Mapping[str, Any]) -> dict[str, float]:
    """Return the default times of a filament that have a meaning for a given table ``[time]``."""
    fields, chosen = TimeTable.model_fields, given.get("time")
    if isinstance(chosen, Mapping) and chosen.get("until") in ("settled", "solved"):
        return {"limit": fields["limit"].default}
    return {"until": fields["until"].default}
