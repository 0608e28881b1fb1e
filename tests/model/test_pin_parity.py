"""Parity with Pinocchio (the `pin` wheel of the test extra)."""

from __future__ import annotations

import numpy as np
import pytest
from model.pin_arm import PinArm
from model.states import States

import irb2400_ctrl as irb

pytest.importorskip("pinocchio")


@pytest.fixture(scope="module")
def engine(robot: irb.Robot) -> PinArm:
    return PinArm.of(robot)


def test_inverse_dynamics(model: irb.Model, engine: PinArm, states: States) -> None:
    found = model.inverse_dynamics(states.q, states.qd, states.qdd, friction=False)
    expected = [
        engine.inverse_dynamics(*row) for row in zip(states.q, states.qd, states.qdd, strict=True)
    ]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("mounted", ["on a wall", "without its tool"])
def test_inverse_dynamics_otherwise_mounted(robot: irb.Robot, states: States, mounted: str) -> None:
    """Regrouping drops what a vertical axis 1 or this tool hides; another arm must not lose it."""
    change = {"gravity_m_s2": (6.0, -7.0, -3.0)} if mounted == "on a wall" else {"tool": None}
    arm = robot.model_copy(update=change)
    engine = PinArm.of(arm)
    model = irb.Model(arm)
    found = model.inverse_dynamics(states.q, states.qd, states.qdd, friction=False)
    expected = [
        engine.inverse_dynamics(*row) for row in zip(states.q, states.qd, states.qdd, strict=True)
    ]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
    masses = np.array([engine.mass_matrix(q) for q in states.q[:20]])
    np.testing.assert_allclose(
        model.mass_matrix(states.q[:20]), masses, rtol=0, atol=1e-12 * masses.max()
    )


def test_forward_dynamics(model: irb.Model, engine: PinArm, states: States) -> None:
    tau = model.inverse_dynamics(states.q, states.qd, states.qdd, friction=False)
    found = model.forward_dynamics(states.q, states.qd, tau, friction=False)
    expected = [engine.forward_dynamics(*row) for row in zip(states.q, states.qd, tau, strict=True)]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * np.abs(expected).max())


def test_mass_matrix(model: irb.Model, engine: PinArm, states: States) -> None:
    expected = np.array([engine.mass_matrix(q) for q in states.q])
    np.testing.assert_allclose(
        model.mass_matrix(states.q), expected, rtol=0, atol=1e-12 * np.abs(expected).max()
    )


def test_pose_and_jacobian(model: irb.Model, engine: PinArm, states: States) -> None:
    for q in states.q:
        X_BT, J = engine.tcp(q)
        np.testing.assert_allclose(model.tcp_pose(q), X_BT, rtol=0, atol=1e-14)
        np.testing.assert_allclose(model.tcp_jacobian(q), J, rtol=0, atol=1e-14)
