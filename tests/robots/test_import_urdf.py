"""URDF in: the imported arm is the one that Pinocchio reads; what is unknown stays unknown."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from robots.public_arms import arms, urdf

import irb2400_ctrl as irb
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot.importing import Imported, Payload, import_robot

Array = npt.NDArray[np.float64]
ARMS = arms()
FINGERS = """
<link name="finger"><inertial><mass value="0.2"/><origin xyz="0 0 0.1"/>
<inertia ixx="1e-4" ixy="0" ixz="0" iyy="1e-4" iyz="0" izz="1e-4"/></inertial></link>
<joint name="finger_slide" type="prismatic"><parent link="tool0"/><child link="finger"/>
<axis xyz="0 1 0"/><limit lower="0" upper="0.04" velocity="1" effort="20"/></joint>
<link name="camera"><inertial><mass value="0.5"/><origin xyz="0.05 0.02 0.1" rpy="0.1 0.2 0.3"/>
<inertia ixx="2e-3" ixy="1e-4" ixz="0" iyy="3e-3" iyz="2e-4" izz="2.5e-3"/></inertial></link>
<joint name="camera_mount" type="fixed"><parent link="link_4"/><child link="camera"/>
<origin xyz="0.01 0.02 0.03" rpy="0.4 -0.5 0.6"/></joint>
"""


def imported(tmp_path: Path, text: str, **options: Any) -> Imported:
    path = tmp_path / "arm.urdf"
    path.write_text(text)
    return import_robot(path, **options)


def one_joint(tmp_path: Path, changes: dict[str, str]) -> Imported:
    text = urdf(ARMS["irb1200"])
    for old, new in changes.items():
        assert old in text
        text = text.replace(old, new, 1)
    return imported(tmp_path, text)


@pytest.mark.parametrize("name", ARMS)
def test_dynamics_and_kinematics_are_those_of_pinocchio(name: str, tmp_path: Path) -> None:
    pin = pytest.importorskip("pinocchio")
    text = urdf(ARMS[name])
    robot = imported(tmp_path, text).robot
    model = irb.Model(robot)
    engine = pin.buildModelFromXML(text)
    data = engine.createData()
    rng = np.random.default_rng(1)
    frame = engine.getFrameId("tool0")
    for _ in range(25):
        q = rng.uniform(robot.q_min, robot.q_max)
        qd, qdd = rng.normal(0.0, 2.0, (2, robot.n))
        pairs = [
            (
                model.inverse_dynamics(q, qd, qdd, friction=False),
                pin.rnea(engine, data, q, qd, qdd),
            ),
            (model.gravity(q), pin.computeGeneralizedGravity(engine, data, q)),
        ]
        upper = np.triu(pin.crba(engine, data, q))
        pairs.append((model.mass_matrix(q), upper + np.triu(upper, 1).T))
        for found, expected in pairs:
            scale = max(float(np.abs(expected).max()), 1.0)
            np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * scale)
        pin.framesForwardKinematics(engine, data, q)
        np.testing.assert_allclose(
            model.tcp_pose(q), data.oMf[frame].homogeneous, rtol=0, atol=1e-12
        )
        J = pin.computeFrameJacobian(engine, data, q, frame, pin.LOCAL_WORLD_ALIGNED)
        np.testing.assert_allclose(model.tcp_jacobian(q), J, rtol=0, atol=1e-12)


def test_fixed_links_are_folded_in_and_fingers_left_out(tmp_path: Path) -> None:
    pin = pytest.importorskip("pinocchio")
    text = urdf(ARMS["irb1200"]).replace("</robot>", FINGERS + "</robot>")
    found = imported(tmp_path, text)
    engine = pin.buildModelFromXML(text)
    # the finger is there for Pinocchio; without its weight the rest must be equal
    engine.inertias[7] = pin.Inertia.Zero()
    q = np.array([0.3, -0.4, 0.5, 0.6, -0.7, 0.8])
    qd = np.array([1.0, -2.0, 1.5, 0.5, -1.0, 2.0])
    full = (np.append(value, 0.0) for value in (q, qd, 3.0 * qd))
    expected = pin.rnea(engine, engine.createData(), *full)[:6]
    tau = irb.Model(found.robot).inverse_dynamics(q, qd, 3.0 * qd, friction=False)
    np.testing.assert_allclose(tau, expected, rtol=0, atol=1e-11)
    assert any("finger_slide" in note and "0.2 kg" in note for note in found.notes)


def test_limits_and_friction_are_carried(tmp_path: Path) -> None:
    damped = '<dynamics damping="1.5" friction="0.25"/><axis xyz="1.0 0.0 0.0"/>'
    robot = one_joint(tmp_path, {'<axis xyz="1.0 0.0 0.0"/>': damped}).robot
    axes = ARMS["irb1200"].axes
    np.testing.assert_allclose(robot.q_min, [a.range[0] for a in axes], rtol=1e-15)
    np.testing.assert_allclose(robot.qd_max, [a.speed for a in axes], rtol=1e-15)
    np.testing.assert_array_equal(robot.tau_max, [a.effort for a in axes])
    assert robot.friction_known.tolist() == [
        [False, k == 3, k == 3, False] for k in range(6)
    ]  # only axis 4 states something
    np.testing.assert_array_equal(robot.friction[3, :3], [0.25, 0.25, 1.5])


@pytest.mark.parametrize("effort", ["0", "1e30", "-1"])
def test_an_absurd_torque_limit_is_unknown(effort: str, tmp_path: Path) -> None:
    found = one_joint(tmp_path, {'effort="110.0"': f'effort="{effort}"'})
    assert any("joint_3: torque limit" in note for note in found.notes)
    assert np.isinf(found.robot.tau_bound[2])
    with pytest.raises(InputError, match=r"torque limit of joint_3 is unknown.*torque_Nm"):
        _ = found.robot.tau_max
    assert any("torque limit of joint_3" in line for line in found.robot.assumptions())


def test_a_range_in_degrees_is_noticed(tmp_path: Path) -> None:
    text = urdf(ARMS["irb1200"])
    low = float(np.radians(-100.0))
    notes = imported(tmp_path, text.replace(f'lower="{low!r}"', 'lower="-100"')).notes
    assert any("looks like degrees" in note for note in notes)


def test_a_continuous_joint_keeps_a_turn_either_way(tmp_path: Path) -> None:
    found = one_joint(
        tmp_path, {'name="joint_6" type="revolute"': 'name="joint_6" type="continuous"'}
    )
    np.testing.assert_allclose(found.robot.q_max[5], 2 * np.pi)
    assert "assumption" in found.robot.joints[5].limits.range_source


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('name="joint_3" type="revolute"', 'name="joint_3" type="prismatic"', "prismatic"),
        ('<axis xyz="1.0 0.0 0.0"/>', '<axis xyz="0 0 0"/>', r"joint joint_\d: found an axis of"),
        ('<axis xyz="1.0 0.0 0.0"/>', '<mimic joint="joint_1"/>', "mimic"),
        ('<axis xyz="1.0 0.0 0.0"/>', '<axis xyz="1 0"/>', "expected 3 finite numbers"),
        ('<parent link="link_2"/>', '<parent link="link_9"/>', "link_9"),
        ('xyz="0.0 0.0 0.399"', 'xyz="${xacro_height} 0 0"', "xacro"),
        ("</robot>", "", "not XML"),
    ],
)
def test_what_cannot_be_read_is_said(old: str, new: str, says: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=says):
        one_joint(tmp_path, {old: new})


def test_base_and_tool_can_be_chosen(tmp_path: Path) -> None:
    text = urdf(ARMS["panda"])
    robot = imported(tmp_path, text, base="link_1", tip="link_6").robot
    assert [joint.name for joint in robot.joints] == [f"joint_{i}" for i in range(2, 7)]
    with pytest.raises(InputError, match="no link 'hand'"):
        imported(tmp_path, text, tip="hand")


def test_gravity_is_that_of_the_link_that_the_chain_begins_with(tmp_path: Path) -> None:
    """An arm below a ceiling: without its stand it would be one on a floor, all torques wrong."""
    text = urdf(ARMS["irb1200"]).replace(
        '<link name="base_link"/>',
        '<link name="base_link"/><link name="ceiling"/><joint name="stand" type="fixed">'
        '<parent link="ceiling"/><child link="base_link"/>'
        '<origin xyz="0 0 3" rpy="3.14159265 0.3 0.5"/></joint>',
    )
    whole = imported(tmp_path, text)
    alone = imported(tmp_path, text, base="base_link")
    q = np.random.default_rng(3).uniform(-1.0, 1.0, (4, 6))
    np.testing.assert_allclose(
        irb.Model(alone.robot).gravity(q), irb.Model(whole.robot).gravity(q), atol=1e-8
    )
    assert any("base_link is mounted turned" in note for note in alone.notes)
    assert not any("mounted" in note for note in whole.notes)


def test_a_parallelogram_and_a_payload_are_stated(tmp_path: Path) -> None:
    text = urdf(ARMS["irb4600"])
    serial = imported(tmp_path, text).robot
    coupled = imported(tmp_path, text, coupling=((3, 2, -1.0),), payload=Payload(10.0)).robot
    q = np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
    theta = q - np.array([0, 0, 0.2, 0, 0, 0])
    np.testing.assert_allclose(
        irb.Model(coupled).flange_pose(q), irb.Model(serial).flange_pose(theta), atol=1e-14
    )
    assert coupled.inertial_parameters[-1, 0] == pytest.approx(11.5)
    with pytest.raises(InputError, match="expected two of the joints"):
        imported(tmp_path, text, coupling=((7, 2, -1.0),))


@pytest.mark.parametrize(("axis", "multiplier"), [("0 1 0", -1.0), ("0 -1 0", 1.0)])
def test_a_parallelogram_written_as_a_follower_is_one(
    axis: str, multiplier: float, tmp_path: Path
) -> None:
    text = urdf(ARMS["irb4600"])
    coupled = imported(tmp_path, text, coupling=((3, 2, -1.0),)).robot
    start = text.index('<joint name="joint_3"')
    origin = re.search(r"<origin [^>]*/>", text[start:])
    assert origin is not None
    level = (
        f'<link name="level"/><joint name="level_joint" type="revolute"><parent link="link_2"/>'
        f'<child link="level"/>{origin[0]}<axis xyz="{axis}"/>'
        f'<mimic joint="joint_2" multiplier="{multiplier}" offset="0.2"/></joint>'
    )
    beyond = text[start:].replace('<parent link="link_2"/>', '<parent link="level"/>', 1)
    beyond = beyond.replace(origin[0], '<origin xyz="0 0 0"/>', 1)
    found = imported(tmp_path, text[:start] + level + beyond)
    robot = found.robot
    assert robot.joint_names == coupled.joint_names
    np.testing.assert_array_equal(robot.A, coupled.A)
    assert any(
        "level_joint follows joint_2 (mimic) on the axis of joint_3" in n for n in found.notes
    )
    # an offset of the follower turns the arm beyond it
    q, qd, qdd = np.random.default_rng(7).normal(0.0, 0.7, (3, 6))
    shifted = q + multiplier / -abs(multiplier) * np.array([0, 0, 0.2, 0, 0, 0])
    mine = irb.Model(robot)
    other = irb.Model(coupled)
    np.testing.assert_allclose(mine.flange_pose(q), other.flange_pose(shifted), atol=1e-14)
    np.testing.assert_allclose(
        mine.inverse_dynamics(q, qd, qdd), other.inverse_dynamics(shifted, qd, qdd), atol=1e-9
    )
    heavy = level.replace(
        '<link name="level"/>',
        '<link name="level"><inertial><mass value="2"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" '
        'iyz="0" izz="1"/></inertial></link>',
    )
    notes = imported(tmp_path, text[:start] + heavy + beyond).notes
    assert any("link level (2 kg) between them" in note for note in notes)
    moved = beyond.replace('<origin xyz="0 0 0"/>', '<origin xyz="0 0 0.1"/>', 1)
    with pytest.raises(InputError, match="does not share its axis with the next joint"):
        imported(tmp_path, text[:start] + level + moved)


def test_what_is_unknown_survives_the_file(tmp_path: Path) -> None:
    found = one_joint(tmp_path, {'effort="110.0"': 'effort="0"'}).robot
    path = irb.save_robot(found, tmp_path / "arm.toml")
    assert irb.load_robot(path) == found
    assert "static_Nm" not in path.read_text()
    torque = irb.Model(found).friction(np.ones(6))
    np.testing.assert_array_equal(torque, np.zeros(6))
    assert any("viscous friction of every joint is unknown" in s for s in found.assumptions())


def test_quarter_turns_of_few_digits_are_exact(tmp_path: Path) -> None:
    text = urdf(ARMS["ur5"])
    exact = imported(tmp_path, text)
    rough = text.replace("1.5707963267948966", "1.5708").replace("3.141592653589793", "3.1416")
    assert rough != text
    found = imported(tmp_path, rough)
    for a, b in zip(found.robot.links, exact.robot.links, strict=True):
        np.testing.assert_array_equal(a.frame.matrix(), b.frame.matrix())
    assert irb.Model(found.robot).arm_geometry.family == "parallel axes"
    assert any("few digits" in note for note in found.notes)
    assert not any("few digits" in note for note in exact.notes)
    skew = imported(tmp_path, text.replace("1.5707963267948966", "1.57")).robot
    assert skew.links[1].frame != exact.robot.links[1].frame


def with_transmission(inner: str) -> dict[str, str]:
    of_joint = f'<joint name="joint_2"/><actuator name="m"/>{inner}'
    return {"</robot>": f"<transmission>{of_joint}</transmission></robot>"}


ROTOR = '<drake:rotor_inertia value="2e-4"/>'


@pytest.mark.parametrize(
    ("inner", "ratio", "rotor"),
    [
        ("<mechanicalReduction>1</mechanicalReduction>", None, None),
        ("<mechanicalReduction>-101.5</mechanicalReduction>", -101.5, None),
        ("<joint name='joint_2'><mechanical_reduction>80</mechanical_reduction></joint>", 80, None),
        ("<mechanicalReduction>high</mechanicalReduction>", None, None),
        ("<joint name='joint_3'/><mechanicalReduction>9</mechanicalReduction>", None, None),
        (ROTOR, None, 2e-4),
        (f'<actuator>{ROTOR}<drake:gear_ratio value="100"/></actuator>', 100, 2.0),
    ],
)
def test_gears_and_rotors_of_transmissions(
    tmp_path: Path, inner: str, ratio: float | None, rotor: float | None
) -> None:
    """A rotor counts as in Drake: times the square of its gear on the joint's side."""
    robot = one_joint(tmp_path, with_transmission(inner)).robot
    between = robot.joints[1].transmission
    assert (between and between.gear_ratio) == ratio
    plain = imported(tmp_path, urdf(ARMS["irb1200"])).robot
    q = np.linspace(0.1, 0.6, 6)
    more = irb.Model(robot).mass_matrix(q) - irb.Model(plain).mass_matrix(q)
    np.testing.assert_allclose(more, np.diag([0, rotor or 0, 0, 0, 0, 0]), atol=1e-12)


