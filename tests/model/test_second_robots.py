"""The model is not one of the IRB 2400: arms with explicit transforms, against Pinocchio."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from model.pin_arm import PinArm
from model.second_robots import KR300, kr300, ur_like
from model.states import States, random_states

import irb2400_ctrl as irb
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model.chain import chain_of
from irb2400_ctrl.model.positive_definite import certify
from irb2400_ctrl.robot import ModifiedDH

pytest.importorskip("pinocchio")

ROBOTS: dict[str, Callable[[], irb.Robot]] = {"ur_like": ur_like, "kr300": kr300}
needs_kr300 = pytest.mark.skipif(not KR300.exists(), reason="measured data are not on this machine")


@pytest.fixture(scope="module", params=["ur_like", pytest.param("kr300", marks=needs_kr300)])
def arm(request: pytest.FixtureRequest) -> irb.Robot:
    return ROBOTS[request.param]()


@pytest.fixture(scope="module")
def motion(arm: irb.Robot) -> States:
    return random_states(arm, 100, seed=1)


def test_inverse_dynamics(arm: irb.Robot, motion: States) -> None:
    engine = PinArm.of(arm)
    found = irb.Model(arm).inverse_dynamics(motion.q, motion.qd, motion.qdd, friction=False)
    expected = [
        engine.inverse_dynamics(*row) for row in zip(motion.q, motion.qd, motion.qdd, strict=True)
    ]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_mass_matrix_and_forward_dynamics(arm: irb.Robot, motion: States) -> None:
    engine = PinArm.of(arm)
    model = irb.Model(arm)
    expected = np.array([engine.mass_matrix(q) for q in motion.q])
    np.testing.assert_allclose(
        model.mass_matrix(motion.q), expected, rtol=0, atol=1e-12 * np.abs(expected).max()
    )
    # the measured arm is bare, without inertia about its last axis: rotors make forward dynamics
    # possible
    rotors = [LIBRARY["rotor_inertia"].of(i + 1, inertia_kgm2=0.5) for i in range(arm.n)]
    driven = irb.Model(arm.with_effects(*rotors))
    tau = driven.inverse_dynamics(motion.q, motion.qd, motion.qdd)
    np.testing.assert_allclose(
        driven.forward_dynamics(motion.q, motion.qd, tau), motion.qdd, rtol=0, atol=1e-8
    )


def test_an_axis_without_inertia_is_named() -> None:
    arm = ur_like()
    links = list(arm.links)
    empty = links[5].body.model_copy(update={"com_m": (0.0, 0.0, 0.1), "inertia_kgm2": (0.0,) * 6})
    links[5] = links[5].model_copy(update={"body": empty})
    model = irb.Model(arm.model_copy(update={"links": tuple(links)}))
    assert np.isfinite(model.inverse_dynamics(np.ones(6), np.ones(6), np.ones(6))).all()
    with pytest.raises(InputError, match="axis 6 has no inertia"):
        model.forward_dynamics(np.ones(6), np.ones(6), np.ones(6))


def test_pose_and_jacobian(arm: irb.Robot, motion: States) -> None:
    engine = PinArm.of(arm)
    model = irb.Model(arm)
    for q in motion.q[:20]:
        X_BT, J = engine.tcp(q)
        np.testing.assert_allclose(model.tcp_pose(q), X_BT, rtol=0, atol=1e-12)
        np.testing.assert_allclose(model.tcp_jacobian(q), J, rtol=0, atol=1e-12)


def test_base_parameters(arm: irb.Robot, motion: States) -> None:
    model = irb.Model(arm)
    base = model.base_parameters
    assert base.count <= 36
    tau = model.inverse_dynamics(motion.q, motion.qd, motion.qdd, friction=False)
    Y = model.base_regressor(motion.q, motion.qd, motion.qdd)
    np.testing.assert_allclose(Y @ base.values, tau, rtol=0, atol=1e-10 * np.abs(tau).max())


def test_parallel_axes_are_found() -> None:
    assert [list(group.links) for group in chain_of(ur_like()).groups] == [[0], [1, 2, 3], [4], [5]]


def test_real_bodies_make_a_positive_definite_mass_matrix() -> None:
    found = certify(ur_like())
    assert found.shown
    assert found.reason == "no body has a negative principal moment"


def test_an_arm_of_no_family_has_no_factors() -> None:
    robot = ur_like()
    skew = robot.links[4].model_copy(update={"frame": ModifiedDH(a_m=0.1, alpha_rad=1.0, d_m=0.2)})
    changed = robot.model_copy(update={"links": (*robot.links[:4], skew, robot.links[5])})
    with pytest.raises(InputError, match=r"no closed-form .* not at right angles"):
        irb.Model(changed).singularity_factors(np.zeros(6))


def test_a_file_of_it_loads_again(tmp_path: Path) -> None:
    robot = ur_like()
    assert irb.load_robot(irb.save_robot(robot, tmp_path / "ur.toml")) == robot
