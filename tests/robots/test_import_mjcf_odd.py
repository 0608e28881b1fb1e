"""MJCF in: frames, names that two things share, several options, actuators with rotors."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot.importing import import_robot
from irb2400_ctrl.robot.importing.mjcf_orientation import turn

BODY = '<inertial pos=".1 .02 .05" mass="3" diaginertia=".04 .05 .06"/>'
ARM = f"""<mujoco><compiler angle="degree" eulerseq="XYZ"/>
  <default><joint armature="0.01"/>
    <default class="wrist"><joint damping="2" axis="1 0 0"/></default></default>
  <worldbody><body name="b1" pos="0 0 .3"><joint name="j1" axis="0 1 0"/>{BODY}
    <body name="b2" pos=".4 0 .1"><joint name="j2" axis="0 1 .3"/>{BODY}
      <body name="b3" pos=".3 0 0"><joint name="j3" class="wrist"/>{BODY}
        <site name="tcp" pos=".1 0 .2"/></body></body></body></worldbody>
</mujoco>"""
JOINT = '<joint name="j2" axis="0 1 .3"/>'
SHAPE = '<geom type="box" size=".1 .05 .04" pos=".1 0 .1" mass="2" euler="10 0 0"/>'
ROD = '<geom type="capsule" size=".03" fromto="0 0 0 .2 .1 .1"/>'
FRAME = '<frame pos=".1 .2 .05" euler="30 10 -20">'
MOTOR = '<actuator><motor joint="j1" gear="3" armature="0.5" damping="0.4"/></actuator></mujoco>'
SECOND = '<motor joint="j1" gear="-2" armature="0.1" damping="0.3"/>'
MOTORS = MOTOR.replace("</actuator>", f"{SECOND}</actuator>")


def worst(path: Path) -> float:
    """Largest difference from MuJoCo, of torques [Nm] and of the tool's pose."""
    mujoco = pytest.importorskip("mujoco")
    arm = import_robot(path, outline=False).robot
    model = irb.Model(arm)
    engine = mujoco.MjModel.from_xml_path(str(path))
    engine.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    data = mujoco.MjData(engine)
    rng = np.random.default_rng(0)
    off = [0.0]
    for _ in range(5):
        data.qpos[:], data.qvel[:], data.qacc[:] = rng.normal(0.0, 1.0, (3, 3))
        mujoco.mj_inverse(engine, data)
        tau = model.inverse_dynamics(data.qpos, data.qvel, data.qacc)
        tcp = data.site("tcp")
        X = model.tcp_pose(data.qpos)
        off += [
            np.abs(tau - data.qfrc_inverse).max(),
            np.abs(X[:3, 3] - tcp.xpos).max(),
            np.abs(X[:3, :3] - tcp.xmat.reshape(3, 3)).max(),
        ]
    return float(max(off))


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("</mujoco>", "</mujoco>"),
        # nearly parallel to axis 1, as 1.5708 or a calibration leaves it
        (JOINT, JOINT.replace("0 1 .3", "1e-5 1 0")),
        # a frame puts what stands in it elsewhere
        (JOINT, f"{FRAME}{JOINT}</frame>"),
        ('<joint name="j3" class="wrist"/>', f'{FRAME[:-1]} childclass="wrist">{FRAME}'
         '<joint name="j3"/></frame></frame>'),
        ('<site name="tcp" pos=".1 0 .2"/>', f'{FRAME}<site name="tcp" pos="1 0 0"/></frame>'),
        (f"{JOINT}{BODY}", f"{JOINT}{FRAME}{SHAPE}</frame>"),
        (f"{JOINT}{BODY}", f"{JOINT}{SHAPE}{FRAME}{ROD}</frame>"),
        (ARM[ARM.index('<body name="b2"') : ARM.index("</body></worldbody>")],
         FRAME + ARM[ARM.index('<body name="b2"') : ARM.index("</body></worldbody>")] + "</frame>"),
        # bodies, sites and joints have names of their own kinds
        (JOINT, f'{JOINT}<site name="b3"/>'),
        (JOINT, f'{JOINT}<site name="b1_frame"/>'),
        ('"b3"', '"b1_frame"'),
        ('"b3"', '"b2_frame"'),
        # a class places a site as it does a geom
        ("<default>", '<default><site euler="0 0 20"/>'),
        # the last statement counts, wherever it stands
        ("<worldbody>", '<option timestep="0.001"/><option gravity="1 0 -5"/><worldbody>'),
        # a rotor that the actuator states, and a second one that turns the same joint
        ("</mujoco>", MOTOR),
        ("</mujoco>", MOTORS),
    ],
)  # fmt: skip
def test_what_mujoco_makes_of_it(tmp_path: Path, old: str, new: str) -> None:
    path = tmp_path / "arm.xml"
    assert ARM.count(old) == 1
    path.write_text(ARM.replace(old, new))
    assert worst(path) < 1e-9


