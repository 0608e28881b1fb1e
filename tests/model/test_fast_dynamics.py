"""The dynamics with few operations: what they cost, and that nothing was lost on the way."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from model.states import States, random_states

import irb2400_ctrl as irb
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.model import newton_euler
from irb2400_ctrl.model.bodies import parameters, regrouped
from irb2400_ctrl.model.linear_solve import factorise

# function -> most SX instructions (inputs, outputs and constants counted: Function.n_instructions)
BUDGET = {
    "inverse_dynamics_without_friction": 600,
    "mass_matrix": 420,
    "forward_dynamics_without_friction": 1050,
    "forward_dynamics_derivatives": 5500,
}


@pytest.mark.parametrize("name", BUDGET)
def test_instructions_stay_in_the_budget(model: irb.Model, name: str) -> None:
    assert model.function(name).n_instructions() <= BUDGET[name]


def test_regrouping_leaves_the_torque_unchanged(robot: irb.Robot, states: States) -> None:
    """The same recursion with the parameters as they stand (symbols are not regrouped) and
    regrouped (numbers are)."""
    symbols = [ca.SX.sym(name, 6) for name in ("q", "qd", "qdd")]
    phi = ca.SX.sym("phi", 6, 10)
    plain = ca.Function(
        "plain", [*symbols, phi], [newton_euler.inverse_dynamics(robot, *symbols, phi)]
    )
    short = ca.Function("short", symbols, [newton_euler.inverse_dynamics(robot, *symbols)])
    assert short.n_instructions() < plain.n_instructions()
    expected = np.array(
        plain(states.q.T, states.qd.T, states.qdd.T, ca.repmat(robot.inertial_parameters, 1, 200))
    )
    found = np.array(short(states.q.T, states.qd.T, states.qdd.T))
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_regrouped_links_hold_the_36_base_parameters(robot: irb.Robot) -> None:
    bodies = regrouped(robot, robot.inertial_parameters)
    felt = [np.count_nonzero(np.triu(J)) for J in bodies]
    # link 1: its moment about axis 1, and a first moment that a vertical axis does not feel
    assert felt[1:] == [7] * 5
    assert np.count_nonzero(bodies[0][:3, :3]) == 1
    assert all(J[3, 3] == 0 for J in bodies)


def test_regrouped_parameters_map_to_the_same_base_values(model: irb.Model) -> None:
    phi = np.array([parameters(J) for J in regrouped(model.robot, model.robot.inertial_parameters)])
    base = model.base_parameters
    np.testing.assert_allclose(base.matrix @ phi.ravel(), base.values, rtol=0, atol=1e-9)


class TestBaseParameters:
    def test_there_are_36(self, model: irb.Model) -> None:
        assert model.base_parameters.count == 36
        assert len(set(model.base_parameters.names)) == 36

    def test_torque_is_linear_in_them(self, model: irb.Model, states: States) -> None:
        Y = model.base_regressor(states.q, states.qd, states.qdd)
        tau = model.inverse_dynamics(states.q, states.qd, states.qdd, friction=False)
        assert Y.shape == (200, 6, 36)
        scale = np.abs(tau).max()
        np.testing.assert_allclose(
            Y @ model.base_parameters.values, tau, rtol=0, atol=1e-10 * scale
        )

    def test_none_is_dispensable(self, model: irb.Model, states: States) -> None:
        Y = model.base_regressor(states.q, states.qd, states.qdd).reshape(-1, 36)
        singular = np.linalg.svd(Y / np.linalg.norm(Y, axis=0), compute_uv=False)
        assert singular[-1] > 1e-4

    def test_standard_regressor_has_the_same_rank(self, model: irb.Model, states: States) -> None:
        Y = model.regressor(states.q, states.qd, states.qdd).reshape(-1, 60)
        tau = model.inverse_dynamics(states.q, states.qd, states.qdd, friction=False).ravel()
        np.testing.assert_allclose(
            Y @ model.robot.inertial_parameters.ravel(), tau, rtol=0, atol=1e-9
        )
        assert np.linalg.matrix_rank(Y, tol=1e-9 * np.linalg.norm(Y)) == 36

    def test_the_map_holds_for_other_masses(
        self, model: irb.Model, robot: irb.Robot, states: States
    ) -> None:
        heavy = irb.Model(
            robot.with_effects(LIBRARY["payload"].of(None, mass_kg=9.0, com_m=(0.1, -0.05, 0.2)))
        )
        tau = heavy.inverse_dynamics(states.q, states.qd, states.qdd, friction=False)
        values = model.base_parameters.matrix @ np.asarray(heavy.phi).ravel()
        Y = model.base_regressor(states.q, states.qd, states.qdd)
        np.testing.assert_allclose(Y @ values, tau, rtol=0, atol=1e-10 * np.abs(tau).max())

    def test_each_can_be_explained(self, model: irb.Model) -> None:
        base = model.base_parameters
        assert base.explain(base.names.index("Ixx_6")) == "Ixx_6 - Iyy_6"
        assert "m_6" in base.explain(base.names.index("mx_2"))


@pytest.fixture(scope="module", params=["no effect", "load_friction", "rotor_inertia"])
def arm(request: pytest.FixtureRequest, robot: irb.Robot) -> irb.Model:
    """Without effects, with one that bends the law in the acceleration, with one that adds to the
    mass matrix."""
    if request.param == "load_friction":
        return irb.Model(robot.with_effects(LIBRARY["load_friction"].of(2, coefficient=0.06)))
    if request.param == "rotor_inertia":
        return irb.Model(robot.with_effects(LIBRARY["rotor_inertia"].of(2, inertia_kgm2=5.0)))
    return irb.Model(robot)


class TestDerivatives:
    """Forward dynamics' derivatives by the implicit function theorem."""

    def test_against_central_differences(self, arm: irb.Model) -> None:
        states = random_states(arm.robot, 5, seed=3)
        f = arm.function("forward_dynamics_derivatives")
        step = 1e-6
        for q, qd, qdd in zip(states.q, states.qd, states.qdd, strict=True):
            tau = arm.inverse_dynamics(q, qd, qdd)
            found = [np.array(out) for out in f(q, qd, tau, 0.0)]
            np.testing.assert_allclose(found[0].ravel(), qdd, rtol=0, atol=1e-7)
            for position, expected in enumerate(found[1:]):
                differences = np.empty((6, 6))
                for k in range(6):
                    low = [q, qd, tau]
                    high = [q, qd, tau]
                    h = step * (100.0 if position == 2 else 1.0)
                    shift = h * np.eye(6)[k]
                    low[position] = low[position] - shift
                    high[position] = high[position] + shift
                    differences[:, k] = (
                        arm.forward_dynamics(*high) - arm.forward_dynamics(*low)
                    ) / (2 * h)
                np.testing.assert_allclose(
                    expected, differences, rtol=2e-5, atol=2e-5 * np.abs(differences).max()
                )

    def test_mobility_is_the_inverse_of_the_mass_matrix(
        self, model: irb.Model, states: States
    ) -> None:
        f = model.function("forward_dynamics_derivatives_without_friction")
        for q in states.q[:10]:
            mobility = np.array(f(q, np.zeros(6), np.zeros(6), 0.0)[3])
            np.testing.assert_allclose(
                mobility @ model.mass_matrix(q), np.eye(6), rtol=0, atol=1e-10
            )


