"""Arms whose axes miss each other by what a calibration finds: inverse kinematics and plans."""

from __future__ import annotations

import numpy as np
import pytest
from robots.imported import robot
from robots.test_verbs import paths_of
from scipy.spatial.transform import Rotation

import irb2400_ctrl as irb
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model.newton_branches import NewtonBranches
from irb2400_ctrl.model.polished_branches import PolishedBranches
from irb2400_ctrl.planners import plan_path
from irb2400_ctrl.planners.enclosure.tcp_path import levers

NAMES = ("irb2400", "puma560", "ur10e")


def calibrated(known: irb.Robot, seed: int = 0, size: float = 5e-4) -> irb.Robot:
    """Every frame moved by up to `size` [m] and turned by as many radians about each axis."""
    rng = np.random.default_rng(seed)
    links = []
    for link in known.links:
        X = link.frame.matrix().copy()
        X[:3, :3] = X[:3, :3] @ Rotation.from_rotvec(rng.uniform(-size, size, 3)).as_matrix()
        X[:3, 3] += rng.uniform(-size, size, 3)
        links.append({**link.model_dump(), "frame": {"transform": X.tolist()}})
    return known.model_copy(update={"links": tuple(links)})


@pytest.mark.parametrize("name", NAMES)
def test_no_branch_is_false_and_none_is_missed(name: str) -> None:
    robot_ = calibrated(irb.load_robot(name))
    model = irb.Model(robot_)
    assert isinstance(model._branch_solver, PolishedBranches)
    assert not model.arm_geometry.exact
    q = np.random.default_rng(1).uniform(-np.pi, np.pi, (2000, 6))
    q = q[np.abs(model.singularity_factors(q)).min(axis=1) > 0.05]
    X = model.tcp_pose(q)
    found = model.inverse_kinematics_branches(X)
    exists = np.isfinite(found.q).all(axis=2)
    wanted = np.broadcast_to(X[:, None], (*exists.shape, 4, 4))[exists]
    np.testing.assert_allclose(model.tcp_pose(found.q[exists]), wanted, rtol=0, atol=1e-9)
    away = np.abs(np.exp(1j * found.q) - np.exp(1j * q)[:, None]).max(axis=2)
    assert np.where(exists, away, np.inf).min(axis=1).max() < 1e-7
    assert ((found.overreach > 0) == ~exists).all()
    search = NewtonBranches(robot_)
    for k in range(6):
        assert len(search.one(model.flange_pose(q[k]), None)[0]) == exists[k].sum()


def test_near_a_singularity_the_method_searches_every_branch() -> None:
    robot_ = calibrated(irb.load_robot("puma560"))
    model = irb.Model(robot_)
    q = np.random.default_rng(4).uniform(robot_.q_min, robot_.q_max, (3000, 6))
    near = np.abs(model.singularity_factors(q)).min(axis=1)
    q = q[(near > 1e-3) & (near < 0.02)][:12]
    assert len(q) == 12
    for one in q:
        found = model.inverse_kinematics(model.tcp_pose(one), seed=one)
        np.testing.assert_allclose(found[0], one, rtol=0, atol=1e-6)


@pytest.mark.parametrize(
    "name", [NAMES[0], *(pytest.param(name, marks=pytest.mark.slow) for name in NAMES[1:])]
)
def test_a_raster_and_a_spiral_are_planned_with_a_certificate(name: str) -> None:
    robot_ = calibrated(irb.load_robot(name))
    model = irb.Model(robot_)
    for path in paths_of(model)[0 if name == "irb2400" else 1 :]:
        plan = plan_path(robot_, path, cells=150)
        assert plan.guaranteed
        assert plan.max_torque_ratio <= 1.0 + 1e-9
        assert plan.max_tcp_deviation < 1e-4
        rows = plan.trajectory
        tau = model.inverse_dynamics(rows.q, rows.qd, rows.qdd)
        assert (np.abs(tau) <= robot_.tau_max * (1 + 1e-9)).all()
        # looked at from outside: the TCP of the calibrated arm itself stays in the paths' plane
        reached = model.tcp_pose(rows.q)[:, :3, 3]
        np.testing.assert_allclose(reached[:, 2], path.position[0, 2], rtol=0, atol=1e-4)
        np.testing.assert_allclose(reached[[0, -1]], path.position[[0, -1]], rtol=0, atol=1e-5)


@pytest.mark.parametrize("name", NAMES)
def test_levers_bound_the_motion_of_the_tool(name: str) -> None:
    """|dp/dq_j| of a calibrated arm, and its change with every later joint, by finite steps."""
    robot_ = calibrated(irb.load_robot(name), size=1e-3)
    model = irb.Model(robot_)
    bound = levers(model)
    q = np.random.default_rng(2).uniform(-np.pi, np.pi, (400, 6))
    J = np.array(model.tcp_jacobian(q))[:, :3]
    assert (np.linalg.norm(J, axis=1).max(axis=0) <= bound).all()
    step = 1e-5
    for i in range(6):
        ahead = np.array(model.tcp_jacobian(q + step * np.eye(6)[i]))[:, :3]
        change = np.linalg.norm(ahead - J, axis=1).max(axis=0) / step
        most = np.array([bound[max(i, j)] for j in range(6)])
        assert (change <= most * (1 + 1e-3) + 1e-4).all()


def test_a_closed_form_is_not_given_for_an_arm_that_is_only_near() -> None:
    model = irb.Model(calibrated(irb.load_robot("puma560")))
    with pytest.raises(InputError, match="only come near those of a spherical wrist arm"):
        model.function("inverse_kinematics")


def test_an_arm_far_from_every_family_stays_one_of_none() -> None:
    model = irb.Model(calibrated(robot("irb1200"), size=2e-2))
    assert isinstance(model._branch_solver, NewtonBranches)
    with pytest.raises(InputError, match="no closed-form"):
        _ = model.arm_geometry
