"""`Robot` as MJCF, for MuJoCo.

Joints are the link angles A q, as in the URDF. An actuator angle that depends on several joints
(the parallelogram: q3 = joint_2 + joint_3) is a fixed tendon: its length is q, a motor on it gives
the torque of the actuator, and its damping, friction and range are those of the actuator.
"""

from __future__ import annotations

from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.files import write_atomic
from irb2400_ctrl.robot.description import Robot
from irb2400_ctrl.robot.exported_names import exported_joints, exported_name
from irb2400_ctrl.robot.link import Body


def save_mjcf(robot: Robot, path: Path | str) -> Path:
    """Write the robot as MJCF."""
    return write_atomic(path, to_mjcf(robot))


def to_mjcf(robot: Robot) -> str:
    """The robot as MJCF text: bodies of the links, `flange` and `tcp` as sites, one motor for each
    actuator."""
    Q: Array = np.asarray(np.linalg.inv(robot.A), dtype=np.float64)
    lines = [
        f"<mujoco model={quoteattr(robot.name)}>",
        f"  <!-- {_head(robot)} -->",
        '  <compiler angle="radian" inertiafromgeom="false" autolimits="true"/>',
        f'  <option gravity="{_words(robot.gravity_m_s2)}" timestep="0.001"/>',
        "  <worldbody>",
    ]
    for i in range(robot.n):
        lines += _opened(robot, i, Q)
    lines += _ends(robot)
    lines += ["    " + "  " * i + "</body>" for i in reversed(range(robot.n))]
    lines.append("  </worldbody>")
    lines += _tendons(robot, Q)
    lines.append("  <actuator>")
    for i, limit in enumerate(robot.tau_bound):
        place = f'joint="{exported_joints(robot)[i]}"' if _alone(Q, i) else f'tendon="q{i + 1}"'
        bound = f' ctrlrange="{_words((-limit, limit))}"' if np.isfinite(limit) else ""
        lines.append(f'    <motor name="tau{i + 1}" {place}{bound}/>')
    return "\n".join([*lines, "  </actuator>", "</mujoco>"]) + "\n"


def left_out(robot: Robot) -> list[str]:
    """Kinds of the robot's effects that have no place in MJCF; the inertia of a rotor has one."""
    return sorted({effect.kind for effect in robot.effects if effect.motor_inertia is None})


def _head(robot: Robot) -> str:
    notes = [f"Made from {robot.name}. {robot.source}"]
    if robot.coupled:
        notes.append(
            "Joints are link angles A q; tendons q1, q2, ... are the actuator angles that depend "
            "on several of them, and carry motor, damping, friction and range."
        )
    notes.append("Static friction and its transition speed (Stribeck) have no place in MJCF.")
    if left_out(robot):
        notes.append(f"Effects of the robot file that are left out: {', '.join(left_out(robot))}.")
    notes += robot.assumptions()
    return escape("\n       ".join(notes)).replace("--", "-")


def _opened(robot: Robot, i: int, Q: Array) -> list[str]:
    """The opening of link i's body with its joint and mass; closed at the end of the chain."""
    link = robot.links[i]
    c = np.cos(robot.offset[i])
    s = np.sin(robot.offset[i])
    X = link.frame.matrix()
    X[:3, :3] = X[:3, :3] @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    pad = "    " + "  " * i
    joint = f'{pad}  <joint name="{exported_joints(robot)[i]}" type="hinge" axis="0 0 1"'
    if _alone(Q, i):
        joint += f' range="{_words((robot.q_min[i], robot.q_max[i]))}"{_of_actuator(robot, i)}'
    name = exported_name(link.name)
    lines = [
        f'{pad}<body name="{name}" pos="{_words(X[:3, 3])}" quat="{_words(quaternion(X))}">',
        joint + "/>",
    ]
    if link.body.mass_kg > 0.0 or any(link.body.inertia_kgm2):
        lines.append(f"{pad}  {_inertial(link.body)}")
    return lines


