"""The straight ways to the start of a plan and from its end, along the tool axis."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.programs.rapid.rapid_options import RapidOptions

_STEP = 1e-3
# between two rows a millimetre apart; more is a change of the branch [rad]
_LARGEST_JUMP = 0.1


def with_ends(
    model: Model, time: Array, q: Array, options: RapidOptions
) -> tuple[Array, Array, int]:
    """The plan with the way to its start before it and the way from its end behind it.

    Returns: time (m,), q (m, 6) and the row at which the plan begins.

    Args:
        model: of the arm.
        time: [s], shape (k,).
        q: [rad], shape (k, 6).
        options: of the program.

    Raises:
        InputError: the arm cannot go straight back so far in the plan's configuration.
    """
    speed = 1e-3 * options.approach_speed_mm_s
    before = _straight_back(model, q[0], 1e-3 * options.approach_mm, "approach_mm")[::-1]
    behind = _straight_back(model, q[-1], 1e-3 * options.retract_mm, "retract_mm")
    shift = 1e-3 * options.approach_mm / speed
    times = [time + shift]
    if len(before):
        times.insert(0, time[0] + np.arange(len(before)) * shift / len(before))
    if len(behind):
        lasting = 1e-3 * options.retract_mm / speed
        share = np.arange(1, len(behind) + 1) / len(behind)
        times.append(time[-1] + shift + share * lasting)
    return np.concatenate(times), np.concatenate([before, q, behind]), len(before)


def _straight_back(model: Model, q: Array, length: float, option: str) -> Array:
    """Rows away from the part, the farthest last, without q itself, shape (m, 6)."""
    if length == 0:
        return np.empty((0, 6))
    X = model.tcp_pose(q)
    back = -X[:3, :3] @ model.robot.spindle_axis
    rows = [q]
    for way in np.linspace(0.0, length, int(np.ceil(length / _STEP)) + 1)[1:]:
        X_k = X.copy()
        X_k[:3, 3] += way * back
        try:
            found = model.inverse_kinematics(X_k, rows[-1])
        except InputError as error:
            raise _cannot(option, length, way) from error
        if len(found) == 0 or np.abs(found[0] - rows[-1]).max() > _LARGEST_JUMP:
            raise _cannot(option, length, way)
        rows.append(found[0])
    return np.array(rows[1:])


def _cannot(option: str, length: float, way: float) -> InputError:
    return InputError(
        f"RAPID: {option} is {1e3 * length:g}, but along the tool axis the arm goes straight back "
        f"less than {1e3 * way:.0f} mm in this configuration; expected a shorter way"
    )
