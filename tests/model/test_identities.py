"""Identities that hold for every state, whatever the numbers of the robot file."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from model.states import States

import irb2400_ctrl as irb
from irb2400_ctrl.model import euler_lagrange
from irb2400_ctrl.robot.link import Transform


def test_mass_matrix_is_symmetric(model: irb.Model, states: States) -> None:
    M = model.mass_matrix(states.q)
    np.testing.assert_array_equal(M, M.transpose(0, 2, 1))


def test_mdot_minus_2c_is_skew(model: irb.Model, states: States) -> None:
    q = ca.SX.sym("q", 6)
    qd = ca.SX.sym("qd", 6)
    M = ca.vec(model.mass_matrix(q))
    rate = ca.Function("rate", [q, qd], [ca.reshape(ca.jtimes(M, q, qd), 6, 6)])
    for position, speed in zip(states.q[:50], states.qd[:50], strict=True):
        N = np.array(rate(position, speed)) - 2 * model.coriolis(position, speed)
        np.testing.assert_allclose(N, -N.T, rtol=0, atol=1e-11 * np.abs(N).max())


def test_a_parallel_axis_may_stand_beside_its_links_line() -> None:
    """A step between parallel axes that has a y, which no robot of the library has: M is still what
    acceleration needs, and what the speeds' energy is the form of."""
    robot = irb.load_robot("irb2400")
    aside = robot.links[2].frame.matrix().copy()
    assert aside[1, 3] == 0.0
    aside[1, 3] = 0.13
    frame = Transform(transform=tuple(tuple(row) for row in aside.tolist()))  # type: ignore[arg-type]
    links = (*robot.links[:2], robot.links[2].model_copy(update={"frame": frame}), *robot.links[3:])
    model = irb.Model(robot.model_copy(update={"links": links}))
    rng = np.random.default_rng(2)
    still = np.zeros(6)
    for q in rng.uniform(robot.q_min, robot.q_max, (20, 6)):
        M = model.mass_matrix(q)
        weight = model.inverse_dynamics(q, still, still, friction=False)
        columns = [model.inverse_dynamics(q, still, e, friction=False) - weight for e in np.eye(6)]
        np.testing.assert_allclose(M, np.transpose(columns), rtol=0, atol=1e-10)
    straight = irb.Model(robot).mass_matrix(q)
    assert np.abs(M - straight).max() > 0.1


def test_m22_does_not_depend_on_the_pose(model: irb.Model, states: States) -> None:
    """A consequence of the parallelogram: q2 turns link 2 only and carries the rest along without
    turning it."""
    assert np.ptp(model.mass_matrix(states.q)[:, 1, 1]) < 1e-12


@pytest.mark.parametrize("friction", [True, False])
def test_forward_after_inverse_is_identity(
    model: irb.Model, states: States, friction: bool
) -> None:
    tau = model.inverse_dynamics(states.q, states.qd, states.qdd, friction=friction)
    qdd = model.forward_dynamics(states.q, states.qd, tau, friction=friction)
    np.testing.assert_allclose(qdd, states.qdd, rtol=0, atol=1e-9)


def test_torque_is_the_sum_of_its_terms(model: irb.Model, states: States) -> None:
    for q, qd, qdd in zip(states.q[:50], states.qd[:50], states.qdd[:50], strict=True):
        terms = (
            model.mass_matrix(q) @ qdd
            + model.coriolis(q, qd) @ qd
            + model.gravity(q)
            + model.friction(qd)
        )
        np.testing.assert_allclose(model.inverse_dynamics(q, qd, qdd), terms, rtol=0, atol=1e-10)


def test_jacobian_is_the_derivative_of_the_pose(model: irb.Model, states: States) -> None:
    q = ca.SX.sym("q", 6)
    qd = ca.SX.sym("qd", 6)
    X = model.tcp_pose(q)
    R = X[:3, :3]
    p = X[:3, 3]
    S = ca.reshape(ca.jtimes(ca.vec(R), q, qd), 3, 3) @ R.T
    twist = ca.vertcat(ca.jtimes(p, q, qd), S[2, 1], S[0, 2], S[1, 0])
    derivative = ca.Function("twist", [q, qd], [twist])
    for position, speed in zip(states.q[:50], states.qd[:50], strict=True):
        expected = np.array(derivative(position, speed)).ravel()
        np.testing.assert_allclose(
            model.tcp_jacobian(position) @ speed, expected, rtol=0, atol=1e-12
        )


