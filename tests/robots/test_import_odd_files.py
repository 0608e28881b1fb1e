"""Files that look right and are not: refused with the reason, or read as MuJoCo reads them."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from robots.public_arms import arms, urdf

import irb2400_ctrl as irb
from irb2400_ctrl.errors import InputError, ToolMissingError
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
    # asked for, the part before it is an arm, and what is behind it
    assert import_robot(tmp_path / "arm.urdf", tip="link_3").robot.n == 3
    with pytest.raises(InputError, match=r"--base-link link_4, or what stands before it"):
        import_robot(tmp_path / "arm.urdf")
    assert import_robot(tmp_path / "arm.urdf", base="link_4").robot.n == 2
    # the same where the tool's frame has a telling name
    with pytest.raises(InputError, match=r"joint_4 is prismatic.*begin.*--base-link link_4"):
        read(tmp_path / "arm.urdf", sliding)


@pytest.mark.parametrize(
    ("link", "joints"), [("Fixed_Jaw", 6), ("jaw", 5), ("finger_1", 5), ("knee", 6)]
)
def test_which_links_are_those_of_a_gripper(tmp_path: Path, link: str, joints: int) -> None:
    """The jaw that stands still is the gripper's body, turned by the last joint of the arm."""
    assert read(tmp_path / "arm.urdf", ARM.replace("link_6", link)).robot.n == joints
    bare = ARM.replace("tool0", "plate").replace("link_2", link)
    assert read(tmp_path / "arm.urdf", bare).robot.n == (6 if joints == 6 else 1)


def test_fingers_of_a_hand_are_none_of_the_arm(tmp_path: Path) -> None:
    """They have names of their own, which an arm may have elsewhere (`middle_lumbar`)."""
    text = ARM.replace("tool0", "tip")
    for name, joints in (("left_hand_middle_0", 5), ("hand_right_index_abd", 5), ("middle", 6)):
        fingered = text.replace('name="joint_6"', f'name="{name}_joint"')
        assert read(tmp_path / "arm.urdf", fingered).robot.n == joints


def test_a_finger_by_itself_is_an_arm(tmp_path: Path) -> None:
    """The joints of one are left out behind an arm; where nothing else turns they are the arm."""
    text = ARM.replace("tool0", "tip").replace('name="joint_', 'name="finger_joint_')
    assert read(tmp_path / "arm.urdf", text).robot.n == 6


def test_coarse_quarter_turns_are_said(tmp_path: Path) -> None:
    """Read as they stand: an arm calibrated by a milliradian is not put right."""
    text = ARM.replace('rpy="0.0 0.0 0.0"', 'rpy="1.57 0 -3.1415"', 1)
    found = read(tmp_path / "arm.urdf", text)
    assert any("rpy 1.57, -3.1415: read as they stand" in note for note in found.notes)
    exact = read(tmp_path / "arm.urdf", text.replace("1.57 0 -3.1415", "1.5708 0 -3.14159"))
    assert not any("read as they stand" in note for note in exact.notes)
    frames = [arm.robot.links[0].frame.matrix()[:3, :3] for arm in (found, exact)]
    assert 5e-4 < np.abs(frames[0] - frames[1]).max() < 2e-3


