"""SI values of the dimensionless units; the only module with SI units.

With length L, bending stiffness B, viscosity mu and slenderness a/L:

    zeta = 4 pi mu / ln(L/a)      normal drag coefficient
    T    = zeta L^4 / B           time
    B/L^2, B/L^3, B/L             force, force density, energy

Source: Ling, Guo & Kanso, J. R. Soc. Interface 2018, Table 1, whose values are the defaults.
"""

import math
from dataclasses import dataclass, fields
from typing import Literal

from undula.errors import InputError

Quantity = Literal["length", "time", "frequency", "force", "force_density", "energy"]

# Bounds within which no product or quotient of scales leaves the range of a float.
_MIN, _MAX = 1e-40, 1e40


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

    def to_si(self, quantity: Quantity, value: float) -> float:
        """Return the SI value of a dimensionless number.

        Parameters
        ----------
        quantity : {"length", "time", "frequency", "force", "force_density", "energy"}
            The quantity of the number.
        value : float
            Dimensionless number.

        Returns
        -------
        float
            The value in m, s, Hz, N, N/m or J.
        """
        return value * self._unit(quantity)

    def from_si(self, quantity: Quantity, value: float) -> float:
        """Return the dimensionless number of an SI value, the inverse of `to_si`.

        Parameters
        ----------
        quantity : {"length", "time", "frequency", "force", "force_density", "energy"}
            The quantity of the value.
        value : float
            Value in m, s, Hz, N, N/m or J.

        Returns
        -------
        float
            Dimensionless number.
        """
        return value / self._unit(quantity)

    def _unit(self, quantity: Quantity) -> float:
        return float(getattr(self, quantity))
