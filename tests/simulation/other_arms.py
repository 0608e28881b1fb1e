"""Arms of other sizes and of fewer axes: a palletiser of a ton, a single axis."""

from __future__ import annotations

from pathlib import Path

from irb2400_ctrl.robot import Robot
from irb2400_ctrl.robot.importing import import_robot

UPRIGHT = "0 0 1"
ACROSS = "0 1 0"
Axis = tuple[str, str, tuple[float, float], float, float, tuple[float, float]]
Body = tuple[float, str, tuple[float, float, float]]

PALLETISER: tuple[tuple[Axis, Body], ...] = (
    (("0 0 0.4", UPRIGHT, (-3.1, 3.1), 6000, 2.0, (60, 150)), (800, "0.1 0 0.3", (60, 60, 50))),
    (("0.35 0 0.6", ACROSS, (-0.7, 1.4), 9000, 1.8, (80, 200)), (250, "0 0 0.6", (40, 40, 5))),
    (("0 0 1.25", ACROSS, (-0.9, 1.2), 6000, 2.0, (50, 120)), (180, "0.6 0 0.1", (4, 35, 35))),
    (("1.35 0 0", UPRIGHT, (-6.2, 6.2), 800, 6.0, (5, 20)), (60, "0 0 -0.1", (1.5, 1.5, 1))),
)
"""where [m], about what, range [rad], torque [Nm], speed [rad/s], (damping, friction); and mass
[kg], its centre [m], moments of inertia [kg m2]"""
SINGLE: tuple[tuple[Axis, Body], ...] = (
    (("0 0 0.3", UPRIGHT, (-2.3, 2.3), 100, 6.0, (0.5, 2)), (8, "0.15 0 0", (0.02, 0.09, 0.09))),
)


def arm_of(parts: tuple[tuple[Axis, Body], ...], name: str, folder: Path) -> Robot:
    """The arm, read from a URDF that is written into the folder.

    Args:
        parts: an axis and its link, from the base on.
        name: of the arm.
        folder: for the file.
    """
    text = [f'<robot name="{name}"><link name="l0"/>']
    for k, ((place, about, ends, torque, speed, friction), (mass, com, moments)) in enumerate(
        parts
    ):
        tensor = " ".join(f'i{a}{a}="{m}"' for a, m in zip("xyz", moments, strict=True))
        text.append(
            f'<link name="l{k + 1}"><inertial><origin xyz="{com}"/><mass value="{mass}"/>'
            f'<inertia {tensor} ixy="0" ixz="0" iyz="0"/></inertial></link>'
            f'<joint name="j{k + 1}" type="revolute"><parent link="l{k}"/><child link="l{k + 1}"/>'
            f'<origin xyz="{place}"/><axis xyz="{about}"/><limit lower="{ends[0]}" '
            f'upper="{ends[1]}" effort="{torque}" velocity="{speed}"/>'
            f'<dynamics damping="{friction[0]}" friction="{friction[1]}"/></joint>'
        )
    end = f'l{len(parts)}"/><child link="tool0"/><origin xyz="0.1 0 -0.1"/></joint></robot>'
    text.append(f'<link name="tool0"/><joint name="f" type="fixed"><parent link="{end}')
    file = folder / f"{name}.urdf"
    file.write_text("\n".join(text))
    return import_robot(file).robot
