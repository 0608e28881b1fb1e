"""Polynomials on cells, by their Bernstein coefficients.

    f(t) = sum_k C(d, k) t^k (1 - t)^(d - k) f_k,      0 <= t <= 1

Axis 1 of an array (m, d + 1, …) holds the coefficients f_k of polynomials of degree d on m cells.
A polynomial stays between its least and its largest coefficient (`hull`), and takes the values f_0
and f_d at the cell's ends. (Farouki, The Bernstein polynomial basis: a centennial retrospective,
Computer Aided Geometric Design 29, 2012.)
"""

from __future__ import annotations

from collections.abc import Callable
from functools import reduce
from math import comb

import numpy as np

from irb2400_ctrl.arrays import Array

AT_ONCE = 2000
"""cells that are worked on at once: what they need fits a processor's cache"""


def blocks(count: int, size: int = AT_ONCE) -> list[slice]:
    """Neighbouring cells that are worked on at once, of so many."""
    return [slice(first, min(first + size, count)) for first in range(0, count, size)]


def basis(degree: int, t: Array) -> Array:
    """The Bernstein polynomials of a degree at the places t (k,), shape (k, degree + 1): values are
    basis @ coefficients."""
    columns = [comb(degree, k) * t**k * (1 - t) ** (degree - k) for k in range(degree + 1)]
    return np.stack(columns, axis=1)


def linear(first: Array, last: Array) -> Array:
    """The straight line between values at the two ends of the cells, (m, …) each."""
    return np.stack([first, last], axis=1)


def through(first: Array, middle: Array, last: Array) -> Array:
    """The parabola through values at start, middle and end of the cells, (m, …) each."""
    return np.stack([first, 2 * middle - (first + last) / 2, last], axis=1)


def leaving(first: Array, rise: Array, last: Array) -> Array:
    """The parabola from `first` to `last` that begins with the slope `rise` over t."""
    return np.stack([first, first + rise / 2, last], axis=1)


def from_powers(coefficients: Array, width: Array) -> Array:
    """Of sum_i c_i w^i, 0 <= w <= width, from its c_i along axis 0, shape (d + 1, m, …)."""
    degree = len(coefficients) - 1
    scaled = [c * width**i for i, c in enumerate(coefficients)]
    found = [
        sum(comb(k, i) / comb(degree, i) * scaled[i] for i in range(k + 1))
        for k in range(degree + 1)
    ]
    return np.stack(found, axis=1)


def product(f: Array, g: Array, times: Callable[[Array, Array], Array] = np.multiply) -> Array:
    """The product of two polynomials, or any bilinear function of them (`np.cross`)."""
    p = f.shape[1] - 1
    q = g.shape[1] - 1
    scaled = [_times(comb(p, i), f[:, i]) for i in range(p + 1)]
    other = [_times(comb(q, j), g[:, j]) for j in range(q + 1)]
    found = []
    for k in range(p + q + 1):
        terms = [times(scaled[i], other[k - i]) for i in range(max(0, k - q), min(p, k) + 1)]
        found.append(_mean(terms, comb(p + q, k)))
    return np.stack(found, axis=1)


def raised(f: Array, degree: int) -> Array:
    """The same polynomial with the coefficients of a higher degree."""
    d = f.shape[1] - 1
    more = degree - d
    found = []
    for k in range(degree + 1):
        among = range(max(0, k - more), min(d, k) + 1)
        terms = [_times(comb(d, i) * comb(more, k - i), f[:, i]) for i in among]
        found.append(_mean(terms, comb(degree, k)))
    return np.stack(found, axis=1)


def _times(weight: int, f: Array) -> Array:
    return f if weight == 1 else weight * f


def _mean(terms: list[Array], weight: int) -> Array:
    total = sum(terms[1:], terms[0])
    return total if weight == 1 else total / weight


def times_parameter(f: Array) -> Array:
    """t f(t), of one degree more."""
    degree = f.shape[1]
    grown = [k * f[:, k - 1] / degree for k in range(1, degree + 1)]
    return np.stack([np.zeros_like(f[:, 0]), *grown], axis=1)


def highest(f: Array) -> Array:
    """Upper bound of f on each cell, (m, …)."""
    # by coefficients: numpy reduces a short axis slowly
    return reduce(np.maximum, (f[:, k] for k in range(f.shape[1])))


def lowest(f: Array) -> Array:
    """Lower bound of f on each cell, (m, …)."""
    return reduce(np.minimum, (f[:, k] for k in range(f.shape[1])))


def hull(f: Array) -> tuple[Array, Array]:
    """Bounds below and above f on each cell, each (m, …)."""
    return lowest(f), highest(f)


def largest_size(f: Array) -> Array:
    """Upper bound of |f| on each cell, (m, …)."""
    return highest(np.abs(f))


def least_size(f: Array) -> Array:
    """Lower bound of |f| on each cell, (m, …): zero where the coefficients have both signs."""
    low, high = hull(f)
    return np.where((low >= 0) | (high <= 0), lowest(np.abs(f)), 0.0)
