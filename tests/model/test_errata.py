"""Every slip of the paper's print in docs/paper_errata.md: the printed form fails, the corrected
one holds."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from model import printed_dynamics as dynamics
from model import printed_kinematics as eq
from model.states import States

import irb2400_ctrl as irb
from irb2400_ctrl.robot import ModifiedDH

Array = npt.NDArray[np.float64]
Element = Callable[[eq.Angles], float]


class TestFrames:
    @pytest.mark.parametrize(
        ("number", "printed"),
        [(1, eq.eq_3), (2, eq.eq_4), (3, eq.eq_5), (4, eq.eq_6), (5, eq.eq_7), (6, eq.eq_8)],
    )
    def test_eqs_3_to_8_are_eq_2_with_table_2(
        self, robot: irb.Robot, states: States, number: int, printed: Callable[[eq.Angles], Array]
    ) -> None:
        frame = robot.links[number - 1].frame
        assert isinstance(frame, ModifiedDH)
        for q in states.q[:20]:
            theta = (robot.A @ q + robot.offset)[number - 1]
            expected = eq.eq_2(frame.a_m, frame.alpha_rad, frame.d_m, theta)
            np.testing.assert_allclose(printed(eq.Angles.of(q)), expected, rtol=0, atol=1e-15)

    def test_eq_6_prints_a_plus_where_a_minus_stands(self, states: States) -> None:
        wrong = eq.eq_6_printed(eq.Angles.of(states.q[0]))[:3, :3]
        assert np.abs(wrong @ wrong.T - np.eye(3)).max() > 0.1, (
            "the printed matrix would be a rotation"
        )

    def test_table_2_heads_its_columns_with_the_subscript_of_the_link_before(
        self, robot: irb.Robot, states: States
    ) -> None:
        """Read literally (a_i, alpha_i in the row of link i) eq. 2 would take them from the row
        above."""
        v = eq.Angles.of(states.q[0])
        theta = (robot.A @ states.q[0] + robot.offset)[1]
        literal = eq.eq_2(0.0, 0.0, 0.0, theta)
        assert np.abs(literal - eq.eq_4(v)).max() > 0.1
        np.testing.assert_allclose(
            eq.eq_2(0.1, -np.pi / 2, 0.0, theta), eq.eq_4(v), rtol=0, atol=1e-15
        )

    def test_x_i_meets_the_next_axis_not_the_one_before(self, states: States) -> None:
        """Section 3 says that x_i intersects z_(i-1): the rule of the classic convention, not of
        the modified one."""
        X = dynamics.poses(states.q[0])
        assert line_distance(X[3], 0, X[2], 2) > 1e-3, "x_4 would meet z_3"
        for i in range(5):
            assert line_distance(X[i], 0, X[i + 1], 2) < 1e-12

    def test_eq_10_holds_o_T_in_7_not_o_7_in_T(self, robot: irb.Robot) -> None:
        """The sentence before eq. 10 names o_7^T, the position of frame 7 in the tool's frame."""
        o_T_in_7 = robot.X_FT[:3, 3]
        R = robot.X_FT[:3, :3]
        o_7_in_T = -R.T @ o_T_in_7
        expected = eq.eq_12(eq.Angles.of(np.zeros(6)))[:3, 3]
        np.testing.assert_array_equal(o_T_in_7, expected)
        assert np.abs(o_7_in_T - expected).max() > 0.1


def line_distance(X: Array, axis: int, Y: Array, other: int) -> float:
    """Distance between two axes as infinite lines [m]."""
    u = X[:3, axis]
    v = Y[:3, other]
    between = Y[:3, 3] - X[:3, 3]
    normal = np.cross(u, v)
    if np.linalg.norm(normal) < 1e-12:
        return float(np.linalg.norm(between - (between @ u) * u))
    return float(abs(between @ normal) / np.linalg.norm(normal))


# number of the equation -> (element of X_BT, corrected, printed when it differs)
ELEMENTS: dict[int, tuple[tuple[int, int], Element, Element | None]] = {
    15: ((0, 0), eq.eq_15, None),
    16: ((0, 1), eq.eq_16, None),
    17: ((0, 2), eq.eq_17, None),
    18: ((1, 0), eq.eq_18, None),
    19: ((1, 1), eq.eq_19, eq.eq_19_printed),
    20: ((1, 2), eq.eq_20, None),
    21: ((2, 0), eq.eq_21, None),
    22: ((2, 1), eq.eq_22, eq.eq_22_printed),
    23: ((2, 2), eq.eq_23, None),
    24: ((0, 3), eq.eq_24, None),
    25: ((1, 3), eq.eq_25, None),
    26: ((2, 3), eq.eq_26, eq.eq_26_printed),
}


