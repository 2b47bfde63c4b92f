"""A model and its load in a few words, for titles and headings.

Named are only the differences from an isotropic straight filament in space with the drag of a
slender body, or from a chain of equal springs and beads.
"""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import fields, is_dataclass
from typing import Any

from undula.models.loads.analytic import LinearLoad, PointLoad, TipLoad
from undula.models.loads.beads import BeadLoad
from undula.models.loads.power import PowerLoad
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
#: Number of entries up to which a list is written out.
_MAX_LISTED = 8


def describe_model(model: Any) -> str:
    """Return a model and its load in a few words.

    Parameters
    ----------
    model : Model
        Any model.

    Returns
    -------
    str
        For example ``tip force 75, confined to a plane``.
    """
    load = model.load
    if not (is_dataclass(model) and is_dataclass(load)):
        return f"{type(model).__name__} under {type(load).__name__}"
    profile = _PROFILES.get(type(load), type(load).__name__)
    body = {entry.name: getattr(model, entry.name) for entry in fields(model)}
    values = {entry.name: getattr(load, entry.name) for entry in fields(load)}
    if profile == "tip":
        values.pop("position", None)
    return describe(body, profile, values)


def describe(
    body: Mapping[str, Any], profile: str, load: Mapping[str, Any], swept: Collection[str] = ()
) -> str:
    """Return a model and its load, given as tables, in a few words.

    Parameters
    ----------
    body : mapping
        Values of the model by the names of its fields; those without meaning may be left out.
    profile : str
        Distribution of the load: a profile of the input file, or another word.
    load : mapping
        Values of the load by the names of its fields; the force is needed.
    swept : collection of str
        Names of swept parameters, which are left out, as ``load.force``.

    Returns
    -------
    str
        As `describe_model` returns.
    """
    swept_fields = {key.partition(".")[2] or key for key in swept}
    links = body.get("links")
    phrases = [*_load_words(profile, load, swept_fields, links), *_body_words(body, swept_fields)]
    if links is not None:
        phrases.insert(0, "chain" if "links" in swept_fields else f"chain of {links} links")
    return ", ".join(phrases)


def _load_words(
    profile: str, load: Mapping[str, Any], swept: set[str], links: int | None
) -> Iterator[str]:
    unit = "" if links is None else f" {chain_units(links).force}"
    shown = {name: value for name, value in load.items() if name not in swept}
    force_text = (
        f"{profile} force {shown['force']:.12g}{unit}" if "force" in shown else f"{profile} load"
    )
    position_text = f" at s = {shown['position']:.12g}" if "position" in shown else ""
    yield force_text + position_text + _share_words(shown)
    for name in ("slope", "exponent"):
        if name in shown:
            yield f"{name} {shown[name]:.12g}"


def _share_words(load: Mapping[str, Any]) -> str:
    """Return the points, the beads or the function of a load's distribution."""
    if "beads" in load:
        beads = load["beads"]
        return " on all" if beads == "all" else f" on {_listed(beads, 'beads')}"
    if "s" in load:
        return f" ({len(load['s'] or ())} points)"
    function = str(load.get("density", ""))
    return f" by {function}" if function.isidentifier() else ""


def _body_words(body: Mapping[str, Any], swept: set[str]) -> Iterator[str]:
    shown = {name: value for name, value in body.items() if name not in swept}
    yield from _rest_words(shown, swept)
    if shown.get("confined"):
        yield "confined to a plane"
    if shown.get("inextensibility") == "weak":
        stiffness = shown.get("tensile_stiffness")
        yield "extensible" if stiffness is None else f"tensile stiffness {stiffness:.6g}"
    default_ratio = _DRAG_RATIOS["chain" if "links" in body else "filament"]
    if shown.get("drag_ratio", default_ratio) != default_ratio:
        yield f"drag ratio {shown['drag_ratio']:.6g}"
    if shown.get("base_spring", 1.0) != 1.0:
        yield f"base spring {shown['base_spring']:.6g}"
    drag = shown.get("bead_drag", 1.0)
    if drag != 1.0:
        yield f"bead drag {_listed(drag, 'values') if isinstance(drag, tuple) else f'{drag:.6g}'}"
    if shown.get("spring") == "unwrapped":
        yield "springs unwrapped"


def _rest_words(body: Mapping[str, Any], swept: set[str]) -> Iterator[str]:
    """Yield natural curvature, bending ratio and twist of a filament."""
    curvature, ratio = body.get("natural_curvature", _STRAIGHT), body.get("bending_ratio", 1.0)
    directed = {"natural_curvature.k1", "natural_curvature.k2", "bending_ratio"} & swept
    if curvature == _STRAIGHT and ratio == 1.0 and not directed:
        return
    if isinstance(curvature, tuple):
        phrases = {f"k{i}": value for i, value in enumerate(curvature, start=1) if value}
        components = [
            f"{name} = {value:.6g}"
            for name, value in phrases.items()
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
    if len(values) > _MAX_LISTED:
        return f"{len(values)} {what}"
    return ", ".join(f"{value:.6g}" for value in values)
