"""The numbers of a state that are worth taking to the limit of many links, by name."""

from undula.analysis.solvers.equilibrium import Equilibrium
from undula.analysis.states.periodic_record import Periodic
from undula.analysis.states.records import Flapping, Spinning


def of_steady(state: Spinning | Equilibrium) -> dict[str, float]:
    """Return those of a shape that does not change."""
    return {
        "frequency": state.frequency,
        "bending_energy": state.bending_energy,
        "tip_radius": state.tip_radius,
        "tip_height": state.tip_height,
        "leading_rate": state.leading_rate,
    }


def of_periodic(state: Flapping | Periodic) -> dict[str, float]:
    """Return those of a motion that repeats itself."""
    ranges = {
        "bending_energy": state.energy,
        "tip_radius": state.tip_radius,
        "tip_height": state.tip_height,
    }
    spread = {
        f"{name}_{part}": getattr(values, part)
        for name, values in ranges.items()
        for part in ("min", "max", "mean")
    }
    return {"frequency": state.frequency} | spread | {"leading_rate": state.leading_rate}


def of_flapping(state: Flapping) -> dict[str, float]:
    """Return those of a planar beat."""
    rates = {"leading_rate_in_plane": state.leading_rate_in_plane}
    if state.leading_rate_out_of_plane is not None:
        rates["leading_rate_out_of_plane"] = state.leading_rate_out_of_plane
    told = of_periodic(state)
    del told["leading_rate"]  # the larger of the two
    return told | rates
