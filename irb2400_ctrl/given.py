"""What a caller gave, as numbers; what is none is refused by its name."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError


def numbers(name: str, value: ArrayLike) -> Array:
    """The value as an array of floats, whatever its shape.

    Args:
        name: of the argument.
        value: as given.

    Raises:
        InputError: text, an object, or rows of different lengths.
    """
    try:
        return np.asarray(value, dtype=float)
    except (TypeError, ValueError) as error:
        raise InputError(f"{name}: found {value!r:.60}, expected an array of numbers") from error


def finite(name: str, value: ArrayLike, shape: tuple[int, ...], unit: str) -> Array:
    """The value as an array of that shape without NaN or inf.

    Args:
        name: of the argument.
        value: as given.
        shape: that it has to have.
        unit: for the message.

    Raises:
        InputError: another shape, or an element that is not finite.
    """
    array = numbers(name, value)
    if array.shape != shape or not np.isfinite(array).all():
        raise InputError(
            f"{name}: found {value!r:.60}, expected finite numbers [{unit}] of shape {shape}"
        )
    return array


def positive(name: str, value: object, unit: str) -> float:
    """The value as one finite number above zero.

    Args:
        name: of the argument.
        value: as given.
        unit: for the message.

    Raises:
        InputError: it is none.
    """
    number = isinstance(value, int | float | np.number)
    if not (number and math.isfinite(value) and value > 0):  # type: ignore[arg-type, operator]
        raise InputError(f"{name}: found {value!r:.60}, expected a positive number [{unit}]")
    return float(value)  # type: ignore[arg-type]


def whole(name: str, value: object, least: int = 0) -> int:
    """The value as a whole number.

    Args:
        name: of the argument.
        value: as given.
        least: smallest that is allowed.

    Raises:
        InputError: it is none, or smaller.
    """
    if not isinstance(value, int | np.integer) or value < least:
        raise InputError(f"{name}: found {value!r:.60}, expected a whole number, at least {least}")
    return int(value)
