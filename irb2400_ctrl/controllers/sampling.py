"""Whether the loop of a controller and its own arm is stable at the rate at which it is sampled."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.codegen import Block
from irb2400_ctrl.controllers.linear import LinearLoop
from irb2400_ctrl.controllers.scaling import (
    inertia_span,
    typical_inertia,
    weight_share,
    weight_slope,
)
from irb2400_ctrl.controllers.timing import Timing
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Robot

POSES = 8
HALVINGS = 7
"""of the sample time, in search of one that would do"""
SLOW = 1.0
"""[1/s] of a growth that is not called unstable where it is the weight's"""
NEUTRAL = 0.01
"""[1/s] of a growth that is rounding"""
OF_THE_WEIGHT = 1.1
"""growth that is the weight's, as a multiple of what a torque held for a while makes of it: an arm
without gains, guided by hand, whose weight is balanced a sample late, has 1"""


def check_sampled_loop(robot: Robot, build: Callable[[float], Block], sample_time: float) -> str:
    """Refuse a controller whose loop is unstable on the very arm that it was made for; a remark
    where the delay of a usual drive is enough for that, else nothing.

    The loop is linearised at rest at poses of the joint box. An ideal drive knows the speed and
    acts at once; a usual one is that of `Timing`: a sample late, its speed filtered at 250 Hz.

    Args:
        robot: the arm.
        build: from the sample time [s] to the controller, without guards.
        sample_time: that is asked for [s].

    Raises:
        InputError: unstable on an ideal drive; the message says which sample time would do.
    """
    block = build(sample_time)
    loops = _Loops(robot, postures(robot))
    alone, where = loops.growth(block, ideal=True)
    late = alone
    if not alone:
        late, where = loops.growth(block, ideal=False)
    if not late:
        return ""
    if alone:
        _refuse_overloaded(robot, loops.poses)
    tries = (build(sample_time / 2**k) for k in range(1, HALVINGS + 1))
    enough = next((b.sample_time for b in tries if not loops.growth(b, ideal=False)[0]), None)
    advice = (
        f"ask for other gains, or leave them to the default: a rate {2**HALVINGS} times as high is "
        "not enough"
    )
    if enough is not None:
        advice = (
            f"sample every {enough:g} s (good for a usual drive, too) or ask for other gains, such "
            "as a lower bandwidth"
        )
    said = f"{block.name} sampled every {sample_time:g} s"
    angles = ", ".join(f"{angle:.0f}" for angle in np.degrees(where))
    grows = f"with the joints at {angles} deg an error doubles every {np.log(2) / late:.2g} s"
    if not alone:
        return (
            f"{said} is unstable with a drive that is a sample late and filters its speed at "
            f"250 Hz: {grows}; {advice}"
        )
    raise InputError(
        f"{said} is unstable on its own arm: {grows}; expected one that fades; {advice}"
    )


def loop_remark(robot: Robot, build: Callable[[float], Block], sample_time: float) -> str:
    """What `check_sampled_loop` says, where a run is to show it: as a remark, never a refusal.

    Args:
        robot: the arm.
        build: from the sample time [s] to the controller, without guards.
        sample_time: that is asked for [s].
    """
    try:
        return check_sampled_loop(robot, build, sample_time)
    except InputError as error:
        return str(error)


@dataclass(frozen=True, eq=False)
class _Loops:
    """An arm at some poses [rad], shape (k, n)."""

    robot: Robot
    poses: Array

    @cached_property
    def weights(self) -> Array:
        """How fast the weight alone speeds up an error, per angle [1/s2]: largest eigenvalue of
        -M^-1 dG/dq at each pose, shape (k,)."""
        mass = Model(self.robot).mass_matrix(self.poses)
        rates = np.linalg.solve(mass, weight_slope(self.robot, self.poses))
        return np.asarray(-np.linalg.eigvals(rates).real.min(axis=1))

    def growth(self, block: Block, *, ideal: bool) -> tuple[float, Array]:
        """Of the fastest error [1/s], zero where all fade or are the weight's; and the pose."""
        T = block.sample_time
        timing = Timing(T, delay_samples=0, speed_filter_Hz=0.0) if ideal else Timing(T)
        worst = 0.0
        where = self.poses[0]
        for q, pull in zip(self.poses, self.weights, strict=True):
            rate = float(np.log(np.abs(LinearLoop(self.robot, block, q, timing).poles).max())) / T
            held = T * (timing.delay_samples + 0.5) * float(pull)
            if rate > max(worst, NEUTRAL, min(SLOW, OF_THE_WEIGHT * held)):
                worst = rate
                where = q
        return worst, where


def postures(robot: Robot) -> Array:
    """Angles all over the joint box, at most a turn of each joint, its middle first; the lightest
    and the heaviest posture and the one that the weight upsets most last [rad], shape (k, n).

    Without those in which the arm cannot hold itself, if there are others: no controller can.
    """
    share = np.random.default_rng(2400).uniform(-0.8, 0.8, (POSES, robot.n))
    share[0] = 0.0
    half = np.minimum((robot.q_max - robot.q_min) / 2, np.pi)
    J = typical_inertia(robot)
    span = inertia_span(robot, J)
    extreme = (span.lightest, span.heaviest, weight_share(robot, J)[1])
    poses = np.vstack([(robot.q_min + robot.q_max) / 2 + share * half, *extreme])
    held = _overload(robot, poses).max(axis=1) <= 1.0
    return poses[held] if held.any() else poses


def _refuse_overloaded(robot: Robot, poses: Array) -> None:
    """Refuse an arm that its own weight is too much for at all of these poses (k, n) [rad]: an
    error grows there, whatever the gains, for the torque is cut."""
    share = _overload(robot, poses)
    least = share[int(share.max(axis=1).argmin())]
    j = int(least.argmax())
    if least[j] > 1.0:
        raise InputError(
            f"{robot.name}: cannot hold its own weight in any of {len(poses)} postures, at the "
            f"least {robot.joints[j].name} needs {least[j]:.3g} times its torque limit: no "
            "controller can; check masses and torque limits"
        )


def _overload(robot: Robot, poses: Array) -> Array:
    """Torque that the weight asks for over the limit [-], shape (k, n)."""
    return np.asarray(np.abs(Model(robot).gravity(poses)) / robot.tau_bound)
