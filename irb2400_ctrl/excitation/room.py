"""Where an arm has room to move: its floor and column, and a part of the joint box away from both.

The middle of the joint box of an IRB 2400 is such a place. Of other arms it may be an arm stretched
out flat, from which most motions lead into the floor.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import TypeVar

import numpy as np

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.errors import InfeasibleError
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Robot

Found = TypeVar("Found")
FLOOR = 0.10
COLUMN = 0.40
"""[m] flange and tool stay this high above the base plane and this far from axis 1; smaller arms
keep a fifth of their reach from the axis"""
_SHARE = 0.2
_AT_SHOULDER = 0.02
"""a base frame this close below axis 2 lies at the shoulder [m]"""
_WIDTHS = np.radians([50.0, 35.0, 25.0, 15.0])
"""half the range that a joint keeps about a place with room, the widest that is free [rad]"""
_FREE = 0.95
"""share of the configurations about such a place that are clear"""
_NARROWED = "narrowed, so that flange and tool keep clear of base plane and axis 1"
"""source of a range that is a part of the robot file's"""
_DRAWN = 3000
_LOOKED_AT = 60
_AROUND = 80


@lru_cache(maxsize=32)
def floor_and_column(robot: Robot) -> tuple[float, float]:
    """Lowest height and smallest distance from axis 1 of flange and tool [m].

    A low shoulder (a small arm on a table) halves the height; a base frame that lies at the
    shoulder (Puma) has its floor below, half a reach is free there. A single axis has no column
    that its tool could come near to.
    """
    frames = [link.frame.matrix() for link in robot.links]
    shoulder = float((frames[0] @ frames[1])[2, 3]) if robot.n > 1 else 0.0
    reach = sum(float(np.linalg.norm(X[:3, 3])) for X in (*frames, robot.flange.matrix()))
    floor = min(FLOOR, shoulder / 2) if shoulder > _AT_SHOULDER else shoulder - reach / 2
    return floor, min(COLUMN, _SHARE * reach) if robot.n > 1 else 0.0


def height_and_radius(model: Model, q: Array) -> tuple[Array, Array]:
    """Of the lower one of flange and TCP over the base plane, and of the one nearer to axis 1 [m],
    shape (m,) each."""
    p = np.stack([pose(q)[:, :3, 3] for pose in (model.tcp_pose, model.flange_pose)])
    first = model.robot.links[0].frame.matrix()
    # axis 1 need not go through the base frame: an arm beside the middle of its stand
    across = np.cross(p - first[:3, 3], first[:3, 2])
    radius: Array = np.linalg.norm(across, axis=-1).min(axis=0)
    return p[..., 2].min(axis=0), radius


def in_room(robot: Robot, planned: Callable[[Robot], Found]) -> Found:
    """What is planned for the robot in its ranges, or where these leave no motion in narrow ones:
    moves between pieces may lead through floor or column.

    Raises:
        InfeasibleError: neither leaves one.
    """
    try:
        return planned(with_room(robot))
    except InfeasibleError:
        narrow = with_room(robot, narrow=True)
    return planned(narrow)


def with_room(robot: Robot, narrow: bool = False) -> Robot:
    """The robot, its ranges narrowed about a place with room if the middle of its box has none, or
    where `narrow` asks for it.

    Raises:
        InfeasibleError: there is no such place.
    """
    model = Model(robot)
    low = robot.q_min
    high = robot.q_max
    if not narrow and _clear(model, (low + high)[None] / 2)[0]:
        return robot
    rng = np.random.default_rng(0)
    # whole turns are the same place
    near = np.clip(rng.uniform(-np.pi, np.pi, (_DRAWN, robot.n)), low, high)
    near = near[_clear(model, near)][:_LOOKED_AT]
    if len(near) == 0:
        floor, column = floor_and_column(robot)
        raise InfeasibleError(
            f"{robot.name}: found flange or tool less than {floor:.2f} m above the base plane or "
            f"{column:.2f} m from axis 1 at every posture that was tried, expected room; wider "
            "range_deg, or the frames of base and flange as they are"
        )
    around = rng.uniform(-1.0, 1.0, (_AROUND, robot.n))
    for wide in _WIDTHS:
        free = [float(_clear(model, np.clip(q + wide * around, low, high)).mean()) for q in near]
        centre = near[int(np.argmax(free))]
        if max(free) >= _FREE:
            break
    ends = np.degrees([np.maximum(low, centre - wide), np.minimum(high, centre + wide)])
    joints = []
    for joint, a, b in zip(robot.joints, *ends, strict=True):
        kept = {"range_deg": (float(a), float(b)), "range_source": _NARROWED}
        limits = joint.limits.model_copy(update=kept)
        joints.append(joint.model_copy(update={"limits": limits}))
    return robot.model_copy(update={"joints": tuple(joints)})


def ranges_kept(robot: Robot) -> list[tuple[float, float]] | None:
    """Ends of the ranges [deg] that `with_room` has left of the robot file's; None: all of them."""
    limits = [joint.limits for joint in robot.joints]
    if all(each.range_source != _NARROWED for each in limits):
        return None
    return [each.range_deg for each in limits]


def remark(robot: Robot) -> list[str]:
    """For the terminal: which part of the ranges a motion keeps; nothing if it is all of them."""
    kept = ranges_kept(robot)
    if kept is None:
        return []
    parts = ", ".join(f"{low:.0f} … {high:.0f}" for low, high in kept)
    return [
        f"only a part of the joints' ranges is used [deg]: {parts}; beyond it flange or tool come "
        "near the base plane or axis 1 (a file with narrower ranges says where the arm has room)"
    ]


def _clear(model: Model, q: Array) -> Mask:
    height, radius = height_and_radius(model, q)
    floor, column = floor_and_column(model.robot)
    return np.asarray((height >= floor) & (radius >= column))
