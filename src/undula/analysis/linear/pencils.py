"""Matrix pencils of the linearised straight state in the force, by three discretisations.

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

# Largest number of elements: beyond it a higher degree converges faster.
_MAX_ELEMENTS = 12
# Largest number of unknowns, for an answer within about a second.
_MAX_UNKNOWNS = 250
# Number of links from which the error is estimated with fewer links instead of more.
_MIN_LINKS_TO_COARSEN = 12
# Arc lengths at which a mode of the continuum is reported [L].
_SHAPE_POINTS = np.linspace(0.0, 1.0, 201)


class Linearisation(Protocol):
    """A discretisation of the linearised straight state, at one resolution."""

    @property
    def method(self) -> Method:
        """Name of the discretisation."""

    @property
    def pencil(self) -> Pencil:
        """The pencil K(F) + sigma M."""

    def coarse(self, size: int) -> LinearPencil:
        """Return a pencil of about `size` unknowns with nearly the same slow eigenvalues."""

    def companion(self) -> "tuple[Linearisation, float] | None":
        """Return the same at another resolution, for an error estimate; None if there is no other.

        The error is the difference of the two answers times the factor that is returned with it.
        """

    def finer(self) -> "Linearisation | None":
        """Return the same at a higher resolution; None at the highest one."""

    def shape(self, vectors: ComplexArray) -> tuple[Points, ComplexArray]:
        """Return arc lengths (m,) [L] and the displacements (k, m) of vectors (n, k)."""


@dataclass(frozen=True)
class Polynomials:
    """Galerkin's method on piecewise polynomials, with exponential convergence in the degree.

    Attributes
    ----------
    load : DensityLoad
    degree : int
        Degree of the curvature on each element, at least 1.
    """

    load: DensityLoad
    degree: int
    method: ClassVar[Method] = "spectral"

    @cached_property
    def pencil(self) -> LinearPencil:
        """The pencil K(F) + sigma M."""
        return _galerkin(self.load, self._basis)

    @property
    def _basis(self) -> LegendreElements:
        return LegendreElements(_thinned(self.load.breaks, _MAX_ELEMENTS), self.degree)

    def coarse(self, size: int) -> LinearPencil:
        """Return the pencil on two elements at most."""
        breaks = _thinned(self.load.breaks, 2)
        degree = max(1, size // (len(breaks) + 1) - 1)
        return _galerkin(self.load, LegendreElements(breaks, degree))

    def companion(self) -> "tuple[Polynomials, float]":
        """Return the same at two thirds of the degree."""
        return replace(self, degree=2 * self.degree // 3), 1.0

    def finer(self) -> "Polynomials | None":
        """Return the same at one and a half times the degree; None beyond the affordable size."""
        finer = replace(self, degree=3 * self.degree // 2)
        return finer if finer.pencil.mass.shape[0] <= _MAX_UNKNOWNS else None

    def shape(self, vectors: ComplexArray) -> tuple[Points, ComplexArray]:
        """Return arc lengths (m,) and displacements (k, m)."""
        return _shape(self._basis, vectors)


@dataclass(frozen=True)
class AssumedModes:
    """Galerkin's method on the free vibrations of a clamped-free beam.

    Attributes
    ----------
    load : DensityLoad
    count : int
        Number of modes, at least 1.
    """

    load: DensityLoad
    count: int
    method: ClassVar[Method] = "modes"

    @cached_property
    def pencil(self) -> LinearPencil:
        """The pencil K(F) + sigma M."""
        return _galerkin(self.load, BeamModes(self.count))

    def coarse(self, size: int) -> LinearPencil:
        """Return the pencil on the first modes."""
        pencil, kept = self.pencil, slice(size)
        return LinearPencil(
            pencil.base[kept, kept], pencil.change[kept, kept], pencil.mass[kept, kept]
        )

    def companion(self) -> "tuple[AssumedModes, float]":
        """Return the same with two thirds of the modes."""
        return replace(self, count=2 * self.count // 3), 1.0

    def finer(self) -> None:
        """Return None: more modes cost more than the gain in accuracy is worth."""

    def shape(self, vectors: ComplexArray) -> tuple[Points, ComplexArray]:
        """Return arc lengths (m,) and displacements (k, m)."""
        return _shape(BeamModes(self.count), vectors)


@dataclass(frozen=True)
class Links:
    """The linearised equations of the links, which any model has.

    Attributes
    ----------
    model : Model
    """

    model: Model
    method: ClassVar[Method] = "discrete"

    @cached_property
    def pencil(self) -> Pencil:
        """The pencil K(F) + sigma M, which is linear for rigid links."""
        pencil = _LinksPencil(self.model)
        base, unit, double = (pencil.stiffness(force) for force in (0.0, 1.0, 2.0))
        change = unit - base
        round_off = 8.0 * np.finfo(float).eps * np.abs(base).max()
        if np.abs(double - base - 2.0 * change).max() <= round_off:
            return LinearPencil(base, change, pencil.mass)
        return pencil

    def coarse(self, size: int) -> LinearPencil:
        """Return the pencil on the slowest modes without a force."""
        return reduced(self.pencil, size)

    def companion(self) -> "tuple[Links, float] | None":
        """Return the same body with two thirds of the links or, if they are few, with twice those.

        The factor follows from the error of the links as a model of the continuum, 1/links^2.
        """
        links = self.model.links
        other = 2 * links // 3 if links >= _MIN_LINKS_TO_COARSEN else 2 * links
        model = self.model.with_links(other)
        return None if model is None else (Links(model), 1.0 / abs((links / other) ** 2 - 1.0))

    def finer(self) -> None:
        """Return None: the number of links is that of the model."""

    def shape(self, vectors: ComplexArray) -> tuple[Points, ComplexArray]:
        """Return arc lengths of the nodes (m,) and their displacements (k, m)."""
        s = np.linspace(0.0, 1.0, self.model.links + 1)
        return s, np.vstack([np.zeros(vectors.shape[1]), vectors]).T


@dataclass(frozen=True)
class _LinksPencil:
    """The pencil of the links of a model, whose stiffness may be nonlinear in the force."""

    model: Model

    @cached_property
    def mass(self) -> Array:
        return self.model.linearised()[1]

    def stiffness(self, p: float) -> Array:
        model = self.model.with_(force=p)
        try:
            return model.linearised()[0]
        except InputError:
            return np.full_like(self.mass, np.nan)  # extensible links turned inside out

    def slope(self, p: float) -> Array:
        # The stiffness of extensible links changes over forces of the order of the tensile
        # stiffness S > 1e3; the relative error of the difference quotient is (step / S)^2.
        step = 1.0 if p >= 1.0 else 0.5 * p or 1.0
        below = max(0.0, p - step)
        return (self.stiffness(p + step) - self.stiffness(below)) / (p + step - below)


def linearised(model: Model, method: Method | None = None) -> Linearisation:
    """Return the linearisation of the straight state of a model.

    Parameters
    ----------
    model : Model
        Model of the filament or chain.
    method : {"spectral", "modes", "discrete"}, optional
        By default "spectral" if the model has a continuous limit, else "discrete".

    Returns
    -------
    Linearisation

    Raises
    ------
    InputError
        The method is unknown, or needs a continuous limit that the model does not have.
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
    displacements, _ = basis.evaluate(_SHAPE_POINTS)
    return _SHAPE_POINTS, np.asarray((displacements @ vectors).T)


