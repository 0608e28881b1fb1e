"""MJCF in: what MuJoCo computes from a file, the imported robot computes too."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
from robots.imported import robot

import irb2400_ctrl as irb
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot.importing import import_robot
from irb2400_ctrl.robot.importing.mjcf_parts import Drive, drives
from irb2400_ctrl.robot.mjcf_export import to_mjcf

OWN = """<mujoco model="own">
  <compiler angle="degree" inertiafromgeom="false"/>
  <option gravity="0.5 0 -9.7"/>
  <default><joint damping="0.5" range="-170 170"/>
    <default class="wrist"><joint armature="0.03" frictionloss="0.2" damping="0.1"/></default>
  </default>
  <worldbody><body name="foot" pos="0 0 0.3" euler="10 20 30">
    <inertial pos="0 0 0.1" mass="9" diaginertia="1 1 1"/>
    <body name="shoulder" pos="0 0.1 0.2" quat="0.9 0.1 -0.2 0.3">
      <joint name="j1" axis="0 1 0" pos="0.02 0 0.01" range="-90 100"/>
      <inertial pos="0.1 0 0.05" quat="0.7 0.1 0.7 0" mass="4" diaginertia="0.1 0.08 0.05"/>
      <body name="arm" pos="0.4 0 0" childclass="wrist">
        <joint name="j2" axis="0 0 1"/><joint name="j3" axis="1 1 0" pos="0.1 0 0"/>
        <inertial pos="0.1 0.02 0" mass="2" fullinertia="0.03 0.04 0.05 0.001 0.002 0.003"/>
        <body name="plate" pos="0 0 0.2" euler="0 45 0">
          <inertial pos="0.05 0 0" mass="0.5" diaginertia="0.002 0.003 0.004"/>
          <site name="tcp" pos="0 0 0.1" euler="0 0 90"/>
        </body></body></body></body></worldbody>
  <actuator><motor joint="j1" gear="50" ctrlrange="-2 2"/></actuator>