@pytest.mark.parametrize(
    "compiler",
    [
        'inertiafromgeom="true"',
        'settotalmass="50"',
        'boundmass="4"',
        'boundinertia=".2"',
        'balanceinertia="true"',
    ],
)
def test_a_compiler_that_makes_other_masses(
    tmp_path: Path, compiler: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    text = mjcf(compiler).replace('diaginertia=".1 .09 .05"', 'diaginertia=".1 .09 .01"')
    if "balance" not in compiler:
        text = mjcf(compiler)
    found = read(tmp_path / "arm.xml", text)
    assert any(f"{compiler.split('=')[0]} = " in note for note in found.notes)
    same_torque(tmp_path / "arm.xml", found.robot)
    plain = read(tmp_path / "arm.xml", mjcf('inertiafromgeom="auto" boundmass="0"'))
    assert plain.robot.links[5].body.mass_kg == 1.0
    assert not any("mass data" in note for note in plain.notes)
    # MuJoCo's own warnings are notes, and no file of its log is left behind
    assert any("deprecated" in note for note in found.notes) == compiler.startswith("settotal")
    assert not list(tmp_path.glob("MUJOCO*"))


SHAPES = """<mujoco model="shapes"><compiler {compiler}/>
  <default><default class="light"><geom density="300"/></default></default>
  <worldbody><body name="foot"><geom type="box" size=".1 .1 .05"/>
    <body name="l1" pos="0 0 .1"><joint name="j1" pos="0 0 .02"/>
      <geom size=".1 .1" type="cylinder"/>
      <body {second} pos=".1 0 .2" euler="0 30 10"><joint name="j2" axis="0 1 0"/>
        <geom type="capsule" fromto="0 0 0 .3 .05 .1" size=".04" class="light"/>
        <body name="bracket" pos=".1 .1 0"><geom type="box" size=".05 .03 .02" mass=".4"/></body>
        <body name="l3" pos=".3 0 0"><joint name="j3" axis="0 1 0"/>
          <inertial pos=".1 0 0" mass="1.5" diaginertia=".01 .02 .02"/><geom size=".05"/>
        </body></body></body></body>
    <body name="cube" pos="1 0 0"><freejoint/><geom size=".1"/></body>
  </worldbody></mujoco>"""


@pytest.mark.parametrize("compiler", ["", 'angle="radian" fusestatic="true"'])
def test_bodies_without_mass_data_have_those_of_their_shapes(tmp_path: Path, compiler: str) -> None:
    """Box, cylinder and capsule, with density and with mass, a body fixed to another."""
    found = read(tmp_path / "arm.xml", SHAPES.format(compiler=compiler, second='name="l2"'))
    assert found.robot.links[2].body.mass_kg == 1.5
    said = [note for note in found.notes if "states no mass data" in note]
    assert len(said) == 1
    assert said[0].startswith("links l1, l2, bracket: ")
    same_torque(tmp_path / "arm.xml", found.robot)


def test_a_body_without_a_name_is_found_by_its_place(tmp_path: Path) -> None:
    found = read(tmp_path / "arm.xml", SHAPES.format(compiler="", second=""))
    same_torque(tmp_path / "arm.xml", found.robot)
    with pytest.raises(InputError, match="give every body a name"):
        read(tmp_path / "arm.xml", SHAPES.format(compiler='fusestatic="true"', second=""))


def test_shapes_without_mujoco_say_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(ToolMissingError, match=r"mass data that the file does not.*\[mjcf\]"):
        read(tmp_path / "arm.xml", SHAPES.format(compiler="", second=""))
    assert read(tmp_path / "arm.xml", mjcf()).robot.n == 6


def test_a_tool_that_is_left_out_needs_no_mass_data(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The mesh of a gripper's jaw, or MuJoCo itself, had to be there for it."""
    jaw = '<body name="jaw"><joint name="jaw"/><geom size=".02" mass=".1"/></body>'
    text = mjcf().replace("</body>", f"{jaw}</body>", 1)
    monkeypatch.setitem(sys.modules, "mujoco", None)
    found = read(tmp_path / "arm.xml", text)
    plain = read(tmp_path / "plain.xml", mjcf()).robot
    assert [link.body for link in found.robot.links] == [link.body for link in plain.links]
    assert any("left out (of unknown weight)" in note for note in found.notes)
    with pytest.raises(ToolMissingError, match="mass data that the file does not"):
        import_robot(tmp_path / "arm.xml", tip="jaw")


def same_torque(path: Path, robot: irb.Robot) -> None:
    """MuJoCo's own, of the same file, what flies freely left out."""
    mujoco = pytest.importorskip("mujoco")
    mujoco.set_mju_user_warning(lambda text: None)
    engine = mujoco.MjModel.from_xml_path(str(path))
    mujoco.set_mju_user_warning(None)
    engine.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    data = mujoco.MjData(engine)
    model = irb.Model(robot)
    n = robot.n
    rng = np.random.default_rng(4)
    for q, qd, qdd in rng.uniform(-1.0, 1.0, (5, 3, n)):
        data.qpos[:n] = q
        data.qvel[:n] = qd
        data.qacc[:n] = qdd
        mujoco.mj_inverse(engine, data)
        tau = model.inverse_dynamics(q, qd, qdd, friction=False)
        np.testing.assert_allclose(tau, data.qfrc_inverse[:n], rtol=0, atol=1e-9)


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


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b'\n\n <?xml version="1.0"?>' + ARM.encode(), ""),
        (b'\xef\xbb\xbf<?xml version="1.0"?>' + ARM.encode(), ""),
        (('<?xml version="1.0" encoding="UTF-16"?>' + ARM).encode("utf-16"), ""),
        ("<?xml version='1.0' encoding='latin-1'?><!-- Gelänk -->".encode("latin-1")
         + ARM.encode(), ""),
        ("<!-- Gelänk -->".encode("latin-1") + ARM.encode(), "is not XML .*save it as UTF-8"),
        ("<?xml version='1.0' encoding='GBK'?><!-- 关节 -->".encode("gbk") + ARM.encode(),
         "cannot be read .*save it as UTF-8"),
        (ARM.encode()[:-4], r"is not XML \([^;]*$"),
    ],
)  # fmt: skip
def test_what_stands_before_the_first_element(tmp_path: Path, content: bytes, says: str) -> None:
    """Empty lines, which simulators pass over, marks and letters of other encodings."""
    path = tmp_path / "arm.urdf"
    path.write_bytes(content)
    if says:
        with pytest.raises(InputError, match=says):
            import_robot(path)
        return
    assert import_robot(path).robot.n == 6


@pytest.mark.parametrize("name", ["deep/links.xml", "parts/deep/links.xml"])
def test_a_file_within_an_included_one(tmp_path: Path, name: str) -> None:
    """Beside the one that includes it, or stated from the first, as in MuJoCo; undeclared prefixes
    are part of the names."""
    pytest.importorskip("mujoco")
    whole = mjcf()
    bodies = whole[whole.index("<body") : whole.index("</worldbody>")]
    (tmp_path / "parts" / "deep").mkdir(parents=True)
    inner = tmp_path / "parts" / "deep" / "links.xml"
    inner.write_text(f"<mujocoinclude>{bodies}</mujocoinclude>")
    part = tmp_path / "parts" / "arm.xml"
    part.write_text(f'<mujoco><worldbody><include file="{name}"/></worldbody></mujoco>')
    text = '<mujoco><include file="parts/arm.xml"/></mujoco>'
    found = read(tmp_path / "scene.xml", text)
    same_torque(tmp_path / "scene.xml", found.robot)
    inner.write_text(f"<mujocoinclude>{bodies}<my:own/></mujocoinclude>")
    assert read(tmp_path / "scene.xml", text).robot == found.robot
