"""Numbers of a run: extents of its late window, and facts and a line from its summary."""

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from undula.analysis.observables.planarity import planarity
from undula.analysis.observables.shapes import envelope, tip_height, tip_radius
from undula.analysis.observables.trajectory import Motion
from undula.analysis.record import Fact
from undula.analysis.regimes.lyapunov import Lyapunov
from undula.analysis.runs.finite_separation import Separation

_RANGES = {"bending_energy": "energy", "tip_radius": "length", "tip_height": "length"}


def extents_of(window: Motion, planarity_share: float | None) -> dict[str, Any]:
    """Return the ranges of energy and tip, and the planarity, in plain JSON types.

    Parameters
    ----------
    window : Motion
        The late window of a run.
    planarity_share : float or None
        The planarity if it was measured already.
    """
    return {
        "bending_energy": asdict(envelope(window.energetics.bending_energy)),
        "tip_radius": asdict(envelope(tip_radius(window.nodes))),
        "tip_height": asdict(envelope(tip_height(window.nodes))),
        "planarity": planarity(window.nodes) if planarity_share is None else planarity_share,
    }


def exponents_of(lyapunov: Lyapunov | None, separation: Separation | None) -> dict[str, Any] | None:
    """Return Lyapunov exponents and the divergence of pairs of runs, in plain JSON types."""
    if lyapunov is None:
        return None
    pairs = separation and separation.as_dict()
    return {**lyapunov.as_dict(), "finite_separation": pairs}


def facts_of(summary: Mapping[str, Any]) -> dict[str, Fact]:
    """Return verdict, frequencies, energy, extents and accuracy by name.

    Parameters
    ----------
    summary : mapping
        As `Run.summary` returns it.
    """
    units = summary["units"]
    facts = {
        "verdict": Fact(summary["verdict"]),
        "ending": Fact(summary["status"]),
        "force": Fact(summary["force"], units["force"]),
        "links": Fact(summary["links"]),
        "time": Fact(summary["time"], "T"),
    }
    on_links = None if summary["error_of"] == "body" else summary["links"]
    for name in ("frequency", "rotation_frequency", "shape_frequency"):
        facts[name] = Fact(summary[name], units["frequency"], summary[f"{name}_error"], on_links)
    for name, quantity in _RANGES.items():
        for part, value in summary[name].items():
            facts[f"{name}_{part}"] = Fact(value, units[quantity])
    return facts | {"power_balance_error": Fact(summary["power_balance_error"])}


def line_of(summary: Mapping[str, Any]) -> str:
    """Return verdict, frequency and accuracy of a run in one line, from its summary."""
    frequency, rate = summary["frequency"], ""
    if frequency is not None:
        links = "" if summary["error_of"] == "body" else f"{summary['links']} links, "
        rate = f" at {frequency:.6g} /T ({links}to {summary['frequency_error']:.1g})"
    return (
        f"{summary['verdict']}{rate}, {summary['status']} at {summary['time']:.4g} T"
        f" (power balance to {summary['power_balance_error']:.1g},"
        f" length to {summary['length_error']:.1g}, {summary['steps']} steps)"
    )
