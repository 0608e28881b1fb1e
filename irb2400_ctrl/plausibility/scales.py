"""Torque columns in another unit, or on the other side of the gears: the factor is searched."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.optimize import minimize_scalar

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.plausibility.evidence import Nominal
from irb2400_ctrl.plausibility.problem import named
from irb2400_ctrl.plausibility.reading import Reading, as_labelled
from irb2400_ctrl.plausibility.rows import Rows

Cost = Callable[[Array], float]

LEAST = 2.5
"""a factor nearer to one than this is an arm's own doing, not a unit's"""
SHARP = 0.05
"""misfit of the model over the torque while a factor is searched: less than for a verdict"""
PRICE = 4.0
"""of each factor that is searched"""
UNITS = {1e3: "kNm", 1e-3: "mNm", 1e-2: "cNm"}


def scale_readings(nominal: Nominal, rows: Rows, columns: tuple[Array, Array]) -> list[Reading]:
    """The best common factor, the best factor of each joint alone, and one factor per joint."""
    n = nominal.robot.n
    start = np.log(_guess(nominal, rows, columns))

    def cost(factors: Array) -> float:
        scaled = rows.with_torque(rows.tau * factors)
        return nominal.explained(scaled, columns, misfit=SHARP).price

    def searched(joints: list[int], factors: Array, middle: float, width: float) -> Array:
        def changed(logarithm: float) -> Array:
            new = factors.copy()
            new[joints] = np.exp(logarithm)
            return new

        found = minimize_scalar(
            lambda x: cost(changed(x)),
            bounds=(middle - width, middle + width),
            method="bounded",
            options={"xatol": 0.01, "maxiter": 14},
        )
        return changed(float(found.x))

    everyone = list(range(n))
    common = searched(everyone, np.ones(n), float(np.median(start)), 1.5)
    readings = [_reading(nominal, common, everyone, cost)]
    for j in range(n):
        if abs(start[j]) > np.log(LEAST):
            one = searched([j], np.ones(n), float(start[j]), 1.2)
            readings.append(_reading(nominal, one, [j], cost))
    each = np.exp(start)
    for _ in range(2):
        for j in range(n):
            each = searched([j], each, float(np.log(each[j])), 0.7)
    readings.append(_reading(nominal, each, everyone, cost))
    return [r for r in readings if np.abs(np.log(np.diag(r.torques))).max() > np.log(LEAST)]


def _guess(nominal: Nominal, rows: Rows, columns: tuple[Array, Array]) -> Array:
    """Size of the nominal torque over that of the recorded one, per joint."""
    friction = nominal.robot.friction
    expected = columns[0] + friction[:, 1] * rows.turn + friction[:, 2] * rows.qd
    wanted = np.mean(expected**2, axis=0)
    found = np.mean(rows.tau**2, axis=0)
    known = (wanted > 1e-12) & (found > 1e-24)
    # a joint that needs no torque, or of which none is recorded, tells no factor
    return np.sqrt(np.where(known, wanted, 1.0) / np.where(known, found, 1.0))


def _reading(nominal: Nominal, factors: Array, joints: list[int], cost: Cost) -> Reading:
    n = len(factors)
    here = [j for j in joints if abs(np.log(factors[j])) > np.log(LEAST)] or joints
    common = np.ptp(np.log(factors[here])) < 1e-9
    plain = replace(as_labelled(n), kind="torque_scale", torques=np.diag(factors))
    if not common:
        bound = nominal.robot.tau_bound
        stated = np.isfinite(bound)
        limits = factors[stated] / bound[stated] * 100.0
        percent = bool(stated.any() and np.abs(np.log(limits)).max() < 0.35)
        what = "per cent of the limits" if percent else "motor side, or currents"
        listed = ", ".join(f"{f:.3g}" for f in factors)
        return replace(
            plain,
            says=f"torque looks like {what}: joints 1 to {n} x {listed}",
            fits={"factors": [float(f"{f:.4g}") for f in factors]},
            price=n * PRICE,
        )
    factor = float(factors[here[0]])
    sigma = factor * _relative_error(lambda x: cost(_scaled(factors, here, x)))
    where = "" if len(here) == n else f" on {named([j + 1 for j in here])}"
    return replace(
        plain,
        says=f"torque looks like {_unit(factor, sigma)}{where}: x {factor:.3g} +- {sigma:.1g}",
        fits={"factor": float(f"{factor:.4g}"), "standard_error": float(f"{sigma:.2g}")},
        joints=() if len(here) == n else tuple(j + 1 for j in here),
        price=PRICE,
    )


def _scaled(factors: Array, joints: list[int], logarithm: float) -> Array:
    found = factors.copy()
    found[joints] *= np.exp(logarithm)
    return found


def _relative_error(cost: Callable[[float], float]) -> float:
    """Standard deviation of the logarithm of a factor from the curvature of the cost."""
    step = 0.1
    bend = (cost(step) - 2.0 * cost(0.0) + cost(-step)) / step**2
    return float(np.sqrt(2.0 / max(bend, 2.0)))


def _unit(factor: float, sigma: float) -> str:
    near = [name for size, name in UNITS.items() if abs(factor - size) < max(3 * sigma, 0.3 * size)]
    if near:
        return near[0]
    return "motor side" if factor > 1.0 else "another unit"
