"""Lists that hold the signals of a joint side by side: `state[1]` the angle of joint 1, `state[2]`
its speed, `state[3]` its torque, `state[4]` the angle of joint 2."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.measurement.columns.rates import (
    ALIKE,
    GOES_WITH,
    LEAST,
    MOST_ROWS,
    WIDTH,
    correlation,
    rates,
)

_PLACE = re.compile(r"(.+)\[(\d+)\]")


def interleaved(columns: Mapping[str, Array], row: float) -> dict[str, list[list[str]]]:
    """By the name of a list the columns of its signals, each in the order of the joints.

    Of lists in which every second, or third, number is the rate of the one before it, and of those
    that are as long.

    Args:
        columns: of the file, by name.
        row: time from one row to the next [s].
    """
    lengths: dict[str, int] = {}
    for name in columns:
        place = _PLACE.fullmatch(name)
        if place is not None:
            lengths[place[1]] = lengths.get(place[1], 0) + 1
    places = {name: [f"{name}[{i + 1}]" for i in range(k)] for name, k in lengths.items()}
    places = {name: names for name, names in places.items() if all(n in columns for n in names)}
    steps: dict[int, int] = {}
    for names in places.values():
        step = _step([columns[name][:MOST_ROWS] for name in names], row)
        steps[len(names)] = step or steps.get(len(names), 0)
    return {
        name: [names[k :: steps[len(names)]] for k in range(steps[len(names)])]
        for name, names in places.items()
        if steps[len(names)]
    }


def place_of(name: str, signals: int, k: int) -> str:
    """The columns of a signal as a column map has them.

    Args:
        name: of the list; signals: of a joint; k: which of them, from 0.
    """
    back = k + 1 - signals
    return f"{name}[{{{signals}j{back or ''}}}]"


def _step(numbers: list[Array], row: float) -> int:
    """How many signals of a joint stand side by side in columns; 0 where they do not.

    Args:
        numbers: of the list, a column each.
        row: time from one row to the next [s].
    """
    k = len(numbers)
    if len({len(values) for values in numbers}) > 1 or len(numbers[0]) < 10 * WIDTH:
        return 0
    known = rates(np.column_stack(numbers))
    goes = correlation(known)
    for step in (3, 2):
        angles = np.arange(0, k - k % step, step)
        moving = angles[known.moves[angles]]
        if k % step or len(moving) < LEAST:
            continue
        speeds = moving + 1
        # joints that follow each other's motion go with each other throughout
        others = goes[speeds[:-1], moving[1:]]
        products = np.sum(known.changes[:, moving] * known.sums[:, speeds], axis=0)
        power = row * np.sum(known.sums[:, speeds] ** 2, axis=0)
        in_time = (products < ALIKE * power) & (power < ALIKE * products)
        if goes[moving, speeds].min() > GOES_WITH > others.min() and in_time.all():
            return step
    return 0
