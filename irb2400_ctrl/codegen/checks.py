"""Points to check a generated package at, and comparisons with the block it was made from."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from irb2400_ctrl.codegen.block import Block, Field
from irb2400_ctrl.codegen.controller import Controller
from irb2400_ctrl.codegen.package import FAULT_INPUT, Package

Array = NDArray[Any]
RUNS = 16
STEPS = 96
"""of a run; a guard's start is over after half of them"""
FARTHEST = 1e4
"""of a reached state, in its unit: one that ran away says nothing of the others"""


def random_points(package: Package, count: int) -> tuple[Array, Array]:
    """States (count, nx) and inputs (count, nu) inside the bounds.

    Half of the inputs are small, where friction is steep. Half of the states are drawn, each number
    for itself; the others are such as the block comes to by itself: a drawn one hardly has a
    switch, a counter or a share of the start at a value that lets the law through, and the law
    would be compared nowhere.
    """
    rng = np.random.default_rng(20240)
    block = package.block
    states = _drawn(rng, block.states, count)
    inputs = _drawn(rng, block.inputs, count)
    if block.states:
        _put_reached(rng, block, states, inputs)
    held = sum(f.size for f in block.outputs)
    dtype = np.float32 if package.real == "float" else np.float64
    # rounded first: both sides get the very same numbers; towards zero, so that bounds are kept
    states = np.hstack([states, np.zeros((count, held))]).astype(dtype)
    # of a range beside zero one end lies on the way there
    low = np.concatenate([np.zeros(0), *(f.lower or (-np.inf,) * f.size for f in block.inputs)])
    high = np.concatenate([np.zeros(0), *(f.upper or (np.inf,) * f.size for f in block.inputs)])
    return states, np.clip(_inwards(inputs, dtype), low.astype(dtype), high.astype(dtype))


def _drawn(rng: np.random.Generator, fields: tuple[Field, ...], count: int) -> Array:
    """Values of all fields side by side, every other row drawn towards the start values."""
    columns = [np.zeros((count, 0))]
    for f in fields:
        low, high, near = _room(f)
        values = low + (high - low) * rng.uniform(0, 1, (count, f.size))
        small = 10.0 ** rng.uniform(-4, 0, count)
        shrink = np.where(np.arange(count) % 2, 1.0, small)
        columns.append(near + shrink[:, None] * (values - near))
    return np.hstack(columns)


def _room(field: Field) -> tuple[Array, Array, Array]:
    """Least, largest and start value to draw of a field, shapes (size,)."""
    room = np.maximum(1.0, np.abs(field.start))
    low = np.array(field.lower) if field.lower else field.start - room
    high = np.array(field.upper) if field.upper else field.start + room
    return low, high, np.clip(field.start, low, high)


def _put_reached(rng: np.random.Generator, block: Block, states: Array, inputs: Array) -> None:
    """Put states from runs of the block into every second pair of rows, and inputs between those of
    the run and those that were drawn.

    A run starts at the initial state and has the same input at every step: next to the start values
    by a millionth of the range or more. What ran away is left out.

    Args:
        rng: draws runs and steps.
        block: that is run, in double.
        states: drawn, a row a point; changed in place.
        inputs: drawn, likewise.
    """
    every = [_room(f) for f in block.inputs]
    near = np.concatenate([np.zeros(0), *(start for _, _, start in every)])
    far = _drawn(rng, block.inputs, RUNS)
    held = near + 10.0 ** rng.uniform(-6, 0, (RUNS, 1)) * (far - near)
    parameters = np.concatenate([np.zeros(0), *(f.start for f in block.parameters)])
    start = np.concatenate([f.start for f in block.states])
    run = block.flat().mapaccum(STEPS).map(RUNS)
    found, _ = run(
        np.tile(start[:, None], RUNS),
        np.repeat(held, STEPS, axis=0).T,
        np.tile(parameters[:, None], RUNS * STEPS),
    )
    reached = np.array(found).T.reshape(RUNS, STEPS, -1)
    rows = np.flatnonzero(np.arange(len(states)) % 4 >= 2)
    which = rng.integers(RUNS, size=rows.size)
    taken = reached[which, rng.integers(STEPS, size=rows.size)]
    quiet = np.all(np.abs(taken) <= FARTHEST, axis=1)
    rows = rows[quiet]
    states[rows] = taken[quiet]
    away = 10.0 ** rng.uniform(-6, 0, (rows.size, 1))
    base = held[which[quiet]]
    inputs[rows] = base + away * (inputs[rows] - base)


