"""What a closed loop is asked for, looked at before anything is compiled or run."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.codegen import Block, Field
from irb2400_ctrl.controllers.parts import LONGEST
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.trajectory import Trajectory


def check_rate(rate: object) -> float:
    """The control rate as a number [1/s].

    Raises:
        InputError: no positive number.
    """
    if not (isinstance(rate, int | float | np.number) and math.isfinite(rate) and rate > 0):
        raise InputError(f"rate is {rate!r}; expected a positive number [1/s], for example 1000")
    if rate * LONGEST < 1:
        raise InputError(f"rate is {rate!r}; expected at least 1, a rate in 1/s and no period")
    return float(rate)


def check_duration(motion: Trajectory, period: float, hold: float) -> None:
    """Refuse a motion without two samples of the controller.

    Args:
        motion: that is to be followed.
        period: of the controller [s].
        hold: for which the last pose is held [s].

    Raises:
        InputError: a period longer than the motion, or a `hold` that shortens it.
    """
    if not (isinstance(hold, int | float | np.number) and math.isfinite(hold) and hold >= 0):
        raise InputError(f"hold is {hold!r}; expected a number of seconds, zero or more")
    if motion.duration + hold < period:
        raise InputError(
            f"the controller has a period of {period:g} s, the motion takes {motion.duration:g} s; "
            "expected a shorter period: a sample time is in seconds, a rate in 1/s"
        )


def check_seed(seed: object) -> None:
    """Refuse what seeds no noise.

    Raises:
        InputError: no whole number from zero on.
    """
    if not isinstance(seed, int | np.integer) or seed < 0:
        raise InputError(f"seed is {seed!r}; expected a whole number, zero or more")


def controller_parameters(controller: Block, gains: Mapping[str, ArrayLike]) -> dict[str, Array]:
    """Parameters of the controller under their names in the loop; one number stands for all
    elements.

    Raises:
        InputError: no parameter of that name, other than one or `size` numbers, no numbers, or
            such as the generated code refuses.
    """
    fields = {f.name: f for f in controller.parameters}
    unknown = sorted(str(name) for name in set(gains) - set(fields))
    if unknown:
        raise InputError(
            f"{controller.name} has no parameter {', '.join(unknown)}; it has "
            f"{', '.join(fields) or 'none'}"
        )
    return {f"c_{name}": _values(fields[name], value) for name, value in gains.items()}


def _values(field: Field, value: ArrayLike) -> Array:
    name = field.name
    size = field.size
    try:
        array = np.asarray(value, dtype=float)
    except (TypeError, ValueError) as error:
        raise InputError(f"gains, {name}: found {value!r}; expected numbers") from error
    if array.shape not in {(), (1,), (size,)}:
        raise InputError(
            f"gains, {name}: found shape {array.shape}; expected one number, or ({size},)"
        )
    if not np.isfinite(array).all():
        raise InputError(f"gains, {name}: found {value!r}; expected finite numbers")
    for bounds, beyond, word in (
        (field.lower, np.less, "least"),
        (field.upper, np.greater, "most"),
    ):
        if bounds and beyond(array, bounds).any():
            said = ", ".join(map(str, bounds if len(set(bounds)) > 1 else bounds[:1]))
            raise InputError(
                f"gains, {name}: found {value!r}; expected at {word} {said} [{field.unit}]: "
                "the C package refuses others"
            )
    return np.broadcast_to(array, size)
