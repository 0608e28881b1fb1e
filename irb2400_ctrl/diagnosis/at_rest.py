"""Joints that rest in a log, which no fit uses, as its witnesses: their torque holds them up."""

from __future__ import annotations

from collections.abc import Sequence

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.preparation.resting import held_at_rest
from irb2400_ctrl.robot import Robot

WORSE_AT_REST = (
    "what was found makes the torque of a joint that rests wrong by more than its friction can "
    "hold ({joints}): it fits the joints that moved, not the arm; record a motion of all "
    "joints (irb2400 excite)"
)


def worse_at_rest(
    given: Robot, resting: Sequence[int], before: Array, after: Array
) -> tuple[int, ...]:
    """Resting joints that are explained worse than by the file, by more than dry friction holds.

    A joint that stands may carry anything between -F_s and F_s beside its bodies (eq. 54): an rms
    error that grows by more than F_s says that the bodies or effects found are wrong.

    Args:
        given: the robot before; a joint without stated dry friction is no witness.
        resting: the joints, from 1.
        before, after: rms torque error of the model as given and with all that was found, shape
            (n,) [Nm].
    """
    worse = after - before > held_at_rest(given)
    return tuple(j for j in resting if worse[j - 1])
