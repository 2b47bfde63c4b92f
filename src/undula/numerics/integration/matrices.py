"""Storage and factorisation of the matrices of a system, specialised to its type.

The matrices are those that `matrix`, `planar_matrix` and `derivative` of
`undula.numerics.integration.system` write.
"""

from typing import Any

from numba.extending import overload

from undula.jit.compilation import RESOLVED
from undula.numerics.linalg import banded


def structure_of(system: type) -> banded.Structure:
    """Return the sparsity of `matrix`: the attribute `structure` of a type, or a full band."""
    half: int = system.half_bandwidth  # type: ignore[attr-defined]
    return getattr(system, "structure", banded.full(half))


def planar_structure_of(system: type) -> banded.Structure | None:
    """Return the sparsity of `planar_matrix`; None for systems without that matrix."""
    return getattr(system, "planar_structure", None)


def derivative_half_bandwidth(system: type) -> int:
    """Return the half-bandwidth of `derivative` for systems of a type."""
    own: int = system.half_bandwidth  # type: ignore[attr-defined]
    return int(getattr(system, "derivative_half_bandwidth", own))


def matrix_width(system: Any) -> Any:
    """Return the number of entries of a row of the system's matrix."""
    return _width(type(system))


def derivative_width(system: Any) -> Any:
    """Return the number of entries of a row of the system's exact derivative."""
    return _derivative_width(type(system))


def factor_derivative(system: Any, band: Any) -> Any:
    """Factor the exact derivative in place; return False where a pivot vanishes."""
    structure = banded.full(derivative_half_bandwidth(type(system)))
    return banded.factor_kernel(structure)(band)


def solve_derivative(system: Any, band: Any, x: Any) -> Any:
    """Overwrite x (n,) by the solution of the factored derivative."""
    structure = banded.full(derivative_half_bandwidth(type(system)))
    return banded.solve_kernel(structure)(band, x)


def factor(system: Any, band: Any) -> Any:
    """Factor the system's matrix in place; return False where a pivot vanishes."""
    return banded.factor_kernel(structure_of(type(system)))(band)


def solve(system: Any, band: Any, x: Any) -> Any:
    """Overwrite x (n,) by the solution of the factored system."""
    return banded.solve_kernel(structure_of(type(system)))(band, x)


def planar_factor(system: Any, band: Any) -> Any:
    """Factor the planar matrix in place; return False where a pivot vanishes or without one."""
    structure = planar_structure_of(type(system))
    return structure is not None and banded.factor_kernel(structure)(band)


def planar_solve(system: Any, band: Any, x: Any) -> Any:
    """Overwrite x (n,) by the solution of the factored planar system."""
    structure = planar_structure_of(type(system))
    return structure and banded.solve_kernel(structure)(band, x)


def _width(system: type) -> int:
    half: int = system.half_bandwidth  # type: ignore[attr-defined]
    return 2 * half + 1


def _derivative_width(system: type) -> int:
    return 2 * derivative_half_bandwidth(system) + 1


@overload(matrix_width, strict=False, jit_options=RESOLVED)
def _matrix_width(system: Any) -> Any:
    width = _width(system.instance_class)
    return lambda system: width  # noqa: ARG005


@overload(derivative_width, strict=False, jit_options=RESOLVED)
def _width_of_derivative(system: Any) -> Any:
    width = _derivative_width(system.instance_class)
    return lambda system: width  # noqa: ARG005


@overload(factor, strict=False, jit_options=RESOLVED)
def _factor(system: Any, band: Any) -> Any:
    kernel = banded.factor_kernel(structure_of(system.instance_class))
    return lambda system, band: kernel(band)  # noqa: ARG005


@overload(solve, strict=False, jit_options=RESOLVED)
def _solve(system: Any, band: Any, x: Any) -> Any:
    kernel = banded.solve_kernel(structure_of(system.instance_class))
    return lambda system, band, x: kernel(band, x)  # noqa: ARG005


@overload(planar_factor, strict=False, jit_options=RESOLVED)
def _planar_factor(system: Any, band: Any) -> Any:
    structure = planar_structure_of(system.instance_class)
    if structure is None:
        return lambda system, band: False  # noqa: ARG005
    kernel = banded.factor_kernel(structure)
    return lambda system, band: kernel(band)  # noqa: ARG005


@overload(planar_solve, strict=False, jit_options=RESOLVED)
def _planar_solve(system: Any, band: Any, x: Any) -> Any:
    structure = planar_structure_of(system.instance_class)
    if structure is None:
        return lambda system, band, x: None  # noqa: ARG005
    kernel = banded.solve_kernel(structure)
    return lambda system, band, x: kernel(band, x)  # noqa: ARG005


@overload(factor_derivative, strict=False, jit_options=RESOLVED)
def _factor_derivative(system: Any, band: Any) -> Any:
    kernel = banded.factor_kernel(banded.full(derivative_half_bandwidth(system.instance_class)))
    return lambda system, band: kernel(band)  # noqa: ARG005


@overload(solve_derivative, strict=False, jit_options=RESOLVED)
def _solve_derivative(system: Any, band: Any, x: Any) -> Any:
    kernel = banded.solve_kernel(banded.full(derivative_half_bandwidth(system.instance_class)))
    return lambda system, band, x: kernel(band, x)  # noqa: ARG005
