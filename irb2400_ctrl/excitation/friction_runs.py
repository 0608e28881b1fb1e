"""Slow runs of one joint after another at constant speed, both ways, for its friction (eqs. 70-74).

The speeds are those of eq. 74, thinned evenly: dense where friction bends. Each joint runs about a
posture in which gravity asks little of it, as load bends friction too.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InfeasibleError
from irb2400_ctrl.excitation.acceleration import AccelerationLimits
from irb2400_ctrl.excitation.assemble import Workshop, resting
from irb2400_ctrl.excitation.feasible import SHARE, Extent, extent
from irb2400_ctrl.planners.joint_move import joint_move
from irb2400_ctrl.trajectory import Trajectory
from irb2400_ctrl.trajectory.trajectory import RATE

SPEEDS = 14
"""of each joint"""
SLOWEST = 0.001
"""[rad/s]: slower runs take minutes each"""
LASTING = 1.0
"""[s] of a run at least"""
WAY = 0.010
"""[rad] of a run at least"""
RAMP = 0.25
"""[s] from rest to the speed of a run, at least"""
EASE = 0.4
"""[s] from one run to the next, at least"""
SHARE_OF_SPEED = 0.45
"""of a joint's limit, at most"""
POSTURES = 400
"""looked at for one in which gravity asks little"""


@dataclass(frozen=True)
class FrictionRuns:
    """The motion and what it holds.

    Args:
        course: rows at 250 Hz, from rest to rest; tau: torque of the model along it, (m, n) [Nm];
            extent: how near to the limits it goes.
        speeds: of each joint, (k,) [rad/s].
    """

    course: Trajectory
    tau: Array
    extent: Extent
    speeds: tuple[Array, ...]


def velocity_grid() -> Array:
    """The speeds of eq. 74 [rad/s]."""
    return np.concatenate(
        [
            1e-5 * np.arange(1, 1501),
            0.015 + 0.0002 * np.arange(1, 926),
            0.2 + 0.001 * np.arange(1, 301),
        ]
    )


def few_speeds(fastest: float = 0.5) -> Array:
    """`SPEEDS` of the grid of eq. 74 from `SLOWEST` to a fastest one, spread evenly [rad/s]."""
    grid = velocity_grid()
    grid = grid[(grid >= SLOWEST - 1e-9) & (grid <= fastest + 1e-9)]
    return np.asarray(grid[np.linspace(0, len(grid) - 1, SPEEDS).round().astype(int)])


def friction_runs(workshop: Workshop, seed: int = 0) -> FrictionRuns:
    """Plan the runs of all joints.

    Raises:
        InfeasibleError: the limits leave no posture for a joint.
    """
    robot = workshop.robot
    rng = np.random.default_rng([seed, 74])
    parts: list[Array] = []
    speeds = []
    bends = SHARE * AccelerationLimits.of(robot).values
    for j in range(robot.n):
        bend = float(bends[j])
        fastest = min(0.5, SHARE_OF_SPEED * float(robot.qd_max[j]))
        own = few_speeds(fastest)
        centre = _posture(workshop, j, _way(fastest, bend), rng)
        one = np.concatenate([there_and_back(speed, bend) for speed in own])
        states = np.repeat(one[:, :, None], robot.n, axis=2)
        states *= np.arange(robot.n) == j
        states[:, 0] += centre
        if parts:
            move = joint_move(workshop.transfers, parts[-1][-1, 0], centre, rate=RATE)
            parts.append(np.stack([move.q, move.qd, move.qdd], axis=1)[1:])
        parts.append(states if not parts else states[1:])
        speeds.append(own)
    q, qd, qdd = np.concatenate(parts).transpose(1, 0, 2)
    course = resting(np.arange(len(q)) / RATE, q, qd, qdd)
    tau = workshop.model.inverse_dynamics(course.q, course.qd, course.qdd)
    # hardly anything happens between two rows of slow runs: they are looked at, and no more
    found = extent(workshop.model, course.q, course.qd, course.qdd)
    if not found.inside:
        raise InfeasibleError(f"{robot.name}: slow runs {found.wrong()}")
    return FrictionRuns(course, tau, found, tuple(speeds))