def test_a_body_with_two_hinges_beside_one_of_the_name_it_would_get(tmp_path: Path) -> None:
    path = tmp_path / "arm.xml"
    text = ARM.replace('<joint name="j1" axis="0 1 0"/>', '<joint axis="0 1 0"/><joint name="k"/>')
    path.write_text(text.replace('"b2"', '"b1_1"').replace('"j3"', '"b1_1_joint"'))
    names = [joint.name for joint in import_robot(path).robot.joints]
    assert names[1:] == ["k", "j2", "b1_1_joint"]
    assert len(set(names)) == 4


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        (JOINT, '<joint name="j2" damping="1 2 3"/>', "joint j2: of damping the first number"),
        (JOINT, '<joint name="j2" damping="1 0 0"/>', None),
        (JOINT, '<joint name="j2" stiffness="9 1"/>', "joint j2: of stiffness the first number"),
        (JOINT, '<joint name="j2" springdamper="0.1 1"/>', "joint j2: springdamper is not read"),
        ("<worldbody>", '<option><flag gravity="disable"/></option><worldbody>',
         "a setting of the simulation: the weight of every link acts here"),
        ("<worldbody>", '<option><flag contact="disable"/></option><worldbody>', None),
        ("<worldbody>", '<option gravity="0 0 0"/><worldbody>', "no link has weight here"),
    ],
)  # fmt: skip
def test_what_has_no_place_here_is_said(
    tmp_path: Path, old: str, new: str, says: str | None
) -> None:
    path = tmp_path / "arm.xml"
    path.write_text(ARM)
    plain = import_robot(path).notes
    path.write_text(ARM.replace(old, new))
    found = [note for note in import_robot(path).notes if note not in plain]
    assert len(found) == (says is not None)
    if says is not None:
        assert says in found[0]


def test_gravity_that_the_file_states_is_no_assumption(tmp_path: Path) -> None:
    path = tmp_path / "arm.xml"
    path.write_text(ARM)
    assert "imported" in import_robot(path).robot.gravity_source


SERVO = '<position joint="j1" kp="1e6" forcerange="-80 90"/>'


@pytest.mark.parametrize(
    ("own", "actuators"),
    [
        ("", SERVO),
        ('actuatorfrcrange="-200 200"', SERVO),
        ('actuatorfrcrange="-50 60"', SERVO),
        ('actuatorfrcrange="-50 60" actuatorfrclimited="false"', SERVO),
        ("", '<motor joint="j1" ctrlrange="-30 30" forcerange="-80 80" gear="3"/>'),
        ("", '<motor joint="j1" ctrlrange="-90 90" forcerange="-80 80"/>'),
        ("", '<motor joint="j1" ctrlrange="-30 30" ctrllimited="false" forcerange="-80 80"/>'),
        ("", '<motor jointinparent="j1" ctrlrange="-30 30" gear="2"/>'),
        ("", f'{SERVO}<velocity joint="j1" kv="1e6" forcerange="-20 20"/>'),
    ],
)
def test_the_largest_torque_is_that_of_mujoco(tmp_path: Path, own: str, actuators: str) -> None:
    """The range of the joint, of the actuator, of a motor's control: the narrowest one counts."""
    mujoco = pytest.importorskip("mujoco")
    text = ARM.replace('name="j1"', f'name="j1" {own}')
    path = tmp_path / "arm.xml"
    path.write_text(text.replace("</mujoco>", f"<actuator>{actuators}</actuator></mujoco>"))
    engine = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(engine)
    data.ctrl[:] = -1e6
    mujoco.mj_forward(engine, data)
    limit = import_robot(path).robot.joints[0].limits.torque_Nm
    assert limit == pytest.approx(-data.qfrc_actuator[0])


def test_rotors_of_an_actuator_in_the_parent_count(tmp_path: Path) -> None:
    path = tmp_path / "arm.xml"
    path.write_text(ARM.replace("</mujoco>", MOTOR.replace("joint=", "jointinparent=")))
    assert worst(path) < 1e-9


