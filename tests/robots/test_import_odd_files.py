"""Files that look right and are not: refused with the reason, or read as MuJoCo reads them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from robots.public_arms import arms, urdf

import irb2400_ctrl as irb
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot.importing import Imported, import_robot

ARM = urdf(arms()["irb1200"])
BODIES = ("0 0 .3", ".05 0 .1", "0 0 .5", ".1 0 .05", ".3 0 0", ".08 0 0")
AXES = ("0 0 1", "0 1 0", "0 1 0", "1 0 0", "0 1 0", "1 0 0")


def mjcf(compiler: str = "", joint_2: str = "", body_2: str = "") -> str:
    """An arm of six bodies in each other."""
    inner = ""
    for k in range(5, -1, -1):
        inner = (
            f'<body name="l{k + 1}" pos="{BODIES[k]}" {body_2 if k == 1 else ""}>'
            f'<inertial pos=".02 .01 .05" mass="{6 - k}" diaginertia=".1 .09 .05"/>'
            f'<joint name="j{k + 1}" axis="{AXES[k]}" range="-100 100" '
            f'{joint_2 if k == 1 else ""}/><geom type="sphere" size=".03" mass="1"/>{inner}</body>'
        )
    return f'<mujoco model="x"><compiler {compiler}/><worldbody>{inner}</worldbody></mujoco>'


def read(path: Path, text: str) -> Imported:
    path.write_text(text)
    return import_robot(path)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('type="revolute"', 'type="Revolute"', r"'Revolute', expected one of revolute"),
        ('rpy="0.0 0.0 0.0"', 'rpy="0 90 0"', "looks like degrees"),
        (
            '<link name="tool0"/>',
            '<link name="tool0"/><joint name="loop" type="revolute"><parent link="link_1"/>'
            '<child link="link_3"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>',
            r"link_3 hangs on two joints, joint_3 and loop",
        ),
    ],
)
def test_a_urdf_that_cannot_be_meant_so(tmp_path: Path, old: str, new: str, says: str) -> None:
    assert old in ARM
    with pytest.raises(InputError, match=says):
        read(tmp_path / "arm.urdf", ARM.replace(old, new, 1))


def test_an_arm_with_a_sliding_joint_is_not_cut_in_silence(tmp_path: Path) -> None:
    sliding = ARM.replace('name="joint_4" type="revolute"', 'name="joint_4" type="prismatic"')
    bare = sliding.replace("tool0", "hand")
    with pytest.raises(InputError, match=r"joint_4 slides, and 2 joints turn behind it.*link_3"):
        read(tmp_path / "arm.urdf", bare)
    # asked for, the part before it is an arm
    assert import_robot(tmp_path / "arm.urdf", tip="link_3").robot.n == 3


@pytest.mark.parametrize(
    "compiler",
    ['inertiafromgeom="true"', 'settotalmass="50"', 'boundmass="4"', 'boundinertia=".2"'],
)
def test_a_compiler_that_makes_other_masses(tmp_path: Path, compiler: str) -> None:
    key = compiler.split("=")[0]
    with pytest.raises(InputError, match=f"{key}.*other mass data.*mj_saveLastXML"):
        read(tmp_path / "arm.xml", mjcf(compiler))
    assert read(tmp_path / "arm.xml", mjcf('inertiafromgeom="auto" boundmass="0"')).robot.n == 6


def test_a_spring_across_a_joint_is_an_effect(tmp_path: Path) -> None:
    """MuJoCo's own torque at rest, spring and the angle of its rest in degrees included."""
    mujoco = pytest.importorskip("mujoco")
    text = mjcf(joint_2='stiffness="40" springref="20"')
    robot = read(tmp_path / "arm.xml", text).robot
    engine = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(engine)
    model = irb.Model(robot)
    for q in np.random.default_rng(3).uniform(-1.0, 1.0, (5, 6)):
        data.qpos[:] = q
        mujoco.mj_inverse(engine, data)
        np.testing.assert_allclose(model.gravity(q), data.qfrc_inverse, rtol=0, atol=1e-9)


def test_a_body_without_weight_is_said(tmp_path: Path) -> None:
    notes = read(tmp_path / "arm.xml", mjcf(body_2='gravcomp="1"')).notes
    assert any("link l2: its weight acts on the motors here (gravcomp)" in note for note in notes)
