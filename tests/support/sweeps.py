"""A stored sweep made up in closed form, in the layout of real ones."""

import json
from collections.abc import Callable, Mapping, Sequence

import numpy as np
import xarray as xr

from undula.analysis.observables.shapes import mean_position

NAMES = (
    "straight",
    "spinning",
    "modulated spinning",
    "planar flapping",
    "non-planar flapping",
    "precessing flapping",
    "windmilling",
    "chaotic",
    "undecided",
    "asymmetric spinning",
    "asymmetric flapping",
)
UNITS = {"length": "L", "force": "B/L^2", "energy": "B/L", "time": "zeta_perp L^4/B"}
NODES, SHAPES = 9, 12

Axes = Mapping[str, Sequence[float]]
#: From the values of the axes and the number of the try to a verdict, "failed", or "" if not done.
Rule = Callable[..., str]


def made_up(axes: Axes, rule: Rule, tries: int = 1, *, shapes: bool = False) -> xr.Dataset:
    """Return a sweep whose verdicts follow a rule; its frequency is that of the force to 4/3."""
    sizes = (*(len(values) for values in axes.values()), tries)
    verdict = np.zeros(sizes, dtype="<U24")
    status = np.zeros(sizes, dtype=np.int8)
    frequency = np.full(sizes, np.nan)
    for index in np.ndindex(*sizes):
        place = [values[k] for values, k in zip(axes.values(), index, strict=False)]
        word = rule(*place, index[-1])
        status[index] = {"": 0, "failed": 2}.get(word, 1)
        if status[index] == 1:
            verdict[index] = word
            if word not in ("straight", "chaotic", "undecided"):
                force = dict(zip(axes, place, strict=True)).get("load.force", 75.0)
                frequency[index] = 0.3 * force ** (4 / 3)
    dims = (*axes, "try")
    energy = np.where(status == 1, 0.02 * np.nan_to_num(frequency), np.nan)
    swings = np.char.find(verdict, "flapping") >= 0
    variables = {
        "status": (dims, status),
        "verdict": (dims, verdict),
        "frequency": (dims, frequency),
        "margin": (dims, np.where(status == 1, 2.0, np.nan)),
        "energy_min": (dims, np.where(swings, 0.5, 1.0) * energy),
        "energy_max": (dims, np.where(swings, 1.5, 1.0) * energy),
    }
    if shapes:
        moved = np.stack([shape_of(word) for word in verdict.ravel()])
        variables["shapes"] = (
            (*dims, "shape", "node", "axis"),
            moved.reshape(*sizes, SHAPES, NODES, 3),
        )
        path = np.stack([path_of(word) for word in verdict.ravel()])
        variables["path"] = ((*dims, "instant", "axis"), path.reshape(*sizes, SHAPES, 3))
    return xr.Dataset(
        variables,
        coords={name: np.array(values) for name, values in axes.items()} | {"try": range(tries)},
        attrs={"units": json.dumps(UNITS), "study": "{}", "load": "tip load"},
    )


def coded(store: xr.Dataset) -> xr.Dataset:
    """Return a sweep with its verdicts as numbers whose meanings stand beside them."""
    codes = np.vectorize(lambda word: NAMES.index(word) if word else -1)(store["verdict"].values)
    meanings = " ".join(name.replace(" ", "_") for name in NAMES)
    attributes = {"flag_values": list(range(len(NAMES))), "flag_meanings": meanings}
    return store.assign(verdict=(store["verdict"].dims, codes.astype(np.int8), attributes))


def shape_of(verdict: str) -> np.ndarray:
    """Return shapes (SHAPES, NODES, 3) over a period: an arc that turns, or swings in a plane."""
    s, phase = np.linspace(0.0, 1.0, NODES), 2.0 * np.pi * np.arange(SHAPES) / SHAPES
    bend = {"": np.nan, "straight": 0.0}.get(verdict, 1.2)
    radius, height = np.sin(bend * s) ** 2, np.cos(0.6 * bend * s) * s
    if "flapping" in verdict:
        swing = np.cos(phase)[:, None] * radius
        sides = swing, np.zeros_like(swing)
    else:
        sides = np.cos(phase)[:, None] * radius, np.sin(phase)[:, None] * radius
    return np.stack([*sides, np.broadcast_to(height, sides[0].shape)], axis=-1)


def path_of(verdict: str) -> np.ndarray:
    """Return the mean position (SHAPES, 3) of these shapes."""
    return mean_position(shape_of(verdict))