@pytest.mark.parametrize(
    ("limit", "range_deg", "acceleration_deg_s2", "says"),
    [
        ('lower="-1" upper="2"', (-57.29578, 114.59156), None, ""),
        ('lower="-1"', (-57.29578, 0), None, ""),
        ('lower="-inf" upper="inf"', (-360, 360), None, "no range in the file"),
        ('lower="-1" upper="Infinity"', (-360, 360), None, "no range in the file"),
        ('lower="-1e16" upper="1e16"', (-360, 360), None, "is none (nothing turns so far)"),
        ('lower="-1" upper="1" drake:acceleration="10"', None, 572.95780, ""),
        ('lower="-1" upper="1" acceleration="10"', None, 572.95780, ""),
        ('lower="-1" upper="1" acceleration="inf"', None, None, ""),
        ('lower="-1" upper="1" acceleration="0"', None, None, "limit is 0 rad/s2 in the file, t"),
        ('lower="-1" upper="1" effort="1e-6"', None, None, "limit is 1e-06 Nm in the file, t"),
        ('lower="-1" upper="1" velocity="1e-5"', None, None, "is 1e-05 rad/s in the file, t"),
        ('lower="-1" upper="1"/><safety_controller soft_lower_limit="-.9" k_velocity="2"', None,
         None, "soft limits within its range are not read"),
        ('lower="-1" upper="1"/><safety_controller soft_lower_limit="-1" soft_upper_limit="1" '
         'k_velocity="2"', None, None, ""),
    ],
)  # fmt: skip
def test_limits_that_a_joint_may_have(
    tmp_path: Path,
    limit: str,
    range_deg: tuple[float, float] | None,
    acceleration_deg_s2: float | None,
    says: str,
) -> None:
    text = urdf(ARMS["irb1200"])
    others = "" if "1e-" in limit else ' effort="90" velocity="2"'
    if "1e-" in limit:
        others = ' velocity="2"' if "effort" in limit else ' effort="90"'
    new = f"<limit{others} {limit}/>"
    found = imported(tmp_path, re.sub(r"<limit [^>]*/>", new, text, count=1))
    limits = found.robot.joints[0].limits
    np.testing.assert_allclose(limits.range_deg, range_deg or (-57.29578, 57.29578), rtol=1e-6)
    assert limits.acceleration_deg_s2 == pytest.approx(acceleration_deg_s2)
    said = [note for note in found.notes if note.startswith("joint joint_1:")]
    assert len(said) == bool(says)
    assert says in "".join(said)


def test_a_frame_turned_by_a_quaternion(tmp_path: Path) -> None:
    """As URDF 1.1 has it, of few digits."""
    old = 'rpy="1.5707963267948966 0.0 0.0"'
    text = urdf(ARMS["ur5"])
    assert old in text
    turned = imported(tmp_path, text.replace(old, 'quat_xyzw="0.7071 0 0 0.7071"')).robot
    for a, b in zip(turned.links, imported(tmp_path, text).robot.links, strict=True):
        np.testing.assert_array_equal(a.frame.matrix(), b.frame.matrix())
    with pytest.raises(InputError, match="found '0 0 1', expected 4 finite numbers"):
        imported(tmp_path, text.replace(old, 'quat_xyzw="0 0 1"'))
