"""No entry point of compiled code takes arrays that do not fit one another."""

import inspect
import pkgutil
from collections.abc import Iterator
from functools import cache
from importlib import import_module
from typing import Any

import numpy as np
import pytest
from numba.core.dispatcher import Dispatcher

import undula
import undula.models.rod.sizes as _registers  # noqa: F401
from undula.arrays import Array
from undula.jit.sizes import DeclaredArray, parse_declaration
from undula.models.chain import Chain
from undula.models.filament import Filament
from undula.models.loads.analytic import TipLoad
from undula.models.rod.tables import RODS
from undula.numerics.integration.matrices import derivative_width, matrix_width
from undula.numerics.integration.step import Options
from undula.numerics.integration.stepper_state import StepperState
from undula.numerics.integration.system import sizes_match

LOAD = TipLoad(50.0)
#: One body of each kind of rod.
BODIES = (
    Filament(4, LOAD),
    Filament(4, LOAD, confined=True),
    Chain(4, LOAD),
    Chain(4, LOAD, confined=True),
    Filament(4, LOAD, inextensibility="weak"),
    Filament(4, LOAD, inextensibility="weak", confined=True),
    Chain(4, LOAD, confined=True, spring="unwrapped"),
    Filament(4, LOAD, bending_ratio=2.0),
)
TYPES = {"float": np.float64, "int": np.int64, "complex": np.complex128}
#: Arguments that are numbers.
NUMBERS = {
    "angle": 0.1,
    "c": 1.0,
    "end": -1.0,
    "farthest": 1.0,
    "frequency": 1.0,
    "harmonics": 1,
    "lag": 1,
    "most": 1,
    "most_steps": 0,
    "share": 0.5,
    "tapered": True,
    "tolerance": 1e-9,
    "turn": 0.0,
}


@cache
def entries() -> dict[str, Dispatcher]:
    """Return every function of the package that is compiled for Python, wherever it is defined."""
    found = {}
    for module in pkgutil.walk_packages(undula.__path__, "undula."):
        if module.name.endswith("__main__"):
            continue
        for function in vars(import_module(module.name)).values():
            if isinstance(function, Dispatcher):
                found[f"{function.py_func.__module__}.{function.py_func.__name__}"] = function
    return found


ENTRIES = sorted(entries())
OF_SYSTEMS = [
    name for name in ENTRIES if "system" in inspect.signature(entries()[name].py_func).parameters
]


def arrays_of(name: str) -> tuple[DeclaredArray, ...]:
    return parse_declaration(entries()[name].py_func.sizes)


def some(shape: list[int], holds: str) -> Array:
    """Return an array of numbers, none of them 0 but for indices."""
    numbers = np.random.default_rng(1).uniform(0.5, 1.5, shape)
    return numbers.astype(TYPES[holds])


def sizes_for(system: Any) -> dict[str, int]:
    """Return numbers for the names of sizes that go together."""
    n = type(system).stride * system.joint.size
    widths = {"b": matrix_width(system), "d": derivative_width(system)}
    return {"n": n, "m": 6, "k": 5, "p": 4, "r": 8, "a": 6, "c": 2, "q": 4, "t": 1, "s": 1} | widths


def given(name: str, system: Any, other: dict[str, Array] | None = None) -> tuple[Any, ...]:
    """Return arguments that fit an entry point, but for some arrays."""
    sizes, filled, function = sizes_for(system), {}, entries()[name].py_func
    if name.endswith("shape_sums.align"):
        sizes["b"] = 1  # one shape beside many
    for array in arrays_of(name):
        shape = [eval(size, {}, NUMBERS | sizes) for size in array.sizes]
        filled[array.name] = some(shape, array.dtype)
        # As models have them; what can be written would be compiled anew.
        filled[array.name].setflags(write=array.name != "weights")
    if "stepper.count" in filled:
        filled["stepper.count"][:] = 1
    filled |= other or {}

    def record(kind: Any, called: str, numbers: dict[str, Any]) -> Any:
        own = {one.partition(".")[2]: value for one, value in filled.items() if called in one}
        return kind(**numbers, **own)

    tolerances = {"rtol": 1.0, "atol": 1.0, "stale_after": 1.0, "longest_step": 1.0, "frame": 0}
    made = NUMBERS | filled | {"system": system}
    if "stepper.count" in filled:
        made["stepper"] = record(StepperState, "stepper.", {})
        made["options"] = record(Options, "options.", tolerances)
    return tuple(made[argument] for argument in inspect.signature(function).parameters)


