"""Solvers hold for any model that keeps the contract, whatever the order of its unknowns."""

import ast
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import undula as un
from pair import Pair
from undula.analysis.states.branch import Branch
from undula.models.chain import Chain
from undula.models.loads.analytic import TipLoad

SOURCE = Path(un.__file__).parent
FORCE = 20.0
ALONE = Chain(3, TipLoad(FORCE))
PAIR = Pair((Chain(2, TipLoad(0.2 * FORCE)), ALONE))


def assert_among(expected: np.ndarray, found: np.ndarray) -> None:
    away = np.abs(found[None, :] - expected[:, None]).min(axis=1)
    assert np.all(away <= 1e-6 * np.abs(expected).max())


def test_a_model_that_is_no_single_rod_spins() -> None:
    state, expected = un.find(PAIR, "spinning"), un.find(ALONE, "spinning")
    assert isinstance(state, un.Spinning)
    assert isinstance(expected, un.Spinning)
    assert state.frequency == pytest.approx(expected.frequency, rel=1e-9)
    assert state.bending_energy.mean == pytest.approx(expected.bending_energy.mean, rel=1e-9)
    assert state.tip_radius.mean == pytest.approx(expected.tip_radius.mean, rel=1e-9)
    assert len(state.exponents) == len(expected.exponents) + 2 * PAIR.chains[0].links
    assert_among(expected.exponents, state.exponents)


@pytest.mark.slow
def test_a_model_that_is_no_single_rod_flaps() -> None:
    branch, expected = un.follow_from_onset(PAIR, "flapping", FORCE), un.find(ALONE, "flapping")
    assert isinstance(branch, Branch)
    assert isinstance(expected, un.Flapping)
    assert branch.complete
    state = branch.states[-1]
    assert state.frequency == pytest.approx(expected.frequency, rel=1e-8)
    assert_among(expected.in_plane, state.in_plane)
    assert_among(expected.out_of_plane, state.out_of_plane)
    assert max(state.trivial) < 1e-6


# ---------------------------------------------------------------- who knows the order of unknowns

#: Literal strides that are about something else than unknowns.
OTHERS = {
    "self.states[::2]",  # every other sample of a run
    "np.array([tuple(vars(pace).values()) for pace in self.paces]).reshape(-1, 4)",  # rates
}


def literal(node: ast.AST | None) -> bool:
    """Tell whether a node is a whole number beyond 1."""
    return isinstance(node, ast.Constant) and isinstance(node.value, int) and node.value > 1


def strides(tree: ast.AST) -> Iterator[str]:
    """Yield expressions that take a literal stride: slices, and shapes that end with one."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Subscript):
            slices = [part for part in ast.walk(node.slice) if isinstance(part, ast.Slice)]
            if any(literal(part.step) for part in slices):
                yield ast.unparse(node)
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
            if node.func.attr == "reshape" and node.args and literal(node.args[-1]):
                yield ast.unparse(node)
        elif isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mod) and literal(node.right):
            yield ast.unparse(node)


def scanned() -> list[Path]:
    """Return the files that use unknowns but do not lay them out."""
    models = [
        path
        for path in (SOURCE / "models").rglob("*.py")
        if "rod" not in path.relative_to(SOURCE).parts
    ]
    rooms = ("linear", "runs", "solvers", "states")
    return models + [path for room in rooms for path in (SOURCE / "analysis" / room).rglob("*.py")]


def test_only_rods_know_how_many_unknowns_a_node_has() -> None:
    found = {
        (str(path.relative_to(SOURCE)), stride)
        for path in scanned()
        for stride in strides(ast.parse(path.read_text(encoding="utf-8")))
        if stride not in OTHERS
    }
    assert found == set()


@pytest.mark.parametrize(
    "code", ["y[::3]", "y[1::4]", "y[..., :-1:2]", "y.reshape(-1, 4)", "np.arange(n) % 4 == 0"]
)
def test_a_literal_stride_is_seen(code: str) -> None:
    assert list(strides(ast.parse(code)))
