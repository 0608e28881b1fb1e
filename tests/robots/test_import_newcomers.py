"""What people bring at first: tables in other dialects and units, files that are not what they
seem."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from robots.public_arms import arms, urdf
from typer.testing import CliRunner

import irb2400_ctrl as irb
from irb2400_ctrl.cli.main import app
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model.plausibility import plausibility
from irb2400_ctrl.robot.importing import import_robot

MASSES = "mass_kg,com_x_mm,com_y_mm,com_z_mm,ixx_kgm2,iyy_kgm2,izz_kgm2"
DH = f"""# convention: standard
alpha_deg,a_mm,d_mm,theta_offset_deg,{MASSES}
-90,100.5,400,10,5,1,2,3,0.1,0.1,0.1
90,300,0,-20,4,10,2,3,0.1,0.1,0.1
"""


def imported(tmp_path: Path, name: str, text: str, encoding: str = "utf-8") -> irb.Robot:
    path = tmp_path / name
    path.write_text(text, encoding)
    return import_robot(path).robot


@pytest.mark.parametrize("separator", [";", "\t"])
def test_a_table_of_a_spreadsheet_is_the_same_arm(tmp_path: Path, separator: str) -> None:
    plain = imported(tmp_path, "a.csv", DH)
    head, *rows = DH.splitlines()
    table = [row.replace(",", separator).replace(".", ",") for row in rows]
    found = imported(tmp_path, "a.csv", "\n".join([head, "", *table]) + "\n", "utf-8-sig")
    q = np.array([0.3, -0.4])
    np.testing.assert_array_equal(irb.Model(found).tcp_pose(q), irb.Model(plain).tcp_pose(q))
    assert found.links[0].body == plain.links[0].body


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("alpha_deg", "alpha", "column 'alpha' has no unit, expected alpha_rad or alpha_deg"),
        ("a_mm", "a_cm", "column 'a_cm' is not known, expected some of alpha_deg"),
        ("theta_offset_deg", "theta_deg", "column 'theta_deg' is not known"),
        ("alpha_deg", "alpha_rad", "alpha is -90 rad, more than a whole turn"),
        ("\n-90,", "\n-1.5708,", "alpha is -1.5708 degrees, which looks like radians"),
        ("# convention: standard\n", "", "the convention of the DH table is not stated"),
        ("# convention: standard", "# convention", "the convention of the DH table is not stated"),
        ("300", "three", "a is 'three', expected a finite number"),
        ("300", "nan", "row 2: a is 'nan', expected a finite number"),
        (",-20,", ",1.5708,", "theta_offset is 1.5708 degrees, which looks like radians"),
        ("theta_offset_deg", "theta_offset_rad", "theta_offset is 10 rad, more than a whole turn"),
        ("100.5", "100,5", "found 12 cells under 11 names, .* decimal comma need semicolons"),
        ("d_mm", "a_m", "column 'a_mm' is there twice, or in two units"),
        ("iyy_kgm2", "ixx_kgm2", "column 'ixx_kgm2' is there twice"),
        (MASSES, MASSES.replace("mass_kg", "name"), "no mass_kg"),
    ],
)
def test_what_a_table_lacks_is_said(old: str, new: str, says: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=says):
        imported(tmp_path, "a.csv", DH.replace(old, new))


def test_a_table_that_went_through_a_spreadsheet_is_the_same_arm(tmp_path: Path) -> None:
    """It fills lines up with separators and quotes them; people put spaces and capitals."""
    plain = imported(tmp_path, "a.csv", DH)
    text = DH.replace("# convention: standard", '"# Convention: Standard",,,,').replace(",", ", ")
    found = imported(tmp_path, "a.csv", text)
    assert found.links == plain.links


def test_two_rows_of_one_name_are_refused(tmp_path: Path) -> None:
    rows = DH.replace("izz_kgm2", "izz_kgm2,name").replace("0.1,0.1,0.1", "0.1,0.1,0.1,arm")
    with pytest.raises(InputError, match="row 2: found a second 'arm', expected a name of its own"):
        imported(tmp_path, "a.csv", rows)


@pytest.mark.parametrize(
    ("cells", "says"),
    [
        ("10,5,1,2,3,0.1,0.1,0.1,,", "found mass of a row named flange"),
        (",,,,,,,,-90,90", "found low and high of a row named flange"),
    ],
)
def test_an_axis_called_flange_is_not_left_out_in_silence(
    cells: str, says: str, tmp_path: Path
) -> None:
    """A table of six axes of which the last was called flange became an arm of five."""
    head = f"name,alpha_deg,a_mm,d_mm,theta_offset_deg,{MASSES},low_deg,high_deg"
    axis = "one,0,0,400,0,5,1,2,3,0.1,0.1,0.1,-90,90"
    table = f"# convention: modified\n{head}\n{axis}\nflange,90,100,0,{cells}\n"
    with pytest.raises(InputError, match=says):
        imported(tmp_path, "a.csv", table.replace(",10,5,", ",5,"))
    plain = table.replace(cells, ",,,,,,,,,")
    assert imported(tmp_path, "a.csv", plain).n == 1


def test_a_table_that_is_no_text_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes(b"\xff\xfe\xd8\x00")
    with pytest.raises(InputError, match=r"UTF-16, expected a DH table \(CSV\)"):
        import_robot(path)


def test_millimetres_and_grams_are_noticed() -> None:
    arm = irb.load_robot("ur10e")
    links = [link.model_dump() for link in arm.links]
    frame = np.array(arm.links[2].frame.matrix())
    frame[:3, 3] *= 1e3
    links[2]["frame"] = {"transform": frame.tolist()}
    links[1]["body"]["mass_kg"] *= 1e3
    notes = plausibility(arm.model_copy(update={"links": tuple(links)}))
    assert any("612.7 m further on; it looks like mm" in note for note in notes)
    assert any("upper_arm: a mass of 1.305e+04 kg; it looks like grams" in note for note in notes)
    assert not any("looks like" in note for note in plausibility(arm))


def test_an_endless_joint_and_no_torque_limits_are_told(tmp_path: Path) -> None:
    text = urdf(arms()["irb1200"])
    path = tmp_path / "arm.urdf"
    path.write_text(text.replace('type="revolute"', 'type="continuous"', 1))
    assert any("turns endlessly" in note for note in import_robot(path).notes)
    dh = tmp_path / "a.csv"
    dh.write_text(DH)
    assert not any("same number" in note for note in import_robot(dh).notes)


RAIL = (
    '<link name="ground"/><joint name="rail" type="prismatic"><parent link="ground"/>'
    '<child link="base_link"/><origin xyz="0 0 0.4"/><axis xyz="1 0 0"/>'
    '<limit lower="0" upper="2" effort="100" velocity="1"/></joint>'
)
HAND = (
    '<link name="palm"/><joint name="palm_mount" type="fixed"><parent link="tool0"/>'
    '<child link="palm"/></joint><link name="pad"/><joint name="left_knuckle_joint" '
    'type="revolute"><parent link="palm"/><child link="pad"/><axis xyz="0 1 0"/></joint>'
)


def ur5(old: str = "", new: str = "") -> str:
    text = urdf(arms()["ur5"])
    return re.sub(old, new, text, flags=re.DOTALL) if old else text


def test_a_rail_below_is_held_and_a_gripper_behind_is_none_of_the_arm(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(ur5("</robot>", f"{RAIL}{HAND}</robot>").replace("tool0", "end"))
    found = import_robot(path)
    assert found.robot.n == 6
    notes = "\n".join(found.notes)
    assert "prismatic joint rail carries the arm: it is held at zero" in notes
    assert "joint left_knuckle_joint (revolute) on palm is not on the chain" in notes
    plain = imported(tmp_path, "plain.urdf", ur5())
    q = np.random.default_rng(0).uniform(-2, 2, (5, 6))
    raised = irb.Model(found.robot).flange_pose(q)
    raised[:, 2, 3] -= 0.4
    np.testing.assert_allclose(raised, irb.Model(plain).flange_pose(q), atol=1e-12)
    assert import_robot(path, tip="pad").robot.n == 7


def test_a_gripper_is_known_by_the_link_that_its_motor_moves(tmp_path: Path) -> None:
    """Its joint may be called anything; fingers that follow it come behind."""
    hand = HAND.replace("left_knuckle_joint", "drive_joint").replace('"pad"', '"outer_knuckle"')
    path = tmp_path / "arm.urdf"
    path.write_text(ur5("</robot>", f"{hand}</robot>").replace("tool0", "end"))
    found = import_robot(path)
    assert found.robot.n == 6
    assert "joint drive_joint (revolute) on palm is not on the chain" in "\n".join(found.notes)


def test_the_last_axis_may_move_the_whole_gripper(tmp_path: Path) -> None:
    last = list(import_and_names(tmp_path, ur5()))[-1]
    text = ur5().replace(f'"{last}"', '"gripper_link"')
    assert list(import_and_names(tmp_path, text))[-1] == "gripper_link"


def import_and_names(folder: Path, text: str) -> list[str]:
    return [link.name for link in imported(folder, "arm.urdf", text).links]


def test_two_arms_in_a_file_are_told_and_each_can_be_taken(tmp_path: Path) -> None:
    path = tmp_path / "two.urdf"
    one = ur5()
    name = re.compile(r'(?<=[ "])(?=\w+")(?<=(?:name|link)=")')
    inner = one[one.index("<link") : one.index("</robot>")]
    left, right = (name.sub(side, inner) for side in ("left_", "right_"))
    base = re.search(r'<link name="([^"]+)"', inner)
    assert base is not None
    mounts = "".join(
        f'<joint name="{side}mount" type="fixed"><parent link="stand"/>'
        f'<child link="{side}{base[1]}"/><origin xyz="0 {y} 0"/></joint>'
        for side, y in (("left_", 0.4), ("right_", -0.4))
    )
    path.write_text(f'<robot name="two"><link name="stand"/>{left}{right}{mounts}</robot>')
    found = import_robot(path)
    assert {joint.name.split("_")[0] for joint in found.robot.joints} == {"left"}
    note = next(note for note in found.notes if "another arm: 6 joints from right_" in note)
    end = re.search(r"--tool-link (\S+)", note)
    assert end is not None
    other = import_robot(path, tip=end[1])
    assert {joint.name.split("_")[0] for joint in other.robot.joints} == {"right"}
    assert end[1] == "right_tool0"


@pytest.mark.parametrize("part", ["finger", "mrl"])
def test_the_other_arm_is_told_without_its_fingers(tmp_path: Path, part: str) -> None:
    """As TIAGo's file states two arms with a gripper each."""
    one = ur5()
    name = re.compile(r'(?<=[ "])(?=\w+")(?<=(?:name|link)=")')
    inner = one[one.index("<link") : one.index("</robot>")]
    last = re.findall(r'<child link="(\w+)"', inner)[-1]
    finger = (
        f'<link name="{part}"/><joint name="{part}_joint" type="revolute"><parent link="{last}"/>'
        f'<child link="{part}"/><axis xyz="1 0 0"/><limit lower="0" upper="1"/></joint>'
    )
    base = re.search(r'<link name="([^"]+)"', inner)
    assert base is not None
    sides = [(side, name.sub(side, inner + finger)) for side in ("left_", "right_")]
    text = "".join(
        f'{arm}<joint name="{side}mount" type="fixed"><parent link="stand"/>'
        f'<child link="{side}{base[1]}"/></joint>'
        for side, arm in sides
    )
    found = imported_notes(tmp_path, f'<robot name="two"><link name="stand"/>{text}</robot>')
    (note,) = [note for note in found if "another arm: 6 joints from right_" in note]
    assert "--tool-link right_tool0 takes" in note


