"""Newton-Euler and Euler-Lagrange: two independent derivations, one dynamics (end of section 6 of
the paper)."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from model.states import States

import irb2400_ctrl as irb
from irb2400_ctrl.model import euler_lagrange


@pytest.fixture(scope="module")
def lagrange(robot: irb.Robot) -> ca.Function:
    q, qd, qdd = (ca.SX.sym(name, robot.n) for name in ("q", "qd", "qdd"))
    M = euler_lagrange.mass_matrix(robot, q)
    C = euler_lagrange.coriolis(robot, q, qd)
    G = euler_lagrange.gravity(robot, q)
    outputs = [M @ qdd + C @ qd + G, M, C @ qd, G]
    return ca.Function("lagrange", [q, qd, qdd], [ca.cse(out) for out in outputs])


def relative(found: np.ndarray, expected: np.ndarray) -> float:
    return float(np.abs(found - expected).max() / np.abs(expected).max())


def test_torques_agree_to_1e_10(model: irb.Model, lagrange: ca.Function, states: States) -> None:
    expected = np.array(lagrange(states.q.T, states.qd.T, states.qdd.T)[0]).T
    found = model.inverse_dynamics(states.q, states.qd, states.qdd, friction=False)
    assert relative(found, expected) < 1e-10


def test_terms_agree_to_1e_10(model: irb.Model, lagrange: ca.Function, states: States) -> None:
    for q, qd in zip(states.q[:20], states.qd[:20], strict=True):
        _, M, C_qd, G = (np.array(out) for out in lagrange(q, qd, np.zeros(6)))
        assert relative(model.mass_matrix(q), M) < 1e-10
        assert relative(model.gravity(q), G.ravel()) < 1e-10
        assert relative(model.coriolis(q, qd) @ qd, C_qd.ravel()) < 1e-10
        bias = model.inverse_dynamics(q, qd, np.zeros(6), friction=False)
        assert relative(bias, (C_qd + G).ravel()) < 1e-10


def test_lagrange_equation_itself_agrees(
    robot: irb.Robot, model: irb.Model, states: States
) -> None:
    """Eq. 44 straight from the energies, without the mass matrix and the Christoffel symbols."""
    symbols = [ca.SX.sym(name, robot.n) for name in ("q", "qd", "qdd")]
    lagrange = ca.Function(
        "lagrange", symbols, [ca.cse(euler_lagrange.lagrange_equation(robot, *symbols))]
    )
    expected = np.array(lagrange(states.q.T, states.qd.T, states.qdd.T)).T
    found = model.inverse_dynamics(states.q, states.qd, states.qdd, friction=False)
    assert relative(found, expected) < 1e-10


def test_kinetic_energy_is_half_qd_m_qd(robot: irb.Robot, model: irb.Model, states: States) -> None:
    q = ca.SX.sym("q", 6)
    qd = ca.SX.sym("qd", 6)
    kinetic = ca.Function("kinetic", [q, qd], [euler_lagrange.kinetic(robot, q, qd)])
    expected = 0.5 * np.einsum("ni,nij,nj->n", states.qd, model.mass_matrix(states.q), states.qd)
    np.testing.assert_allclose(
        np.array(kinetic(states.q.T, states.qd.T)).ravel(), expected, rtol=1e-12
    )
