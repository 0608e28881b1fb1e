"""How far the axes of a wrist turn the motors of those behind them: ratios, which no linear fit
tells.

They are looked for on what a fit without such motors leaves of the wrist's torques, its own drives
told anew, and moved once more beside the fit that has them. Dry friction turns over late behind a
turn of the motor, which one that jumps would make up for by other ratios.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy.optimize import minimize

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.effects.geared_motor import GearedMotor, along
from irb2400_ctrl.identification.fitting.columns import Extra, motor_torques
from irb2400_ctrl.identification.fitting.fitted import Fit
from irb2400_ctrl.identification.fitting.moments import Recording, predicted
from irb2400_ctrl.identification.fitting.noise import NOTHING
from irb2400_ctrl.model import Model

BEFORE = 2
"""axes of the wrist before the last, which may turn its motor; they turn no motor of their own"""
ROWS = 3000
"""samples that the search looks at, at most"""
RATIOS = np.linspace(-1.5, 1.5, 31)
"""turns of a motor with the axis before, where the search begins"""
LARGEST = 2.0
"""and the most that it looks at"""
LEAST = 0.03
"""below which an axis turns no motor"""
STARTS = 3
"""of the ratios, from which it goes on"""
STEPS = (0.08, 0.03)
"""of ratios that are looked for, and of such as are moved"""
CLEARLY = 0.9
"""share of what the wrist leaves otherwise, at most"""
CONTACT = 3e-4
"""[rad] within which dry friction turns over; of arms that were looked at 0.13 to 0.7 mrad"""
RIDGE = 1e-6
"""over the mean square of a column"""


def geared_motors(model: Model, parts: Sequence[Recording], bare: Fit) -> list[Extra]:
    """Motors that axes before theirs may turn, with the ratios that leave least.

    Args:
        model: of the arm; parts: its recordings; bare: a fit without such motors.
    """
    joints = list(GearedMotor.joints(model.robot.n))
    wrist = _Wrist.of(model, parts, bare) if joints else None
    if wrist is None:
        return []
    found: dict[int, Extra] = {}
    # what one motor leaves decides of the other's ratios
    for _ in range(2):
        for joint in reversed(joints):
            others = [extra for extra in found.values() if extra.joint != joint]
            best = wrist.best(joint, others)
            if wrist.left_by([*others, best]) < CLEARLY * wrist.left_by(others):
                found[joint] = best
            else:
                found.pop(joint, None)
    return list(found.values())


def refined(model: Model, parts: Sequence[Recording], found: Fit) -> tuple[Extra, ...]:
    """The extras of a fit, the ratios of its motors moved to where they leave least beside it.

    Args:
        model: of the arm; parts: its recordings; found: a fit with such motors, or without.
    """
    motors = [extra for extra in found.layout.extras if extra.kind == "motor"]
    wrist = _Wrist.of(model, parts, found) if motors else None
    if wrist is None:
        return found.layout.extras
    better = dict(zip(motors, wrist.moved(motors), strict=True))
    return tuple(better.get(extra, extra) for extra in found.layout.extras)


def turned_over(speed: Array, acceleration: Array) -> Array:
    """Dry friction of one, -1 to 1: behind a turn it passes over within `CONTACT`.

    Args:
        speed: [rad/s]; acceleration: [rad/s2], which tells how far the last turn is.
    """
    away = speed * acceleration > 0.0
    passed = speed**2 / (2.0 * np.where(away, np.abs(acceleration), 1.0))
    share = np.where(away, np.exp(-passed / CONTACT), 0.0)
    return np.asarray(np.sign(speed) * (1.0 - 2.0 * share))


@dataclass(frozen=True)
class _Wrist:
    """What a fit leaves of the torques of the wrist's axes, without their drives.

    Args:
        torque: (m, n) [Nm]; known: whether it was recorded; qd: [rad/s]; qdd: [rad/s2], (m, n).
        axes: zero-based, of the wrist.
    """

    torque: Array
    known: Mask
    qd: Array
    qdd: Array
    axes: range

    @classmethod
    def of(cls, model: Model, parts: Sequence[Recording], fit: Fit) -> _Wrist | None:
        """None where too little was recorded of it."""
        n = model.robot.n
        axes = range(n - BEFORE - 1, n)
        layout = fit.layout
        rows = []
        for part in parts:
            motion = part.motion
            left = motion.tau - predicted(model, layout, part, fit.theta)
            for term, signal in (
                ("coulomb", np.sign(motion.qd)),
                ("viscous", motion.qd),
                ("rotor", motion.qdd),
            ):
                left += fit.theta[layout.drive(term)] * signal
            for extra in layout.extras:
                if extra.kind == "motor":
                    numbers = fit.theta[layout.extra(extra)]
                    left[:, : extra.joint] += motor_torques(extra, motion.qd, motion.qdd) @ numbers
            rows.append((left, motion.known, motion.qd, motion.qdd))
        left, known, qd, qdd = (np.concatenate(one) for one in zip(*rows, strict=True))
        some = np.flatnonzero(known[:, axes].any(axis=1))
        some = some[:: max(1, len(some) // ROWS)]
        if not known[some][:, axes].any(axis=0).all():
            return None
        return cls(left[some], known[some], qd[some], qdd[some], axes)

    def best(self, joint: int, others: list[Extra]) -> Extra:
        """A motor with the ratios that leave least beside others."""
        count = min(BEFORE, joint - 1 - self.axes[0])

        def motor(ratios: Sequence[float] | Array) -> list[Extra]:
            return [*others, _motor(joint, ratios)]

        starts = [[float(r)] + [0.0] * (count - 1) for r in RATIOS if abs(r) > LEAST]
        starts.sort(key=lambda ratios: self.left_by(motor(ratios)))
        ends = [
            _least(lambda x: self.left_by(motor(x)), np.array(start), STEPS[0])
            for start in starts[:STARTS]
        ]
        return _motor(joint, min(ends, key=lambda x: self.left_by(motor(x))))

    def moved(self, motors: list[Extra]) -> list[Extra]:
        """The motors with ratios near theirs that leave less."""
        counts = [min(BEFORE, motor.joint - 1 - self.axes[0]) for motor in motors]
        ends = np.cumsum(counts)[:-1]

        def at(x: Array) -> list[Extra]:
            every = zip(motors, np.split(x, ends), strict=True)
            return [_motor(motor.joint, ratios) for motor, ratios in every]

        start = np.concatenate([m.ratios[:k] for m, k in zip(motors, counts, strict=True)])
        return at(_least(lambda x: self.left_by(at(x)), start, STEPS[1]))

    def left_by(self, motors: Sequence[Extra]) -> float:
        """Geometric mean over the axes of what drives with these motors leave of their torque."""
        if any(abs(ratio) > LARGEST for motor in motors for ratio in motor.ratios):
            return float("inf")
        drives = self._drives
        count, m = drives.torque.shape
        turned = np.zeros((count, m, 3 * len(motors)))
        for k, motor in enumerate(motors):
            here = slice(motor.joint)
            motion = (self.qd[:, here], self.qdd[:, here])
            on = along(motion, motor.turns, motor.joint - 1, turned_over)
            turned[: motor.joint - self.axes[0], :, 3 * k : 3 * k + 3] = on[
                :, self.axes[0] :
            ].swapaxes(0, 1)
        A = drives.columns
        B = _of_one_size(turned * drives.weight[:, :, None])
        y = drives.torque.ravel()
        beside = A.T @ B
        H = np.block([[drives.squares, beside], [beside.T, B.T @ B]])
        H += RIDGE * len(A) * np.eye(len(H))
        own, others = np.split(np.linalg.solve(H, np.append(A.T @ y, B.T @ y)), [A.shape[1]])
        rest = (y - A @ own - B @ others).reshape(count, m)
        each = (rest**2).sum(axis=1) / drives.samples
        return float(np.exp(np.mean(np.log(each + NOTHING)) / 2.0))

    @cached_property
    def _drives(self) -> _Drives:
        known = self.known[:, self.axes].T
        torque = np.where(known, self.torque[:, self.axes].T, 0.0)
        samples = np.maximum(known.sum(axis=1), 1)
        size = np.sqrt((torque**2).sum(axis=1) / samples) + NOTHING
        weight = known / size[:, None]
        count, m = known.shape
        columns = np.zeros((count, m, 4 * count))
        for row, j in enumerate(self.axes):
            qd = self.qd[:, j]
            qdd = self.qdd[:, j]
            for place, signal in enumerate((turned_over(qd, qdd), qd, qdd, np.ones(m))):
                columns[row, :, 4 * row + place] = signal * weight[row]
        A = _of_one_size(columns)
        return _Drives(torque / size[:, None], samples, weight, A, A.T @ A)


@dataclass(frozen=True)
class _Drives:
    """What stays of a wrist whatever its axes turn, its axes one after another.

    Args:
        torque: over the size of each, (axes, m); samples: that are known of each, (axes,).
        weight: one over the size, nothing where the torque is not known, (axes, m).
        columns: of the drives' own numbers, of one size, (axes m, 4 axes); squares: their products.
    """

    torque: Array
    samples: npt.NDArray[np.intp]
    weight: Array
    columns: Array
    squares: Array


def _of_one_size(columns: Array) -> Array:
    """Columns of rms one below one another, (axes, m, k) as (axes m, k)."""
    count, m, k = columns.shape
    A = columns.reshape(count * m, k)
    return np.asarray(A / (np.sqrt(np.mean(A**2, axis=0)) + NOTHING))


def _motor(joint: int, ratios: Sequence[float] | Array) -> Extra:
    kept = [float(r) if abs(r) > LEAST else 0.0 for r in (*ratios, 0.0)]
    return Extra("motor", joint, (kept[0], kept[1]))


def _least(cost: Callable[[Array], float], start: Array, step: float) -> Array:
    """A minimum near a start: no slope, as signs of speeds jump."""
    simplex = np.vstack([start, *(start + step * one for one in np.eye(len(start)))])
    found = minimize(
        cost,
        start,
        method="Nelder-Mead",
        options={"xatol": 2e-3, "fatol": 1e-5, "maxfev": 120, "initial_simplex": simplex},
    )
    return np.asarray(found.x)
