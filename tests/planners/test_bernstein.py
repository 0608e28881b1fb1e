"""Polynomials by their Bernstein coefficients: every operation is that of the polynomials, and the
hull holds."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import numpy.typing as npt
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from irb2400_ctrl.planners.enclosure import bernstein

Array = npt.NDArray[np.float64]

CELLS = 3
T = np.linspace(0, 1, 41)
NUMBERS = st.floats(-1e3, 1e3, allow_nan=False)


def polynomials(vectors: int | None = None) -> st.SearchStrategy[Array]:
    """Coefficients (cells, degree + 1) of degree 0 to 5, or of vectors (cells, degree + 1, n)."""
    more = () if vectors is None else (vectors,)
    return st.integers(1, 6).flatmap(lambda d: arrays(float, (CELLS, d, *more), elements=NUMBERS))


def value(f: Array) -> Array:
    """Of every cell at all T by de Casteljau's scheme, shape (cells, T, …)."""
    t = T.reshape(1, -1, *[1] * (f.ndim - 2))
    shape = (len(f), len(T), *f.shape[2:])
    left = [np.broadcast_to(f[:, k, None], shape) for k in range(f.shape[1])]
    while len(left) > 1:
        left = [(1 - t) * one + t * other for one, other in pairwise(left)]
    return left[0]


def close(found: Array, expected: Array, terms: float = 0.0) -> None:
    """Equal up to the rounding of terms of this size."""
    room = 1e-12 * (1 + terms + np.abs(expected).max())
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=room)


@given(polynomials())
def test_basis_gives_the_values_and_adds_up_to_one(f: Array) -> None:
    basis = bernstein.basis(f.shape[1] - 1, T)
    close(f @ basis.T, value(f))
    close(basis.sum(axis=1), np.ones(len(T)))


@given(polynomials(), polynomials())
def test_product_is_that_of_the_values(f: Array, g: Array) -> None:
    found = bernstein.product(f, g)
    assert found.shape == (CELLS, f.shape[1] + g.shape[1] - 1)
    close(value(found), value(f) * value(g))


@given(polynomials(3), polynomials(3))
def test_product_of_vectors_by_any_bilinear_function(f: Array, g: Array) -> None:
    size = float(np.abs(f).max() * np.abs(g).max())
    close(value(bernstein.product(f, g, np.cross)), np.cross(value(f), value(g)), size)


@given(polynomials(2), polynomials())
def test_product_broadcasts_behind_the_coefficients(f: Array, g: Array) -> None:
    close(value(bernstein.product(f, g[..., None])), value(f) * value(g)[..., None])


@given(polynomials(2), st.integers(0, 4))
def test_raising_keeps_the_polynomial(f: Array, more: int) -> None:
    degree = f.shape[1] - 1 + more
    found = bernstein.raised(f, degree)
    assert found.shape[1] == degree + 1
    close(value(found), value(f))
    close(found[:, [0, -1]], f[:, [0, -1]])


@given(polynomials())
def test_times_parameter(f: Array) -> None:
    found = bernstein.times_parameter(f)
    assert found.shape[1] == f.shape[1] + 1
    close(value(found), T * value(f))


@given(arrays(float, (4, CELLS), elements=NUMBERS), st.floats(0.01, 10))
def test_from_powers(c: Array, width: float) -> None:
    found = bernstein.from_powers(c, np.full(CELLS, width))
    close(value(found), sum(a[:, None] * (width * T) ** i for i, a in enumerate(c)))


@given(arrays(float, (3, CELLS, 2), elements=NUMBERS))
def test_lines_and_parabolas_meet_what_they_are_made_of(values: Array) -> None:
    first, middle, last = values
    line = value(bernstein.linear(first, last))
    close(line, first[:, None] + T[:, None] * (last - first)[:, None])
    parabola = value(bernstein.through(first, middle, last))
    close(parabola[:, [0, 20, 40]], np.stack(values, axis=1))
    close(np.diff(parabola, 3, axis=1), np.zeros((CELLS, 38, 2)), float(np.abs(values).max()))
    rise = middle
    leaving = bernstein.leaving(first, rise, last)
    close(value(leaving)[:, [0, 40]], np.stack([first, last], axis=1))
    close(2 * (leaving[:, 1] - leaving[:, 0]), rise)


@given(polynomials(2))
def test_hull_and_sizes_enclose_every_value(f: Array) -> None:
    room = 1e-12 * (1 + np.abs(f).max())
    low, high = bernstein.hull(f)
    seen = value(f)
    assert (seen >= low[:, None] - room).all()
    assert (seen <= high[:, None] + room).all()
    assert (np.abs(seen) <= bernstein.largest_size(f)[:, None] + room).all()
    assert (np.abs(seen) >= bernstein.least_size(f)[:, None] - room).all()


def test_least_size_is_sharp_for_one_sign_and_zero_for_two() -> None:
    f = np.array([[1.0, 2, 3], [-3, -2, -1], [-1, 0, 1], [0, 5, 7]])
    np.testing.assert_array_equal(bernstein.least_size(f), [1, 1, 0, 0])
