"""The joint's table of a robot file from what another format says; what is absurd is unknown."""

from __future__ import annotations

from typing import Any

import numpy as np

from irb2400_ctrl.robot.importing.tree import TreeJoint
from irb2400_ctrl.robot.joint import PLAUSIBLE

ABSURD_EFFORT = 1e5
"""a joint of an arm does not reach this torque [Nm]"""
ABSURD_SPEED = 100.0
"""nor this speed [rad/s]"""
LEAST_EFFORT = PLAUSIBLE["torque_Nm"][0]
LEAST_SPEED = float(np.radians(PLAUSIBLE["speed_deg_s"][0]))
"""and every joint has more than these"""
SOURCE = "the imported file"
DEGREES = 4 * np.pi
"""a range beyond two turns either way looks like degrees [rad]"""
ENDLESS = 1e5
"""and one beyond this says that there is none [rad]"""


def joint_table(joint: TreeJoint, notes: list[str]) -> dict[str, Any]:
    """Limits and friction of one joint; appends to `notes` what was not believed."""
    table: dict[str, Any] = {"name": joint.name, "limits": _limits(joint, notes)}
    if joint.unread:
        notes.append(
            f"joint {joint.name}: not read: {', '.join(joint.unread)}; URDF has damping and "
            "friction in one <dynamics> (armature is read, too)"
        )
    friction: dict[str, Any] = {}
    if joint.damping:
        friction["viscous_Nms_rad"] = joint.damping
    if joint.dry:
        friction["coulomb_Nm"] = joint.dry
    if friction:
        table["friction"] = {**friction, "source": SOURCE}
    if joint.gear:
        table["transmission"] = {"gear_ratio": joint.gear, "source": SOURCE}
    return table


def _limits(joint: TreeJoint, notes: list[str]) -> dict[str, Any]:
    source = SOURCE
    ends = joint.range
    if ends is None or ends[0] >= ends[1] or max(map(abs, ends)) > ENDLESS:
        notes.append(f"joint {joint.name}: {_no_range(joint)}; one turn either way is kept")
        ends = (-2 * np.pi, 2 * np.pi)
        source = "assumption: the file states no range, one turn either way is kept"
    elif max(abs(end) for end in ends) > DEGREES:
        notes.append(
            f"joint {joint.name}: range {ends[0]:g} to {ends[1]:g} rad is beyond two turns; it "
            "looks like degrees, check the file"
        )
    low, high = ends
    if joint.soft is not None and (low < joint.soft[0] < high or low < joint.soft[1] < high):
        notes.append(
            f"joint {joint.name}: soft limits within its range are not read (safety_controller): "
            "plans use the whole range"
        )
    limits: dict[str, Any] = {"range_deg": np.degrees(ends).tolist(), "range_source": source}
    if joint.speed is not None and LEAST_SPEED <= joint.speed <= ABSURD_SPEED:
        limits["speed_deg_s"] = float(np.degrees(joint.speed))
    else:
        found = _found(joint.speed, "rad/s", ABSURD_SPEED)
        notes.append(f"joint {joint.name}: speed limit {found}, taken as unknown")
    if joint.effort is not None and LEAST_EFFORT <= joint.effort < ABSURD_EFFORT:
        limits["torque_Nm"] = joint.effort
        limits["torque_source"] = SOURCE
    else:
        found = _found(joint.effort, "Nm", ABSURD_EFFORT)
        notes.append(f"joint {joint.name}: torque limit {found}, taken as unknown")
    least, most = PLAUSIBLE["acceleration_deg_s2"]
    acceleration = np.degrees(joint.acceleration or 0.0)
    if least <= acceleration <= most:
        limits["acceleration_deg_s2"] = float(acceleration)
    elif joint.acceleration is not None:
        found = _found(joint.acceleration, "rad/s2", float(np.radians(most)))
        notes.append(f"joint {joint.name}: acceleration limit {found}, taken as unknown")
    return limits


def _no_range(joint: TreeJoint) -> str:
    if joint.kind == "continuous":
        return "it turns endlessly (continuous)"
    if joint.range is None:
        return "no range in the file"
    low, high = joint.range
    why = "the lower end must be below" if low >= high else "nothing turns so far"
    if low == high == 0.0:
        why += '; of a joint that does not turn, as that of a force sensor, write type="fixed"'
    return f"range {low:g} to {high:g} rad in the file is none ({why})"


def _found(value: float | None, unit: str, most: float) -> str:
    """A limit that is not believed.

    Args:
        value: in the file.
        unit: that a URDF states it in.
        most: larger ones are of no arm.
    """
    if value is None:
        return "is not in the file"
    return f"is {value:g} {unit} in the file" + ", more than any arm's" * (value > most)
