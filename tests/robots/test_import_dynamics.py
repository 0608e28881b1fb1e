"""What a URDF says of a joint's dynamics beside damping and friction is read or said."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from robots.public_arms import arms, urdf

import irb2400_ctrl as irb
from irb2400_ctrl.robot.importing import Imported, import_robot

TEXT = urdf(arms()["irb1200"])
JOINT = '<joint name="joint_2" type="revolute">'
LINK = '<link name="link_3">'
Q = np.linspace(0.1, 0.6, 6)


def with_joint(tmp_path: Path, inner: str, end: str = "") -> Imported:
    path = tmp_path / "arm.urdf"
    path.write_text(TEXT.replace(JOINT, JOINT + inner).replace("</robot>", end + "</robot>"))
    return import_robot(path)


def test_the_armature_of_a_joint_is_a_rotor(tmp_path: Path) -> None:
    """As MuJoCo, Genesis and programs that identify arms write it."""
    plain = irb.Model(with_joint(tmp_path, "").robot)
    found = irb.Model(with_joint(tmp_path, '<dynamics armature="0.592" damping="3"/>').robot)
    more = found.mass_matrix(Q) - plain.mass_matrix(Q)
    np.testing.assert_allclose(more, np.diag([0, 0.592, 0, 0, 0, 0]), atol=1e-12)
    assert found.robot.friction[1, 2] == 3.0


def test_a_spring_of_gazebo_pulls(tmp_path: Path) -> None:
    spring = "<springReference>0.1</springReference><springStiffness>50</springStiffness>"
    end = f'<gazebo reference="joint_2">{spring}</gazebo>'
    plain = irb.Model(with_joint(tmp_path, "").robot)
    found = irb.Model(with_joint(tmp_path, "", end).robot)
    more = found.gravity(Q) - plain.gravity(Q)
    np.testing.assert_allclose(more, [0, 50 * (Q[1] - 0.1), 0, 0, 0, 0], atol=1e-9)


@pytest.mark.parametrize(
    ("inner", "says"),
    [
        ('<dynamics damping="1" friction="2" armature="0"/>', ""),
        ('<calibration rising="0.1"/>', ""),
        ('<dynamics spring_stiffness="0" damping="1"/>', ""),
        ('<dynamics K="7000" mu_viscous="16" D="1" mu_coulomb="0"/>',
         "K, mu_viscous, D of <dynamics>"),
        ('<joint_properties damping="1" friction="2"/>', "<joint_properties>"),
        ('<dynamics damping="1"/><dynamics friction="2"/>', "a second <dynamics>"),
        ('<limit lower="-1" upper="1" effort="300" velocity="2"/>', "a second <limit>"),
    ],
)  # fmt: skip
def test_what_means_nothing_in_a_urdf_is_said(tmp_path: Path, inner: str, says: str) -> None:
    notes = with_joint(tmp_path, inner).notes
    said = [note for note in notes if "not read" in note]
    assert len(said) == bool(says)
    assert f"joint joint_2: not read: {says};" in said[0] if says else True


def test_a_link_of_two_bodies_is_said(tmp_path: Path) -> None:
    body = '<inertial><mass value="9"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
    path = tmp_path / "arm.urdf"
    path.write_text(TEXT.replace(LINK, f"{LINK}{body}</inertial>"))
    found = import_robot(path)
    assert "link link_3: has several <inertial>, expected one: the first counts" in found.notes
    assert found.robot.links[2].body.mass_kg == 9.0
