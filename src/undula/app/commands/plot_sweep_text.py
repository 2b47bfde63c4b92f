"""What `undula plot` tells of a stored study, in plain JSON types and for people."""

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
from undula.schema.sweep_axes import DONE, FAILED, verdicts_of
from undula.sweeps.boundary_cache import tables_of
from undula.terminal.numbers import BODY, LINKS

# So many lines of each kind are told to people; the JSON answer has all.
_MOST_LINES = 20


def diagram_answer(
    store: xr.Dataset,
    borders: StabilityBoundaries | None,
    wrong: Sequence[Disagreement],
    shares: xr.Dataset | None,
) -> dict[str, Any]:
    """Return what is told of a study in plain JSON types."""
    status, words = store["status"].values, verdicts_of(store).values
    answer: dict[str, Any] = {
        "status": "done",
        "points": int(status.size),
        "done": int((status == DONE).sum()),
        "failed": int((status == FAILED).sum()),
        "verdicts": dict(Counter(str(word) for word in words[words != ""]).most_common()),
    }
    if borders is not None:
        model = build_model(parse_input(tables_of(store)))
        changing = borders.parameter in ("model.segments", "model.links")
        answer |= {
            "parameter": borders.parameter,
            "links": None if changing else model.links,
            "error_of": BODY if links_are_body(model) else LINKS,
            "borders": {name: list(_border(borders, name)) for name in BOUNDARIES},
            "disagreements": [
                {**one.at, "verdict": one.verdict, "near": one.near, "sentence": one.sentence}
                for one in wrong
            ],
        }
    return answer if shares is None else answer | {"basins": list(_basins(shares))}


def diagram_text(answer: Mapping[str, Any]) -> str:
    """Return an answer for people."""
    missing = answer["points"] - answer["done"] - answer["failed"]
    counts = [f"{answer['done']} of {answer['points']} points done"]
    counts += [f"{answer['failed']} failed"] * bool(answer["failed"])
    counts += [f"{missing} to go"] * bool(missing)
    lines = [answer["figure"], f"  {', '.join(counts)}"]
    lines += [f"  {count:>6} {verdict}" for verdict, count in answer["verdicts"].items()]
    if answer.get("error_of") == LINKS and answer["links"] is not None:
        lines.append(f"  borders of {answer['links']} links, as the runs are of")
    for name, points in answer.get("borders", {}).items():
        lines += _some(f"{name}:", list(_border_lines(points, answer["parameter"])))
    if "disagreements" in answer:
        lines += _disagreement_lines(answer["disagreements"])
    shares = [told for told in answer.get("basins", ()) if len(told["verdicts"]) > 1]
    if shares:
        lines += _some("ends of several starts:", [_basin_line(told) for told in shares])
    return "\n".join(lines)


def _border(borders: StabilityBoundaries, name: str) -> Iterator[dict[str, Any]]:
    forces, errors = borders.curve(name)
    for index, value in enumerate(borders.values):
        known = bool(np.isfinite(forces[index]))
        place = {} if borders.parameter is None else {borders.parameter: value}
        yield place | {
            "force": float(forces[index]) if known else None,
            "error": float(errors[index]) if known else None,
            "reason": borders.why_no_boundary(name, index),
        }


def _basins(shares: xr.Dataset) -> Iterator[dict[str, Any]]:
    """Yield the shares of each point with answers, of the verdicts that occur there."""
    axes = [str(name) for name in shares["tries"].dims]
    for index in np.ndindex(*(shares.sizes[name] for name in axes)):
        here = shares.isel(dict(zip(axes, index, strict=True)))
        if int(here["tries"]):
            yield {name: float(here[name]) for name in axes} | {
                "tries": int(here["tries"]),
                "verdicts": {
                    str(one["verdict"].values): {
                        name: float(one[name]) for name in ("fraction", "low", "high")
                    }
                    for one in (here.sel(verdict=name) for name in here["verdict"].values)
                    if int(one["hits"])
                },
            }


def _border_lines(points: Sequence[Mapping[str, Any]], parameter: str | None) -> Iterator[str]:
    if all(point["force"] is None for point in points):
        # One reason stands for all.
        yield f"none: {points[0]['reason']}"
        return
    for point in points:
        place = "" if parameter is None else f"{point[parameter]:>12.6g}  "
        force = f"none: {point['reason']}" if point["force"] is None else f"{point['force']:.7g}"
        yield f"{place}{force}"


def _disagreement_lines(found: Sequence[Mapping[str, Any]]) -> list[str]:
    near = sum(1 for one in found if one["near"])
    if not found:
        return ["  no point contradicts the solved states"]
    counts = (
        f"points that contradict the solved states: {len(found)}, {near} of them next to a border"
    )
    told = [one["sentence"] for one in found if not one["near"]]
    return _some(counts, told)


def _basin_line(told: Mapping[str, Any]) -> str:
    place = ", ".join(
        f"{name} = {value:g}" for name, value in told.items() if name not in ("tries", "verdicts")
    )
    shares = ", ".join(
        f"{verdict} {share['fraction']:.0%} ({share['low']:.0%} to {share['high']:.0%})"
        for verdict, share in told["verdicts"].items()
    )
    return f"{place}: {shares} of {told['tries']}"


def _some(heading: str, lines: Sequence[str]) -> list[str]:
    """Return lines below a heading, not too many of them."""
    told = [f"  {heading}", *(f"    {line}" for line in lines[:_MOST_LINES])]
    more = len(lines) - _MOST_LINES
    return [*told, f"    and {more} more"] if more > 0 else told