class TestPose:
    """Eqs. 15-26 against the chain product of eqs. 3-12."""

    @staticmethod
    def product(v: eq.Angles) -> Array:
        X = np.eye(4)
        for factor in (eq.eq_3, eq.eq_4, eq.eq_5, eq.eq_6, eq.eq_7, eq.eq_8, eq.eq_9, eq.eq_12):
            X = X @ factor(v)
        return X

    def test_library_is_the_chain_product(self, model: irb.Model, states: States) -> None:
        for q in states.q[:50]:
            np.testing.assert_allclose(
                model.tcp_pose(q), self.product(eq.Angles.of(q)), rtol=0, atol=1e-14
            )

    @pytest.mark.parametrize("number", ELEMENTS)
    def test_element(self, number: int, states: States) -> None:
        place, corrected, printed = ELEMENTS[number]
        errors = []
        for q in states.q[:50]:
            v = eq.Angles.of(q)
            expected = self.product(v)[place]
            assert corrected(v) == pytest.approx(expected, abs=1e-14)
            if printed is not None:
                errors.append(abs(printed(v) - expected))
        assert printed is None or max(errors) > 0.1

    @pytest.mark.parametrize(("row", "corrected"), [(0, eq.eq_24), (1, eq.eq_25), (2, eq.eq_26)])
    def test_y_T_terms(self, row: int, corrected: Callable[..., float], states: States) -> None:
        """They do not show with this spindle (y_T = 0), so they are tried with another."""
        for q in states.q[:50]:
            v = eq.Angles.of(q)
            X = self.product(v)
            assert corrected(v, 0.3) == pytest.approx(X[row, 3] + 0.3 * X[row, 1], abs=1e-14)

    def test_eq_25_prints_c_q1_for_s_q1(self, states: States) -> None:
        v = eq.Angles.of(states.q[0])
        X = self.product(v)
        assert abs(eq.eq_25_printed(v, 0.3) - X[1, 3] - 0.3 * X[1, 1]) > 1e-3


class TestSingularities:
    def test_eq_36_is_r_k_over_the_whole_box(self, model: irb.Model, states: States) -> None:
        factors = model.singularity_factors(states.q)
        found = [eq.eq_36(eq.Angles.of(q)) for q in states.q]
        np.testing.assert_allclose(found, factors[:, 1] * factors[:, 2], rtol=0, atol=1e-14)

    def test_det_j_is_the_product_of_three_factors_over_the_whole_box(
        self, model: irb.Model
    ) -> None:
        robot = model.robot
        q = np.random.default_rng(5).uniform(robot.q_min, robot.q_max, (5000, 6))
        factors = model.singularity_factors(q)
        expected = -model.arm_geometry.a2 * factors.prod(axis=1)
        np.testing.assert_allclose(
            np.linalg.det(model.tcp_jacobian(q)), expected, rtol=0, atol=1e-13
        )

    @pytest.mark.parametrize("vanishing", ["wrist", "shoulder", "elbow"])
    def test_there_are_three_singularities_not_exactly_two(
        self, model: irb.Model, vanishing: str
    ) -> None:
        """Each factor vanishes inside the joint box while the other two do not."""
        q = singular_pose(model, vanishing)
        robot = model.robot
        assert (q > robot.q_min).all()
        assert (q < robot.q_max).all()
        factors = dict(
            zip(("wrist", "shoulder", "elbow"), model.singularity_factors(q), strict=True)
        )
        assert abs(factors.pop(vanishing)) < 1e-12
        assert min(abs(value) for value in factors.values()) > 0.1
        singular = np.linalg.svd(model.tcp_jacobian(q), compute_uv=False)
        assert singular[5] < 1e-12 < 1e-3 < singular[4]

    def test_eq_36_does_not_put_the_wrist_centre_on_axis_1(self, model: irb.Model) -> None:
        """The text reads eq. 36 as 'the wrist centre meets z_B'; it also vanishes a metre away from
        that axis."""
        q = singular_pose(model, "elbow")
        assert abs(eq.eq_36(eq.Angles.of(q))) < 1e-12
        wrist = dynamics.poses(q)[3][:3, 3]
        assert np.hypot(*wrist[:2]) > 0.5

    def test_eq_35_names_axis_5_collinear_with_4_and_6(self, model: irb.Model) -> None:
        X = dynamics.poses(singular_pose(model, "wrist"))
        z4, z5, z6 = (X[i][:3, 2] for i in (3, 4, 5))
        assert np.linalg.norm(np.cross(z4, z6)) < 1e-12
        assert abs(z4 @ z5) < 1e-12


