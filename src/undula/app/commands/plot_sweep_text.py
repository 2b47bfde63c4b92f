"""The answer of `undula plot` on a stored sweep, in plain JSON types and for people."""

import json
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from undula.analysis.maps.contradictions import Disagreement
from undula.analysis.maps.stability_boundaries import BOUNDARIES, StabilityBoundaries
from undula.analysis.states.extrapolation import links_are_body
from undula.inputs.build import build_model
from undula.inputs.input import parse_input
from undula.inputs.units_table import scales_of
from undula.models.scales import Scales
from undula.schema.sweep_axes import DONE, FAILED, verdicts_of
from undula.sweeps.boundary_cache import tables_of
from undula.terminal.numbers import BODY, LINKS
from undula.terminal.physical import bracketed, scales_lines, with_physical

#: Most lines of each kind in the answer for people; the JSON answer has all.
_MOST_LINES = 20


def diagram_answer(
    store: xr.Dataset,
    boundaries: StabilityBoundaries | None,
    contradicting: Sequence[Disagreement],
    shares: xr.Dataset | None,
) -> dict[str, Any]:
    """Return the answer in plain JSON types.

    Parameters
    ----------
    store
        The selected part of a sweep.
    boundaries
        Solved stability boundaries, or None.
    contradicting
        Points that contradict the boundaries.
    shares
        Shares of verdicts at each point, as `undula.basins` returns them, or None.
    """
    status, words = store["status"].values, verdicts_of(store).values
    answer: dict[str, Any] = {
        "status": "done",
        "points": int(status.size),
        "done": int((status == DONE).sum()),
        "failed": int((status == FAILED).sum()),
        "verdicts": dict(Counter(str(word) for word in words[words != ""]).most_common()),
    }
    if boundaries is not None:
        model = build_model(parse_input(tables_of(store)))
        changing = boundaries.parameter in ("model.segments", "model.links")
        answer |= {
            "parameter": boundaries.parameter,
            "links": None if changing else model.links,
            "error_of": BODY if links_are_body(model) else LINKS,
            "borders": {name: list(_boundary(boundaries, name)) for name in BOUNDARIES},
            "disagreements": [
                {
                    **point.at,
                    "verdict": point.verdict,
                    "near": point.near,
                    "sentence": point.sentence,
                }
                for point in contradicting
            ],
        }
    basins = {} if shares is None else {"basins": list(_basins(shares))}
    return with_physical(answer | basins, "plot", scales_of_store(store))


def scales_of_store(store: xr.Dataset) -> Scales | None:
    """Return the scales of a stored sweep, None without ``[units]`` in its input."""
    return scales_of(json.loads(store.attrs["study"]))


def diagram_text(answer: Mapping[str, Any], scales: Scales | None = None) -> str:
    """Return the answer for people.

    Parameters
    ----------
    answer
        The answer as `diagram_answer` returns it, with its figure.
    scales
        SI values of the dimensionless units; None for a text without physical units.
    """
    missing = answer["points"] - answer["done"] - answer["failed"]
    counts = [f"{answer['done']} of {answer['points']} points done"]
    counts += [f"{answer['failed']} failed"] * bool(answer["failed"])
    counts += [f"{missing} to go"] * bool(missing)
    lines = [answer["figure"], *scales_lines(scales), f"  {', '.join(counts)}"]
    lines += [f"  {count:>6} {verdict}" for verdict, count in answer["verdicts"].items()]
    if answer.get("error_of") == LINKS and answer["links"] is not None:
        lines.append(f"  borders of {answer['links']} links, as the runs are of")
    for name, points in answer.get("borders", {}).items():
        boundary = list(_boundary_lines(points, answer["parameter"], scales))
        lines += _listed(f"{name}:", boundary)
    if "disagreements" in answer:
        lines += _contradiction_lines(answer["disagreements"])
    several = [basin for basin in answer.get("basins", ()) if len(basin["verdicts"]) > 1]
    if several:
        lines += _listed("ends of several starts:", [_basin_line(basin) for basin in several])
    return "\n".join(lines)


def _boundary(boundaries: StabilityBoundaries, name: str) -> Iterator[dict[str, Any]]:
    forces, errors = boundaries.curve(name)
    for index, value in enumerate(boundaries.values):
        exists = bool(np.isfinite(forces[index]))
        place = {} if boundaries.parameter is None else {boundaries.parameter: value}
        yield place | {
            "force": float(forces[index]) if exists else None,
            "error": float(errors[index]) if exists else None,
            "reason": boundaries.why_no_boundary(name, index),
        }


def _basins(shares: xr.Dataset) -> Iterator[dict[str, Any]]:
    """Yield the shares of the verdicts that occur, for each point with results."""
    axes = [str(name) for name in shares["tries"].dims]
    for index in np.ndindex(*(shares.sizes[name] for name in axes)):
        point = shares.isel(dict(zip(axes, index, strict=True)))
        if int(point["tries"]):
            yield {name: float(point[name]) for name in axes} | {
                "tries": int(point["tries"]),
                "verdicts": {
                    str(share["verdict"].values): {
                        name: float(share[name]) for name in ("fraction", "low", "high")
                    }
                    for share in (point.sel(verdict=name) for name in point["verdict"].values)
                    if int(share["hits"])
                },
            }


def _boundary_lines(
    points: Sequence[Mapping[str, Any]], parameter: str | None, scales: Scales | None
) -> Iterator[str]:
    if all(point["force"] is None for point in points):
        # The reason is the same at all points.
        yield f"none: {points[0]['reason']}"
        return
    for point in points:
        place = "" if parameter is None else f"{point[parameter]:>12.6g}  "
        force = f"none: {point['reason']}" if point["force"] is None else f"{point['force']:.7g}"
        yield f"{place}{force}{bracketed(scales, 'force', point['force'])}"


def _contradiction_lines(points: Sequence[Mapping[str, Any]]) -> list[str]:
    near = sum(1 for point in points if point["near"])
    if not points:
        return ["  no point contradicts the solved states"]
    counts = (
        f"points that contradict the solved states: {len(points)}, {near} of them next to a border"
    )
    return _listed(counts, [point["sentence"] for point in points if not point["near"]])


def _basin_line(basin: Mapping[str, Any]) -> str:
    place = ", ".join(
        f"{name} = {value:g}" for name, value in basin.items() if name not in ("tries", "verdicts")
    )
    shares = ", ".join(
        f"{verdict} {share['fraction']:.0%} ({share['low']:.0%} to {share['high']:.0%})"
        for verdict, share in basin["verdicts"].items()
    )
    return f"{place}: {shares} of {basin['tries']}"


def _listed(heading: str, lines: Sequence[str]) -> list[str]:
    """Return at most `_MOST_LINES` lines below a heading."""
    listed = [f"  {heading}", *(f"    {line}" for line in lines[:_MOST_LINES])]
    more = len(lines) - _MOST_LINES
    return [*listed, f"    and {more} more"] if more > 0 else listed