def wrong_sizes(name: str, system: Any) -> Iterator[tuple[str, Array]]:
    """Yield every array of an entry point that has a size too many, too few, or none.

    A size that no other array has, and no number goes with, is as it may be.
    """
    arrays = arrays_of(name)
    told = " ".join(size for array in arrays for size in array.sizes).split()
    sizes = sizes_for(system)
    if name.endswith("shape_sums.align"):
        sizes["b"] = 1
    for array in arrays:
        shape = [eval(size, {}, NUMBERS | sizes) for size in array.sizes]
        for axis, size in enumerate(array.sizes):
            alone = size.isidentifier() and told.count(size) == 1
            if alone and not (name in OF_SYSTEMS and size in "ndbq"):
                continue
            for length in (shape[axis] + 1, shape[axis] - 1, 0):
                wrong = [*shape[:axis], length, *shape[axis + 1 :]]
                yield array.name, some(wrong, array.dtype)


def test_there_are_entry_points_and_each_declares_its_arrays() -> None:
    assert len(ENTRIES) > 20
    bare = [name for name in ENTRIES if not arrays_of(name)]
    assert bare == []


@pytest.mark.parametrize("name", ENTRIES)
def test_an_entry_point_refuses_every_array_of_a_wrong_size(name: str) -> None:
    system, entry = BODIES[0].system, entries()[name]
    entry(*given(name, system))  # what fits is taken
    tried = 0
    for array, wrong in wrong_sizes(name, system):
        with pytest.raises(ValueError, match="not fit"):
            entry(*given(name, system, {array: wrong}))
        tried += 1
    # One quantity alone can have any number of samples.
    assert tried > 0 or name.rpartition(".")[2] in ("mean_and_deviation", "extremes_and_mean")


@pytest.mark.parametrize("name", ENTRIES)
def test_an_entry_point_refuses_numbers_of_another_type(name: str) -> None:
    # As Python, which is the same check: compiled code would be compiled anew for each type.
    system, function = BODIES[0].system, entries()[name].py_func
    for array in arrays_of(name):
        fitting = dict(
            zip(inspect.signature(function).parameters, given(name, system), strict=True)
        )
        owner, _, own = array.name.partition(".")
        whole = getattr(fitting[owner], own) if own else fitting[owner]
        for other in {np.float32, np.float64, np.int64} - {TYPES[array.dtype]}:
            with pytest.raises(ValueError, match="not fit"):
                function(*given(name, system, {array.name: whole.real.astype(other)}))


@pytest.mark.parametrize("body", BODIES, ids=lambda body: type(body.system).__name__)
@pytest.mark.parametrize("name", OF_SYSTEMS)
def test_no_system_takes_the_unknowns_of_another(name: str, body: Any) -> None:
    function = entries()[name].py_func
    named = {size for array in arrays_of(name) for size in array.sizes}
    for other in BODIES:
        theirs, own = sizes_for(other.system), sizes_for(body.system)
        if any(theirs[size] != own[size] for size in {"n", "b", "d"} & named):
            arguments = list(given(name, other.system))
            arguments[0] = body.system
            with pytest.raises(ValueError, match="not fit"):
                function(*arguments)


def test_there_is_a_body_of_each_kind_of_rod() -> None:
    assert [type(body.system) for body in BODIES] == list(RODS)


@pytest.mark.parametrize("body", BODIES, ids=lambda body: type(body.system).__name__)
def test_the_tables_of_a_rod_have_to_fit_one_another(body: Any) -> None:
    system = body.system
    n = type(system).stride * 4
    assert sizes_match(system, n)
    assert not sizes_match(system, n + 1)
    assert not sizes_match(system, 0)
    for name, table in system._asdict().items():
        if isinstance(table, np.ndarray):
            assert not sizes_match(system._replace(**{name: table[:-1]}), n)
            assert not sizes_match(system._replace(**{name: np.concatenate([table, table])}), n)


@pytest.mark.parametrize("count", [0, 6])
def test_a_memory_of_an_order_that_it_has_no_differences_for_is_refused(count: int) -> None:
    name, system = "undula.numerics.integration.time_loop.advance", BODIES[0].system
    counts = np.ones(12, np.int64)
    counts[1] = count
    with pytest.raises(ValueError, match="not fit"):
        entries()[name](*given(name, system, {"stepper.count": counts}))


def test_places_outside_of_an_array_are_refused() -> None:
    for name, array in (("shape_sums.gather", "columns"), ("link_sums.link_turns", "chosen")):
        called = f"undula.analysis.observables.{name}"
        fitting = given(called, BODIES[0].system)
        beyond = np.full_like(fitting[1], 1000)
        with pytest.raises(ValueError, match="not fit"):
            entries()[called](*given(called, BODIES[0].system, {array: beyond}))


def test_an_array_with_gaps_is_read_as_what_it_is() -> None:
    values = np.arange(12.0).reshape(6, 2)
    mean = entries()["undula.analysis.observables.sample_sums.mean_and_deviation"]
    assert mean(values[:, 1]) == mean(np.ascontiguousarray(values[:, 1]))


def test_a_declaration_that_is_none_is_refused() -> None:
    with pytest.raises(ValueError, match="declares no arrays"):
        parse_declaration("y of n")