</mujoco>"""


def test_a_file_with_defaults_offsets_and_two_hinges_in_a_body(tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    path = tmp_path / "own.xml"
    path.write_text(OWN)
    own = import_robot(path).robot
    assert [joint.name for joint in own.joints] == ["j1", "j2", "j3"]
    assert own.tau_bound[0] == 100.0
    np.testing.assert_allclose(np.degrees([own.q_min[0], own.q_max[0]]), [-90, 100])
    np.testing.assert_allclose(own.friction[:, 1:3], [[0, 0.5], [0.2, 0.1], [0.2, 0.1]])
    engine = mujoco.MjModel.from_xml_path(str(path))
    engine.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    data = mujoco.MjData(engine)
    model = irb.Model(own)
    rng = np.random.default_rng(0)
    for _ in range(10):
        q, qd, qdd = rng.normal(0.0, 1.0, (3, 3))
        data.qpos[:] = q
        data.qvel[:] = qd
        data.qacc[:] = qdd
        mujoco.mj_inverse(engine, data)
        tau = model.inverse_dynamics(q, qd, qdd, friction=False) + own.friction[:, 2] * qd
        np.testing.assert_allclose(tau, data.qfrc_inverse, rtol=0, atol=1e-9)
        mujoco.mj_forward(engine, data)
        tcp = data.site("tcp")
        X = model.tcp_pose(q)
        np.testing.assert_allclose(X[:3, 3], tcp.xpos, atol=1e-12)
        np.testing.assert_allclose(X[:3, :3], tcp.xmat.reshape(3, 3), atol=1e-12)


@pytest.mark.parametrize(
    ("compiler", "turned"),
    [
        ('angle="degree" eulerseq="zyx"', 'euler="10 20 30"'),
        ('angle="degree" eulerseq="XYZ"', 'euler="10 20 30"'),
        ('angle="radian" eulerseq="ZXZ"', 'euler="0.3 -1.2 2"'),
        ('angle="degree"', 'axisangle="1 2 -1 50"'),
        ('angle="radian"', 'axisangle="0 0 3 -0.7"'),
        ("", 'xyaxes="1 0.2 0 -0.3 1 0.4"'),
        ("", 'zaxis="0.2 -0.3 0.5"'),
        ("", 'zaxis="0 0 -2"'),
        ("", 'euler="90 0 45"'),
    ],
)
def test_orientations_are_those_of_mujoco(compiler: str, turned: str, tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    text = (
        f"<mujoco><compiler {compiler}/><worldbody><body {turned}><joint/>"
        '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
        f'<site name="tcp" {turned}/></body></worldbody></mujoco>'
    )
    path = tmp_path / "arm.xml"
    path.write_text(text)
    engine = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(engine)
    mujoco.mj_forward(engine, data)
    X = irb.Model(import_robot(path).robot).tcp_pose(np.zeros(1))
    np.testing.assert_allclose(X[:3, :3], data.site("tcp").xmat.reshape(3, 3), atol=1e-12)


def test_an_exported_arm_comes_back(tmp_path: Path) -> None:
    arm = robot("kr16")
    path = tmp_path / "kr16.xml"
    path.write_text(to_mjcf(arm))
    back = import_robot(path).robot
    q, qd, qdd = np.random.default_rng(1).uniform(-1, 1, (3, 20, 6))
    np.testing.assert_allclose(
        irb.Model(back).inverse_dynamics(q, qd, qdd),
        irb.Model(arm).inverse_dynamics(q, qd, qdd),
        atol=1e-9,
    )
    np.testing.assert_allclose(irb.Model(back).tcp_pose(q), irb.Model(arm).tcp_pose(q), atol=1e-12)
    np.testing.assert_allclose(back.tau_max, arm.tau_max)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("<worldbody>", "<include file='x.xml'/><worldbody>", "which is not beside it"),
        ('childclass="wrist"', 'childclass="hand"', "of class 'hand', which the file does not"),
        ('<body name="foot"', '<replicate><body/></replicate><body name="foot"', "<replicate> in"),
        ('<joint name="j1"', '<attach/><joint name="j1"', "<attach> in shoulder is not read"),
        (
            '<inertial pos="0.1 0.02 0" mass="2" fullinertia="0.03 0.04 0.05 0.001 0.002 0.003"/>',
            '<geom size="-0.1"/>',
            "made from shapes, and MuJoCo does not take the file: .*size 0 must be positive",
        ),
        ('name="j2"', 'name="j2" type="ball"', "ball"),
        ('mass="4"', 'mass="four"', "finite numbers"),
        ("mujoco", "robots", "expected <robot>"),
        ('angle="degree"', 'angle="degree" eulerseq="xYz"', "eulerseq 'xYz', expected three of"),
        ('euler="10 20 30"', 'zaxis="0 0 0"', "foot: found an axis of"),
        ('euler="10 20 30"', 'axisangle="0 0 1"', "expected 4 finite numbers"),
    ],
)
def test_what_cannot_be_read_is_said(old: str, new: str, says: str, tmp_path: Path) -> None:
    path = tmp_path / "own.xml"
    path.write_text(OWN.replace(old, new))
    with pytest.raises(InputError, match=says):
        import_robot(path)


SCENE = """<mujoco model="scene">
  <include file="parts/arm.xml"/>
  <worldbody>
    <light pos="0 0 1"/><geom name="floor" type="plane" size="0 0 0.05"/>
    <body name="table" pos="1 0 0"><geom type="box" size="0.3 0.3 0.2"/></body>
    <body name="cube" pos="1 0 0.5"><freejoint/><geom type="box" size="0.02 0.02 0.02"/></body>
  </worldbody>
