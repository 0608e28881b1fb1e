"""Numpy's arrays: names for their types, one for each kind of element, and algebra with them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import numpy.typing as npt
from threadpoolctl import threadpool_limits

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Integers = npt.NDArray[np.int64]


def inner_products(a: Array, b: Array) -> Array:
    """Of the vectors in the last axis; numpy's sum over a short axis takes several times as
    long."""
    return np.asarray(np.einsum("...k,...k->...", a, b))


def norms(a: Array) -> Array:
    """Lengths of the vectors in the last axis."""
    return np.sqrt(inner_products(a, a))


@contextmanager
def one_thread() -> Iterator[None]:
    """Linear algebra on one thread: the matrices of an arm are small, and threads would only wait
    for each other (a plan takes twice the time on a busy machine)."""
    with threadpool_limits(limits=1, user_api="blas"):
        yield
