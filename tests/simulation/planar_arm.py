"""An arm of two parallel axes that move in the plane of the weight."""

from __future__ import annotations

import tempfile
from functools import cache
from pathlib import Path

import numpy as np

from irb2400_ctrl.robot import Robot
from irb2400_ctrl.robot.importing import import_robot
from irb2400_ctrl.simulation import Trajectory, from_angles

URDF = """<robot name="planar"><link name="base"/>
<link name="upper"><inertial><origin xyz="0.25 0 0"/><mass value="6"/>
<inertia ixx="0.01" iyy="0.14" izz="0.14" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="lower"><inertial><origin xyz="0.2 0 0"/><mass value="3"/>
<inertia ixx="0.005" iyy="0.05" izz="0.05" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="tool0"/>
<joint name="j1" type="revolute"><parent link="base"/><child link="upper"/>
<origin xyz="0 0 0.4"/><axis xyz="0 1 0"/><dynamics damping="1" friction="4"/>
<limit lower="-2" upper="2" effort="150" velocity="3"/></joint>
<joint name="j2" type="revolute"><parent link="upper"/><child link="lower"/>
<origin xyz="0.5 0 0"/><axis xyz="0 1 0"/><dynamics damping="0.3" friction="1.5"/>
<limit lower="-2.5" upper="2.5" effort="50" velocity="5"/></joint>
<joint name="end" type="fixed"><parent link="lower"/><child link="tool0"/>
<origin xyz="0.4 0 0"/></joint></robot>"""


@cache
def planar(*, limits: bool = True, torque: float = 150.0) -> Robot:
    """The arm with a torque limit of its first axis [Nm]; without `limits` its file states none."""
    text = URDF.replace('"150"', f'"{torque}"')
    if not limits:
        text = URDF.replace('effort="150"', 'effort="0"').replace('effort="50"', 'effort="0"')
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "planar.urdf"
        path.write_text(text)
        return import_robot(path, outline=False).robot


def reach(way: float = 1.0) -> Trajectory:
    """From rest to rest in a second, downwards; upwards with a `way` below zero."""
    time = np.linspace(0.0, 1.0, 251)
    share = time**3 * (10 - 15 * time + 6 * time**2)
    return from_angles(time, np.outer(share, way * np.array([0.8, 0.6])))