def _way(speed: float, bend: float) -> float:
    return max(WAY, speed * LASTING) + speed * _ramp(speed, bend) / RATE


def _ramp(speed: float, bend: float) -> int:
    """Rows from rest to a speed: a cubic's acceleration is at most 1.5 times the mean."""
    return max(2, round(RAMP * RATE), math.ceil(1.5 * speed / bend * RATE))


def there_and_back(speed: float, bend: float = np.inf) -> Array:
    """Angle, speed, acceleration about 0, through it forth and back at one speed, shape (m, 3);
    `bend`: largest acceleration [rad/s2]."""
    rows = round(max(LASTING, WAY / speed) * RATE)
    ramp = _ramp(speed, bend)
    x = np.arange(ramp) / ramp
    up = np.column_stack([x * x * (3 - 2 * x), 6 * x * (1 - x) * RATE / ramp])
    level = np.tile([1.0, 0.0], (rows, 1))
    down = np.column_stack([1 - up[:, 0], -up[:, 1]])
    shape = speed * np.concatenate([up, level, down])
    # the ramps are odd about their middles: sums of the speed are its integral
    angle = np.concatenate([[0.0], np.cumsum(0.5 * (shape[1:, 0] + shape[:-1, 0]))]) / RATE
    angle -= 0.5 * angle[-1]
    forth = np.column_stack([angle, shape])
    back = forth * -1.0
    start = np.zeros((1, 3))
    return np.concatenate([_eased(start, forth, bend), forth, back, _eased(back[-1:], start, bend)])


def _eased(here: Array, there: Array, bend: float) -> Array:
    """From rest at one angle to rest at another, quintic, without its last row.

    Args:
        here, there: rows of which the last and the first are met, shape (m, 3).
        bend: largest acceleration [rad/s2].
    """
    a = float(here[-1, 0])
    b = float(there[0, 0])
    way = abs(b - a)
    # largest acceleration of a quintic: 10 / sqrt(3) of the way over the time squared
    least = math.sqrt(10.0 / math.sqrt(3.0) * way / bend)
    rows = max(round(max(EASE, 3.0 * way) * RATE), math.ceil(least * RATE))
    x = np.arange(rows) / rows
    seconds = rows / RATE
    q = a + (b - a) * x**3 * (10 - 15 * x + 6 * x**2)
    qd = (b - a) * 30 * x**2 * (1 - x) ** 2 / seconds
    qdd = (b - a) * 60 * x * (1 - x) * (1 - 2 * x) / seconds**2
    return np.column_stack([q, qd, qdd])


def _posture(workshop: Workshop, j: int, way: float, rng: np.random.Generator) -> Array:
    """Where a joint may run, with the least gravity upon it (for joints 2 and 3 of most arms not
    none), (n,) [rad]."""
    robot = workshop.robot
    span = robot.q_max - robot.q_min
    drawn = rng.uniform(robot.q_min + 0.1 * span, robot.q_max - 0.1 * span, (POSTURES, robot.n))
    drawn = np.clip(drawn, np.maximum(robot.q_min, -np.pi), np.minimum(robot.q_max, np.pi))
    asked = np.abs(workshop.model.gravity(drawn)[:, j])
    rest = np.zeros((3, robot.n))
    for place in np.argsort(asked):
        q = drawn[place] + 0.6 * way * np.array([-1.0, 0.0, 1.0])[:, None] * (
            np.arange(robot.n) == j
        )
        if extent(workshop.model, q, rest, rest).inside:
            return np.asarray(drawn[place])
    raise InfeasibleError(
        f"{robot.name}: of {POSTURES} postures none leaves joint {j + 1} room to run"
    )
