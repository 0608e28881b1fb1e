"""Names for the types of numpy arrays, one for each kind of element, and products of short
vectors."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

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
