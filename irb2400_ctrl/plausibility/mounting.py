"""An arm that is mounted otherwise than its file says: on a wall, below a ceiling, on a slope.

    tau = D(q, qd, qdd) + W(q) g

A URDF has no place for gravity, and an arm in it stands upright; torques of one that hangs fit no
unit, sign or order of the columns, and a zero a quarter turn off comes nearest. The torque is
linear in g: its direction is fitted, its size is the file's.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.model import Model
from irb2400_ctrl.plausibility.criteria import FITS_PRICE, MARGIN, clearly_better
from irb2400_ctrl.plausibility.evidence import Fit, Nominal
from irb2400_ctrl.plausibility.problem import LogProblem
from irb2400_ctrl.plausibility.rows import Rows
from irb2400_ctrl.robot import Robot

LEAST = np.radians(20.0)
"""[rad] from the file's gravity, below which it is a base that leans, an effect of its own"""
PRICE = 6.0
"""of a direction that is fitted"""


def mounting_problem(
    nominal: Nominal, rows: Rows, labelled: Fit, least: float, told: LogProblem | None
) -> LogProblem | None:
    """Gravity in another direction, where that fits clearly better than all else; None where it
    does not.

    Args:
        nominal: the robot as a yardstick, gravity as its file has it.
        rows: the slow part of the log as labelled; labelled: how well that is explained.
        least: cost of what explains it best otherwise; told: what that is, None where it is not
            said.
    """
    found = best_mounting(nominal, rows)
    if found is None:
        return None
    fit, said = found
    fits = fit.price < FITS_PRICE * nominal.robot.n / 6.0 and clearly_better(fit, labelled)
    if fits and least - fit.cost > MARGIN:
        return said
    # to hang is to have one's zeros half a turn off, but one thing and not several
    alike = told is not None and told.kind == "angle_zero" and fit.cost - least < MARGIN
    return replace(said, says=f"{said.says}; or {told.says}") if fits and told and alike else None


def best_mounting(nominal: Nominal, rows: Rows) -> tuple[Fit, LogProblem] | None:
    """How well gravity in another direction explains a log, and what to say of it; None where the
    direction that fits best is the file's.
    """
    robot = nominal.robot
    size = float(np.linalg.norm(robot.gravity))
    fitted = _direction(nominal, rows)
    if size == 0.0 or fitted is None:
        return None
    # bases are screwed on at right angles mostly
    axis = np.zeros(3)
    k = int(np.argmax(np.abs(fitted)))
    axis[k] = np.sign(fitted[k])
    fits = []
    for way, price in ((fitted, PRICE), (axis, 0.0)):
        found = Nominal(turned(robot, size * way), free_rotors=nominal.free_rotors)
        fit = found.explained(rows, found.columns(rows))
        fits.append((replace(fit, cost=fit.cost + price), way))
    fit, way = min(fits, key=lambda pair: pair[0].cost)
    if way @ robot.gravity > np.cos(LEAST) * size:
        return None
    gravity = [float(f"{v:.3g}") + 0.0 for v in size * way]
    said = ", ".join(f"{v:g}" for v in gravity)
    before = ", ".join(f"{v:g}" for v in robot.gravity)
    return fit, LogProblem(
        "mounting",
        f"the arm looks mounted otherwise than in the robot file: gravity along ({said}) m/s2 of "
        f"its base, not along ({before}); if it is, write gravity_m_s2 = [{said}] into the file",
        {"gravity_m_s2": gravity},
    )


def turned(robot: Robot, gravity: Array) -> Robot:
    """The robot under another gravity [m/s2], shape (3,)."""
    return robot.model_copy(update={"gravity_m_s2": tuple(float(v) for v in gravity)})


def _direction(nominal: Nominal, rows: Rows) -> Array | None:
    """The direction of gravity with which the file's bodies come nearest to the torques, beside
    friction and an offset of each joint; a unit vector in the base, shape (3,)."""
    robot = nominal.robot
    n = robot.n
    # springs of the file pull without gravity, too
    at_rest = [
        np.asarray(Model(turned(robot, g)).gravity(rows.q)) for g in (*np.eye(3), np.zeros(3))
    ]
    W = np.stack(at_rest[:3], axis=-1) - at_rest[3][..., None]
    motion = nominal.columns(rows)[0] - W @ robot.gravity
    friction = robot.friction
    known = motion + friction[:, 1] * rows.turn + friction[:, 2] * rows.qd
    A = np.zeros((len(rows.q), n, 3 + 3 * n))
    A[:, :, :3] = W
    joints = np.arange(n)
    for part, signal in enumerate((np.ones_like(rows.qd), rows.turn, rows.qd)):
        A[:, joints, 3 + part * n + joints] = signal
    weight = ~rows.silent / rows.size
    A = A * weight[:, None]
    y = (rows.tau - known) * weight
    found = np.linalg.lstsq(A.reshape(len(rows.q) * n, -1), y.ravel(), rcond=1e-9)[0][:3]
    size = float(np.linalg.norm(found))
    return np.asarray(found / size) if size > 0.0 else None