@pytest.mark.parametrize("free", ["<freejoint/>", '<joint type="free"/>'])
def test_an_arm_on_what_flies_is_held_where_the_file_shows_it(tmp_path: Path, free: str) -> None:
    """A vehicle or a trunk; a cube that flies beside it is none."""
    path = tmp_path / "arm.xml"
    arm = ARM[ARM.index('<body name="b1"') : ARM.index("</worldbody>")]
    base = '<body name="trunk" pos=".5 0 .4" euler="0 10 20">'
    path.write_text(ARM.replace(arm, f"{base}{arm}</body>"))
    assert worst(path) < 1e-9
    q = np.array([0.3, -0.4, 0.5])
    X = irb.Model(import_robot(path).robot).tcp_pose(q)
    cube = '<body name="cube"><freejoint/><geom size=".1"/></body>'
    path.write_text(ARM.replace(arm, f"{base}{free}{BODY}{arm}</body>{cube}"))
    found = import_robot(path)
    np.testing.assert_allclose(irb.Model(found.robot).tcp_pose(q), X, atol=1e-12)
    said = [note for note in found.notes if "flies freely" in note]
    assert [note.split(",")[0].split(":")[0] for note in said] == [
        "body trunk flies freely and carries the arm",
        "body cube flies freely",
    ]
    path.write_text(ARM.replace(arm, cube))
    with pytest.raises(InputError, match="found no body on a base; cube flies freely"):
        import_robot(path)


def test_notes_name_bodies_of_the_file(tmp_path: Path) -> None:
    """A finger hung on "b3_frame", which is nowhere in the file."""
    finger = f'<body name="tip"><joint name="finger" type="slide"/>{BODY}</body>'
    path = tmp_path / "arm.xml"
    path.write_text(ARM.replace('<site name="tcp"', f'{finger}<site name="tcp"'))
    assert any("joint finger (prismatic) on b3 is" in note for note in import_robot(path).notes)


@pytest.mark.parametrize(
    "beside",
    [
        '<body name="door"><joint name="hinge"/><geom size=".1" mass="9"/></body>',
        '<body name="marker" mocap="true"><geom size=".1"/></body>',
    ],
)
def test_what_stands_beside_the_arm_is_none_of_it(tmp_path: Path, beside: str) -> None:
    """The mass data of a door were "a guess, identify them", a marker the space of the base."""
    pytest.importorskip("mujoco")
    path = tmp_path / "arm.xml"
    path.write_text(ARM)
    plain = import_robot(path)
    path.write_text(ARM.replace("<worldbody>", f"<worldbody>{beside}"))
    found = import_robot(path)
    assert found.robot == plain.robot
    more = [note for note in found.notes if note not in plain.notes]
    assert len(more) == 1
    assert "left out" in more[0]


@pytest.mark.parametrize(("given", "said"), [("0.0", False), ("0.5", True)])
def test_no_weight_compensated_is_none(tmp_path: Path, given: str, said: bool) -> None:
    path = tmp_path / "arm.xml"
    path.write_text(ARM.replace('name="b2"', f'name="b2" gravcomp="{given}"'))
    notes = import_robot(path).notes
    assert any("link b2: its weight acts on the motors" in note for note in notes) == said


@pytest.mark.parametrize(
    ("turned", "exact", "said"),
    [
        ('quat="0.707 0.707 0 0"', True, ""),
        ('quat="0.70711 0.707107 0 0"', True, "is read as exact"),
        ('euler="1.5708 0 0"', True, "is read as exact"),
        ('axisangle="1 0 0 1.5708"', True, "is read as exact"),
        ('euler="1.57 0 0"', False, "turned as it stands"),
        ('quat="0.7071 0.7079 0 0"', False, "turned as it stands"),
        ('quat="1 0.0005 0 0"', False, ""),
    ],
)
def test_right_angles_of_few_digits_are_exact_or_said(
    tmp_path: Path, turned: str, exact: bool, said: str
) -> None:
    """An arm that is skew by 4e-6 has no family, and planning took three times as long."""
    path = tmp_path / "arm.xml"
    text = ARM.replace("degree", "radian").replace("0 1 .3", "0 0 1")
    path.write_text(text.replace('name="b2"', f'name="b2" {turned}'))
    found = import_robot(path)
    R = found.robot.links[1].frame.matrix()[:3, :3]
    assert (R.round() == R).all() == exact
    notes = [note for note in found.notes if "link b2: " in note]
    assert [said in note for note in notes] == [True] * bool(said)


def test_quarter_turns_are_exact() -> None:
    """A 6e-17 beside a zero is an arm of no family, and a term in its C code."""
    for quarters in range(-4, 5):
        R = turn(np.array([0.0, 0.0, 2.0]), quarters * np.pi / 2)
        assert (R.round() == R).all()
        assert not np.signbit(R[R == 0.0]).any()
    slant = turn(np.array([1.0, 1.0, 0.0]), np.pi)
    np.testing.assert_array_equal(slant.round(12), [[0, 1, 0], [1, 0, 0], [0, 0, -1]])
