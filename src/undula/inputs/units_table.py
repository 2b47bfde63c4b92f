"""The table `[units]` of an input file: the filament in physical units."""

from collections.abc import Mapping
from functools import cached_property
from typing import Any, Self

from pydantic import Field, model_validator

from undula.errors import InputError
from undula.inputs.table import Table, conflict
from undula.models.scales import Scales

_DEFAULTS = Scales()


class UnitsTable(Table):
    """The table ``[units]``: the filament to which physical numbers belong.

    The first three values are texts of a number and its unit, in any unit of their quantity.

    Attributes
    ----------
    length
        Filament length L, from 1 nm to 1 km.
    stiffness
        Bending stiffness B, above 0.
    viscosity
        Viscosity of the fluid, above 0.
    slenderness
        Radius over length, above 0 and below 1.
    """

    length: str = Field(
        default=f"{_DEFAULTS.length * 1e6:g} um",
        description="a text with a number and its unit, such as '12 um'",
    )
    stiffness: str = Field(
        default=f"{_DEFAULTS.bending_stiffness * 1e24:g} pN um^2",
        description="a text with a number and its unit, such as '25 pN um^2'",
    )
    viscosity: str = Field(
        default=f"{_DEFAULTS.viscosity * 1e3:g} mPa s",
        description="a text with a number and its unit, such as '1 mPa s'",
    )
    slenderness: float = Field(
        default=_DEFAULTS.slenderness,
        gt=0.0,
        lt=1.0,
        description="a number above 0 and below 1",
    )

    @model_validator(mode="after")
    def _texts_are_quantities(self) -> Self:
        try:
            # The scales are kept, since the import of the library that reads them is slow.
            self.scales  # noqa: B018
        except InputError as error:
            raise conflict(f"units.{error}") from None
        return self

    @cached_property
    def scales(self) -> Scales:
        """SI values of the dimensionless units."""
        return Scales.from_units(self.length, self.stiffness, self.viscosity, self.slenderness)


def scales_of(tables: Mapping[str, Any]) -> Scales | None:
    """Return the scales of a checked input in plain types, None without a table ``[units]``."""
    table = tables.get("units")
    return None if table is None else UnitsTable(**table).scales
