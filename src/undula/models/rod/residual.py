"""Compiled equations of the linked rod: residual, drag, rates, rotation, error norm."""

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from undula.jit.compilation import kernel
from undula.models.rod.joint import stiffening
from undula.models.rod.tables import RODS, RODS_WITH_OWN_JOINTS, DirectedRod
from undula.models.rod.vectors import vectors
from undula.numerics.integration.system import (
    apply_drag,
    constraint_error,
    error_norm,
    generator,
    implements,
    rates,
    residual,
    rotate,
)


@cache
def tangents_kernel(rod: Any) -> Callable[..., Any]:
    """Return `tangents(system, y, t, l)`: link tangents t (N, d) and lengths l (N,)."""
    d, m, extensible = rod.dimension, rod.stride, rod.extensible

    @kernel
    def tangents(system: Any, y: Any, t: Any, length: Any) -> None:
        inverse = 1.0 / system.link
        for a in range(d):
            t[0, a] = y[a] * inverse
        for i in range(1, t.shape[0]):
            for a in range(d):
                t[i, a] = (y[m * i + a] - y[m * (i - 1) + a]) * inverse
        for i in range(t.shape[0]):
            length[i] = system.link
            if extensible:
                square = 0.0
                for a in range(d):
                    square += t[i, a] * t[i, a]
                stretch = math.sqrt(square)
                length[i] *= stretch
                for a in range(d):
                    t[i, a] /= stretch

    return tangents


@cache
def cosine_kernel(dimension: int) -> Callable[..., Any]:
    """Return `cosine(t, i)`: t_{i-1} . t_i, with the clamp's e_z before the first link.

    It is computed from the chord, as 1 - |t_i - t_{i-1}|^2 / 2, which is the same for unit vectors.
    During Newton's iteration tangents are not of unit length; their error then changes the cosine
    by the square of the joint's angle only, so that the matrix without the slope of g is accurate
    from the first correction on.
    """
    d = dimension

    @kernel
    def cosine(t: Any, i: Any) -> Any:
        square = 0.0
        for a in range(d):
            previous = t[i - 1, a] if i > 0 else (1.0 if a == d - 1 else 0.0)
            square += (t[i, a] - previous) * (t[i, a] - previous)
        return 1.0 - 0.5 * square

    return cosine


@cache
def link_kernel(rod: Any) -> Callable[..., Any]:
    """Return `link(system, e)`: tangent and length of a link with the vector e along it."""
    times, dot, extensible = (
        vectors(rod.dimension).times,
        vectors(rod.dimension).dot,
        rod.extensible,
    )

    @kernel
    def link(system: Any, e: Any) -> Any:
        if extensible:
            length = math.sqrt(dot(e, e))
            return times(1.0 / length, e), length
        return times(1.0 / system.link, e), system.link

    return link


@cache
def moment_kernel(dimension: int) -> Callable[..., Any]:
    """Return `moment(system, t, u, i)`: a and K g (1 - c) of the joint from t to u below link i.

    c is computed from the chord, as in `cosine_kernel`.
    """
    v = vectors(dimension)
    minus, times, dot = v.minus, v.times, v.dot

    @kernel
    def moment(system: Any, t: Any, u: Any, i: Any) -> Any:
        step = minus(u, t)
        chord = 0.5 * dot(step, step)
        bend = system.joint[i] * stiffening(1.0 - chord)
        return times(bend, step), bend * chord

    return moment


@cache
def along_kernel(rod: Any) -> Callable[..., Any]:
    """Return `along(t, u, i)`: s . u / |s|^2 at node i, so that m m . u = s (s . u) / |s|^2.

    s = t_i + t_{i+1} has the direction m of the drag; at the last node s = t_i.
    """
    d, m = rod.dimension, rod.stride

    @kernel
    def along(t: Any, u: Any, i: Any) -> Any:
        product = square = 0.0
        for a in range(d):
            s = t[i, a] + (t[i + 1, a] if i + 1 < t.shape[0] else 0.0)
            product += s * u[m * i + a]
            square += s * s
        return product / square

    return along


@cache
def mean_tangent_kernel(dimension: int) -> Callable[..., Any]:
    """Return `mean_tangent(t, i, out)`: write the drag's direction m, return 1/|t_i + t_{i+1}|."""
    d = dimension

    @kernel
    def mean_tangent(t: Any, i: Any, out: Any) -> Any:
        last = i == t.shape[0] - 1
        square = 0.0
        for a in range(d):
            out[a] = t[i, a] if last else t[i, a] + t[i + 1, a]
            square += out[a] * out[a]
        inverse = 1.0 / math.sqrt(square)
        for a in range(d):
            out[a] *= inverse
        return inverse

    return mean_tangent


