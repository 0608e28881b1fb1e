"""Joints of a chain that follow another one (URDF's `<mimic>`): a parallelogram, or refused.

A link that a parallelogram keeps upright is written as a passive joint on the axis of the next
one, driven by the upper arm: theta_p = m q_j + o. Both turn about one line, so that what is beyond
turns by

    theta_k = q_k +- (m q_j + o),

which is a coupling of axis k to axis j.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot.importing.tree import TURNING, Tree, TreeJoint

_ONE_LINE = 1e-5
"""angle [rad] and distance [m] between two axes that count as one"""


@dataclass(frozen=True)
class Driven:
    """A coupling that the file states: theta_k = q_k + factor q_j + offset; joints by number."""

    axis: int
    by: int
    factor: float
    offset: float
    """[rad]"""


def driven(
    tree: Tree, path: list[TreeJoint], notes: list[str]
) -> tuple[list[TreeJoint], list[Driven]]:
    """The path with its followers held, and what they couple; appends to `notes` what is assumed.

    Raises:
        InputError: a follower that is no part of a parallelogram.
    """
    motors = [joint for joint in path if joint.kind in TURNING and not joint.mimics]
    numbers = {joint.name: k for k, joint in enumerate(motors, 1)}
    held = []
    found = []
    for place, joint in enumerate(path):
        if joint.kind not in TURNING or not joint.mimics:
            held.append(joint)
            continue
        other, sign = _on_the_same_line(path, place)
        if other is None or joint.mimics not in numbers or other.name == joint.mimics:
            raise InputError(
                f"{tree.name}: joint {joint.name} follows {joint.mimics} (mimic), has no actuator "
                "of its own, and does not share its axis with the next joint, as in a "
                "parallelogram; choose another end with --tool-link, or take <mimic> out of the "
                "file if a motor drives it (--coupling I,J,FACTOR says what it is coupled to)"
            )
        held.append(replace(joint, kind="fixed", mimics=None))
        axis = numbers[other.name]
        by = numbers[joint.mimics]
        found.append(Driven(axis, by, sign * joint.multiplier, sign * joint.offset))
        notes.append(
            f"{joint.name} follows {joint.mimics} (mimic) on the axis of {other.name}: "
            f"theta{axis} = q{axis} {sign * joint.multiplier:+g} q{by}"
        )
        body = tree.links[joint.child]
        if body is not None and body.mass > 0:
            notes.append(
                f"link {joint.child} ({body.mass:.3g} kg) between them turns with neither: it is "
                f"counted as part of {joint.parent}"
            )
    return held, found


def _on_the_same_line(path: list[TreeJoint], place: int) -> tuple[TreeJoint | None, float]:
    """The next joint, if it has a motor and turns about the same line, and 1 or -1: the same way,
    or against it."""
    X = np.eye(4)
    for other in path[place + 1 :]:
        # from the frame of the one to that of the other, at angle zero
        X = X @ other.X
        if other.kind in TURNING:
            break
    else:
        return None, 1.0
    first = _unit(path[place].axis)
    second = X[:3, :3] @ _unit(other.axis)
    apart = np.cross(X[:3, 3], first)
    skew = np.cross(first, second)
    if other.mimics or max(np.linalg.norm(skew), np.linalg.norm(apart)) > _ONE_LINE:
        return None, 1.0
    return other, float(np.sign(first @ second))


def _unit(axis: Array) -> Array:
    return np.asarray(axis / max(float(np.linalg.norm(axis)), 1e-12))
