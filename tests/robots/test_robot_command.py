"""`irb2400 robot import|new|check|show` and what the verbs say of an arm that is half known."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from robots.public_arms import arms, urdf
from typer.testing import CliRunner

import irb2400_ctrl as irb
from irb2400_ctrl.cli.main import app
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model.plausibility import plausibility
from irb2400_ctrl.robot import robot_names
from irb2400_ctrl.robot.changed import changed
from irb2400_ctrl.robot.importing import import_robot

RUN = CliRunner()


def test_import_writes_a_robot_that_loads_and_says_what_is_unknown(tmp_path: Path) -> None:
    source = tmp_path / "kr16.urdf"
    source.write_text(urdf(arms()["kr16"]))
    out = tmp_path / "kr16.toml"
    found = RUN.invoke(
        app,
        ["robot", "import", str(source), "--out", str(out), "--payload-kg", "5"],
        catch_exceptions=False,
    )
    assert found.exit_code == 0
    assert "viscous friction of every joint is unknown" in found.output
    assert "chain from base_link to tool0" in found.output
    robot = irb.load_robot(out)
    assert robot.tool is not None
    assert robot.tool.body.mass_kg == 5.0
    assert RUN.invoke(app, ["robot", "show", str(out)]).exit_code == 0
    assert RUN.invoke(app, ["robot", "check", str(out)]).exit_code == 0


def test_show_has_acceleration_and_gear_of_each_joint(tmp_path: Path) -> None:
    out = tmp_path / "known.toml"
    known = changed(
        irb.load_robot("ur10e"),
        ["joints.1.limits.acceleration_deg_s2=345",
         "joints.2.transmission={gear_ratio=-101.5, source='data sheet'}"],
    )  # fmt: skip
    irb.robot.save_robot(known, out)
    head, *rows = RUN.invoke(app, ["robot", "show", str(out)]).output.splitlines()[1:8]
    first, second, *others = (row.split("…")[1].split() for row in rows)
    assert head.split("]  ")[2:5] == ["acceleration [deg/s2", "torque [Nm", "gear [-"]
    assert first[1:5] == ["120", "345", "330", "?"]
    assert second[1:5] == ["120", "?", "330", "-101.50"]
    assert all(row[2] == row[4] == "?" for row in others)


def test_the_template_loads_as_it_is(tmp_path: Path) -> None:
    out = tmp_path / "my.toml"
    assert RUN.invoke(app, ["robot", "new", "--out", str(out)]).exit_code == 0
    robot = irb.load_robot(out)
    assert robot.n == 2
    assert np.isfinite(irb.Model(robot).gravity(np.zeros(2))).all()


def test_what_the_template_shows_as_a_comment_is_valid(tmp_path: Path) -> None:
    RUN.invoke(app, ["robot", "new", "--out", str(tmp_path / "my.toml")])
    text = (tmp_path / "my.toml").read_text()
    keys = (
        *("friction =", "transmission =", "acceleration_deg_s2", "torque_rate_Nm_s", "[tool"),
        *('name = "gripper"', 'source = "data sheet"', "tcp.", "mass_kg = 2.0"),
        *("com_m = [0.0, 0.0, 0.05]", "inertia_kgm2 = { xx = 0.01", "[motor_coupling]"),
        "matrix = [[1, 0], [0, 1]]",
    )
    lines = [
        line.removeprefix("# ")
        if line.startswith("# ") and line.removeprefix("# ").startswith(keys)
        else line
        for line in text.splitlines()
    ]
    full = tmp_path / "full.toml"
    full.write_text("\n".join(lines))
    robot = irb.load_robot(full)
    assert robot.tool is not None
    assert robot.motor_coupling is not None
    transmission = robot.joints[0].transmission
    assert transmission is not None
    assert transmission.gear_ratio == 121.0
    assert irb.load_robot(irb.save_robot(robot, tmp_path / "again.toml")) == robot


@pytest.mark.parametrize("name", ["irb2400", "puma560", "ur10e"])
def test_the_shipped_arms_load_and_their_files_state_the_prior(name: str, tmp_path: Path) -> None:
    assert name in robot_names()
    robot = irb.load_robot(name)
    assert irb.load_robot(irb.save_robot(robot, tmp_path / "arm.toml")) == robot
    assert np.isfinite(irb.Model(robot).inverse_dynamics(*np.full((3, 6), 0.3))).all()


def test_a_verb_says_what_it_does_without() -> None:
    found = RUN.invoke(app, ["codegen", "--controller", "none", "--robot", "ur10e", "--out", "x"])
    assert "viscous friction of every joint is unknown: left out of the torque" in found.output


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('mass value="8.0"', 'mass value="0.0"', "no mass"),
        ('mass value="8.0"', 'mass value="0.001"', "too much for"),
        ('<origin xyz="0.008 0.0008 0.0"/>', '<origin xyz="8 0.8 0"/>', "looks like mm"),
        ('ixx="', 'ixx="-', "negative"),
        ('velocity="', 'velocity="90" was="', "beyond any arm's"),
    ],
)
def test_what_looks_wrong_is_noted(old: str, new: str, says: str, tmp_path: Path) -> None:
    text = urdf(arms()["irb1200"])
    assert old in text
    path = tmp_path / "arm.urdf"
    path.write_text(text)
    assert plausibility(import_robot(path).robot) == []
    path.write_text(text.replace(old, new, 1))
    assert any(says in note for note in plausibility(import_robot(path).robot))


def test_gravity_is_looked_at() -> None:
    robot = irb.load_robot("ur10e")
    up = robot.model_copy(update={"gravity_m_s2": (0.0, 0.0, 9.81)})
    weak = robot.model_copy(update={"gravity_m_s2": (0.0, 0.0, -0.981)})
    assert "points up" in plausibility(up)[0]
    assert "0.981" in plausibility(weak)[0]


DH = """# convention: {convention}
alpha_deg,a_mm,d_mm,theta_offset_deg,mass_kg,com_x_mm,com_y_mm,com_z_mm,ixx_kgm2,iyy_kgm2,izz_kgm2
-90,100,400,10,5,1,2,3,0.1,0.1,0.1
0,300,0,-20,4,10,2,3,0.1,0.1,0.1
90,0,50,30,3,1,20,3,0.1,0.1,0.1
"""


@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_a_dh_table_is_the_product_of_its_matrices(convention: str, tmp_path: Path) -> None:
    path = tmp_path / "arm.csv"
    path.write_text(DH.format(convention=convention))
    model = irb.Model(import_robot(path).robot)
    q = np.array([0.3, -0.4, 0.5])
    X = np.eye(4)
    weight = np.zeros(3)
    step = 1e-6
    for alpha, a, d, offset, angle in zip(
        (-90, 0, 90), (0.1, 0.3, 0.0), (0.4, 0.0, 0.05), (10, -20, 30), q, strict=True
    ):
        turn = _about(2, angle + np.radians(offset)) @ _along(2, d)
        lift = _about(0, np.radians(alpha)) @ _along(0, a)
        X = X @ (turn @ lift if convention == "standard" else lift @ turn)
    np.testing.assert_allclose(model.flange_pose(q), X, atol=1e-14)
    for j in range(3):
        ends = [_energy(convention, q + sign * step * np.eye(3)[j]) for sign in (1, -1)]
        weight[j] = (ends[0] - ends[1]) / (2 * step)
    np.testing.assert_allclose(model.gravity(q), weight, atol=1e-7)


def test_a_stub_of_a_tool_makes_its_link_no_body() -> None:
    """An end effector of 1e-6 kg and 1 kg m2, fixed to a link of 0.3 kg, makes 1 kg m2 of it."""
    arm = irb.load_robot("ur10e")
    last = arm.links[-1]
    stub = last.body.model_copy(update={"mass_kg": 0.3, "inertia_kgm2": (1.0, 1.0, 1.0, 0, 0, 0)})
    links = (*arm.links[:-1], last.model_copy(update={"body": stub}))
    assert any(
        "placeholder" in note for note in plausibility(arm.model_copy(update={"links": links}))
    )
    assert not any("placeholder" in note for note in plausibility(arm))


def _energy(convention: str, q: np.ndarray) -> float:
    X = np.eye(4)
    energy = 0.0
    rows = ((-90, 0.1, 0.4, 10, 5, (1, 2, 3)), (0, 0.3, 0.0, -20, 4, (10, 2, 3)),
            (90, 0.0, 0.05, 30, 3, (1, 20, 3)))  # fmt: skip
    for (alpha, a, d, offset, mass, com), angle in zip(rows, q, strict=True):
        turn = _about(2, angle + np.radians(offset)) @ _along(2, d)
        lift = _about(0, np.radians(alpha)) @ _along(0, a)
        X = X @ (turn @ lift if convention == "standard" else lift @ turn)
        energy += 9.81 * mass * (X @ np.append(np.array(com) / 1e3, 1.0))[2]
    return float(energy)


def _about(axis: int, angle: float) -> np.ndarray:
    c = np.cos(angle)
    s = np.sin(angle)
    j = (axis + 1) % 3
    k = (axis + 2) % 3
    X = np.eye(4)
    X[j, j] = X[k, k] = c
    X[j, k] = -s
    X[k, j] = s
    return X


def _along(axis: int, length: float) -> np.ndarray:
    X = np.eye(4)
    X[axis, 3] = length
    return X


def test_a_dh_table_without_convention_or_mass_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "arm.csv"
    path.write_text(DH.replace("# convention: {convention}\n", ""))
    with pytest.raises(InputError, match="convention"):
        import_robot(path)
    path.write_text("alpha_deg,a_mm,d_mm,com_x_mm\n90,0,100,5\n")
    with pytest.raises(InputError, match="found no mass_kg beside"):
        import_robot(path, convention="standard")


def test_uncertainty_of_the_file_is_the_prior() -> None:
    from irb2400_ctrl.diagnosis.preparation.base_prior import BasePrior
    from irb2400_ctrl.robot import BodyUncertainty

    robot = irb.load_robot("ur10e")
    own = robot.uncertainty.model_copy(
        update={"links": {"forearm": BodyUncertainty(mass_relative=0.5)}}
    )
    changed = robot.model_copy(update={"uncertainty": own})
    size = np.ones(6)
    sigma = [BasePrior(r, r.uncertainty, size, size).sigmas() for r in (robot, changed)]
    assert sigma[0][20] == pytest.approx(0.1 * robot.links[2].body.mass_kg)
    assert sigma[1][20] == pytest.approx(0.5 * robot.links[2].body.mass_kg)
    assert (np.delete(sigma[0], 20) == np.delete(sigma[1], 20)).all()
    # friction that the file does not state may be up to half of the torque
    assert (sigma[0][60:66] == 0.5).all()
    own = own.model_copy(update={"links": {"nose": BodyUncertainty(com_m=0.1)}})
    with pytest.raises(ValueError, match="no such link"):
        robot.model_copy(update={"uncertainty": own})


def test_a_rotor_that_is_stated_and_in_no_torque_is_said() -> None:
    """Axis 6 of the Puma 560 was five thousand times too light: its rotor stood in a table that
    nothing read."""
    robot = irb.load_robot("puma560")
    assert not [note for note in plausibility(robot) if "motor_inertia" in note]
    rotors = [effect.motor_inertia for effect in robot.effects]
    stated = [j.transmission.reflected_inertia for j in robot.joints if j.transmission]
    np.testing.assert_allclose(np.array(rotors, float), np.array(stated, float), rtol=1e-3)
    without = robot.model_copy(update={"effects": robot.effects[:-1]})
    (note,) = [note for note in plausibility(without) if "motor_inertia" in note]
    assert note.startswith("axis_6: motor_inertia_kgm2 and gear_ratio make 0.194 kg m2")


def test_what_was_written_is_said_last(tmp_path: Path) -> None:
    out = tmp_path / "arm.toml"
    told = RUN.invoke(app, ["robot", "new", "--out", str(out)])
    assert told.stdout == f"written: {out}\n"


def test_static_friction_that_no_file_states_is_not_left_out(tmp_path: Path) -> None:
    for name, said in (("irb2400", True), ("ur10e", False)):
        found = RUN.invoke(app, ["robot", "export", name, "--out", str(tmp_path)])
        assert found.exit_code == 0, found.output
        assert ("static friction and its transition speed" in found.output) == said
