"""A model and its load in a few words, for titles and the heads of answers.

Told is what departs from an isotropic straight filament in space with the drag of a slender body,
or from a chain of like springs and beads.
"""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import fields, is_dataclass
from typing import Any

from undula.models.loads.analytic import LinearLoad, PointLoad, PowerLoad, TipLoad
from undula.models.loads.beads import BeadLoad
from undula.models.loads.user_density import ProfileLoad, TableLoad
from undula.models.natural_curvature import CurvatureTable
from undula.models.units import chain_units

_PROFILES = {
    TipLoad: "tip",
    PointLoad: "point",
    LinearLoad: "linear",
    PowerLoad: "power",
    TableLoad: "table",
    BeadLoad: "beads",
    ProfileLoad: "spread",
}
_DRAG_RATIOS = {"filament": 2.0, "chain": 1.0}
_STRAIGHT = (0.0, 0.0)
_TWISTS = {"paper": "twist moment left out", "rigid": "rigid twist", "elastic": "elastic twist"}
#: Longer lists are told by how many they are.
_LISTED = 8


def model_words(model: Any) -> str:
    """Return a model and its load in a few words, such as ``tip force 75, confined``."""
    load = model.load
    if not (is_dataclass(model) and is_dataclass(load)):
        return f"{type(model).__name__} under {type(load).__name__}"
    profile = _PROFILES.get(type(load), type(load).__name__)
    body = {one.name: getattr(model, one.name) for one in fields(model)}
    values = {one.name: getattr(load, one.name) for one in fields(load)}
    if profile == "tip":
        values.pop("position", None)
    return words(body, profile, values)


def words(
    body: Mapping[str, Any], profile: str, load: Mapping[str, Any], swept: Collection[str] = ()
) -> str:
    """Return a model and its load in a few words.

    Parameters
    ----------
    body
        Values of the model by the names of its fields; those without meaning may be left out.
    profile
        How the load is spread: a profile of the input file, or another word.
    load
        Values of the load by the names of its fields; the force is needed.
    swept
        Names that stand for many values and are left out, as ``load.force``.
    """
    bare = {key.partition(".")[2] or key for key in swept}
    links = body.get("links")
    told = [*_load_words(profile, load, bare, links), *_body_words(body, bare)]
    if links is not None:
        told.insert(0, "chain" if "links" in bare else f"chain of {links} links")
    return ", ".join(told)


def _load_words(
    profile: str, load: Mapping[str, Any], swept: set[str], links: int | None
) -> Iterator[str]:
    unit = "" if links is None else f" {chain_units(links).force}"
    known = {name: value for name, value in load.items() if name not in swept}
    head = f"{profile} force {known['force']:.12g}{unit}" if "force" in known else f"{profile} load"
    place = f" at s = {known['position']:.12g}" if "position" in known else ""
    yield head + place + _share_words(known)
    for name in ("slope", "exponent"):
        if name in known:
            yield f"{name} {known[name]:.12g}"


def _share_words(load: Mapping[str, Any]) -> str:
    """Return between which points or beads a load is shared, or by which function."""
    if "beads" in load:
        beads = load["beads"]
        return " on all" if beads == "all" else f" on {_listed(beads, 'beads')}"
    if "s" in load:
        return f" ({len(load['s'] or ())} points)"
    function = str(load.get("density", ""))
    return f" by {function}" if function.isidentifier() else ""


def _body_words(body: Mapping[str, Any], swept: set[str]) -> Iterator[str]:
    known = {name: value for name, value in body.items() if name not in swept}
    yield from _rest_words(known, swept)
    if known.get("confined"):
        yield "confined to a plane"
    if known.get("inextensibility") == "weak":
        stiffness = known.get("tensile_stiffness")
        yield "extensible" if stiffness is None else f"tensile stiffness {stiffness:.6g}"
    usual = _DRAG_RATIOS["chain" if "links" in body else "filament"]
    if known.get("drag_ratio", usual) != usual:
        yield f"drag ratio {known['drag_ratio']:.6g}"
    if known.get("base_spring", 1.0) != 1.0:
        yield f"base spring {known['base_spring']:.6g}"
    drag = known.get("bead_drag", 1.0)
    if drag != 1.0:
        yield f"bead drag {_listed(drag, 'values') if isinstance(drag, tuple) else f'{drag:.6g}'}"
    if known.get("spring") == "unwrapped":
        yield "springs unwrapped"


def _rest_words(body: Mapping[str, Any], swept: set[str]) -> Iterator[str]:
    """Tell how a filament is curved at rest and how it differs across, and of its twist."""
    curvature, ratio = body.get("natural_curvature", _STRAIGHT), body.get("bending_ratio", 1.0)
    directed = {"natural_curvature.k1", "natural_curvature.k2", "bending_ratio"} & swept
    if curvature == _STRAIGHT and ratio == 1.0 and not directed:
        return
    if isinstance(curvature, tuple):
        told = {f"k{i}": value for i, value in enumerate(curvature, start=1) if value}
        components = [
            f"{name} = {value:.6g}"
            for name, value in told.items()
            if f"natural_curvature.{name}" not in swept
        ]
        if components:
            yield f"curvature {', '.join(components)}"
    elif isinstance(curvature, CurvatureTable):
        yield f"curvature of {len(curvature.s)} points"
    else:
        yield "curvature by a function"
    if ratio != 1.0:
        yield f"bending ratio {ratio:.6g}"
    if "twist" in body:
        elastic = body["twist"] == "elastic" and "twist_stiffness" in body
        stiffness = f" of stiffness {body['twist_stiffness']:.6g}" if elastic else ""
        yield _TWISTS[body["twist"]] + stiffness


def _listed(values: Collection[float], what: str) -> str:
    if len(values) > _LISTED:
        return f"{len(values)} {what}"
    return ", ".join(f"{value:.6g}" for value in values)
