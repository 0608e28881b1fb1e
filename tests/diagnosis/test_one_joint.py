"""An arm of a single joint, a pendulum whose torque is written down by hand."""

from __future__ import annotations

import numpy as np
import pytest

from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.excitation.room import with_room
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.robot.importing import import_robot

MASS = 5.0
LEVER = 0.2
INERTIA = 0.1
COULOMB = 1.0
VISCOUS = 0.5
URDF = f"""<robot name="pendulum">
<link name="base"/>
<link name="arm"><inertial><origin xyz="{LEVER} 0 0"/><mass value="{MASS}"/>
<inertia ixx="0.01" iyy="{INERTIA}" izz="{INERTIA}" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0 0 1"/>
<axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="60" velocity="4"/>
<dynamics friction="{COULOMB}" damping="{VISCOUS}"/></joint>
</robot>"""


@pytest.fixture(scope="module")
def pendulum(tmp_path_factory: pytest.TempPathFactory) -> Robot:
    """Its tool centre point lies on the axis, so no force there shows."""
    path = tmp_path_factory.mktemp("one") / "pendulum.urdf"
    path.write_text(URDF)
    return import_robot(path).robot


def recorded(coulomb: float = COULOMB, offset: float = 0.0) -> Log:
    """tau = J qdd - m g l cos q + F_c sign qd + F_v qd + offset; q turns the arm downwards."""
    time = np.arange(0.0, 20.0, 0.004)
    q = np.zeros_like(time)
    qd = np.zeros_like(time)
    qdd = np.zeros_like(time)
    for a, w, phase in ((0.5, 1.3, 0.2), (0.25, 2.9, 1.0), (0.15, 4.1, 3.0)):
        q += a * np.sin(w * time + phase)
        qd += a * w * np.cos(w * time + phase)
        qdd -= a * w**2 * np.sin(w * time + phase)
    tau = (INERTIA + MASS * LEVER**2) * qdd - MASS * 9.81 * LEVER * np.cos(q)
    tau += coulomb * np.sign(qd) + VISCOUS * qd + offset
    tau += np.random.default_rng(4).normal(0.0, 0.1, len(time))
    return Log(time, q[:, None], tau[:, None], q_ref=q[:, None], name="pendulum")


def test_a_sound_pendulum_lacks_nothing(pendulum: Robot) -> None:
    found = diagnose(pendulum, recorded())
    assert (found.verdict, found.findings) == ("nothing_missing", ())
    assert found.identification.error_before.rmse[0] < 0.12


def test_what_it_lacks_is_named_with_its_size(pendulum: Robot) -> None:
    found = diagnose(pendulum, recorded(coulomb=2 * COULOMB, offset=2.0))
    (finding,) = found.findings
    assert (finding.effect.kind, finding.effect.joint) == ("torque_offset", 1)
    assert finding.effect.coefficients()[0] == pytest.approx(2.0, rel=0.05)
    assert found.robot.friction[0, 1] == pytest.approx(2 * COULOMB, rel=0.05)


def test_a_motion_to_identify_it_by_is_designed(pendulum: Robot) -> None:
    """Neither floor nor column is in the way of a tool on the axis of its only joint."""
    assert with_room(pendulum) == pendulum
