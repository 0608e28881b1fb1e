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
GROWS = 1.0 + 1e-6
"""largest |z| of a loop that is not called unstable: without a gain its poles lie at 1"""


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

    def largest(tried: Block, *, ideal: bool) -> float:
        T = tried.sample_time
        timing = Timing(T, delay_samples=0, speed_filter_Hz=0.0) if ideal else Timing(T)
        loops = (LinearLoop(robot, tried, q, timing) for q in poses)
        return max(float(np.abs(loop.poles).max()) for loop in loops)

    alone = largest(block, ideal=True)
    late = alone if alone > GROWS else largest(block, ideal=False)
    if late <= GROWS:
        return ""
    tries = (build(sample_time / 2**k) for k in range(1, 8))
    enough = next((b.sample_time for b in tries if largest(b, ideal=False) <= GROWS), None)
    advice = "lower the bandwidth"
    if enough is not None:
        advice = f"sample every {enough:g} s (that is stable with a usual drive, too) or {advice}"
    said = f"{block.name} sampled every {sample_time:g} s"
    if alone <= GROWS:
        return (
            f"{said} is unstable with a drive that is a sample late and filters its speed at "
            f"250 Hz: an error grows {late:.3g} times with each sample; {advice}"
        )
    raise InputError(
        f"{said} is unstable on its own arm: an error grows {alone:.3g} times with each sample; "
        f"expected one that fades; {advice}"
    )


def _poses(robot: Robot) -> Array:
    """Angles all over the joint box, its middle first [rad], shape (k, n)."""
    low = np.maximum(robot.q_min, -np.pi)
    high = np.minimum(robot.q_max, np.pi)
    share = np.random.default_rng(2400).uniform(0.1, 0.9, (POSES, robot.n))
    share[0] = 0.5
    return np.asarray(low + share * (high - low))
