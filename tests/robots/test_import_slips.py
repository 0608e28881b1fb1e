"""What strangers' files have wrong, or have of their own, and what is made of it."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from robots.public_arms import arms, tensor, urdf

import irb2400_ctrl as irb
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model.plausibility import plausibility
from irb2400_ctrl.robot.importing import Imported, import_robot

MJCF = """<mujoco model="arm"><compiler angle="radian"/>{defaults}<worldbody><body name="base">
<body name="l1" pos="0 0 0.4"><joint name="j1"/><inertial pos="0 0 0.1" mass="9"
 diaginertia="0.1 0.1 0.1"/><body name="l2" pos="0.1 0 0"><joint name="j2" axis="0 1 0"/>
<inertial pos="0 0 0.2" mass="7" diaginertia="0.1 0.1 0.05"/>
<site name="{site}" pos="0 0.1 0" quat="1 -1 0 0"/></body></body></body></worldbody></mujoco>"""
ROWS = ((-90, 0.15, 0.475), (0, 0.6, 0), (-90, 0.12, 0), (90, 0, 0.72), (-90, 0, 0), (0, 0, 0.085))
"""alpha [deg], a [m], d [m]"""
GREIFER = """<link name="backe_a"/><link name="backe_b"/>
<joint name="antrieb" type="revolute"><parent link="{on}"/><child link="backe_a"/>
<axis xyz="0 1 0"/><limit lower="0" upper="0.7" velocity="1" effort="20"/></joint>
<joint name="gegenlauf" type="revolute"><parent link="{on}"/><child link="backe_b"/>
<axis xyz="0 -1 0"/><mimic joint="antrieb"/><limit lower="0" upper="0.7" velocity="1" effort="20"/>
</joint></robot>"""


def read(tmp_path: Path, text: str, suffix: str = "urdf") -> Imported:
    path = tmp_path / f"arm.{suffix}"
    path.write_text(text)
    return import_robot(path, outline=False)


def table(unit: str, names: str = "123456", factor: float = 1.0, speed: float = 180.0) -> str:
    """A standard table whose lengths are `factor` times what their unit says."""
    head = f"# convention: standard\nname,alpha_deg,a_{unit},d_{unit},speed_deg_s\n"
    scale = factor * {"m": 1.0, "mm": 1e3}[unit]
    rows = zip(names, ROWS, strict=True)
    return head + "".join(
        f"A{name},{alpha},{a * scale},{d * scale},{speed}\n" for name, (alpha, a, d) in rows
    )


@pytest.mark.parametrize("site", ["attachment_site", "ee_site", "tcp_site", "pinch_site"])
def test_a_site_for_the_tool_is_the_end(tmp_path: Path, site: str) -> None:
    """The tool ended in the frame of the last body, 0.1 m off and turned."""
    found = read(tmp_path, MJCF.format(defaults="", site=site), "xml")
    assert f"chain from world to {site}" in found.notes
    flange = found.robot.flange.matrix()
    last = found.robot.links[-1].frame.matrix()
    assert np.linalg.norm(flange[:3, 3]) == pytest.approx(0.1)
    np.testing.assert_allclose((last @ flange)[:3, 2], [0.0, 1.0, 0.0], atol=1e-12)


def test_a_top_class_of_another_name_is_that_of_all_elements(tmp_path: Path) -> None:
    """As older files have it; its damping and rotors were left out in silence."""
    defaults = """<default class="arm"><joint damping="3" armature="0.5"/>
    <default class="small"><joint armature="0.1"/></default></default>"""
    text = MJCF.format(defaults=defaults, site="tcp")
    small = text.replace('name="j2"', 'name="j2" class="small"')
    robot = read(tmp_path, small.replace('name="j1"', 'name="j1" class="arm"'), "xml").robot
    same = read(tmp_path, small, "xml").robot
    for one in (robot, same):
        assert [joint.friction.viscous_Nms_rad for joint in one.joints] == [3.0, 3.0]
        assert [effect.inertia_kgm2 for effect in one.effects] == [0.5, 0.1]


def test_inertias_about_the_frames_of_the_links_are_asked_about(tmp_path: Path) -> None:
    """All of them exist, and every one is too large: torques of accelerations were wrong."""
    asked = "about the frames of the links"
    arm = arms()["irb4600"]
    text = urdf(arm)
    assert not [note for note in plausibility(read(tmp_path, text).robot) if asked in note]
    for number, axis in enumerate(arm.axes, 1):
        com = np.array(axis.com)
        T = tensor(axis, number) + axis.mass * (com @ com * np.eye(3) - np.outer(com, com))
        six = zip(("xx", "xy", "xz", "yy", "yz", "zz"), T[np.triu_indices(3)], strict=True)
        inertia = " ".join(f'i{key}="{value:.17g}"' for key, value in six)
        link = f'(<link name="link_{number}">.*?)<inertia [^>]*/>'
        text = re.sub(link, rf"\1<inertia {inertia}/>", text, count=1)
    (said,) = plausibility(read(tmp_path, text).robot)
    assert asked in said
    assert said.endswith("expected them about the centre of mass")


def test_measured_and_drawn_inertias_are_not_asked_about(tmp_path: Path) -> None:
    robots = [read(tmp_path, urdf(arm)).robot for arm in arms().values()]
    for robot in (*robots, *map(irb.load_robot, ("irb2400", "puma560", "ur10e"))):
        assert not [note for note in plausibility(robot) if "look" in note]


def test_metres_and_radians_under_other_names_are_asked_about(tmp_path: Path) -> None:
    """An arm of two millimetres, and one that needs minutes for a turn, were fine."""

    def said(text: str) -> list[str]:
        notes = plausibility(read(tmp_path, text, "csv").robot)
        return [note for note in notes if "look" in note]

    assert said(table("mm")) == said(table("m")) == []
    assert said(table("mm", factor=1e-3)) == [
        "the arm reaches 2.02 mm; its lengths look like metres read as mm"
    ]
    assert said(table("mm", speed=3.14)) == [
        "no joint may turn faster than 3.14 deg/s; the speed limits look like rad/s"
    ]


def test_centres_of_mass_in_metres_are_asked_about(tmp_path: Path) -> None:
    for factor, told in ((1e-3, 1), (0.0, 0)):
        wrong = irb.load_robot("ur10e")
        for link in wrong.links:
            com = tuple(factor * value for value in link.body.com_m)
            moved = link.model_copy(update={"body": link.body.model_copy(update={"com_m": com})})
            links = tuple(moved if one.name == link.name else one for one in wrong.links)
            wrong = wrong.model_copy(update={"links": links})
        said = plausibility(wrong)
        assert len([note for note in said if "look like metres" in note]) == told
        assert len([note for note in said if "a placeholder, with which the wei" in note]) != told


def test_rows_that_begin_at_the_tool_are_refused(tmp_path: Path) -> None:
    """The arm was built from its flange on."""
    assert read(tmp_path, table("mm"), "csv").robot.n == 6
    for names in ("654321", "124356"):
        with pytest.raises(InputError, match=r"row \d: found axis \d below axis \d, by their name"):
            read(tmp_path, table("mm", names=names), "csv")


@pytest.mark.parametrize("site", ["pinch", "other"])
def test_a_linkage_of_two_jaws_is_none_of_the_arm(tmp_path: Path, site: str) -> None:
    """Spring link and follower of a gripper for MuJoCo were two more axes."""
    mass = '<inertial pos="0 0 0" mass="0.02" diaginertia="1e-5 1e-5 1e-5"/>'
    linkage = "".join(
        f'<body name="{side}_driver"><joint name="{side}_driver_joint"/>{mass}</body>'
        f'<body name="{side}_spring_link"><joint name="{side}_spring_link_joint"/>{mass}'
        f'<body name="{side}_follower"><joint name="{side}_follower_joint"/>{mass}</body></body>'
        for side in ("left", "right")
    )
    gripper = f'<body name="mount" pos="0 0 0.1">{mass}<site name="{site}"/>{linkage}</body>'
    text = re.sub("<site .*?/>", gripper, MJCF.format(defaults="", site="x"), flags=re.S)
    found = read(tmp_path, text, "xml")
    assert [joint.name for joint in found.robot.joints] == ["j1", "j2"]
    assert f"chain from world to {'pinch' if site == 'pinch' else 'l2'}" in found.notes


def test_a_finger_is_known_by_the_one_that_follows_it(tmp_path: Path) -> None:
    """Not English, it was the seventh axis of the arm."""
    text = urdf(arms()["irb1200"]).replace("tool0", "end")
    found = read(tmp_path, text.replace("</robot>", GREIFER.format(on="end")))
    assert found.robot.n == 6
    assert [n for n in found.notes if n.startswith("joint antrieb (revolute) on end is not on")]
    # what is drawn beside the last axis and turns with it does not take that axis away
    named = urdf(arms()["irb1200"])
    gear = GREIFER.format(on="link_5").replace('"antrieb"/>', '"joint_6"/>')
    beside = re.sub('<joint name="antrieb".*?</joint>|<link name="backe_a"/>', "", gear, flags=re.S)
    assert read(tmp_path, named.replace("</robot>", beside)).robot.n == 6


@pytest.mark.parametrize(("digits", "says"), [(4, "read as exact ones: 4 angles"), (2, "1.57 rad")])
def test_right_angles_of_a_table_in_radians(tmp_path: Path, digits: int, says: str) -> None:
    """An arm of 1.5708 was only near one with a closed form, and nothing said so."""
    text = table("mm").replace("alpha_deg", "alpha_rad")
    text = re.sub(r",(-?)90,", lambda found: f",{found[1]}{np.pi / 2:.{digits}f},", text)
    found = read(tmp_path, text, "csv")
    assert any(says in note for note in found.notes)
    exact = read(tmp_path, table("mm"), "csv")
    same = all(
        np.array_equal(one.frame.matrix(), other.frame.matrix())
        for one, other in zip(found.robot.links, exact.robot.links, strict=True)
    )
    assert same == (digits == 4)
    assert not [note for note in exact.notes if "quarter" in note]


def test_the_joint_of_a_force_sensor_is_told_how_it_is_written(tmp_path: Path) -> None:
    text = re.sub(r'lower="[^"]*" upper="[^"]*"', 'lower="0" upper="0"', urdf(arms()["irb1200"]))
    (said,) = [note for note in read(tmp_path, text).notes if "range 0 to 0" in note]
    assert 'write type="fixed"' in said


def test_a_flange_of_the_elbow_is_no_end_of_the_arm(tmp_path: Path) -> None:
    """Six axes were three."""
    flange = """<link name="elbow_flange"/><joint name="bolts" type="fixed"><parent link="link_3"/>
    <child link="elbow_flange"/></joint></robot>"""
    text = urdf(arms()["irb1200"]).replace("</robot>", flange)
    for end in ("tool0", "end"):
        assert read(tmp_path, text.replace("tool0", end)).robot.n == 6


def test_frames_on_the_last_link_are_said(tmp_path: Path) -> None:
    """The tool ended in the frame of the last link without a word of the others."""
    text = urdf(arms()["irb1200"])
    (said,) = [n for n in read(tmp_path, text.replace("tool0", "Teil_7")).notes if "Teil_7" in n]
    assert "where one of these is meant, take it with --tool-link" in said
    named = read(tmp_path, text.replace("tool0", "tool"))
    assert "chain from base_link to tool" in named.notes
    assert not [note for note in named.notes if "--tool-link" in note]