def _ends(robot: Robot) -> list[str]:
    """Flange, TCP and the tool's body, which is fixed to the last link."""
    pad = "      " + "  " * (robot.n - 1)
    X = robot.flange.matrix()
    place = f'pos="{_words(X[:3, 3])}" quat="{_words(quaternion(X))}"'
    X_T = X @ robot.X_FT
    lines = [
        f'{pad}<site name="flange" {place}/>',
        f'{pad}<site name="tcp" pos="{_words(X_T[:3, 3])}" quat="{_words(quaternion(X_T))}"/>',
    ]
    if robot.tool is not None and robot.tool.body.mass_kg > 0.0:
        lines.append(f'{pad}<body name="tool" {place}>{_inertial(robot.tool.body)}</body>')
    return lines


def _inertial(body: Body) -> str:
    xx, yy, zz, xy, xz, yz = body.inertia_kgm2
    return (
        f'<inertial pos="{_words(body.com_m)}" mass="{_words((body.mass_kg,))}" '
        f'fullinertia="{_words((xx, yy, zz, xy, xz, yz))}"/>'
    )


def _tendons(robot: Robot, Q: Array) -> list[str]:
    """A fixed tendon for every actuator angle that is not a joint alone."""
    lines = []
    for i in range(robot.n):
        if _alone(Q, i):
            continue
        ends = _words((robot.q_min[i], robot.q_max[i]))
        lines.append(f'    <fixed name="q{i + 1}" range="{ends}"{_of_actuator(robot, i)}>')
        lines += [
            f'      <joint joint="{exported_joints(robot)[j]}" coef="{_words((Q[i, j],))}"/>'
            for j in np.flatnonzero(Q[i])
        ]
        lines.append("    </fixed>")
    return ["  <tendon>", *lines, "  </tendon>"] if lines else []


def _alone(Q: Array, i: int) -> bool:
    """Actuator angle i is joint i."""
    return bool((Q[i] == np.eye(len(Q))[i]).all())


def _of_actuator(robot: Robot, i: int) -> str:
    """Its friction and its rotor, where they are known."""
    _, coulomb, viscous, _ = robot.friction[i]
    _, coulomb_known, viscous_known, _ = robot.friction_known[i]
    text = f' damping="{_words((viscous,))}"' if viscous_known else ""
    text += f' frictionloss="{_words((coulomb,))}"' if coulomb_known else ""
    rotor = sum(e.motor_inertia or 0.0 for e in robot.effects if e.joint == i + 1)
    return text + (f' armature="{_words((rotor,))}"' if rotor else "")


def quaternion(X: Array) -> Array:
    """(w, x, y, z) of the rotation of a pose, shape (4,)."""
    R = X[:3, :3]
    # the four sizes 4 w^2, 4 x^2, ...: the largest one is divided by
    sizes = 1.0 + np.array(
        [
            R[0, 0] + R[1, 1] + R[2, 2],
            R[0, 0] - R[1, 1] - R[2, 2],
            R[1, 1] - R[0, 0] - R[2, 2],
            R[2, 2] - R[0, 0] - R[1, 1],
        ]
    )
    x = R[2, 1] - R[1, 2]
    y = R[0, 2] - R[2, 0]
    z = R[1, 0] - R[0, 1]
    xy = R[0, 1] + R[1, 0]
    xz = R[0, 2] + R[2, 0]
    yz = R[1, 2] + R[2, 1]
    k = int(np.argmax(sizes))
    row = [[sizes[0], x, y, z], [x, sizes[1], xy, xz], [y, xy, sizes[2], yz], [z, xz, yz, sizes[3]]]
    q = np.array(row[k])
    return np.asarray(q / np.linalg.norm(q))


def _words(values: tuple[float, ...] | Array) -> str:
    """Shortest texts that read back to the same numbers."""
    return " ".join(repr(float(value) + 0.0) for value in values)