@cache
def rates_kernel(rod: Any) -> Any:
    """Return `rates(system, y, v, out)` of `undula.numerics.integration.system` for line loads."""
    d, m = rod.dimension, rod.stride
    read, _, plus, minus, _, dot, _ = vectors(d)
    link, zero = link_kernel(rod), (0.0,) * d

    @kernel
    def rod_rates(system: Any, y: Any, v: Any, out: Any) -> None:
        n = system.joint.shape[0]
        node, before = read(y, 0), zero
        t, _ = link(system, node)
        spin = inertia = power = dissipation = 0.0
        for i in range(n):
            k, velocity = m * i, read(v, m * i)
            outer, u, s = node, t, t
            if i + 1 < n:
                outer = read(y, k + m)
                u, _ = link(system, minus(outer, node))
                s = plus(t, u)
            if d == 3:
                spin += y[k] * v[k + 1] - y[k + 1] * v[k]
                inertia += y[k] * y[k] + y[k + 1] * y[k + 1]
            along = dot(s, velocity)
            along_reduction = system.anisotropy * along * along / dot(s, s)
            dissipation += system.weight[i] * (dot(velocity, velocity) - along_reduction)
            power -= system.outer_force[i] * dot(t, velocity) + system.inner_force[i] * dot(
                t, before
            )
            node, t, before = outer, u, velocity
        out[0] = spin / inertia if inertia > 0.0 else 0.0
        out[1] = power
        out[2] = dissipation

    return rod_rates


def _register_forces(rod: Any) -> None:
    d, m, extensible = rod.dimension, rod.stride, rod.extensible
    read, write, plus, minus, times, dot, axis = vectors(d)
    link, moment, zero = link_kernel(rod), moment_kernel(d), (0.0,) * d

    @implements(residual, rod)
    def rod_residual(system: Any, y: Any, w: Any, c: Any, out: Any) -> None:
        n = system.joint.shape[0]
        node = read(y, 0)
        t, length = link(system, node)
        a, shortfall = moment(system, axis, t, 0)
        row = zero  # residual of node i - 1 without the force of the link to node i
        for i in range(n):
            k, last = m * i, i + 1 == n
            outer, u, outer_length, s = node, t, length, t
            b, outer_shortfall = zero, 0.0
            if not last:
                outer = read(y, k + m)
                u, outer_length = link(system, minus(outer, node))
                b, outer_shortfall = moment(system, t, u, i + 1)
                s = plus(t, u)
            multiplier = y[k + d]
            force = minus(times(1.0 / length, minus(b, a)), times(multiplier, t))
            if i > 0:
                write(out, k - m, plus(row, times(c, plus(force, times(system.inner_force[i], t)))))
            velocity = read(w, k)
            reduction = times(system.anisotropy * dot(s, velocity) / dot(s, s), s)
            drag = times(system.weight[i], minus(velocity, reduction))
            row = minus(drag, times(c, minus(force, times(system.outer_force[i], t))))
            if extensible:
                tension = multiplier + (shortfall + outer_shortfall) / length
                out[k + d] = length / system.link - 1.0 - tension / system.tensile
            else:
                out[k + d] = 0.5 * (dot(t, t) - 1.0)
            node, t, length, a, shortfall = outer, u, outer_length, b, outer_shortfall
        write(out, m * (n - 1), row)

    if not extensible:

        @implements(constraint_error, rod)
        def rod_constraint_error(system: Any, y: Any) -> Any:
            n, largest = system.joint.shape[0], 0.0
            for i in range(n):
                square = 0.0
                for a in range(d):
                    link = y[m * i + a] - (y[m * (i - 1) + a] if i > 0 else 0.0)
                    square += link * link
                largest = max(largest, abs(0.5 * (square * n * n - 1.0)))
            return largest


def _register_motion(rod: Any) -> None:
    d, m = rod.dimension, rod.stride
    tangents, along = tangents_kernel(rod), along_kernel(rod)

    @implements(apply_drag, rod)
    def rod_apply_drag(system: Any, y: Any, u: Any, out: Any) -> None:
        n = system.joint.shape[0]
        t, length = np.empty((n, d)), np.empty(n)
        tangents(system, y, t, length)
        for i in range(n):
            reduction = system.anisotropy * along(t, u, i)
            for a in range(d):
                direction = t[i, a] + (t[i + 1, a] if i + 1 < n else 0.0)
                out[m * i + a] = system.weight[i] * (u[m * i + a] - reduction * direction)
            for k in range(m * i + d, m * i + m):
                out[k] = 0.0

    if rod is not DirectedRod:
        implements(rates, rod)(rates_kernel(rod))

    @implements(error_norm, rod)
    def rod_error_norm(system: Any, vector: Any, mask: Any) -> Any:
        total = 0.0
        for a in range(d):
            total += vector[a] * vector[a]
        for k in range(mask.shape[0] - m):  # masked, as loops without gaps are vectorised
            change = vector[k + m] - vector[k]
            total += mask[k] * change * change
        return math.sqrt(total * system.joint.shape[0])

    if d == 3 and rod is not DirectedRod:

        @implements(generator, rod)
        def rod_generator(system: Any, y: Any, out: Any) -> None:
            for k in range(0, y.shape[0], 4):
                x = y[k]
                out[k] = -y[k + 1]
                out[k + 1] = x
                out[k + 2] = 0.0
                out[k + 3] = 0.0

        @implements(rotate, rod)
        def rod_rotate(system: Any, y: Any, angle: Any, out: Any) -> None:
            cosine, sine = math.cos(angle), math.sin(angle)
            for k in range(0, y.shape[0], 4):
                x, z = y[k], y[k + 1]
                out[k] = cosine * x - sine * z
                out[k + 1] = sine * x + cosine * z
                out[k + 2] = y[k + 2]
                out[k + 3] = y[k + 3]


for _rod in RODS:
    _register_motion(_rod)
    if _rod not in RODS_WITH_OWN_JOINTS:
        _register_forces(_rod)