</mujoco>"""

ARM = """<mujoco model="arm">
  <compiler angle="radian" autolimits="true"/>
  <default>
    <default class="arm">
      <joint damping="0.2" axis="0 0 1" range="-2.5 2.5"/>
      <general gaintype="fixed" biastype="affine" gainprm="2000" forcerange="-80 80"/>
      <default class="wrist"><position forcerange="-12 12"/></default>
    </default>
  </default>
  <worldbody>
    <body name="base" childclass="arm" pos="0 0 0.1">
      <geom type="cylinder" size="0.1 0.05"/>
      <body name="upper" pos="0 0 0.2" quat="0.707107 0.707107 0 0">
        <inertial pos="0.1 0 0" mass="3" diaginertia="0.03 0.04 0.05"/>
        <joint name="shoulder" ref="0.4" pos="0.01 0.02 0"/>
        <geom type="capsule" size="0.05 0.2"/>
        <body name="fore" pos="0.4 0 0">
          <inertial pos="0.15 0.01 0" mass="1.5" diaginertia="0.01 0.02 0.02"/>
          <joint name="elbow" axis="0 1 0" ref="-0.3"/>
          <body name="moving_jaw" pos="0.3 0 0">
            <inertial pos="0.02 0 0" mass="0.1" diaginertia="1e-5 2e-5 2e-5"/>
            <joint name="jaw" range="0 1"/>
          </body></body></body></body>
  </worldbody>
  <actuator>
    <general class="arm" joint="shoulder"/>
    <position class="wrist" joint="elbow" kp="10"/>
  </actuator>
</mujoco>"""


def test_a_scene_with_an_arm_a_table_and_a_cube_is_the_arm(tmp_path: Path) -> None:
    """Included file, base without mass, joints drawn at `ref`, limits of actuators by class."""
    mujoco = pytest.importorskip("mujoco")
    path = tmp_path / "scene.xml"
    path.write_text(SCENE)
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "arm.xml").write_text(ARM)
    found = import_robot(path)
    own = found.robot
    assert [joint.name for joint in own.joints] == ["shoulder", "elbow"]
    np.testing.assert_allclose(own.tau_bound, [80.0, 12.0])
    notes = "\n".join(found.notes)
    assert "body cube flies freely: it is left out" in notes
    assert "joint jaw (revolute) on fore_frame is not on the chain" in notes
    assert "--tool-link moving_jaw" in notes
    whole = import_robot(path, tip="moving_jaw").robot
    engine = mujoco.MjModel.from_xml_string(ARM)
    engine.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    engine.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_ACTUATION)
    data = mujoco.MjData(engine)
    model = irb.Model(whole)
    for q, qd, qdd in np.random.default_rng(3).normal(0.0, 1.0, (8, 3, 3)):
        data.qpos[:] = q
        data.qvel[:] = qd
        data.qacc[:] = qdd
        mujoco.mj_inverse(engine, data)
        tau = model.inverse_dynamics(q, qd, qdd, friction=False) + whole.friction[:, 2] * qd
        np.testing.assert_allclose(tau, data.qfrc_inverse, rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    ("given", "limit"),
    [
        ('forcerange="-12 12"', 12.0),
        ('forcerange="-12 20" gear="2 0 0"', 24.0),
        ('forcerange="-inf inf"', None),
        ('forcerange="-12 1 2"', "actuator of elbow: found '-12 1 2', expected 2 finite numbers"),
        ('forcerange="-12 12" gear="a"', "actuator of elbow: found 'a', expected 1 finite numbers"),
    ],
)
def test_limits_of_actuators_are_two_numbers(given: str, limit: float | str | None) -> None:
    """A line break within a number made three of them, and a traceback."""
    root = ET.fromstring(f'<m><actuator><motor joint="elbow" {given}/></actuator></m>')
    if isinstance(limit, str):
        with pytest.raises(InputError, match=limit):
            drives(root, {})
        return
    assert drives(root, {}).get("elbow", Drive()).limit == limit
