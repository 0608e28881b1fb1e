"""Points to check a generated package at, and comparisons with the block it was made from."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from irb2400_ctrl.codegen.block import Field
from irb2400_ctrl.codegen.controller import Controller
from irb2400_ctrl.codegen.package import FAULT_INPUT, Package

Array = NDArray[Any]


def random_points(package: Package, count: int) -> tuple[Array, Array]:
    """States (count, nx) and inputs (count, nu) inside the bounds; half of them small, where
    friction is steep."""
    rng = np.random.default_rng(20240)
    held = sum(f.size for f in package.block.outputs)
    states = np.hstack([_drawn(rng, package.block.states, count), np.zeros((count, held))])
    inputs = _drawn(rng, package.block.inputs, count)
    dtype = np.float32 if package.real == "float" else np.float64
    # rounded first: both sides get the very same numbers; towards zero, so that bounds are kept
    return states.astype(dtype), _inwards(inputs, dtype)


def _drawn(rng: np.random.Generator, fields: tuple[Field, ...], count: int) -> Array:
    """Values of all fields side by side, every other row drawn towards the start values."""
    columns = [np.zeros((count, 0))]
    for f in fields:
        room = np.maximum(1.0, np.abs(f.start))
        low = np.array(f.lower) if f.lower else f.start - room
        high = np.array(f.upper) if f.upper else f.start + room
        values = low + (high - low) * rng.uniform(0, 1, (count, f.size))
        near = np.clip(f.start, low, high)
        small = 10.0 ** rng.uniform(-4, 0, count)
        shrink = np.where(np.arange(count) % 2, 1.0, small)
        columns.append(near + shrink[:, None] * (values - near))
    return np.hstack(columns)


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