def _thinned(breaks: tuple[float, ...], pieces: int) -> tuple[float, ...]:
    """Return at most `pieces` - 1 of the breaks, selected evenly."""
    if len(breaks) < pieces:
        return breaks
    selected = np.linspace(0, len(breaks) - 1, pieces + 1)[1:-1]
    return tuple(breaks[round(k)] for k in selected)


def _continuum(model: Model) -> DensityLoad:
    if model.continuum_load is None:
        raise InputError(
            "this model stands for no continuous inextensible filament, which the methods"
            " 'spectral' and 'modes' compute; use method = 'discrete'"
        )
    return model.continuum_load


# Degree on a single element, which gives the first threshold of a smooth profile to round-off, and
# number of modes, which gives it to eight digits. Each answer measures its own error.
_FIRST_DEGREE, _MODE_COUNT = 24, 72

_METHODS: Mapping[str, Callable[[Model], Linearisation]] = {
    "spectral": lambda model: _polynomials(_continuum(model)),
    "modes": lambda model: AssumedModes(_continuum(model), _MODE_COUNT),
    "discrete": Links,
}


def _polynomials(load: DensityLoad) -> Polynomials:
    elements = len(_thinned(load.breaks, _MAX_ELEMENTS)) + 1
    return Polynomials(load, max(10, _FIRST_DEGREE // elements))