def test_external_torque_does_the_work_of_the_wrench(model: irb.Model, states: States) -> None:
    """Virtual work: tau_ext . qd = F . v + N . omega for every motion (v, omega by differences of
    the pose)."""
    rng = np.random.default_rng(1)
    step = 1e-6
    for q, qd in zip(states.q[:20], states.qd[:20], strict=True):
        wrench = rng.normal(size=6) * 100
        before = model.tcp_pose(q - step * qd)
        after = model.tcp_pose(q + step * qd)
        v = (after[:3, 3] - before[:3, 3]) / (2 * step)
        S = (after[:3, :3] - before[:3, :3]) @ model.tcp_pose(q)[:3, :3].T / (2 * step)
        omega = np.array([S[2, 1], S[0, 2], S[1, 0]])
        work = wrench[:3] @ v + wrench[3:] @ omega
        assert model.external_torque(q, wrench) @ qd == pytest.approx(work, abs=1e-5)


class TestFreeSwing:
    """The arm released from a pose with the motors off, integrated by fourth-order Runge-Kutta."""

    @staticmethod
    def energy(model: irb.Model) -> ca.Function:
        q = ca.SX.sym("q", 6)
        qd = ca.SX.sym("qd", 6)
        robot = model.robot
        energy = euler_lagrange.kinetic(robot, q, qd) + euler_lagrange.potential(robot, q)
        return ca.Function("energy", [q, qd], [energy])

    @staticmethod
    def swing(model: irb.Model, steps: int, friction: bool) -> tuple[np.ndarray, np.ndarray]:
        """(states (13, steps + 1)) of q, qd and the work of friction."""
        x = ca.MX.sym("x", 13)

        def rate(x: ca.MX) -> ca.MX:
            q = x[:6]
            qd = x[6:12]
            qdd = model.forward_dynamics(q, qd, ca.MX.zeros(6), friction=friction)
            return ca.vertcat(qd, qdd, ca.dot(qd, model.friction(qd)) if friction else 0)

        # with friction: so short that no joint comes to rest, where the law jumps and the
        # integrator loses its order
        h = (0.01 if friction else 0.4) / steps
        k1 = rate(x)
        k2 = rate(x + h / 2 * k1)
        k3 = rate(x + h / 2 * k2)
        k4 = rate(x + h * k3)
        step = ca.Function("step", [x], [x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)])
        start = np.array([0.3, 0.4, -0.2, 0.5, 0.8, 0.1, *[0.5, -0.4, 0.3, 3.0, -4.0, 5.0], 0.0])
        return start, np.array(step.mapaccum(steps)(start))

    def test_energy_is_conserved_to_fourth_order(self, model: irb.Model) -> None:
        energy = self.energy(model)
        drift = []
        for steps in (50, 100, 200):
            start, path = self.swing(model, steps, friction=False)
            drift.append(
                abs(float(energy(path[:6, -1], path[6:12, -1]) - energy(start[:6], start[6:12])))
            )
        orders = np.log2(np.array(drift[:-1]) / np.array(drift[1:]))
        assert (orders > 3.5).all()
        kinetic = float(energy(path[:6, -1], path[6:12, -1]) - energy(path[:6, -1], np.zeros(6)))
        assert drift[-1] < 1e-6 * kinetic

    def test_friction_takes_the_energy_that_is_missing(self, model: irb.Model) -> None:
        energy = self.energy(model)
        start, path = self.swing(model, 100, friction=True)
        lost = float(energy(start[:6], start[6:12]) - energy(path[:6, -1], path[6:12, -1]))
        work = path[12, -1]
        assert (np.sign(path[6:12]) == np.sign(path[6:12, :1])).all(), "a joint came to rest"
        assert work > 1.0
        assert lost == pytest.approx(work, rel=1e-6)
