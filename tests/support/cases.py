"""The axes along which claims on models are tested, and random states that belong to them."""

from collections.abc import Callable, Iterable
from typing import Any, Literal, NamedTuple

import numpy as np
import pytest

from undula.arrays import Points, State
from undula.models.filament import Filament
from undula.models.loads.analytic import LinearLoad, Load, PointLoad, TipLoad
from undula.models.loads.power import PowerLoad
from undula.models.loads.user_density import ProfileLoad, TableLoad


class Form(NamedTuple):
    """A kind of linked rod: how its length is kept, and whether it is kept in a plane."""

    inextensibility: Literal["exact", "weak"]
    confined: bool

    def __str__(self) -> str:
        return f"{self.inextensibility}, {'confined' if self.confined else 'free'}"


ALL_FORMS = [Form(kept, confined) for kept in ("exact", "weak") for confined in (False, True)]
RIGID_FORMS = [form for form in ALL_FORMS if form.inextensibility == "exact"]
FREE_FORMS = [form for form in ALL_FORMS if not form.confined]


def stepped(s: Points) -> Points:
    """Return a density that grows with s and jumps at 0.3, as given by a user."""
    return np.exp(2.0 * s) * np.where(s < 0.3, 1.0, 2.0)


#: One of each profile, both ends of the linear one's range, and a table that pulls in places.
ALL_LOADS: list[Load] = [
    TipLoad(75.0),
    PointLoad(60.0, 0.37),
    LinearLoad(90.0, -1.0),
    LinearLoad(90.0, 1.0),
    PowerLoad(120.0, 2.5),
    TableLoad(100.0, (0.0, 0.15, 0.6, 1.0), (2.0, -1.0, 3.0, 1.0)),
    ProfileLoad(80.0, stepped, (0.3,)),
]
ALL_DRAG_RATIOS = [1.0, 2.0, 5.0]

every_load = pytest.mark.parametrize("load", ALL_LOADS, ids=repr)
every_form = pytest.mark.parametrize("form", ALL_FORMS, ids=str)
every_free_form = pytest.mark.parametrize("form", FREE_FORMS, ids=str)
every_drag_ratio = pytest.mark.parametrize("drag_ratio", ALL_DRAG_RATIOS)


def filament(
    form: Form = ALL_FORMS[0],
    load: Load = ALL_LOADS[0],
    *,
    segments: int = 12,
    drag_ratio: float = 2.0,
) -> Filament:
    """Return a small filament of the given form."""
    return Filament(
        segments,
        load,
        drag_ratio=drag_ratio,
        inextensibility=form.inextensibility,
        confined=form.confined,
    )


def random_state(
    model: Filament, seed: int = 0, *, bend: float = 1.0, strain: float = 0.01
) -> State:
    """Return a state far from straight: each joint turns by a random angle up to `bend` [rad].

    Extensible links are stretched or shortened by a random part up to `strain`.
    """
    random = np.random.default_rng(seed)
    tangent = np.eye(model.dimension)[-1]
    links = []
    for _ in range(model.segments):
        across = random.normal(size=model.dimension)
        across -= (across @ tangent) * tangent
        across /= np.linalg.norm(across)
        angle = bend * random.uniform()
        tangent = np.cos(angle) * tangent + np.sin(angle) * across
        stretch = 1.0
        if model.inextensibility == "weak":
            stretch += strain * random.uniform(-1.0, 1.0)
        links.append(stretch * tangent / np.linalg.norm(tangent) / model.segments)
    return np.cumsum(links, axis=0).ravel()


def mostly_slow(values: Iterable[Any], is_fast: Callable[[Any], bool]) -> list[Any]:
    """Return the values of a parameter, or of several as tuples, each slow unless it is fast."""
    return [value if is_fast(value) else _slow(value) for value in values]


def _slow(value: Any) -> Any:
    values = value if isinstance(value, tuple) else (value,)
    return pytest.param(*values, marks=pytest.mark.slow)
