"""Quantities of a state that are extrapolated to the limit of many links, by name."""

from undula.analysis.states.records import Flapping
from undula.analysis.states.state import State


def quantities_of(state: State) -> dict[str, float]:
    """Return frequency, energy, tip and leading rate of a state, by name.

    Ranges of a steady state are single numbers; others are given by their ends and their mean.
    Flapping has a leading rate in its plane and, in space, one out of it.
    """
    ranges = {
        "bending_energy": state.bending_energy,
        "tip_radius": state.tip_radius,
        "tip_height": state.tip_height,
    }
    if state.steady:
        numbers = {name: values.mean for name, values in ranges.items()}
    else:
        numbers = {
            f"{name}_{part}": getattr(values, part)
            for name, values in ranges.items()
            for part in ("min", "max", "mean")
        }
    return {"frequency": state.frequency} | numbers | _leading_rates(state)


def _leading_rates(state: State) -> dict[str, float]:
    if not isinstance(state, Flapping):
        return {"leading_rate": state.leading_rate}
    rates = {"leading_rate_in_plane": state.leading_rate_in_plane}
    if state.leading_rate_out_of_plane is not None:
        rates["leading_rate_out_of_plane"] = state.leading_rate_out_of_plane
    return rates
