"""Masses, inertias and limits of another unit, and the frame of the tool, in files of other
people."""

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
from irb2400_ctrl.excitation.feasible import Extent
from irb2400_ctrl.model.plausibility import plausibility
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.robot.importing import import_robot

UR5 = urdf(arms()["ur5"])


def scaled(text: str, attribute: str, factor: float) -> str:
    """The file with every number of an attribute times a factor."""
    return re.sub(rf'({attribute}=")([^"]+)"', lambda m: f'{m[1]}{factor * float(m[2]):.9g}"', text)


def read(text: str, tmp_path: Path) -> Robot:
    path = tmp_path / "arm.urdf"
    path.write_text(text)
    return import_robot(path).robot


def test_an_arm_as_it_is_has_no_other_unit(tmp_path: Path) -> None:
    assert not [note for note in plausibility(read(UR5, tmp_path)) if "looks like" in note]
    assert not [note for note in plausibility(irb.load_robot("irb2400")) if "look like" in note]


@pytest.mark.parametrize(
    ("attribute", "factor", "says"),
    [
        ("mass value", 1e2, "masses look like grams, or limits like another unit"),
        ("effort", 1e-3, "masses look like grams, or limits like another unit"),
        ("effort", 1e3, "and of no other joint for more; limits look like another unit"),
        ("i[xyz][xyz]", 1e-6, "which would be a point; it looks like another unit"),
        ("i[xyz][xyz]", 0.0, "which would be a point; it looks like another unit"),
    ],
)
def test_another_unit_is_said(attribute: str, factor: float, says: str, tmp_path: Path) -> None:
    """Of links of tons at 0.95 m reach "every body could exist"."""
    notes = plausibility(read(scaled(UR5, attribute, factor), tmp_path))
    assert any(says in note for note in notes), notes


@pytest.mark.parametrize("name", sorted(arms()))
def test_inertias_of_another_unit_are_asked_about(name: str, tmp_path: Path) -> None:
    """A radius of 2 mm is no measure of a link of 0.3 m: a thousandth passed without a word."""
    text = urdf(arms()[name])
    asked = "are they in another unit?"
    assert not [note for note in plausibility(read(text, tmp_path)) if asked in note]
    for factor in (1e-2, 1e-3):
        wrong = read(scaled(text, "i[xyz][xyz]", factor), tmp_path)
        (said,) = [note for note in plausibility(wrong) if asked in note]
        named = [link for link in wrong.links if link.name in said]
        assert 2 * len(named) > wrong.n
        assert factor > 1e-3 or len(named) >= wrong.n - 1


def test_a_check_says_of_them_that_no_matter_is_so_dense(tmp_path: Path) -> None:
    path = irb.save_robot(read(scaled(UR5, "i[xyz][xyz]", 1e-3), tmp_path), tmp_path / "arm.toml")
    found = CliRunner().invoke(app, ["robot", "check", str(path)])
    assert found.output.rstrip().endswith("every body could exist, if there were matter so dense")


def test_sound_inertias_are_not_asked_about() -> None:
    """Measured ones of which noise is left, thin rods, point masses beside them."""
    bare = irb.load_robot("ur10e")
    rod = {"inertia_kgm2": (0.0, 0.02, 0.02, 0.0, 0.0, 0.0)}
    point = {"inertia_kgm2": (0.0,) * 6}
    bodies = [rod, rod, rod, point, point, point]
    links = [
        link.model_copy(update={"body": link.body.model_copy(update=change)})
        for link, change in zip(bare.links, bodies, strict=True)
    ]
    rods = bare.model_copy(update={"links": tuple(links)})
    for robot in (rods, *map(irb.load_robot, ("irb2400", "puma560", "ur10e"))):
        assert not [note for note in plausibility(robot) if "are they in another unit?" in note]


@pytest.mark.parametrize("name", ["end_effector_link", "tcp_link", "my_flange_link", "link_eef"])
def test_the_frame_of_the_tool_is_the_end(name: str, tmp_path: Path) -> None:
    """126 mm of an end effector were dropped without a word."""
    text = UR5.replace("tool0", "end")
    last = re.findall(r'<link name="([^"]+)"', text)[-1]
    fixed = f'<link name="{name}"/><joint name="to_tool" type="fixed"><parent link="{last}"/>'
    fixed += f'<child link="{name}"/><origin xyz="0 0 0.126"/></joint></robot>'
    plain = read(text, tmp_path).flange.matrix()
    longer = read(text.replace("</robot>", fixed), tmp_path).flange.matrix()
    assert np.linalg.norm(longer[:3, 3] - plain[:3, 3]) == pytest.approx(0.126, abs=1e-6)


