"""Robots out: MuJoCo and Pinocchio load what is written and make the torques of what is written."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from robots.imported import robot as public
from typer.testing import CliRunner

import irb2400_ctrl as irb
from irb2400_ctrl.cli.main import app
from irb2400_ctrl.effects.rotor_inertia import RotorInertia
from irb2400_ctrl.model.consistency import project, second_moments, with_masses
from irb2400_ctrl.robot.exported_names import exported_joints
from irb2400_ctrl.robot.importing import import_robot
from irb2400_ctrl.robot.mjcf_export import to_mjcf
from irb2400_ctrl.robot.urdf_export import to_urdf

Array = npt.NDArray[np.float64]
MARGIN = 1e-3
NAMES = ("irb2400", "ur10e", "puma560", "irb1200", "kr16", "panda")
OWN = ("irb2400", "ur10e", "puma560")


def arm(name: str) -> irb.Robot:
    known = irb.load_robot(name) if name in OWN else public(name)
    return project(with_masses(known)[0], MARGIN)[0]


def states(robot: irb.Robot, count: int = 12) -> tuple[Array, Array, Array]:
    rng = np.random.default_rng(2)
    q = rng.uniform(robot.q_min, robot.q_max, (count, robot.n))
    qd, qdd = rng.normal(0.0, 1.5, (2, count, robot.n))
    return q, qd, qdd


def inverse(mujoco: Any, model: Any, q: Array, qd: Array, qdd: Array) -> Array:
    data = mujoco.MjData(model)
    data.qpos[:] = q
    data.qvel[:] = qd
    data.qacc[:] = qdd
    mujoco.mj_inverse(model, data)
    return np.array(data.qfrc_inverse)


def without_constraints(mujoco: Any, text: str) -> Any:
    model = mujoco.MjModel.from_xml_string(text)
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    return model


@pytest.mark.parametrize("name", ["irb2400", "ur10e"])
def test_rotors_of_the_robot_file_are_in_the_mjcf(name: str) -> None:
    """They were named as left out, though an MJCF has a place for them and is read with them."""
    mujoco = pytest.importorskip("mujoco")
    plain = arm(name)
    rotors = tuple(RotorInertia.of(j, inertia_kgm2=0.2 * j) for j in (2, 3, 5))
    robot = plain.model_copy(update={"effects": rotors})
    text = to_mjcf(robot)
    assert "Effects of the robot file" not in text
    own, bare = (without_constraints(mujoco, made) for made in (text, to_mjcf(plain)))
    for q, qd, qdd in zip(*states(robot, 3), strict=True):
        angles = robot.A @ q, robot.A @ qd, robot.A @ qdd
        added = inverse(mujoco, own, *angles) - inverse(mujoco, bare, *angles)
        rotor = np.array([0.0, 0.4, 0.6, 0.0, 1.0, 0.0]) * qdd
        np.testing.assert_allclose(robot.A.T @ added, rotor, atol=1e-9)


@pytest.mark.parametrize("name", NAMES)
def test_mujoco_makes_the_torques_of_the_mjcf(name: str) -> None:
    mujoco = pytest.importorskip("mujoco")
    robot = arm(name)
    engine = without_constraints(mujoco, to_mjcf(robot))
    for q, qd, qdd in zip(*states(robot), strict=True):
        tau = irb.Model(robot).inverse_dynamics(q, qd, qdd, friction=False)
        # damping of joints and tendons acts on the actuators' speeds, dry friction is a constraint
        tau = tau + robot.friction[:, 2] * qd
        found = robot.A.T @ inverse(mujoco, engine, robot.A @ q, robot.A @ qd, robot.A @ qdd)
        np.testing.assert_allclose(found, tau, rtol=0, atol=1e-6 * max(1.0, np.abs(tau).max()))


def test_a_motor_on_the_tendon_is_the_actuator() -> None:
    """The torque of motor i, through the transmission, is the i-th of tau_q, and the length q."""
    mujoco = pytest.importorskip("mujoco")
    robot = arm("irb2400")
    engine = without_constraints(mujoco, to_mjcf(robot))
    data = mujoco.MjData(engine)
    q = np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
    data.qpos[:] = robot.A @ q
    data.ctrl[:] = tau = np.array([10.0, 20.0, 30.0, 4.0, 5.0, 6.0])
    mujoco.mj_forward(engine, data)
    np.testing.assert_allclose(data.actuator_length, q, atol=1e-12)
    np.testing.assert_allclose(robot.A.T @ data.qfrc_actuator, tau, atol=1e-12)
    np.testing.assert_allclose(engine.tendon_range[0], [robot.q_min[2], robot.q_max[2]])
    np.testing.assert_allclose(engine.tendon_frictionloss, robot.friction[2:3, 1])
    tcp = data.site("tcp")
    X = irb.Model(robot).tcp_pose(q)
    np.testing.assert_allclose(tcp.xpos, X[:3, 3], atol=1e-12)
    np.testing.assert_allclose(tcp.xmat.reshape(3, 3), X[:3, :3], atol=1e-12)


@pytest.mark.parametrize("name", NAMES)
def test_mujoco_and_pinocchio_make_the_torques_of_the_urdf(name: str) -> None:
    mujoco = pytest.importorskip("mujoco")
    pin = pytest.importorskip("pinocchio")
    robot = arm(name)
    text = to_urdf(robot)  # rotors have no place in it
    engines = (without_constraints(mujoco, text), pin.buildModelFromXML(text))
    for q, qd, qdd in zip(*states(robot, 5), strict=True):
        tau = irb.Model(robot.bare()).inverse_dynamics(q, qd, qdd, friction=False)
        joint = tuple(robot.A @ value for value in (q, qd, qdd))
        damping = np.array(engines[0].dof_damping) * joint[1]
        found = (
            inverse(mujoco, engines[0], *joint) - damping,
            pin.rnea(engines[1], engines[1].createData(), *joint),
        )
        for torque in found:
            np.testing.assert_allclose(
                robot.A.T @ torque, tau, rtol=0, atol=1e-6 * max(1.0, np.abs(tau).max())
            )


@pytest.mark.parametrize("name", NAMES)
def test_drake_makes_the_torques_of_both(name: str) -> None:
    """Where Drake is installed: its wheel brings a proprietary solver, so no extra asks for it."""
    pytest.importorskip("pydrake")
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import MultibodyPlant
    from pydrake.multibody.tree import MultibodyForces

    robot = arm(name)
    for form, text in (("urdf", to_urdf(robot)), ("xml", to_mjcf(robot))):
        plant = MultibodyPlant(0.0)
        Parser(plant).AddModelsFromString(text, form)
        if form == "urdf":
            plant.WeldFrames(plant.world_frame(), plant.GetFrameByName("base"))
        plant.mutable_gravity_field().set_gravity_vector(robot.gravity)
        plant.Finalize()
        context = plant.CreateDefaultContext()
        for q, qd, qdd in zip(*states(robot, 5), strict=True):
            plant.SetPositions(context, robot.A @ q)
            plant.SetVelocities(context, robot.A @ qd)
            # gravity and damping; Drake takes neither dry friction nor tendons
            forces = MultibodyForces(plant)
            plant.CalcForceElementsContribution(context, forces)
            tau = irb.Model(robot).inverse_dynamics(q, qd, qdd, friction=False)
            joints = [plant.GetJointByName(name) for name in exported_joints(robot)]
            damping = np.array([joint.default_damping() for joint in joints])
            found = plant.CalcInverseDynamics(context, robot.A @ qdd, forces)
            found = robot.A.T @ (found - damping * (robot.A @ qd))
            np.testing.assert_allclose(found, tau, rtol=0, atol=1e-6 * max(1.0, np.abs(tau).max()))


def test_the_margin_puts_every_body_strictly_inside() -> None:
    printed = irb.load_robot("irb2400")
    inside, distance = project(printed, MARGIN)
    for link in inside.links:
        values = np.linalg.eigvalsh(second_moments(link.body))
        assert values[0] >= 0.999 * MARGIN * values[-1] > 0.0
    again, moved = project(inside, MARGIN)
    assert moved < 1e-12 < distance
    assert again.links == inside.links


@pytest.mark.parametrize("form", ["urdf", "mjcf"])
def test_export_says_what_it_changed_and_left_out(form: str, tmp_path: Path) -> None:
    run = CliRunner().invoke(app, ["robot", "export", "--format", form, "--out", str(tmp_path)])
    assert run.exit_code == 0
    assert "strictly inside" in run.output
    assert "torque difference" in run.output
    assert "static friction" in run.output
    lost = "left out: the coupling, and the friction of axis_2, axis_3"
    assert (lost in run.output) == (form == "urdf")
    assert ("speed limits" in run.output) == (form == "mjcf")
    written = next(tmp_path.iterdir())
    mujoco = pytest.importorskip("mujoco")
    assert mujoco.MjModel.from_xml_path(str(written)).nv == 6
    as_is = ["robot", "export", "--format", form, "--as-is", "--out", str(tmp_path)]
    assert "strictly" not in CliRunner().invoke(app, as_is).output
    with pytest.raises(ValueError, match="inertia"):
        mujoco.MjModel.from_xml_path(str(written))


def test_a_urdf_comes_back_as_it_went_out(tmp_path: Path) -> None:
    robot = arm("irb1200")
    path = tmp_path / "arm.urdf"
    path.write_text(to_urdf(robot))
    back = import_robot(path).robot
    q, qd, qdd = states(robot)
    np.testing.assert_allclose(
        irb.Model(back).inverse_dynamics(q, qd, qdd),
        irb.Model(robot).inverse_dynamics(q, qd, qdd),
        atol=1e-10,
    )
    np.testing.assert_allclose(back.q_max, robot.q_max, rtol=1e-14)


@pytest.mark.parametrize("along", [(0, 0, 9.81), (9.81, 0, 0), (2, -3, -8.9)])
def test_an_arm_that_hangs_or_leans_takes_its_gravity_along(
    along: tuple[float, float, float], tmp_path: Path
) -> None:
    """URDF has none: the reader's, straight down, has to be that of the arm."""
    pin = pytest.importorskip("pinocchio")
    robot = arm("irb1200").model_copy(update={"gravity_m_s2": along})
    text = to_urdf(robot)
    engine = pin.buildModelFromXML(text)
    size = float(np.linalg.norm(robot.gravity))
    engine.gravity.linear = np.array([0.0, 0.0, -size])
    path = tmp_path / "arm.urdf"
    path.write_text(text)
    back = import_robot(path, base="base").robot
    np.testing.assert_allclose(robot.gravity * 9.81 / size, back.gravity, atol=1e-9)
    for q in states(robot, 3)[0]:
        np.testing.assert_allclose(
            pin.computeGeneralizedGravity(engine, engine.createData(), robot.A @ q),
            irb.Model(robot).gravity(q),
            atol=1e-9,
        )


