"""Whether the loop of a controller and its own arm is stable at the rate at which it is sampled."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.codegen import Block
from irb2400_ctrl.controllers.linear import LinearLoop
from irb2400_ctrl.controllers.timing import Timing
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot import Robot

POSES = 8
HALVINGS = 7
"""of the sample time, in search of one that would do"""
SLOW = 1.0
"""[1/s] of a growth that is not called unstable. An arm without gains, guided by hand, has 0.1 at a
millisecond, because the held torque balances the weight of a sample ago; where a rate is too low
for its gains, one percent more of the sample time passes it."""


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
    poses = _poses(robot)
    block = build(sample_time)

    def growth(tried: Block, *, ideal: bool) -> float:
        """Of the fastest error [1/s], negative where all fade."""
        T = tried.sample_time
        timing = Timing(T, delay_samples=0, speed_filter_Hz=0.0) if ideal else Timing(T)
        loops = (LinearLoop(robot, tried, q, timing) for q in poses)
        return float(np.log(max(np.abs(loop.poles).max() for loop in loops))) / T

    alone = growth(block, ideal=True)
    late = alone if alone > SLOW else growth(block, ideal=False)
    if late <= SLOW:
        return ""
    tries = (build(sample_time / 2**k) for k in range(1, HALVINGS + 1))
    enough = next((b.sample_time for b in tries if growth(b, ideal=False) <= SLOW), None)
    advice = f"ask for other gains: a rate {2**HALVINGS} times as high is not enough"
    if enough is not None:
        advice = f"sample every {enough:g} s (good for a usual drive, too) or lower the bandwidth"
    said = f"{block.name} sampled every {sample_time:g} s"
    grows = f"an error doubles every {np.log(2) / late:.2g} s"
    if alone <= SLOW:
        return (
            f"{said} is unstable with a drive that is a sample late and filters its speed at "
            f"250 Hz: {grows}; {advice}"
        )
    raise InputError(
        f"{said} is unstable on its own arm: {grows}; expected one that fades; {advice}"
    )


def _poses(robot: Robot) -> Array:
    """Angles all over the joint box, at most a turn of each joint, its middle first [rad], shape
    (k, n)."""
    share = np.random.default_rng(2400).uniform(-0.8, 0.8, (POSES, robot.n))
    share[0] = 0.0
    half = np.minimum((robot.q_max - robot.q_min) / 2, np.pi)
    return np.asarray((robot.q_min + robot.q_max) / 2 + share * half)
