"""What texts and answers tell of the units of their numbers; a filament's go without saying."""

from collections.abc import Collection, Mapping

from undula.models.units import FILAMENT_UNITS, Units

#: What the letters in further units of force mean.
_LETTERS = {"K/l": "l = L/N", "B/L^2": "B = K l of the filament it stands for"}


def units_lines(names: Mapping[str, str], further: Collection[str] = ()) -> list[str]:
    """Return the line below the heading of a text that names its units; none for a filament.

    Parameters
    ----------
    names
        Units by quantity, as `Units.names` gives them.
    further
        Further units of force that the text tells.
    """
    if names == FILAMENT_UNITS.names():
        return []
    line = f"  force in {names['force']}, T = {names['time']}"
    letters = ", ".join(_LETTERS[name] for name in further)
    return [f"{line}; {letters}" if letters else line]


def force_in(units: Units, force: float | None, owner: str = "") -> dict[str, dict[str, float]]:
    """Return the key of an answer that holds a force in further units; none where there are none.

    Parameters
    ----------
    units
        Units of the model.
    force
        A force, or None if there is none.
    owner
        What stands before the key's name, such as "hopf_".
    """
    told = {} if force is None else units.force_in(force)
    return {f"{owner}force_in": told} if told else {}
