"""Every verb on every arm: planned with a certificate, generated; refused where it must be."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from robots.imported import MOST, SIX_AXES, bent, robot

import irb2400_ctrl as irb
from irb2400_ctrl.codegen import export_package
from irb2400_ctrl.controllers import controller
from irb2400_ctrl.diagnosis.preparation.base_prior import BasePrior
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.measurement.prepared_log import prepare
from irb2400_ctrl.planners import plan_path
from irb2400_ctrl.planners.toolpath.builders import curve, raster
from irb2400_ctrl.planners.toolpath.toolpath import ToolPath
from irb2400_ctrl.plausibility import check_log
from irb2400_ctrl.robot import Friction
from irb2400_ctrl.simulation import simulate


def paths(name: str) -> tuple[ToolPath, ToolPath]:
    """`paths_of` an arm of the tests."""
    return paths_of(irb.Model(robot(name)))


def paths_of(model: irb.Model) -> tuple[ToolPath, ToolPath]:
    """A raster and a spiral in front of the arm, of its size."""
    x, y, z = model.tcp_pose(bent(model))[:3, 3]
    size = 0.1 * model.arm_geometry.a2

    def spiral(t: np.ndarray) -> np.ndarray:
        angle = 4 * np.pi * t
        rho = size * (0.2 + 0.8 * t)
        return np.stack([x + rho * np.cos(angle), y + rho * np.sin(angle), z + 0 * t], axis=1)

    return raster((x, y, z), 2 * size, size, lines=3, points=5), curve(spiral)


@pytest.mark.parametrize("name", MOST)
def test_a_raster_and_a_spiral_are_planned_with_a_certificate(name: str) -> None:
    for path in paths(name):
        plan = plan_path(robot(name), path, cells=150)
        assert plan.guaranteed
        assert plan.max_torque_ratio <= 1.0 + 1e-9
        assert plan.max_tcp_deviation < 1e-4
        assert set(plan.singularity_margin) == {"wrist", "shoulder", "elbow"}
        assert min(plan.singularity_margin.values()) > 0.0
        # looked at from outside: the rows keep the limits and follow the path
        rows = plan.trajectory
        tau = irb.Model(robot(name)).inverse_dynamics(rows.q, rows.qd, rows.qdd)
        assert (np.abs(tau) <= robot(name).tau_max * (1 + 1e-9)).all()
        assert (np.abs(rows.qd) <= robot(name).qd_max * (1 + 1e-9)).all()


def test_a_stated_orientation_is_held_on_parallel_axes() -> None:
    model = irb.Model(robot("ur5"))
    X = np.broadcast_to(model.tcp_pose(bent(model)), (5, 4, 4)).copy()
    X[:, 1, 3] += np.linspace(0.0, 0.1, 5)
    from irb2400_ctrl.planners.toolpath.builders import poses

    plan = plan_path(robot("ur5"), poses(X), cells=150, free_tool_rotation=False)
    assert plan.guaranteed
    reached = model.tcp_pose(plan.trajectory.q)
    np.testing.assert_allclose(reached[:, :3, :3], X[:1, :3, :3].repeat(len(reached), 0), atol=1e-3)


def test_planning_without_torque_limits_says_what_is_missing() -> None:
    unknown = without_limit(robot("irb1200"), 3)
    with pytest.raises(InputError, match=r"torque limit of joint_4 is unknown.*torque_Nm = "):
        plan_path(unknown, paths("irb1200")[0])
    # a controller needs none: it cuts the others
    block = controller("computed_torque", unknown)
    assert not np.isfinite(unknown.tau_bound[3])
    assert block.name == "computed_torque"


def test_seven_axes_are_not_planned() -> None:
    with pytest.raises(InputError, match="six"):
        plan_path(robot("panda"), paths("ur5")[0])


@pytest.mark.parametrize("name", [*SIX_AXES, "panda"])
def test_a_controller_is_generated_and_agrees_with_the_model(name: str, tmp_path: Path) -> None:
    arm = robot(name)
    block = controller("computed_torque", arm)
    verification = export_package(block, tmp_path / name, target="host")
    assert verification.passed


def without_limit(arm: irb.Robot, index: int) -> irb.Robot:
    """The arm with one torque limit unknown."""
    joints = list(arm.joints)
    limits = joints[index].limits.model_copy(update={"torque_Nm": None, "torque_source": "unknown"})
    joints[index] = joints[index].model_copy(update={"limits": limits})
    return arm.model_copy(update={"joints": tuple(joints)})


def test_an_arm_with_an_unknown_limit_is_simulated_and_generated(tmp_path: Path) -> None:
    from irb2400_ctrl.planners import joint_move

    known = robot("irb1200")
    start = np.array([0.1, 0.2, 0.3, 0.1, 0.5, 0.1])
    move = joint_move(irb.Model(known), start, start + 0.3, rate=250.0)
    run = simulate(without_limit(known, 3), move.trajectory, "computed_torque")
    assert np.abs(run.q[-1] - start - 0.3).max() < 1e-3
    share = run.summary()["max_torque_ratio"]
    assert share[3] is None
    assert share[1] > 0.0
    block = controller("computed_torque", without_limit(known, 3))
    assert export_package(block, tmp_path / "c", target="host").passed


def test_unknown_friction_is_found_in_a_motion() -> None:
    """The prior of a file without friction has a wide column for each term, and a fit fills it."""
    known = irb.load_robot("irb2400")
    bare = known.model_copy(
        update={
            "joints": tuple(j.model_copy(update={"friction": Friction()}) for j in known.joints)
        }
    )
    time = np.arange(0.0, 8.0, 0.004)
    phase = np.arange(6)
    q = 0.3 * np.sin(np.outer(time, 1.0 + 0.37 * phase) + phase)
    qd = np.gradient(q, time, axis=0)
    qdd = np.gradient(qd, time, axis=0)
    tau = irb.Model(known).inverse_dynamics(q, qd, qdd)
    motion = prepare(Log(time=time, q=q, tau=tau, name="made"))
    prior = BasePrior.of(bare, bare.uncertainty, motion)
    model = irb.Model(bare)
    Z = prior.columns(model, motion).reshape(-1, len(prior.sigmas()))
    rest = motion.tau - model.inverse_dynamics(motion.q, motion.qd, motion.qdd)
    z = np.linalg.solve(Z.T @ Z + np.eye(Z.shape[1]), Z.T @ rest.ravel())
    found = prior.updated(z)
    assert found.friction_known.all()
    np.testing.assert_allclose(found.friction[:, 1], known.friction[:, 1], rtol=0.15)
    np.testing.assert_allclose(found.friction[:, 2], known.friction[:, 2], rtol=0.15)


def test_a_log_of_an_arm_without_friction_is_understood_and_its_friction_found() -> None:
    arm = without_limit(robot("irb1200"), 3)
    time = np.arange(0.0, 10.0, 0.004)
    q = 0.4 * np.sin(np.outer(time, 1.0 + 0.3 * np.arange(6)))
    qd = np.gradient(q, time, axis=0)
    qdd = np.gradient(qd, time, axis=0)
    dry = np.array([5.0, 4.0, 3.0, 1.0, 1.0, 0.5])
    noise = np.random.default_rng(0).normal(0.0, 0.3, q.shape)
    tau = irb.Model(arm).inverse_dynamics(q, qd, qdd) + dry * np.sign(qd) + noise
    log = Log(time=time, q=q, tau=tau, name="made")
    assert check_log(arm, log).problem is None
    found = irb.diagnose(arm, log)
    assert found.verdict == "nothing_missing"
    np.testing.assert_allclose(found.robot.friction[:, 1], dry, rtol=0.1)
