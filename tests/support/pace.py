"""Marks for the parameters of a test that are left to `make test-slow`."""

from collections.abc import Callable, Iterable
from typing import Any

import pytest


def mostly_slow(values: Iterable[Any], is_fast: Callable[[Any], bool]) -> list[Any]:
    """Return the values of a parameter, or of several as tuples, each slow unless it is fast."""
    return [value if is_fast(value) else _slow(value) for value in values]


def _slow(value: Any) -> Any:
    values = value if isinstance(value, tuple) else (value,)
    return pytest.param(*values, marks=pytest.mark.slow)
