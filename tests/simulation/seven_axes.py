"""A light arm of seven axes, of a cobot's size: what its first axis has to turn differs thirty-fold
between its postures."""

from __future__ import annotations

from pathlib import Path

from irb2400_ctrl.robot import Robot
from irb2400_ctrl.robot.importing import import_robot

QUARTER = 1.5707963267948966
LIMITS = ((2.9, 87), (1.76, 87), (2.9, 87), (1.5, 87), (2.9, 12), (1.88, 12), (2.9, 12))
"""half range [rad], torque [Nm]"""
MIDDLE = (0.0, 0.0, 0.0, -1.57, 0.0, 1.87, 0.0)
PLACES = (
    (0, 0, 0.33), (0, 0, 0), (0, -0.32, 0), (0.08, 0, 0), (-0.08, 0.38, 0), (0, 0, 0), (0.09, 0, 0),
)  # fmt: skip
TURNS = (0.0, -QUARTER, QUARTER, QUARTER, -QUARTER, QUARTER, QUARTER)
BODIES = (
    (5.0, (0.0, 0.0, -0.05), (0.05, 0.05, 0.01)),
    (0.7, (0.0, -0.03, 0.0), (0.01, 0.03, 0.03)),
    (3.2, (0.03, 0.04, -0.07), (0.04, 0.04, 0.01)),
    (3.6, (-0.05, 0.10, 0.03), (0.03, 0.02, 0.03)),
    (1.2, (-0.01, 0.04, -0.04), (0.035, 0.03, 0.01)),
    (1.7, (0.06, -0.01, -0.01), (0.002, 0.004, 0.005)),
    (0.7, (0.01, 0.0, 0.06), (0.012, 0.010, 0.005)),
)
"""mass [kg], its centre [m], moments of inertia [kg m2]"""


def seven_axes(folder: Path) -> Robot:
    """The arm, read from a URDF that is written into the folder."""
    parts = ['<robot name="seven_axes"><link name="l0"/>']
    for k, (mass, com, moments) in enumerate(BODIES):
        half, torque = LIMITS[k]
        tensor = " ".join(f'i{a}{a}="{m}"' for a, m in zip("xyz", moments, strict=True))
        parts.append(
            f'<link name="l{k + 1}"><inertial><origin xyz="{_row(com)}"/><mass value="{mass}"/>'
            f'<inertia {tensor} ixy="0" ixz="0" iyz="0"/></inertial></link>'
            f'<joint name="j{k + 1}" type="revolute"><parent link="l{k}"/><child link="l{k + 1}"/>'
            f'<origin xyz="{_row(PLACES[k])}" rpy="{TURNS[k]} 0 0"/><axis xyz="0 0 1"/>'
            f'<limit lower="{MIDDLE[k] - half}" upper="{MIDDLE[k] + half}" effort="{torque}" '
            'velocity="2.2"/><dynamics damping="0.3" friction="0.5"/></joint>'
        )
    file = folder / "seven_axes.urdf"
    file.write_text("\n".join([*parts, "</robot>"]))
    return import_robot(file).robot


def _row(numbers: tuple[float, ...]) -> str:
    return " ".join(map(str, numbers))