def _inwards(values: Array, dtype: type[np.floating[Any]]) -> Array:
    rounded = values.astype(dtype)
    outside = np.abs(rounded.astype(float)) > np.abs(values)
    return np.where(outside, np.nextafter(rounded, dtype(0)), rounded)


def run_points(controller: Controller, states: Array, inputs: Array) -> tuple[Array, Array]:
    """(next states with held outputs, outputs), row by row.

    Args:
        controller: compiled.
        states: a row a point.
        inputs: a row a point.
    """
    after = []
    outputs = []
    for x, u in zip(states, inputs, strict=True):
        controller.state = x
        y, status = controller.step(u)
        after.append(controller.state)
        # a fault at an ordinary state must not pass for agreement
        outputs.append(y if status == 0 else np.full_like(y, np.nan))
    return np.array(after), np.array(outputs)


def compare_with_block(
    package: Package, states: Array, inputs: Array, after: Array, outputs: Array
) -> tuple[dict[str, float], float]:
    """Largest difference per field to the block's own step in double, outputs saturated; and the
    largest relative.

    Args:
        package: whose block is meant.
        states: a row a point.
        inputs: a row a point.
        after: next states that its C gives, likewise.
        outputs: that its C gives, likewise.
    """
    block = package.block
    width = sum(f.size for f in block.states)
    dtype = states.dtype
    parameters = (
        np.concatenate([np.zeros(0), *(f.start for f in block.parameters)])
        .astype(dtype)
        .astype(float)
    )
    columns = [a.astype(float).T for a in (states[:, :width], inputs)]
    spread = np.tile(parameters[:, None], len(inputs))
    expected_after, expected = (
        np.array(v).T for v in block.flat().map(len(inputs))(*columns, spread)
    )
    low = np.concatenate([f.lower or (-np.inf,) * f.size for f in block.outputs]).astype(dtype)
    high = np.concatenate([f.upper or (np.inf,) * f.size for f in block.outputs]).astype(dtype)
    found = np.hstack([after[:, :width], outputs]).astype(float)
    wanted = np.hstack([expected_after, np.clip(expected, low, high)])
    differences = {}
    relative = 0.0
    at = 0
    names = [f"{f.name} (next)" for f in block.states] + [f.name for f in block.outputs]
    for name, field in zip(names, (*block.states, *block.outputs), strict=True):
        part = slice(at, at + field.size)
        error = np.abs(found[:, part] - wanted[:, part])
        worst = float(np.max(error)) if np.isfinite(error).all() else float("inf")
        differences[name] = worst
        relative = max(relative, worst / max(float(np.max(np.abs(wanted[:, part]))), 1e-9))
        at += field.size
    return differences, relative


def faults_are_held(controller: Controller, ordinary: Array) -> bool:
    """Whether every single wrong input raises the fault, repeats the output and keeps the state."""
    controller.reset()
    good, status = controller.step(ordinary)
    before = controller.state
    if status != 0:
        return False
    for wrong in wrong_inputs(controller.package, ordinary):
        answer, status = controller.step(wrong)
        if (
            status != FAULT_INPUT
            or not np.array_equal(answer, good)
            or not np.array_equal(controller.state, before)
        ):
            return False
    return controller.step(ordinary)[1] == 0


def wrong_inputs(package: Package, ordinary: Array) -> list[Array]:
    """The ordinary input with one element that is no number, infinite, or beyond a bound."""
    wrong = []
    at = 0
    for field in package.block.inputs:
        for i in range(0 if field.judged else field.size):
            bad = [np.nan, np.inf, -np.inf]
            bad += [field.lower[i] - max(1e-3, 1e-3 * abs(field.lower[i]))] if field.lower else []
            bad += [field.upper[i] + max(1e-3, 1e-3 * abs(field.upper[i]))] if field.upper else []
            for value in bad:
                changed = ordinary.copy()
                changed[at + i] = value
                wrong.append(changed)
        at += field.size
    return wrong
