"""Quantities drawn over time: labels, lines, samples and interpolation."""

from collections.abc import Callable
from dataclasses import dataclass

from undula.views.common import style
from undula.views.run.resample import tip_at, values_at
from undula.views.run.scene import Floats, Scene


@dataclass(frozen=True)
class Curve:
    """A line of a row: name, look, stored samples and a function for values at any times."""

    name: str
    colour: str
    samples: Floats
    at: Callable[[Floats], Floats]
    dashes: str = "-"
    width: float = 1.4


@dataclass(frozen=True)
class Row:
    """A quantity: label of its axis, and its curves."""

    label: str
    curves: tuple[Curve, ...]


def tip_row(scene: Scene) -> Row:
    """Return the row of the tip's three coordinates."""
    looks = (
        (r"$x$", style.X_COLOUR, "-"),
        (r"$y$", style.Y_COLOUR, "--"),
        (r"$z$", style.Z_COLOUR, "-"),
    )

    def coordinate(k: int) -> Callable[[Floats], Floats]:
        return lambda times: tip_at(scene, times)[:, k]

    curves = (
        Curve(name, colour, scene.nodes[:, -1, k], coordinate(k), dashes)
        for k, (name, colour, dashes) in enumerate(looks)
    )
    return Row(style.tip_label(), tuple(curves))


def energy_row(scene: Scene) -> Row:
    """Return the row of the bending energy."""
    energy = Curve("", style.ENERGY_COLOUR, scene.energy, _between(scene, scene.energy))
    return Row(style.energy_label(scene.units), (energy,))


def power_row(scene: Scene) -> Row:
    """Return the row of active power and, as both often coincide, of dotted dissipation."""
    active = _between(scene, scene.active)
    lost = _between(scene, scene.dissipation)
    return Row(
        style.power_label(scene.units),
        (
            Curve("active", style.ACTIVE_COLOUR, scene.active, active, width=2.6),
            Curve("dissipation", style.DISSIPATION_COLOUR, scene.dissipation, lost, ":"),
        ),
    )


def _between(scene: Scene, samples: Floats) -> Callable[[Floats], Floats]:
    return lambda times: values_at(scene, samples, times)
