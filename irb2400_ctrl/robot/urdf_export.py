"""`Robot` as URDF, for tools that read nothing else.

URDF knows chains of joints but no coupling: its joints are the link angles A q, not the actuators.
What a user of the file must do about the parallelogram stands in a comment at its head. Effects
have no place in URDF and are named there.
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


def save_urdf(robot: Robot, path: Path | str) -> Path:
    """Write the robot as URDF."""
    return write_atomic(path, to_urdf(robot))


def to_urdf(robot: Robot) -> str:
    """The robot as URDF text: links `base`, those of the file, `flange`, `tool`, `tcp`; joints turn
    by A q. URDF has no gravity, its users let it point down: a base that does not stand upright is
    mounted on a link `world` that does."""
    lines = [
        '<?xml version="1.0" encoding="utf-8"?>',
        f"<robot name={quoteattr(robot.name)}>",
        _head(robot),
    ]
    X_WB = _mounting(robot)
    if X_WB is not None:
        lines += ['  <link name="world"/>', _fixed("base", "world", X_WB)]
    lines.append('  <link name="base"/>')
    parent = "base"
    for i, link in enumerate(robot.links):
        name = exported_name(link.name)
        lines += [_link(name, link.body), _revolute(robot, i, parent, name)]
        parent = name
    lines += ['  <link name="flange"/>', _fixed("flange", parent, robot.flange.matrix())]
    if robot.tool is not None:
        lines += [_link("tool", robot.tool.body), _fixed("tool", "flange", np.eye(4))]
    lines += ['  <link name="tcp"/>', _fixed("tcp", "flange", np.asarray(robot.X_FT)), "</robot>"]
    return "\n".join(lines) + "\n"


def _head(robot: Robot) -> str:
    notes = [f"Made from {robot.name}. {robot.source}"]
    A = robot.A
    if np.abs(A - np.eye(robot.n)).max() > 0:
        rows = []
        for i, row in enumerate(A):
            if np.abs(row - np.eye(robot.n)[i]).max() > 0:
                rows.append(f"{exported_joints(robot)[i]} = {_combination(row)}")
        notes.append(
            "The joints below are link angles, not actuator angles q: "
            + "; ".join(rows)
            + ", every other joint is its q (parallelogram). Speeds and accelerations go the same "
            "way; torques come back as tau_q = A^T tau_joint."
        )
        notes.append("Limits of coupled joints are what the actuators' limits allow at most.")
    if _mounting(robot) is not None:
        along = ", ".join(f"{v:g}" for v in robot.gravity)
        notes.append(f"Gravity is [{along}] m/s2 in base; world stands upright.")
    if robot.effects:
        kinds = ", ".join(sorted({effect.kind for effect in robot.effects}))
        notes.append(f"Effects of the robot file that URDF cannot hold: {kinds}.")
    if not np.isfinite([*robot.tau_bound, *robot.qd_bound]).all():
        notes.append("An effort or velocity of 0 is a limit that the robot file does not state.")
    lost = friction_left_out(robot)
    notes.append(
        "Stribeck friction (static, transition speed) is not part of URDF; damping and friction "
        f"are{', but for those of ' + ', '.join(lost) if lost else ''}."
    )
    text = "\n       ".join(notes).replace("--", "-")
    return f"  <!-- {escape(text)} -->"


def friction_left_out(robot: Robot) -> list[str]:
    """Joints whose friction has no place: it goes with the speed of an actuator that is none of the
    file's joints."""
    return [joint.name for i, joint in enumerate(robot.joints) if not _alone(robot.A, i)]


def _mounting(robot: Robot) -> Array | None:
    """Pose of the base in a frame whose z axis points up, shape (4, 4); None where its own does."""
    if np.array_equal(robot.upright, np.eye(3)):
        return None
    X = np.eye(4)
    X[:3, :3] = robot.upright
    return X


def _combination(row: Array) -> str:
    """ "q3 - q2" of a row of the coupling matrix, positive terms first."""
    order = sorted(np.flatnonzero(row), key=lambda k: row[k] < 0)
    text = ""
    for k in order:
        size = "" if abs(row[k]) == 1 else f"{abs(row[k]):g} "
        text += f" {'-' if row[k] < 0 else '+'} {size}q{k + 1}"
    return text.removeprefix(" + ").strip()