def test_factors_give_back_the_matrix() -> None:
    rng = np.random.default_rng(0)
    root = rng.normal(size=(5, 5))
    A = root @ root.T + np.eye(5)
    b = rng.normal(size=(5, 3))
    x = np.array(ca.evalf(factorise(ca.SX(A)).solve(ca.SX(b))))
    np.testing.assert_allclose(A @ x, b, rtol=0, atol=1e-11)


class TestWrench:
    """An external wrench at the TCP is an input of the dynamics."""

    def test_it_takes_its_share_of_the_torque(self, model: irb.Model, states: States) -> None:
        wrench = np.random.default_rng(2).normal(size=(200, 6)) * 100
        with_it = model.inverse_dynamics(states.q, states.qd, states.qdd, wrench=wrench)
        without = model.inverse_dynamics(states.q, states.qd, states.qdd)
        J = model.tcp_jacobian(states.q)
        expected = without - np.einsum("nji,nj->ni", J, wrench)
        np.testing.assert_allclose(with_it, expected, rtol=0, atol=1e-10)

    def test_forward_undoes_inverse(self, model: irb.Model, states: States) -> None:
        wrench = np.array([30.0, -20.0, 100.0, 5.0, -4.0, 3.0])
        tau = model.inverse_dynamics(states.q, states.qd, states.qdd, wrench=wrench)
        found = model.forward_dynamics(states.q, states.qd, tau, wrench=wrench)
        np.testing.assert_allclose(found, states.qdd, rtol=0, atol=1e-9)

    def test_symbolic_functions_take_it_too(self, model: irb.Model, states: States) -> None:
        q = states.q[0]
        qd = states.qd[0]
        qdd = states.qdd[0]
        wrench = np.array([30.0, -20.0, 100.0, 5.0, -4.0, 3.0])
        tau = np.array(
            model.function("inverse_dynamics_with_wrench")(q, qd, qdd, wrench, 0.0)
        ).ravel()
        np.testing.assert_allclose(
            tau, model.inverse_dynamics(q, qd, qdd, wrench=wrench), rtol=0, atol=1e-10
        )
        back = np.array(
            model.function("forward_dynamics_with_wrench")(q, qd, tau, wrench, 0.0)
        ).ravel()
        np.testing.assert_allclose(back, qdd, rtol=0, atol=1e-9)

    def test_a_weight_in_the_tool_is_a_force_at_the_tcp(
        self, robot: irb.Robot, states: States
    ) -> None:
        """A point mass at the TCP at rest and the force of its weight are the same torque."""
        place = tuple(robot.X_FT[:3, 3])
        loaded = irb.Model(
            robot.with_effects(LIBRARY["payload"].of(None, mass_kg=8.0, com_m=place))
        )
        weight = np.array([0.0, 0.0, -8.0 * 9.81, 0.0, 0.0, 0.0])
        zero = np.zeros(6)
        plain = irb.Model(robot)
        for q in states.q[:20]:
            held = plain.inverse_dynamics(q, zero, zero, friction=False, wrench=weight)
            np.testing.assert_allclose(loaded.gravity(q), held, rtol=0, atol=1e-9)