def imported_notes(folder: Path, text: str) -> list[str]:
    path = folder / "two.urdf"
    path.write_text(text)
    return list(import_robot(path).notes)


def test_a_prefix_that_is_not_declared_is_no_hindrance(tmp_path: Path) -> None:
    """Collision properties for one simulator, as many files carry them."""
    text = ur5("</robot>", '<drake:properties a="1"><drake:soft/></drake:properties></robot>')
    assert imported(tmp_path, "a.urdf", text).links == imported(tmp_path, "a.urdf", ur5()).links


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("<link.*</robot>", "</robot>", "found no link, expected a robot"),
        ('<mass value="', '<mass value="-', r"link_1 body mass_kg: found -3.7"),
        ("<inertia .*?/>", "", 'link link_1: found no <inertia ixx="…">, expected one'),
        ('type="revolute"', 'type="fixed"', "found no joint that turns between base_link"),
        ("</robot>", '<link name="link_1"/></robot>', "link link_1 is there 2 times"),
        ("</robot>", '<link name="other"/></robot>', "choose one of them with --base-link"),
    ],
)
def test_what_is_wrong_in_a_urdf_is_said(old: str, new: str, says: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=says):
        imported(tmp_path, "arm.urdf", ur5(old, new))


def test_notes_of_several_joints_are_one_line(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(ur5("<inertial>.*?</inertial>").replace('type="revolute"', 'type="continuous"'))
    notes = import_robot(path).notes
    assert sum("it turns endlessly" in note for note in notes) == 1
    assert any(note.startswith("links link_1, link_2, link_3,") for note in notes)
    assert any("no link has mass" in note for note in notes)


def test_a_range_upside_down_and_a_linkage_are_told(tmp_path: Path) -> None:
    """Not as if the file said nothing, or the joint were one of its own."""
    path = tmp_path / "arm.urdf"
    bar = '<link name="bar"/><joint name="bar_joint" type="revolute">'
    bar += '<parent link="upper_arm_link"/><child link="bar"/><axis xyz="0 0 1"/>'
    bar += '<mimic joint="elbow_joint"/></joint></robot>'
    text = ur5("</robot>", bar)
    parent = re.search(r'<parent link="([^"]+)"/>', text[text.index("<joint") :])
    assert parent is not None
    text = text.replace("upper_arm_link", parent[1])
    path.write_text(re.sub(r'lower="[^"]+" upper="[^"]+"', 'lower="3" upper="-3"', text, count=1))
    notes = "\n".join(import_robot(path).notes)
    assert "range 3 to -3 rad in the file is none" in notes
    assert "joint bar_joint (follows elbow_joint, mimic)" in notes


MESH = '<visual><geometry><mesh filename="package://arm/{}.stl"/></geometry></visual></link>'


def test_meshes_that_are_not_there_are_one_line(tmp_path: Path) -> None:
    text = ur5()
    for k in range(7):
        text = text.replace("</link>", f"</LINK{k}>", 1)
    for k in range(7):
        text = text.replace(f"</LINK{k}>", MESH.format(k))
    path = tmp_path / "arm.urdf"
    path.write_text(text)
    notes = [note for note in import_robot(path).notes if "left out of the outline" in note]
    assert len(notes) == 1
    assert "their meshes (package://arm/0.stl, …): found nothing beside the file" in notes[0]


def test_a_plan_of_an_arm_without_masses_promises_no_torque(tmp_path: Path) -> None:
    """Files of ROS-Industrial have joints, ranges and speeds, and no mass data."""
    path = tmp_path / "arm.urdf"
    path.write_text(ur5("<inertial>.*?</inertial>"))
    robot = import_robot(path).robot
    assert "mass of every link is unknown: torques are those of friction alone" in (
        robot.assumptions()
    )
    path_of_tip = irb.planners.builders.circle((0.4, 0.2, 0.4), 0.03, feed=0.05)
    plan = irb.plan_path(robot, path_of_tip)
    assert not plan.guaranteed
    assert "no link of the robot file has mass" in plan.summary()["guarantee_note"]
    irb.save_robot(robot, tmp_path / "arm.toml")
    found = CliRunner().invoke(app, ["robot", "check", str(tmp_path / "arm.toml")])
    assert "no link has mass: only kinematics can be asked of this arm" in found.output
    assert "every body could exist" not in found.output
    assert sum("no mass; expected" in line for line in found.output.splitlines()) == 1


def test_the_same_body_on_every_link_is_a_placeholder(tmp_path: Path) -> None:
    body = '<inertial><mass value="1"/><origin xyz="0 0 0"/>'
    body += '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
    path = tmp_path / "arm.urdf"
    path.write_text(re.sub("<inertial>.*?</inertial>", body, ur5(), flags=re.DOTALL))
    notes = plausibility(import_robot(path).robot)
    assert any("all links have the same mass data, placeholders" in note for note in notes)
    assert not any("placeholders" in note for note in plausibility(irb.load_robot("puma560")))


def test_a_xacro_is_told_how_it_is_expanded(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"xacro arm.xacro > .*xacrodoc arm.xacro -d"):
        imported(tmp_path, "arm.xacro", ur5("link_1", "${prefix}link_1"))


def test_a_property_that_nothing_asks_for_needs_no_expansion(tmp_path: Path) -> None:
    """As in files that were written by hand after one of xacro."""
    text = ur5("<robot ", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" ')
    text = text.replace("</robot>", '<xacro:property name="width" value=".2"/></robot>')
    assert imported(tmp_path, "a.urdf", text).links == imported(tmp_path, "a.urdf", ur5()).links


def test_a_urdf_in_the_place_of_a_robot_file_is_told_how_to_become_one(tmp_path: Path) -> None:
    """It was "not TOML"."""
    path = tmp_path / "ur5e.urdf"
    path.write_text(urdf(arms()["ur5"]))
    with pytest.raises(InputError, match=r"irb2400 robot import .*ur5e.urdf --out"):
        irb.load_robot(path)
