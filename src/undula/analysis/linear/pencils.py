"""The straight filament's small displacements as a matrix pencil in the force, in three ways.

    y'''' - Lambda(s) y'' + sigma y = 0,   y(0) = y'(0) = 0,   y''(1) = y'''(1) = 0

in weak form, with Lambda(s) = -int_s^1 f_a = -F lambda(s): for all w that meet the clamp

    int y'' w'' + F int lambda y'' w + sigma int y w = 0,

on polynomials (`spectral`) or beam modes (`modes`); or the equations of the links themselves
(`discrete`). Each gives K(F) c = -sigma M c. See docs/theory/stability.md.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar, Protocol

import numpy as np

from undula.analysis.linear.bases import Basis, BeamModes, LegendreElements
from undula.analysis.linear.results import Method
from undula.arrays import Array, ComplexArray, Points
from undula.errors import InputError
from undula.models.loads.analytic import DensityLoad
from undula.models.model import Model
from undula.numerics.linalg.legendre import gauss
from undula.numerics.linalg.pencil import LinearPencil, Pencil, reduced

# More elements than this gain nothing that a higher degree would not give for less.
_MOST_ELEMENTS = 12
# Beyond this size an answer takes more than a second.
_MOST_UNKNOWNS = 250
# From here on the second answer, which tells the error, is taken from fewer links.
_MANY_LINKS = 12
# Points at which a mode of the continuum is given.
_SHAPE = np.linspace(0.0, 1.0, 201)


class Linearisation(Protocol):
    """One way to turn the straight state into a pencil, at one resolution."""

    @property
    def method(self) -> Method:
        """The name of the way."""

    @property
    def pencil(self) -> Pencil:
        """The pencil K(F) + sigma M."""

    def coarse(self, size: int) -> LinearPencil:
        """Return a pencil of about `size` unknowns with nearly the same slow eigenvalues."""

    def companion(self) -> "tuple[Linearisation, float] | None":
        """Return the same at another resolution, to tell the error; None if there is none.

        With it comes the factor from the difference of two answers to the error of this one's.
        """

    def finer(self) -> "Linearisation | None":
        """Return the same at a higher resolution; None if there is none to choose."""

    def shape(self, vectors: ComplexArray) -> tuple[Points, ComplexArray]:
        """Return arc lengths (m,) and, for vectors (n, k), their displacements (k, m)."""


@dataclass(frozen=True)
class Polynomials:
    """Galerkin's method on piecewise polynomials, with an error that falls exponentially."""

    load: DensityLoad
    degree: int
    method: ClassVar[Method] = "spectral"

    @cached_property
    def pencil(self) -> LinearPencil:
        """The pencil K(F) + sigma M."""
        return _galerkin(self.load, self._basis)

    @property
    def _basis(self) -> LegendreElements:
        return LegendreElements(_thinned(self.load.breaks, _MOST_ELEMENTS), self.degree)

    def coarse(self, size: int) -> LinearPencil:
        """Return the pencil on two elements at most."""
        breaks = _thinned(self.load.breaks, 2)
        degree = max(1, size // (len(breaks) + 1) - 1)
        return _galerkin(self.load, LegendreElements(breaks, degree))

    def companion(self) -> "tuple[Polynomials, float]":
        """Return the same at two thirds of the degree."""
        return replace(self, degree=2 * self.degree // 3), 1.0

    def finer(self) -> "Polynomials | None":
        """Return the same at one and a half times the degree, as long as that is affordable."""
        finer = replace(self, degree=3 * self.degree // 2)
        return finer if finer.pencil.mass.shape[0] <= _MOST_UNKNOWNS else None

    def shape(self, vectors: ComplexArray) -> tuple[Points, ComplexArray]:
        """Return arc lengths (m,) and displacements (k, m)."""
        return _shape(self._basis, vectors)


@dataclass(frozen=True)
class AssumedModes:
    """Galerkin's method on the free vibrations of a clamped-free beam."""

    load: DensityLoad
    count: int
    method: ClassVar[Method] = "modes"

    @cached_property
    def pencil(self) -> LinearPencil:
        """The pencil K(F) + sigma M."""
        return _galerkin(self.load, BeamModes(self.count))

    def coarse(self, size: int) -> LinearPencil:
        """Return the pencil on the first modes."""
        whole, few = self.pencil, slice(size)
        return LinearPencil(whole.base[few, few], whole.change[few, few], whole.mass[few, few])

    def companion(self) -> "tuple[AssumedModes, float]":
        """Return the same with two thirds of the modes."""
        return replace(self, count=2 * self.count // 3), 1.0

    def finer(self) -> None:
        """Return None: more modes take longer than they are worth."""

    def shape(self, vectors: ComplexArray) -> tuple[Points, ComplexArray]:
        """Return arc lengths (m,) and displacements (k, m)."""
        return _shape(BeamModes(self.count), vectors)


@dataclass(frozen=True)
class Links:
    """The equations of the links, linearised; any model has them."""

    model: Model
    method: ClassVar[Method] = "discrete"

    @cached_property
    def pencil(self) -> Pencil:
        """The pencil K(F) + sigma M, which is linear for rigid links."""
        whole = _LinksPencil(self.model)
        base, one, two = (whole.stiffness(force) for force in (0.0, 1.0, 2.0))
        change = one - base
        round_off = 8.0 * np.finfo(float).eps * np.abs(base).max()
        if np.abs(two - base - 2.0 * change).max() <= round_off:
            return LinearPencil(base, change, whole.mass)
        return whole

    def coarse(self, size: int) -> LinearPencil:
        """Return the pencil on the slowest modes without a force."""
        return reduced(self.pencil, size)

    def companion(self) -> "tuple[Links, float] | None":
        """Return the same body made of two thirds or, if few, of twice the links.

        The error of a body that links stand for falls as 1/links^2, which makes the factor.
        """
        links = self.model.links
        other = 2 * links // 3 if links >= _MANY_LINKS else 2 * links
        model = self.model.with_links(other)
        return None if model is None else (Links(model), 1.0 / abs((links / other) ** 2 - 1.0))

    def finer(self) -> None:
        """Return None: the links are the model's own."""

    def shape(self, vectors: ComplexArray) -> tuple[Points, ComplexArray]:
        """Return arc lengths of the nodes (m,) and their displacements (k, m)."""
        s = np.linspace(0.0, 1.0, self.model.links + 1)
        return s, np.vstack([np.zeros(vectors.shape[1]), vectors]).T


@dataclass(frozen=True)
class _LinksPencil:
    """The pencil of a model's links; its stiffness need not be linear in the force."""

    model: Model

    @cached_property
    def mass(self) -> Array:
        return self.model.linearised()[1]

    def stiffness(self, p: float) -> Array:
        model = self.model.with_(force=p)
        try:
            return model.linearised()[0]
        except InputError:
            return np.full_like(self.mass, np.nan)  # pushed beyond their length

    def slope(self, p: float) -> Array:
        # Extensible links' stiffness bends over forces of the size of S > 1e3: the relative error
        # is (step / S)^2.
        step = 1.0 if p >= 1.0 else 0.5 * p or 1.0
        below = max(0.0, p - step)
        return (self.stiffness(p + step) - self.stiffness(below)) / (p + step - below)


def linearised(model: Model, method: Method | None = None) -> Linearisation:
    """Return the linearisation of a model's straight state.

    Parameters
    ----------
    model : Model
    method : {"spectral", "modes", "discrete"}, optional
        By default "spectral" if links stand for a continuous filament, else "discrete".

    Raises
    ------
    InputError
        The method is none of these, or needs a continuum that the model has not.
    """
    if method is None:
        method = "discrete" if model.continuum_load is None else "spectral"
    if not isinstance(method, str) or method not in _METHODS:
        raise InputError(f"method = {method!r} is not known; use 'spectral', 'modes' or 'discrete'")
    return _METHODS[method](model)


def _galerkin(load: DensityLoad, basis: Basis) -> LinearPencil:
    """Return the pencil of the weak form on a basis."""
    unit = replace(load, force=1.0)
    s, weight = gauss(np.union1d(basis.panels, load.breaks), basis.points)
    displacements, curvatures = basis.evaluate(s)
    carried = (weight * (1.0 - unit.force_below(s)))[:, None]
    weighted = weight[:, None] * displacements
    return LinearPencil(
        curvatures.T @ (weight[:, None] * curvatures),
        displacements.T @ (carried * curvatures),
        displacements.T @ weighted,
    )


def _shape(basis: Basis, vectors: ComplexArray) -> tuple[Points, ComplexArray]:
    displacements, _ = basis.evaluate(_SHAPE)
    return _SHAPE, np.asarray((displacements @ vectors).T)


def _thinned(breaks: tuple[float, ...], pieces: int) -> tuple[float, ...]:
    """Return at most `pieces` - 1 of the breaks, evenly picked."""
    if len(breaks) < pieces:
        return breaks
    picked = np.linspace(0, len(breaks) - 1, pieces + 1)[1:-1]
    return tuple(breaks[round(k)] for k in picked)


def _continuum(model: Model) -> DensityLoad:
    if model.continuum_load is None:
        raise InputError(
            "this model stands for no continuous inextensible filament, which the methods"
            " 'spectral' and 'modes' compute; use method = 'discrete'"
        )
    return model.continuum_load


# Degree 24 leaves nothing but round-off at the first threshold of a smooth profile, 72 modes an
# error in the eighth digit. What is left is measured in each answer.
_FIRST_DEGREE, _MODES = 24, 72

_METHODS: Mapping[str, Callable[[Model], Linearisation]] = {
    "spectral": lambda model: _polynomials(_continuum(model)),
    "modes": lambda model: AssumedModes(_continuum(model), _MODES),
    "discrete": Links,
}


def _polynomials(load: DensityLoad) -> Polynomials:
    elements = len(_thinned(load.breaks, _MOST_ELEMENTS)) + 1
    return Polynomials(load, max(10, _FIRST_DEGREE // elements))
