"""Slips of the paper's print in its dynamics (docs/paper_errata.md): the printed form fails, the
corrected one holds."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np
import numpy.typing as npt
import pytest
from model import printed_dynamics as dynamics
from model import printed_kinematics as eq
from model.states import States

import irb2400_ctrl as irb
from irb2400_ctrl.model import euler_lagrange

Array = npt.NDArray[np.float64]
Element = Callable[[eq.Angles], float]


class TestEnergies:
    def test_eq_46_lacks_the_half_on_rotation(self, model: irb.Model, states: States) -> None:
        q = states.q[0]
        qd = states.qd[0]
        expected = 0.5 * qd @ model.mass_matrix(q) @ qd
        assert dynamics.kinetic_energy(model.robot, q, qd) == pytest.approx(expected, rel=1e-7)
        printed = dynamics.kinetic_energy(
            model.robot, q, qd, dynamics.Print(kinetic_rotation_not_halved=True)
        )
        assert abs(printed - expected) > 0.01 * expected

    def test_eq_46_lacks_the_sum(self, model: irb.Model, states: States) -> None:
        """The one term that is printed, of whichever link, is not half qd^T M qd."""
        q = states.q[0]
        qd = states.qd[0]
        total = dynamics.kinetic_energy(model.robot, q, qd)
        for link in range(6):
            links = list(model.robot.links)
            body = links[link].body
            links[link] = links[link].model_copy(
                update={
                    "body": body.model_copy(update={"mass_kg": 0.0, "inertia_kgm2": (0.0,) * 6})
                }
            )
            without = dynamics.kinetic_energy(
                model.robot.model_copy(update={"links": tuple(links)}), q, qd
            )
            assert abs(total - without) < 0.95 * total

    def test_eqs_48_and_50_sum_over_the_links_and_forget_the_tool(
        self, model: irb.Model, states: States
    ) -> None:
        """n = 6 bodies in section 5, while eqs. 62, 63 of section 6 carry the spindle: the methods
        would disagree."""
        robot = model.robot
        q = ca.SX.sym("q", 6)
        terms = [
            ca.Function(
                "terms", [q], [euler_lagrange.mass_matrix(arm, q), euler_lagrange.gravity(arm, q)]
            )
            for arm in (robot, robot.model_copy(update={"tool": None}))
        ]
        for position in states.q[:5]:
            with_tool, without = ([np.array(term) for term in f(position)] for f in terms)
            at_rest = dynamics.joint_torques(robot, position, np.zeros(6), np.zeros(6))
            np.testing.assert_allclose(
                robot.A.T @ at_rest, with_tool[1].ravel(), rtol=0, atol=1e-10
            )
            assert np.abs(without[1].ravel() - with_tool[1].ravel()).max() > 10.0
            assert np.abs(without[0] - with_tool[0]).max() > 1.0

    def test_eq_48_has_the_sign_of_an_upward_g(self, model: irb.Model, states: States) -> None:
        """With the g of eqs. 58-64, which points down, G = dP/dq (eq. 52) comes out with the wrong
        sign."""
        step = 1e-6
        for q in states.q[:5]:
            printed = np.array(
                [
                    (
                        dynamics.potential_energy_printed(model.robot, q + step * e)
                        - dynamics.potential_energy_printed(model.robot, q - step * e)
                    )
                    / (2 * step)
                    for e in np.eye(6)
                ]
            )
            G = model.gravity(q)
            np.testing.assert_allclose(-printed, G, rtol=0, atol=1e-5)
            assert np.abs(printed - G).max() > 1.0

    def test_eq_49_prints_the_speed_for_the_acceleration(
        self, model: irb.Model, states: States
    ) -> None:
        q = states.q[0]
        qd = states.qd[0]
        qdd = states.qdd[0]
        M = model.mass_matrix(q)
        rest = model.coriolis(q, qd) @ qd + model.gravity(q)
        tau = model.inverse_dynamics(q, qd, qdd, friction=False)
        np.testing.assert_allclose(M @ qdd + rest, tau, rtol=0, atol=1e-10)
        assert np.abs(M @ qd + rest - tau).max() > 10.0


class TestRecursion:
    @pytest.fixture(scope="class")
    @classmethod
    def state(cls, states: States) -> tuple[Array, Array, Array]:
        return states.q[1], states.qd[1], states.qdd[1]

    def test_corrected_recursion_is_the_library(self, model: irb.Model, states: States) -> None:
        for q, qd, qdd in zip(states.q[:20], states.qd[:20], states.qdd[:20], strict=True):
            tau_theta = dynamics.joint_torques(model.robot, q, qd, qdd)
            expected = model.inverse_dynamics(q, qd, qdd, friction=False)
            np.testing.assert_allclose(model.robot.A.T @ tau_theta, expected, rtol=0, atol=1e-10)

    def test_u_i_is_not_the_projection_on_axis_i(
        self, model: irb.Model, state: tuple[Array, Array, Array]
    ) -> None:
        """Below eq. 57; the motor of axis 2 does not feel axis 3: u_2 = tau_z2 - tau_z3 (tau = A^T
        tau_theta)."""
        tau_z = dynamics.joint_torques(model.robot, *state)
        u = model.inverse_dynamics(*state, friction=False)
        assert abs(tau_z[1] - u[1]) > 10.0
        assert tau_z[1] - tau_z[2] == pytest.approx(u[1], abs=1e-10)
        np.testing.assert_allclose(tau_z[[0, 2, 3, 4, 5]], u[[0, 2, 3, 4, 5]], rtol=0, atol=1e-10)

    def test_eqs_59_and_61_load_friction_on_the_joints_below(
        self, model: irb.Model, state: tuple[Array, Array, Array]
    ) -> None:
        """Friction is an inner torque of joint i: its reaction on link i - 1 is missing in the
        print."""
        q, qd, qdd = state
        A = model.robot.A
        F = model.friction(qd)
        on_joints = np.linalg.solve(A.T, F)
        expected = model.inverse_dynamics(q, qd, qdd)
        right = dynamics.joint_torques(model.robot, q, qd, qdd, dynamics.Print(friction=on_joints))
        np.testing.assert_allclose(A.T @ right, expected, rtol=0, atol=1e-10)
        form = dynamics.Print(friction=on_joints, friction_carried_down=True)
        printed = A.T @ dynamics.joint_torques(model.robot, q, qd, qdd, form)
        assert np.abs(printed - expected).max() > 5.0
        # axis 4 would carry the friction of axis 6 by the cosine of q5 (axes 4 and 6 are parallel
        # at q5 = 0)
        assert printed[3] - expected[3] == pytest.approx(np.cos(q[4]) * F[5], abs=1e-9)

    def test_text_below_fig_6_turns_the_force_of_the_next_link_round(
        self, model: irb.Model, state: tuple[Array, Array, Array]
    ) -> None:
        """f_(i+1) as 'exerted by link i+1 on link i' would enter eqs. 58, 59 with the other
        sign."""
        form = dynamics.Print(force_of_the_next_link_as_described=True)
        printed = model.robot.A.T @ dynamics.joint_torques(model.robot, *state, form)
        assert np.abs(printed - model.inverse_dynamics(*state, friction=False)).max() > 10.0

    def test_eq_64_needs_the_transpose(
        self, model: irb.Model, state: tuple[Array, Array, Array]
    ) -> None:
        form = dynamics.Print(gravity_without_transpose=True)
        printed = model.robot.A.T @ dynamics.joint_torques(model.robot, *state, form)
        assert np.abs(printed - model.inverse_dynamics(*state, friction=False)).max() > 10.0
