"""Units of a model's numbers, by name; the unit of length is L throughout."""

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Units:
    """Units of a model's numbers.

    Attributes
    ----------
    force, energy, power : str
        Names of the units.
    time : str
        Definition of the unit of time T.
    forces : mapping of str to float
        Further units of force, and a force of 1 in each of them.
    duration : float
        Duration in T of a motion that takes a filament one unit of its time.
    """

    force: str
    energy: str
    power: str
    time: str
    forces: Mapping[str, float] = field(default_factory=dict)
    duration: float = 1.0

    def names(self) -> dict[str, str]:
        """Return the names of all units, by quantity."""
        return {
            "length": "L",
            "force": self.force,
            "energy": self.energy,
            "power": self.power,
            "time": self.time,
            "frequency": "cycles per T",
        }

    def force_in(self, force: float) -> dict[str, float]:
        """Return the values of a force in the further units, by their names."""
        return {name: factor * force for name, factor in self.forces.items()}

    def bracketed(self, force: float) -> str:
        """Return a text with a force in the further units, in brackets; empty without any."""
        values = [f"{value:.6g} {name}" for name, value in self.force_in(force).items()]
        return f" ({' or '.join(values)})" if values else ""


#: Units of a filament of length L, bending stiffness B and normal drag zeta_perp per length.
FILAMENT_UNITS = Units(
    force="B/L^2", energy="B/L", power="B^2/(zeta_perp L^5)", time="zeta_perp L^4/B"
)


def chain_units(links: int) -> Units:
    """Return the units of a chain with springs K between beads of drag zeta.

    The corresponding filament has B = K l and zeta_perp = zeta / l, with the length l = L/N of a
    link: F L^2/B = N F L/K, and its unit of time is N^2 of the chain's.

    Parameters
    ----------
    links : int
        Number of links N, at least 1.

    Returns
    -------
    Units
        The units.
    """
    return Units(
        force="K/L",
        energy="K",
        power="K^2/(zeta L^2)",
        time="zeta L^2/K",
        forces={"K/l": 1.0 / links, "B/L^2": float(links)},
        duration=float(links) ** 2,
    )