def singular_pose(model: irb.Model, kind: str) -> Array:
    """A configuration where one factor vanishes [rad]."""
    g = model.arm_geometry
    q3 = np.radians(-20.0)
    if kind == "wrist":
        return np.array([0.3, 0.2, 0.1, 0.4, 0.0, 0.2])
    if kind == "elbow":
        return np.array([0.3, q3 + np.arctan2(g.d4, g.a3), q3, 0.4, 0.8, 0.2])
    q3 = np.radians(50.0)
    q2 = np.arcsin(-(g.a1 + g.a3 * np.sin(q3) + g.d4 * np.cos(q3)) / g.a2)
    return np.array([0.3, q2, q3, 0.4, 0.8, 0.2])


class TestNumbersAndClaims:
    def test_fig_8_speed_is_beyond_the_axis_and_the_test_range(self, robot: irb.Robot) -> None:
        assert robot.qd_max[1] < 9.3
        assert np.radians(9.3) < 0.5, "9.3 deg/s lies inside the range of eq. 74"

    def test_mean_absolute_errors_are_not_3_5_percent(self) -> None:
        """Section 7: 'MAE and RMSE for joints 2 and 3 represent approximately 3.5 %'; true for the
        RMSE only."""
        mae = np.array([8.52, 2.9])
        rmse = np.array([10.89, 3.79])
        mean = np.array([319.60, 102.91])
        assert (rmse / mean > 0.034).all()
        assert (mae / mean < 0.029).all()

    def test_table_6_percentages_follow_from_its_columns(self) -> None:
        rmse = np.array([4.08, 10.89, 3.79, 1.17, 0.78, 0.81])
        mean = np.array([35.13, 319.60, 102.91, 13.69, 10.03, 8.96])
        percent = np.array([11.61, 3.41, 3.69, 8.56, 7.80, 9.06])
        half = 0.005
        assert ((rmse - half) / (mean + half) * 100 - half <= percent).all()
        assert (percent <= (rmse + half) / (mean - half) * 100 + half).all()

    def test_modified_dh_does_not_condition_the_jacobian_better(
        self, model: irb.Model, states: States
    ) -> None:
        """Section 8 claims better-conditioned Jacobians; the product of exponentials gives the very
        same matrix."""
        zero = np.zeros(6)
        axes = [(X[:3, 2], X[:3, 3]) for X in dynamics.poses(zero)[:6]]
        for q in states.q[:10]:
            theta = model.robot.A @ q
            X = np.eye(4)
            columns = []
            for (z, point), angle in zip(axes, theta, strict=True):
                columns.append((X[:3, :3] @ z, (X @ [*point, 1.0])[:3]))
                X = X @ screw(z, point, angle)
            tip = (X @ model.tcp_pose(zero))[:3, 3]
            J = np.array([[*np.cross(z, tip - o), *z] for z, o in columns]).T @ model.robot.A
            np.testing.assert_allclose(model.tcp_jacobian(q), J, rtol=0, atol=1e-13)

    def test_constant_speed_of_one_joint_leaves_friction_and_gravity(
        self, model: irb.Model, states: States
    ) -> None:
        """Eq. 70 is right for this arm: a joint that moves alone feels no velocity product of its
        own."""
        for q in states.q[:10]:
            for i in range(6):
                qd = 2.0 * np.eye(6)[i]
                assert abs((model.coriolis(q, qd) @ qd)[i]) < 1e-10

    def test_eqs_54_and_55_agree(self, model: irb.Model) -> None:
        static, coulomb, viscous, stribeck = model.robot.friction.T
        for qd in np.random.default_rng(1).normal(0, 0.02, (20, 6)):
            eq_54 = (
                coulomb + (static - coulomb) * np.exp(-(np.abs(qd) ** 2) / stribeck**2)
            ) * np.sign(qd)
            np.testing.assert_allclose(model.friction(qd), eq_54 + viscous * qd, rtol=0, atol=1e-12)

    def test_eqs_37_to_42_and_table_3_are_different_arms(
        self, model: irb.Model, reference: dict[str, Array]
    ) -> None:
        s = reference
        difference = s["tau_rigid"] - s["tau_rigid_com_in_symmetry_plane"]
        assert np.abs(difference).max() > 1.0


def screw(z: Array, point: Array, angle: float) -> Array:
    """Turn by `angle` about the axis through `point` along z, (4, 4)."""
    K = np.array([[0, -z[2], z[1]], [z[2], 0, -z[0]], [-z[1], z[0], 0]])
    X = np.eye(4)
    X[:3, :3] = np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K
    X[:3, 3] = point - X[:3, :3] @ point
    return X


def test_every_slip_of_the_list_names_a_test_that_exists() -> None:
    text = (Path(__file__).parents[2] / "docs" / "paper_errata.md").read_text()
    named = re.findall(r"`(test_\w+)", text)
    assert len(named) >= 25
    pages = sorted(Path(__file__).parent.glob("test_errata*.py"))
    tests = [name for page in pages for name in re.findall(r"def (test_\w+)", page.read_text())]
    for name in named:
        assert any(test.startswith(name) for test in tests), name