def _link(name: str, body: Body) -> str:
    xx, yy, zz, xy, xz, yz = (_number(value) for value in body.inertia_kgm2)
    return (
        f'  <link name="{name}">\n    <inertial>\n'
        f'      <origin xyz="{_numbers(body.com_m)}" rpy="0 0 0"/>\n      <mass '
        f'value="{_number(body.mass_kg)}"/>\n'
        f'      <inertia ixx="{xx}" ixy="{xy}" ixz="{xz}" iyy="{yy}" iyz="{yz}" izz="{zz}"/>\n'
        "    </inertial>\n  </link>"
    )


def _revolute(robot: Robot, i: int, parent: str, child: str) -> str:
    """Joint i with its zero where A q is zero: the offset of theta is part of its origin."""
    A = robot.A
    c = np.cos(robot.offset[i])
    s = np.sin(robot.offset[i])
    X = robot.links[i].frame.matrix()
    X[:3, :3] = X[:3, :3] @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    ends = np.array([A[i] * robot.q_min, A[i] * robot.q_max])
    lower = ends.min(axis=0).sum()
    upper = ends.max(axis=0).sum()
    effort = _bound(np.linalg.inv(A).T[i], robot.tau_bound)
    velocity = _bound(A[i], robot.qd_bound)
    lines = [
        f'  <joint name="{exported_joints(robot)[i]}" type="revolute">',
        f'    <parent link="{parent}"/>\n    <child link="{child}"/>\n    {_origin(X)}\n    <axis '
        f'xyz="0 0 1"/>',
        f'    <limit lower="{_number(lower)}" upper="{_number(upper)}" effort="{_number(effort)}" '
        f'velocity="{_number(velocity)}"/>',
    ]
    if _alone(A, i):
        _, coulomb, viscous, _ = robot.friction[i]
        lines.append(f'    <dynamics damping="{_number(viscous)}" friction="{_number(coulomb)}"/>')
    return "\n".join([*lines, "  </joint>"])


def _alone(A: Array, i: int) -> bool:
    """Whether joint i of the file turns as its actuator does, and drives no other."""
    unit = np.eye(len(A))[i]
    return bool((A[i] == unit).all() and (A[:, i] == unit).all())


def _bound(row: Array, limits: Array) -> float:
    """Largest |row x| within |x| <= limits; 0 where a limit that counts is unknown (infinite)."""
    counts = row != 0
    largest = float(np.abs(row[counts]) @ limits[counts])
    return largest if np.isfinite(largest) else 0.0


def _fixed(child: str, parent: str, X: Array) -> str:
    return (
        f'  <joint name="{parent}_to_{child}" type="fixed">\n    <parent link="{parent}"/>\n'
        f'    <child link="{child}"/>\n    {_origin(X)}\n  </joint>'
    )


def _origin(X: Array) -> str:
    """Position and fixed-axis angles: R = Rz(yaw) Ry(pitch) Rx(roll)."""
    R = X[:3, :3]
    if abs(R[2, 0]) < 1 - 1e-12:
        pitch = np.arctan2(-R[2, 0], np.hypot(R[0, 0], R[1, 0]))
        roll = np.arctan2(R[2, 1], R[2, 2])
        yaw = np.arctan2(R[1, 0], R[0, 0])
    else:
        # roll and yaw turn about the same axis: all of it goes into yaw
        pitch = -np.sign(R[2, 0]) * np.pi / 2
        roll = 0.0
        yaw = np.arctan2(-R[0, 1], R[1, 1])
    return f'<origin xyz="{_numbers(X[:3, 3])}" rpy="{_numbers((roll, pitch, yaw))}"/>'


def _number(value: float) -> str:
    """Shortest text that reads back to the same number."""
    return repr(float(value) + 0.0)


def _numbers(values: tuple[float, ...] | Array) -> str:
    return " ".join(_number(value) for value in values)
