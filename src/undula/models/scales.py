"""SI values of the dimensionless units; the only module with SI units.

With length L, bending stiffness B, viscosity mu and slenderness a/L:

    zeta = 4 pi mu / ln(L/a)      normal drag coefficient
    T    = zeta L^4 / B           time
    B/L^2, B/L^3, B/L             force, force density, energy

Source: Ling, Guo & Kanso, J. R. Soc. Interface 2018, Table 1, whose values are the defaults.
"""

import math
from dataclasses import dataclass, fields
from typing import Any, Literal, Self, cast, get_args

from undula.errors import InputError
from undula.schema.physical_units import SHOWN_IN
from undula.schema.unit_texts import si_value

Quantity = Literal[
    "length",
    "time",
    "frequency",
    "rate",
    "force",
    "force_density",
    "energy",
    "power",
    "curvature",
]

# Bounds within which no product or quotient of scales leaves the range of a float.
_MIN, _MAX = 1e-36, 1e36


@dataclass(frozen=True)
class Scales:
    """SI value of one dimensionless unit of each quantity, for a filament.

    Parameters
    ----------
    length : float
        Filament length L [m], positive.
    bending_stiffness : float
        Bending stiffness B [N m^2], positive.
    viscosity : float
        Viscosity of the fluid mu [Pa s], positive.
    slenderness : float
        Radius over length a/L, above 0 and below 1.

    Raises
    ------
    InputError
        A value is not a positive finite number, or the slenderness is not below 1.

    References
    ----------
    Ling, Guo & Kanso (2018), J. R. Soc. Interface 15, table 1: the default values.

    Examples
    --------
    >>> import undula as un
    >>> scales = un.Scales(length=10e-6)
    >>> f"{scales.force:.3g} N"
    '8e-12 N'
    >>> f"{scales.to_si('frequency', 77.4):.4g} Hz"
    '2269 Hz'
    """

    length: float = 20e-6
    bending_stiffness: float = 800e-24
    viscosity: float = 1e-3
    slenderness: float = 1e-2

    def __post_init__(self) -> None:
        """Check the values."""
        for field in fields(self):
            value = getattr(self, field.name)
            if not _MIN <= value <= _MAX:
                raise InputError(
                    f"{field.name} = {value} is not a positive number that SI scales can be made"
                    f" of; give one from {_MIN} to {_MAX}, such as {field.default}"
                )
        if self.slenderness >= 1.0:
            raise InputError(
                f"slenderness = {self.slenderness} is out of range; give radius over length,"
                " above 0 and below 1"
            )

    @classmethod
    def from_units(
        cls,
        length: str | None = None,
        stiffness: str | None = None,
        viscosity: str | None = None,
        slenderness: float | None = None,
    ) -> Self:
        """Return the scales of a filament from texts of numbers with their units.

        Parameters
        ----------
        length : str, optional
            Filament length, from 1 nm to 1 km; like all arguments by default that of `Scales()`.
        stiffness : str, optional
            Bending stiffness, above 0.
        viscosity : str, optional
            Viscosity of the fluid, above 0.
        slenderness : float, optional
            Radius over length, above 0 and below 1.

        Returns
        -------
        Scales
            The scales.

        Raises
        ------
        InputError
            A text has no number or no unit, the unit is unknown or belongs to another quantity,
            or a value is out of range. The sentence names the argument and the cure.

        Examples
        --------
        >>> import undula as un
        >>> scales = un.Scales.from_units(length="12 um", stiffness="25 pN um^2")
        >>> f"{scales.force:.3g} N"
        '1.74e-13 N'
        """
        texts = {"length": length, "stiffness": stiffness, "viscosity": viscosity}
        given: dict[str, Any] = {
            "bending_stiffness" if name == "stiffness" else name: si_value(
                name, text, name, of_filament=True
            )
            for name, text in texts.items()
            if text is not None
        }
        return cls(**given | ({} if slenderness is None else {"slenderness": slenderness}))

    @property
    def normal_drag(self) -> float:
        """Normal drag coefficient per length, zeta [Pa s]."""
        return 4.0 * math.pi * self.viscosity / -math.log(self.slenderness)

    @property
    def time(self) -> float:
        """Unit of time [s]."""
        return self.normal_drag * self.length**4 / self.bending_stiffness

    @property
    def frequency(self) -> float:
        """Unit of frequency [Hz]."""
        return 1.0 / self.time

    @property
    def rate(self) -> float:
        """Unit of rate [1/s]."""
        return 1.0 / self.time

    @property
    def force(self) -> float:
        """Unit of force [N]."""
        return self.bending_stiffness / self.length**2

    @property
    def force_density(self) -> float:
        """Unit of force per length [N/m]."""
        return self.bending_stiffness / self.length**3

    @property
    def energy(self) -> float:
        """Unit of energy [J]."""
        return self.bending_stiffness / self.length

    @property
    def power(self) -> float:
        """Unit of power [W]."""
        return self.energy / self.time

    @property
    def curvature(self) -> float:
        """Unit of curvature [1/m]."""
        return 1.0 / self.length

    def to_si(self, quantity: Quantity, value: float) -> float:
        """Return the SI value of a dimensionless number.

        Parameters
        ----------
        quantity : str
            The quantity of the number: "length", "time", "frequency", "rate", "force",
            "force_density", "energy", "power" or "curvature".
        value : float
            Dimensionless number.

        Returns
        -------
        float
            The value in m, s, Hz, 1/s, N, N/m, J, W or 1/m.
        """
        return value * self._unit(quantity)

    def from_si(self, quantity: Quantity, value: float) -> float:
        """Return the dimensionless number of an SI value, the inverse of `to_si`.

        Parameters
        ----------
        quantity : str
            The quantity of the value, as for `to_si`.
        value : float
            Value in m, s, Hz, 1/s, N, N/m, J, W or 1/m.

        Returns
        -------
        float
            Dimensionless number.
        """
        return value / self._unit(quantity)

    def physical(self, quantity: Quantity, value: float) -> tuple[float, str]:
        """Return a dimensionless number in the physical unit in which its quantity is shown.

        Parameters
        ----------
        quantity : str
            The quantity of the number, as for `to_si`.
        value : float
            Dimensionless number.

        Returns
        -------
        float
            The value in um, s, Hz, 1/s, pN, pN/um, pN um, pN um/s or 1/um.
        str
            The name of this unit.

        Examples
        --------
        >>> import undula as un
        >>> value, unit = un.Scales().physical("frequency", 77.4)
        >>> f"{value:.4g} {unit}"
        '141.8 Hz'
        """
        name, si = SHOWN_IN[quantity]
        return self.to_si(quantity, value) / si, name

    def units(self) -> dict[str, dict[str, Any]]:
        """Return one dimensionless unit of each quantity in physical units.

        Returns
        -------
        dict
            By quantity, the `value` and the `unit`, in plain JSON types.

        Examples
        --------
        >>> import undula as un
        >>> un.Scales().units()["length"]
        {'value': 20.0, 'unit': 'um'}
        """
        table = {}
        for quantity in get_args(Quantity):
            value, unit = self.physical(cast(Quantity, quantity), 1.0)
            table[quantity] = {"value": value, "unit": unit}
        return table

    def _unit(self, quantity: Quantity) -> float:
        return float(getattr(self, quantity))