def test_limits_that_nobody_knows_hinder_no_urdf(tmp_path: Path) -> None:
    """Most files of makers state no effort, and an MJCF no speed."""
    robot = arm("irb1200")
    joints = list(robot.joints)
    for k, gone in ((1, {"torque_Nm": None}), (2, {"speed_deg_s": None})):
        limits = joints[k].limits.model_copy(update=gone)
        joints[k] = joints[k].model_copy(update={"limits": limits})
    text = to_urdf(robot.model_copy(update={"joints": tuple(joints)}))
    assert "0 is a limit that the robot file does not state" in text
    path = tmp_path / "arm.urdf"
    path.write_text(text)
    back = import_robot(path).robot
    assert np.isinf(back.tau_bound).tolist() == [False, True, False, False, False, False]
    assert np.isinf(back.qd_bound).tolist() == [False, False, True, False, False, False]
    assert "does not state" not in to_urdf(robot)


@pytest.mark.parametrize("form", ["urdf", "mjcf"])
def test_a_link_without_mass_gets_a_gram_and_the_export_says_so(form: str, tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    arguments = ["robot", "export", "puma560", "--format", form, "--out", str(tmp_path)]
    run = CliRunner().invoke(app, arguments)
    assert run.exit_code == 0
    assert "link_1 has no mass in the robot file: 1 g is assumed" in run.output
    engine = mujoco.MjModel.from_xml_path(str(next(tmp_path.iterdir())))
    assert engine.nv == 6
    assert engine.body("link_1").mass[0] == pytest.approx(1e-3)
    assert "assumed" not in CliRunner().invoke(app, [*arguments, "--as-is"]).output
    kept, names = with_masses(irb.load_robot("irb2400"))
    assert names == []
    assert kept == irb.load_robot("irb2400")


@pytest.mark.parametrize("form", ["urdf", "mjcf"])
def test_joints_keep_their_names_there_and_back(form: str, tmp_path: Path) -> None:
    robot = irb.load_robot("ur10e")
    suffix, text = {"urdf": ("urdf", to_urdf), "mjcf": ("xml", to_mjcf)}[form]
    path = tmp_path / f"arm.{suffix}"
    path.write_text(text(robot))
    assert import_robot(path).robot.joint_names == robot.joint_names
    same = robot.joints[0].model_copy(update={"name": "wrist 1"})
    twice = robot.model_copy(update={"joints": (same, *robot.joints[1:])})
    path.write_text(text(twice))
    assert import_robot(path).robot.joint_names == [f"joint_{k}" for k in range(1, 7)]
