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
WORTH = 1.3
"""a joint whose torque is so far from the model's, either way, is searched: the file may be off"""
SHARP = 0.05
"""misfit of the model over the torque while a factor is searched: less than for a verdict"""
AGAINST = -0.5
"""correlation of the model's torque with one that is turned over besides"""
PRICE = 4.0
"""of each factor that is searched"""
MOST_NM_A = 30.0
"""[Nm/A] at a joint, as the drivers of some arms publish currents; reductions are mostly larger"""
UNITS = {1e3: "kNm", 1e-3: "mNm", 1e-2: "cNm"}


def scale_readings(nominal: Nominal, rows: Rows, columns: tuple[Array, Array]) -> list[Reading]:
    """The best common factor, the best factor of each joint alone, and one factor per joint; where
    the recorded torque goes against the model's, of a joint alone it is negative."""
    n = nominal.robot.n
    size, way = _guess(nominal, rows, columns)
    start = np.log(size)

    def cost(factors: Array) -> float:
        scaled = rows.with_torque(rows.tau * factors)
        return nominal.explained(scaled, columns, misfit=SHARP).cost

    def searched(joints: list[int], factors: Array, middle: float, width: float) -> Array:
        signs = np.ones(n) if len(joints) == n else way

        def changed(logarithm: float) -> Array:
            new = factors.copy()
            new[joints] = signs[joints] * np.exp(logarithm)
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
        if abs(start[j]) > np.log(WORTH):
            one = searched([j], np.ones(n), float(start[j]), 1.2)
            readings.append(_reading(nominal, one, [j], cost))
    each = way * size
    for _ in range(2):
        for j in range(n):
            each = searched([j], each, float(np.log(abs(each[j]))), 0.7)
    readings.append(_reading(nominal, each, everyone, cost))
    return [r for r in readings if np.abs(np.log(np.abs(np.diag(r.torques)))).max() > np.log(LEAST)]


def _guess(nominal: Nominal, rows: Rows, columns: tuple[Array, Array]) -> tuple[Array, Array]:
    """Size of the nominal torque over that of the recorded one, and -1 where the two clearly go
    against each other, else 1, per joint."""
    friction = nominal.robot.friction
    expected = columns[0] + friction[:, 1] * rows.turn + friction[:, 2] * rows.qd
    wanted = np.mean(expected**2, axis=0)
    found = np.mean(rows.tau**2, axis=0)
    known = (wanted > 1e-12) & (found > 1e-24)
    # a joint that needs no torque, or of which none is recorded, tells no factor
    wanted = np.where(known, wanted, 1.0)
    found = np.where(known, found, 1.0)
    against = np.mean(expected * rows.tau, axis=0) < AGAINST * np.sqrt(wanted * found)
    return np.sqrt(wanted / found), np.where(known & against, -1.0, 1.0)


def _reading(nominal: Nominal, factors: Array, joints: list[int], cost: Cost) -> Reading:
    n = len(factors)
    size = np.abs(factors)
    here = [j for j in joints if abs(np.log(size[j])) > np.log(LEAST)] or joints
    common = np.ptp(factors[here]) < 1e-9 * size[here[0]]
    plain = replace(as_labelled(n), kind="torque_scale", torques=np.diag(factors))
    if not common:
        bound = nominal.robot.tau_bound
        stated = np.isfinite(bound)
        limits = size[stated] / bound[stated] * 100.0
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
    sigma = abs(factor) * _relative_error(lambda x: cost(_scaled(factors, here, x)))
    where = "" if len(here) == n else f" on {named([j + 1 for j in here])}"
    # bodies that are off by the factor are the same to the torque
    what = "friction or bodies" if where else "masses"
    there = " there (then state them nearer to the arm)" if where else ""
    unit = _unit(factor, sigma)
    return replace(
        plain,
        says=f"torque looks like {unit}{where}: times {factor:.3g} ± {sigma:.1g}, or the "
        f"{what} of the robot file are off by as much{there}",
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
    if abs(factor) < 1.0:
        return "another unit"
    return "motor side" if abs(factor) > MOST_NM_A else "motor side, or currents"
