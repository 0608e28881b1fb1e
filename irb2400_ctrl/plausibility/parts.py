"""Torques that hold a part of what an arm needs: gravity taken out, gravity alone, no friction.

A controller that holds the arm by itself commands and publishes what comes on top (`tau_J_d` of a
Franka); a column of a model holds gravity and nothing else. No unit, sign or order of such columns
fits, and the clock that makes motion slow enough does for the second.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from irb2400_ctrl.arrays import Array, rms
from irb2400_ctrl.measurement.log import Log
from irb2400_ctrl.model import Model
from irb2400_ctrl.plausibility.columns.jumps import MOVES
from irb2400_ctrl.plausibility.evidence import Fit, Nominal
from irb2400_ctrl.plausibility.problem import LogProblem, named
from irb2400_ctrl.plausibility.rows import MOST, Rows
from irb2400_ctrl.robot import Robot

DOUBT = 0.2
"""share of the torque of a joint that moves, left by the whole torque, from which gravity alone is
asked"""
EXPECTED = 0.01
"""of the largest recorded torque, that a joint has which is asked, and that the model expects where
a channel is silent"""

NO_FRICTION = 0.05
"""of the rms torque of a joint: no drive has so little of it, all of an arm's still less"""
MOVING = 0.02
"""[rad/s] rms speed of a joint whose friction shows, and"""
FEWEST = 3
"""of these that tell"""
FRICTIONLESS = (
    "the torques hold no friction, less than 5 % of them on every joint: those of a controller's "
    "model (`target_moment` of a Universal Robot), of a simulation or of a command look so, and "
    "those of sensors behind the gears; of motors measured ones do not"
)

PARTS = (
    (
        "the torques look like those without gravity: what a controller adds to the weight that it "
        "holds by itself, not what the joints carry",
        "without_gravity",
    ),
    (
        "the torques look like gravity alone, without inertia and friction: a model's, not "
        "measured ones",
        "gravity",
    ),
)


def best_part(nominal: Nominal, rows: Rows, labelled: Fit) -> tuple[Fit, LogProblem]:
    """The part of the torque that explains a log best, and what to say of it.

    Args:
        nominal: the robot as a yardstick.
        rows: the slow part of the log as labelled.
        labelled: how well the whole torque explains it.
    """
    still = 0.0 * rows.qd
    # a column of gravity holds no friction either
    resting = replace(rows, qd=still, qdd=still, turn=still)
    whole, slopes = nominal.columns(rows)
    weight, held = nominal.columns(resting)
    # what a controller holds by its own model differs from the file's weight
    fits = [nominal.explained(rows, (whole - weight, slopes))]
    asked = (np.ptp(rows.q, axis=0) > MOVES) & (rows.size > EXPECTED * rows.size.max())
    if labelled.left[asked].max(initial=0.0) > DOUBT:
        # else a joint whose brake holds it is all that is not explained
        fits.append(nominal.explained(resting, (weight, held)))
    k = int(np.argmin([fit.cost for fit in fits]))
    said, part = PARTS[k]
    return fits[k], LogProblem("torque_part", said, {"part": part})


def silent_problem(robot: Robot, log: Log) -> LogProblem | None:
    """Joints whose angle and torque never change, where the model expects a torque.

    A gripper among the joints of an arm, a joint that was not recorded, a brake.
    """
    silent = (np.ptp(log.q, axis=0) == 0.0) & ~log.tau.any(axis=0)
    if not silent.any():
        return None
    q: Array = log.q[:: max(1, len(log.q) // MOST)]
    expected = Model(robot).inverse_dynamics(q, 0 * q, 0 * q, friction=False)
    size = rms(np.asarray(expected))
    recorded = rms(log.tau).max()
    dead = [int(j) + 1 for j in np.flatnonzero(silent & (size > EXPECTED * recorded))]
    if not dead:
        return None
    needs = ", ".join(f"{size[j - 1]:.2g}" for j in dead)
    return LogProblem(
        "zero_torque",
        f"angle and torque of {named(dead)} never change, and the torque is zero where the model "
        f"expects {needs} Nm: nothing was recorded of it, a brake held it, or the columns are "
        "another thing's, a gripper's. Give the joint's own columns, or make it fixed in the URDF "
        "(then `irb2400 robot import` again) and leave its columns out",
        joints=tuple(dead),
    )


def hold_no_friction(nominal: Nominal, rows: Rows) -> bool:
    """Whether torques are a model's: bodies of any kind, without the file's, leave no friction.

    tau = Y(q, qd, qdd) phi + Fc turn + Fv qd + J qdd + o by plain least squares
    """
    speed = rms(rows.qd)
    moving = speed > MOVING
    if np.count_nonzero(moving) < FEWEST:
        return False
    Y = np.asarray(nominal.model.regressor(rows.q, rows.qd, rows.qdd))
    signals = np.stack([rows.turn, rows.qd, rows.qdd, np.ones_like(rows.q)])
    n = rows.q.shape[1]
    drives = np.einsum("smj,jk->mjsk", signals, np.eye(n)).reshape(*rows.q.shape, -1)
    X = np.concatenate([Y, drives], axis=2) / rows.size[:, None]
    X = X.reshape(-1, X.shape[2])
    scale = np.maximum(np.linalg.norm(X, axis=0), 1e-12)
    found = np.linalg.lstsq(X / scale, (rows.tau / rows.size).ravel(), rcond=1e-8)[0] / scale
    dry, viscous = np.abs(found[Y.shape[2] :]).reshape(len(signals), n)[:2]
    return bool((dry + viscous * speed < NO_FRICTION * rows.size)[moving].all())
