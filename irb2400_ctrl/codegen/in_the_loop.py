"""Processor in the loop: generated code steers a simulated plant, on this computer or on the
emulated target."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from irb2400_ctrl.codegen.controller import Controller
from irb2400_ctrl.errors import InputError

Array = NDArray[Any]
Sense = Callable[[int, Array], ArrayLike]
"""(step number, plant state) -> input vector of the controller"""
Plant = Callable[[Array, Array], ArrayLike]
"""(plant state, controller output) -> plant state one sample later"""


@dataclass(frozen=True)
class LoopRecord:
    """What happened in a closed loop of n steps."""

    states: Array
    """plant states, shape (n + 1, nx)"""
    outputs: Array
    """controller outputs, shape (n, ny), in the controller's precision"""
    status: Array
    """status words of the controller, shape (n,); 0: no fault"""

    def same_bits(self, other: LoopRecord) -> bool:
        """Whether two records are identical in every bit."""
        pairs = (
            (self.states, other.states),
            (self.outputs, other.outputs),
            (self.status, other.status),
        )
        return all(a.dtype == b.dtype and a.tobytes() == b.tobytes() for a, b in pairs)


def run_in_the_loop(
    controller: Controller, plant: Plant, sense: Sense, x0: ArrayLike, steps: int
) -> LoopRecord:
    """Close the loop of a generated controller and a plant, sample by sample.

    Args:
        controller: `HostController` or `TargetController`; reset first.
        plant: advances the plant by one sample time; the controller's output is held meanwhile.
        sense: what the controller gets to see (measurement and reference).
        x0: first plant state, shape (nx,).
        steps: number of samples.

    Raises:
        InputError: no steps, or an input vector of the wrong size.
    """
    if steps < 1:
        raise InputError(f"found {steps} steps; expected at least one")
    controller.reset()
    x = np.array(x0, float)
    states = [x]
    outputs = []
    status = []
    for k in range(steps):
        y, word = controller.step(sense(k, x))
        x = np.array(plant(x, y.astype(float)), float)
        states.append(x)
        outputs.append(y)
        status.append(word)
    arrays = (np.array(states), np.array(outputs), np.array(status, np.uint32))
    for array in arrays:
        array.flags.writeable = False
    return LoopRecord(*arrays)
