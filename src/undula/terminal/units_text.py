"""Units in texts and answers; the units of a filament are not repeated."""

from collections.abc import Collection, Mapping

from undula.models.units import FILAMENT_UNITS, Units

#: Meaning of the letters in further units of force.
_LETTERS = {"K/l": "l = L/N", "B/L^2": "B = K l of the filament it stands for"}


def units_lines(names: Mapping[str, str], further: Collection[str] = ()) -> list[str]:
    """Return the line with the units below the heading of a text; no line for a filament.

    Parameters
    ----------
    names
        Units by quantity, as `Units.names` returns them.
    further
        Further units of force in the text.
    """
    if names == FILAMENT_UNITS.names():
        return []
    line = f"  force in {names['force']}, T = {names['time']}"
    letters = ", ".join(_LETTERS[name] for name in further)
    return [f"{line}; {letters}" if letters else line]


def force_in(units: Units, force: float | None, owner: str = "") -> dict[str, dict[str, float]]:
    """Return the entry of an answer with a force in further units; empty without such units.

    Parameters
    ----------
    units
        Units of the model.
    force
        A force, or None.
    owner
        Prefix of the key, such as "hopf_".
    """
    further = {} if force is None else units.force_in(force)
    return {f"{owner}force_in": further} if further else {}
