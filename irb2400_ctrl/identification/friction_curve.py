"""The Stribeck law of each joint through its friction at constant speeds (Fig. 9, Tab. 5)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.optimize import least_squares, nnls

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.identification.constant_runs import FrictionPoint, Run, friction_points
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.model.friction import FrictionLaw
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.wording import counted

FEWEST = 4
"""speeds through which Coulomb and viscous friction are drawn"""
FOR_STRIBECK = 6
"""speeds through which the rise at low speed is drawn as well"""
CLEAR = 20.0
"""fall of the scaled squares that the rise must bring, two numbers being free"""
RIGHT = 0.01
"""of friction: what the law itself is worth, so that no point is taken for exact [-]"""
BENT = 3.0
"""Stribeck speeds up to which friction still bends"""
MOSTLY = 0.3
"""share of a log of slow runs that is runs; the rest are moves between them"""
NAMES = ("static_Nm", "coulomb_Nm", "viscous_Nms_rad", "stribeck_rad_s")


@dataclass(frozen=True)
class FrictionCurve:
    """Friction of one joint, from 1.

    Args:
        points: eq. 73 at each speed; left_out: runs that stick and slip.
        law: F_s, F_c, F_v, omega_st as in Tab. 5; errors: standard ones, (4,); the rise at low
            speed is zero, F_s = F_c, and its errors are nan where the runs do not show it.
    """

    joint: int
    points: tuple[FrictionPoint, ...]
    left_out: tuple[Run, ...]
    law: Array
    errors: Array

    @property
    def shows_rise(self) -> bool:
        """Whether static friction and Stribeck speed are known from these runs."""
        return bool(np.isfinite(self.errors[3]))

    def torque(self, speed: Array) -> Array:
        """The law [Nm] at speeds [rad/s]."""
        return np.asarray(FrictionLaw(*self.law).torque(speed))

    def says(self) -> str:
        """One line for the reader."""
        slowest = min(p.speed for p in self.points)
        said = f"joint {self.joint}: {counted(len(self.points), 'speed')} from {slowest:.2g} rad/s"
        if self.left_out:
            worst = max(abs(run.speed) for run in self.left_out)
            runs = counted(len(self.left_out), "run")
            said += f"; {runs} up to {worst:.2g} rad/s stick and slip, left out"
        if not self.shows_rise:
            said += "; more friction at low speed is not shown and stays as in the file"
            said += "" if self.left_out else ": slower runs would help"
        return said

    def to_json(self) -> dict[str, Any]:
        """As in identification.json."""
        errors = [float(e) if np.isfinite(e) else None for e in self.errors]
        known = self.law if self.shows_rise else np.array([np.nan, *self.law[1:3], np.nan])
        values = [float(v) if np.isfinite(v) else None for v in known]
        return {
            "joint": self.joint,
            **dict(zip(NAMES, values, strict=True)),
            "standard_errors": dict(zip(NAMES, errors, strict=True)),
            "left_out_rad_s": [run.speed for run in self.left_out],
            "points": [
                {"speed_rad_s": p.speed, "friction_Nm": p.torque, "standard_error_Nm": p.error}
                for p in self.points
            ],
        }


def friction_curves(runs: Sequence[Run]) -> list[FrictionCurve]:
    """Of every joint that ran at enough speeds."""
    points = friction_points(runs)
    found = []
    for joint in sorted({p.forth.joint for p in points}):
        own = tuple(p for p in points if p.forth.joint == joint)
        if len({round(float(np.log(p.speed)), 1) for p in own}) < FEWEST:
            continue
        jumpy = tuple(run for run in runs if run.joint == joint and not run.steady)
        found.append(FrictionCurve(joint, own, jumpy, *_law(own)))
    return found


def log_of_runs(log: Log, curves: Sequence[FrictionCurve]) -> bool:
    """Whether the log is one of slow runs: `MOSTLY` of it made points of a curve."""
    runs = [run for curve in curves for p in curve.points for run in (p.forth, p.back)]
    seconds = sum(float(np.ptp(run.time)) for run in runs if run.log == log.name)
    return seconds > MOSTLY * log.duration


def with_curves(robot: Robot, curves: Sequence[FrictionCurve]) -> Robot:
    """The robot with the friction that its runs show."""
    joints = list(robot.joints)
    for curve in curves:
        joint = joints[curve.joint - 1]
        static, coulomb, viscous, stribeck = (float(v) for v in curve.law)
        own = robot.friction[curve.joint - 1]
        if not curve.shows_rise:
            # what the file says of low speeds stays
            static = coulomb + float(max(own[0] - own[1], 0.0))
            stribeck = float(own[3])
        update = {
            "static_Nm": static,
            "coulomb_Nm": coulomb,
            "viscous_Nms_rad": viscous,
            "stribeck_rad_s": stribeck,
            "source": "constant-speed runs",
        }
        friction = joint.friction.model_copy(update=update)
        joints[curve.joint - 1] = joint.model_copy(update={"friction": friction})
    return robot.model_copy(update={"joints": tuple(joints)})


def with_run_samples(
    motion: PreparedLog, runs: Sequence[Run], curves: Sequence[FrictionCurve]
) -> PreparedLog:
    """The motion with the samples of its runs, which others would leave out as slow: a joint that
    runs steadily does not stick. Where the law still rises the curve has said all they tell."""
    slow = {curve.joint: BENT * curve.law[3] for curve in curves if curve.shows_rise}
    known = motion.known.copy()
    for run in runs:
        if run.steady and abs(run.speed) > slow.get(run.joint, np.inf):
            inside = (motion.time >= run.time[0]) & (motion.time <= run.time[-1])
            known[inside, run.joint - 1] = True
    return replace(motion, known=known)


def _law(points: Sequence[FrictionPoint]) -> tuple[Array, Array]:
    """F_s, F_c, F_v, omega_st and their standard errors, (4,) each."""
    v = np.array([p.speed for p in points])
    F = np.array([p.torque for p in points])
    e = np.hypot([p.error for p in points], RIGHT * np.abs(F))
    flat = np.column_stack([np.ones_like(v), v]) / e[:, None]
    plain, left = nnls(flat, F / e)
    scale = max(1.0, left**2 / max(len(v) - 2, 1))
    error = np.sqrt(np.diag(np.linalg.pinv(flat.T @ flat)) * scale)
    law = np.array([plain[0], *plain, 1.0])
    errors = np.array([np.nan, *error, np.nan])
    if len(v) < FOR_STRIBECK:
        return law, errors
    rising, rising_errors, rising_left = _stribeck(v, F, e)
    own_scale = max(1.0, rising_left / max(len(v) - 4, 1))
    if (left**2 - rising_left) / own_scale > CLEAR:
        return rising, rising_errors
    return law, errors


def _stribeck(v: Array, F: Array, e: Array) -> tuple[Array, Array, float]:
    """(law, standard errors, scaled squares) with a rise at low speed; the best of many Stribeck
    speeds, each with its best other numbers, and from there all four."""
    trials = []
    for speed in np.geomspace(0.5 * v.min(), 0.5 * v.max(), 60):
        bell = np.exp(-((v / speed) ** 2))
        numbers, left = nnls(np.column_stack([np.ones_like(v), v, bell]) / e[:, None], F / e)
        trials.append((left, speed, numbers))
    _, speed, (coulomb, viscous, rise) = min(trials, key=lambda t: t[0])

    def residual(x: Array) -> Array:
        law = FrictionLaw(x[1] + x[0], x[1], x[2], np.exp(x[3]))
        return np.asarray((law.torque(v) - F) / e)

    start = np.array([rise, coulomb, viscous, np.log(speed)])
    low = np.array([0.0, 0.0, 0.0, np.log(0.2 * v.min())])
    high = np.array([np.inf, np.inf, np.inf, np.log(v.max())])
    start = np.clip(start, low + 1e-9, high)
    found = least_squares(residual, start, bounds=(low, high), x_scale="jac")
    squares = 2.0 * float(found.cost)
    scale = max(1.0, squares / max(len(v) - 4, 1))
    jacobian = np.asarray(found.jac, dtype=float)
    covariance = np.linalg.pinv(jacobian.T @ jacobian) * scale
    rise, coulomb, viscous, logarithm = found.x
    stribeck = np.exp(logarithm)
    law = np.array([coulomb + rise, coulomb, viscous, stribeck])
    # F_s = F_c + rise, omega_st = exp(log omega_st)
    turn = np.array([[1, 1, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, stribeck]], dtype=float)
    errors = np.sqrt(np.diag(turn @ covariance @ turn.T))
    return law, errors, squares