def test_bodies_of_a_model_are_less_sure_than_those_of_a_table(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(UR5)
    drawn = import_robot(path)
    assert drawn.robot.uncertainty.of_body("any") == (0.06, 0.015, 0.15)
    assert (
        sum("known to 6 % of a mass, 15 mm and 15 % of an inertia" in n for n in drawn.notes) == 1
    )
    path.write_text(re.sub("<inertial>.*?</inertial>", "", UR5, flags=re.DOTALL))
    assert not any("known to" in note for note in import_robot(path).notes)
    table = tmp_path / "arm.csv"
    masses = "mass_kg,com_x_mm,com_y_mm,com_z_mm,ixx_kgm2,iyy_kgm2,izz_kgm2"
    row = "one,0,0,400,5,1,2,3,0.1,0.1,0.1"
    table.write_text(f"# convention: modified\nname,alpha_deg,a_mm,d_mm,{masses}\n{row}\n")
    assert import_robot(table).robot.uncertainty.of_body("any") == (0.02, 0.005, 0.05)


def test_no_controller_is_made_of_an_arm_without_masses(tmp_path: Path) -> None:
    """Its torques were zero, and its verdict "passed"."""
    robot = read(re.sub("<inertial>.*?</inertial>", "", UR5, flags=re.DOTALL), tmp_path)
    irb.save_robot(robot, tmp_path / "arm.toml")
    words = [
        "codegen",
        "--controller",
        "computed_torque",
        "--robot",
        str(tmp_path / "arm.toml"),
        "--out",
        str(tmp_path / "c"),
    ]
    found = CliRunner().invoke(app, words)
    assert found.exit_code != 0
    assert "found no link with a mass" in str(found.exception) + found.output
    with pytest.raises(InputError, match="found no link with a mass"):
        irb.controller("pid", robot)
    with pytest.raises(InputError, match="found no link with a mass"):
        irb.controllers.momentum_observer(robot)


def test_what_is_wrong_with_slow_runs_is_said_alone() -> None:
    """Of too small a distance from axis 1 "86 %, expected at most 90 %" was printed."""
    fine = Extent(0.86, 0.5, 0.1, 0.65, 0.3, 0.1, 0.2448, 0.9)
    assert fine.inside
    assert not fine.wrong()
    narrow = Extent(0.86, 0.5, 0.1, 0.65, 0.2355, 0.1, 0.2448, 0.9)
    assert narrow.wrong().startswith("come to 0.235 m from axis 1, expected 0.245 m")
    several = Extent(0.95, 1.1, -0.1, 0.05, 0.2355, 0.1, 0.2448, 1.2).wrong()
    for part in (
        "95 % of a torque limit",
        "110 % of a speed",
        "120 % of an accel",
        "5.7 deg",
        "0.050 m above",
    ):
        assert part in several
    assert several.count("; they ") == 5


def test_centres_of_mass_in_the_frame_of_the_base_are_said(tmp_path: Path) -> None:
    """Torques of six times the limits "look like grams" in such a file, and the last link's centre
    was 1.4 m off."""
    heights = iter((0.05, 0.1, 0.3, 0.6, 0.75, 0.8, 0.85))
    text = re.sub(
        r'(<inertial>\s*<origin xyz=")[^"]+',
        lambda found: f"{found[1]}0 0 {next(heights)}",
        UR5,
    )
    notes = plausibility(read(text, tmp_path))
    told = [note for note in notes if "it looks like the base's frame" in note]
    assert len(told) == 1
    assert re.match(r"link_\d, .*: the centres of mass are 0\.\d+, ", told[0]), told
    assert not [note for note in notes if "grams" in note]


def test_endless_limits_are_none(tmp_path: Path) -> None:
    text = re.sub(r'(effort|velocity)="[^"]+"', r'\1="inf"', UR5)
    found = read(text, tmp_path)
    assert all(j.limits.torque_Nm is None and j.limits.speed_deg_s is None for j in found.joints)


def test_a_joint_along_gravity_says_nothing_of_units(tmp_path: Path) -> None:
    """Its 1e-16 Nm were less than a 300th of its limit, the only one that the file stated."""
    text = re.sub(r' effort="[^"]*"', "", UR5)
    limited = text.replace("<limit ", '<limit effort="90" ', 1)
    assert not [note for note in plausibility(read(limited, tmp_path)) if "limits" in note]


def test_an_inertia_without_a_mass_is_said_once(tmp_path: Path) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(re.sub('mass value="[^"]*"', 'mass value="0"', UR5, count=4))
    found = import_robot(path)
    assert not [note for note in found.notes if "no mass data" in note]
    assert [note for note in plausibility(found.robot) if "has no mass but an inertia" in note]


def test_a_turning_joint_on_a_vehicle_is_asked_about(tmp_path: Path) -> None:
    """The third joint of a planar base became the first axis of an arm of seven."""
    path = tmp_path / "arm.urdf"
    base = ""
    for name, kind, axis, parent, child in (
        ("way_x", "prismatic", "1 0 0", "map", "x"),
        ("way_y", "prismatic", "0 1 0", "x", "y"),
        ("heading", "continuous", "0 0 1", "y", "base_link"),
    ):
        base += f'<link name="{parent}"/><joint name="{name}" type="{kind}"><axis xyz="{axis}"/>'
        base += f'<parent link="{parent}"/><child link="{child}"/></joint>'
    path.write_text(UR5.replace("</robot>", f"{base}</robot>"))
    found = import_robot(path)
    (said,) = [note for note in found.notes if "turns behind them" in note]
    assert said.startswith("joint heading turns")
    assert said.endswith("--base-link base_link")
    assert found.robot.n == 7
    assert import_robot(path, base="base_link").robot.n == 6


def test_placeholders_with_a_gripper_behind_them_are_placeholders(tmp_path: Path) -> None:
    """The palm that is fixed to the last link made that one another body."""
    body = '<inertial><mass value="0.01"/><inertia ixx="1e-3" ixy="0" ixz="0" iyy="1e-3" iyz="0" '
    body += 'izz="1e-3"/></inertial>'
    palm = f'<link name="palm">{body}</link><joint name="grip" type="fixed"><parent link="tool0"/>'
    palm += '<child link="palm"/></joint></robot>'
    text = re.sub("<inertial>.*?</inertial>", body, UR5, flags=re.DOTALL)
    found = plausibility(read(text.replace("</robot>", palm), tmp_path))
    assert any("all links but the last have the same mass data" in note for note in found)


def test_damping_that_keeps_a_simulation_steady_is_asked_about(tmp_path: Path) -> None:
    """180 Nm s/rad on joints of 346 Nm, of a published model of a real arm."""
    for damping, said in ((5.0, 0), (180.0, 1)):
        text = UR5.replace("<limit ", f'<dynamics damping="{damping}"/><limit ', 2)
        text = re.sub('effort="[^"]*"', 'effort="346"', text)
        notes = [note for note in plausibility(read(text, tmp_path)) if "friction is most" in note]
        assert len(notes) == said
        assert all("180 of 346 Nm at 1 rad/s" in note for note in notes)


def test_one_inertia_for_links_of_any_weight_is_a_placeholder(tmp_path: Path) -> None:
    tensor = '<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/>'
    text = re.sub("<inertia .*?/>", tensor, UR5)
    found = [note for note in plausibility(read(text, tmp_path)) if "placeholder" in note]
    assert len(found) == 1
    assert found[0].startswith("all links have the same inertia (0.01 kg m2), whatever they weigh")


def test_speeds_in_degrees_are_one_line(tmp_path: Path) -> None:
    text = re.sub('velocity="[^"]*"', 'velocity="90"', UR5)
    (said,) = [note for note in plausibility(read(text, tmp_path)) if "speed limit" in note]
    assert said.endswith("speed limit 5156.62 deg/s is beyond any arm's")
    path = tmp_path / "arm.urdf"
    path.write_text(text.replace('velocity="90"', 'velocity="180"'))
    (unknown,) = [note for note in import_robot(path).notes if "speed limit" in note]
    assert "speed limit is 180 rad/s in the file, more than any arm's, taken as unknown" in unknown


def test_lengths_in_centimetres_are_asked_about(tmp_path: Path) -> None:
    """Of a large arm one link tells it, of a small one all of them together."""

    def said(factor: float) -> list[str]:
        text = re.sub(
            r'(<origin xyz=")([^"]+)("[^>]*/><axis)',
            lambda m: f"{m[1]}{' '.join(f'{factor * float(v)!r}' for v in m[2].split())}{m[3]}",
            UR5,
        )
        return [note for note in plausibility(read(text, tmp_path)) if " cm" in note]

    assert not said(1.0)
    assert any("further on; it looks like mm or cm" in note for note in said(100.0))
    assert any("lengths look like cm or dm read as metres" in note for note in said(20.0))


def test_sdf_is_answered_with_what_to_import(tmp_path: Path) -> None:
    path = tmp_path / "arm.sdf"
    path.write_text('<sdf version="1.6"><model name="arm"><link name="base"/></model></sdf>')
    with pytest.raises(InputError, match=r"SDF is not read: import the URDF .*sdf2mjcf"):
        import_robot(path)
