"""Physical units in which quantities are shown, and the quantities of input keys."""

from collections.abc import Mapping

#: Name and SI value of the physical unit in which a quantity is shown.
SHOWN_IN: Mapping[str, tuple[str, float]] = {
    "length": ("um", 1e-6),
    "time": ("s", 1.0),
    "frequency": ("Hz", 1.0),
    "rate": ("1/s", 1.0),
    "force": ("pN", 1e-12),
    "force_density": ("pN/um", 1e-6),
    "energy": ("pN um", 1e-18),
    "power": ("pN um/s", 1e-18),
    "curvature": ("1/um", 1e6),
}
#: Quantity of an input key, or of each number in its list or table; other keys have no unit.
INPUT_QUANTITIES: Mapping[str, str] = {
    "model.tensile_stiffness": "force",
    "model.natural_curvature": "curvature",
    "load.force": "force",
    "load.position": "length",
    "load.s": "length",
    "time.until": "time",
    "time.limit": "time",
}
#: Attribute of a stored result: one dimensionless unit of each quantity in physical units.
UNITS_PHYSICAL = "units_physical"
