"""Closed-form inverse kinematics over the joint box, its singular sets and its refusals."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from model.states import States

import irb2400_ctrl as irb
from irb2400_ctrl.errors import InputError, UnreachableError

ARM = irb.Model(irb.load_robot("irb2400"))
BOX = list(zip(ARM.robot.q_min, ARM.robot.q_max, strict=True))
configurations = st.tuples(*(st.floats(low, high) for low, high in BOX)).map(np.array)


def assert_all_reach(
    model: irb.Model, q: np.ndarray, X_BT: np.ndarray, tolerance: float = 1e-9
) -> None:
    np.testing.assert_allclose(
        model.tcp_pose(q), np.broadcast_to(X_BT, (len(q), 4, 4)), rtol=0, atol=tolerance
    )
    assert (q >= model.robot.q_min - 1e-8).all()
    assert (q <= model.robot.q_max + 1e-8).all()


@settings(deadline=None, max_examples=200)
@given(configurations)
def test_every_solution_reaches_the_pose_and_the_nearest_to_the_seed_is_first(
    q: np.ndarray,
) -> None:
    X_BT = ARM.tcp_pose(q)
    solutions = ARM.inverse_kinematics(X_BT, seed=q)
    assert_all_reach(ARM, solutions, X_BT, 1e-8)
    distance = np.abs(solutions - q).max(axis=1)
    assert (np.diff(distance) >= -1e-12).all()


def test_the_seed_comes_back_away_from_singularities(model: irb.Model, states: States) -> None:
    for q in states.q:
        if np.abs(model.singularity_factors(q)).min() > 1e-3:
            np.testing.assert_allclose(
                model.inverse_kinematics(model.tcp_pose(q), seed=q)[0], q, rtol=0, atol=1e-9
            )


def test_eight_branches_are_eight_different_postures(model: irb.Model) -> None:
    X_BT = model.tcp_pose(np.array([0.2, 0.3, 0.1, 0.4, 0.9, 0.3]))
    q = model.inverse_kinematics_branches(X_BT[None]).q[0]
    existing = q[np.isfinite(q).all(axis=1)]
    np.testing.assert_allclose(
        model.tcp_pose(existing), np.broadcast_to(X_BT, (len(existing), 4, 4)), rtol=0, atol=1e-12
    )
    apart = np.abs(existing[:, None] - existing[None]).max(axis=2) + np.eye(len(existing))
    assert len(existing) == 8
    assert apart.min() > 0.05


def test_whole_turns_of_axes_4_and_6_are_solutions(model: irb.Model) -> None:
    q = np.array([0.0, 0.2, 0.1, 3.3, 0.5, -6.0])
    solutions = model.inverse_kinematics(model.tcp_pose(q))
    turns = {tuple(np.round((row - q)[[3, 5]] / (2 * np.pi), 6)) for row in solutions}
    assert {(0.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (-1.0, 1.0)} <= turns


SINGULAR = {
    "wrist straight": [0.4, 0.3, 0.2, 0.7, 0.0, -0.5],
    "wrist straight, arm up": [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    "wrist folded by rounding": [0.4, 0.3, 0.2, 0.7, 1e-12, -0.5],
}


@pytest.mark.parametrize("q", SINGULAR.values(), ids=SINGULAR)
def test_at_the_wrist_singularity_the_seed_decides_axis_4(model: irb.Model, q: list[float]) -> None:
    X_BT = model.tcp_pose(np.array(q))
    seed = np.add(q, [0, 0, 0, 0.3, 0, 0])
    solutions = model.inverse_kinematics(X_BT, seed=seed)
    assert_all_reach(model, solutions, X_BT)
    assert solutions[0, 3] == pytest.approx(seed[3], abs=1e-6)


def test_wrist_centre_on_axis_1_takes_axis_1_from_the_seed(model: irb.Model) -> None:
    g = model.arm_geometry
    # r = 0 inside the joint box: solve a1 + a2 sin q2 + a3 sin q3 + d4 cos q3 = 0 for q2 at q3 = 50
    # deg
    q3 = np.radians(50.0)
    q2 = np.arcsin(-(g.a1 + g.a3 * np.sin(q3) + g.d4 * np.cos(q3)) / g.a2)
    q = np.array([0.7, q2, q3, 0.2, 0.6, 0.1])
    assert abs(model.singularity_factors(q)[1]) < 1e-12
    X_BT = model.tcp_pose(q)
    for heading in (0.7, -1.1):
        solutions = model.inverse_kinematics(X_BT, seed=np.array([heading, *q[1:]]))
        assert_all_reach(model, solutions, X_BT)
    np.testing.assert_allclose(model.inverse_kinematics(X_BT, seed=q)[0], q, rtol=0, atol=1e-7)


def test_stretched_arm_is_reached_and_a_nanometre_beyond_is_not_a_crash(model: irb.Model) -> None:
    g = model.arm_geometry
    # k = 0: tan(q2 - q3) = d4 / a3
    q3 = np.radians(-20.0)
    q = np.array([0.3, q3 + np.arctan2(g.d4, g.a3), q3, 0.4, 0.8, 0.2])
    assert abs(model.singularity_factors(q)[2]) < 1e-12
    X_BT = model.tcp_pose(q)
    # near a double root half of the digits are lost: 1e-16 in the cosine is 1e-8 rad at the elbow
    assert_all_reach(model, model.inverse_kinematics(X_BT, seed=q), X_BT, 1e-7)


def test_vectorised_branches_equal_single_ones(model: irb.Model, states: States) -> None:
    poses = model.tcp_pose(states.q[:20])
    together = model.inverse_kinematics_branches(poses).q
    alone = np.concatenate([model.inverse_kinematics_branches(X[None]).q for X in poses])
    np.testing.assert_allclose(together, alone, rtol=0, atol=1e-13)


class TestCoupledBound:
    """An optional bound on q3 - q2, which the real controller has and the paper does not print."""

    @staticmethod
    def bounded(robot: irb.Robot, low: float, high: float) -> irb.Model:
        coupling = robot.coupling.model_copy(update={"difference_deg": (low, high)})
        return irb.Model(robot.model_copy(update={"coupling": coupling}))

    def test_solutions_beyond_it_are_left_out(self, robot: irb.Robot, model: irb.Model) -> None:
        X_BT = model.tcp_pose(np.array([0.2, 0.9, 0.1, 0.4, 0.9, 0.3]))
        free = model.inverse_kinematics(X_BT)
        difference = np.degrees(free[:, 2] - free[:, 1])
        assert np.ptp(difference) > 10.0
        middle = (difference.min() + difference.max()) / 2
        some = self.bounded(robot, -300.0, middle).inverse_kinematics(X_BT)
        np.testing.assert_array_equal(some, free[difference < middle])

    def test_when_none_is_left_it_says_so(self, robot: irb.Robot, model: irb.Model) -> None:
        X_BT = model.tcp_pose(np.array([0.2, 0.3, 0.1, 0.4, 0.9, 0.3]))
        with pytest.raises(UnreachableError, match=r"q3 - q2 is .* deg, range 200 to 201 deg"):
            self.bounded(robot, 200.0, 201.0).inverse_kinematics(X_BT)


class TestRefusals:
    def test_out_of_reach_says_by_how_much(self, model: irb.Model) -> None:
        X = np.eye(4)
        X[:3, 3] = 5.0, 0.0, 0.0
        with pytest.raises(UnreachableError, match=r"\d+\.\d mm out of reach of the arm$"):
            model.inverse_kinematics(X)
        X[:3, 3] *= 1e3
        with pytest.raises(UnreachableError, match=r"in metres, this one looks like millimetres"):
            model.inverse_kinematics(X)

    def test_outside_the_joint_box_names_the_axis_and_its_range(self, model: irb.Model) -> None:
        q = np.array([0.0, 0.0, 0.0, 0.0, np.radians(-125.0), 0.0])
        narrow = model.tcp_pose(q + np.array([0, 0, 0, np.radians(100), 0, 0]))
        with pytest.raises(UnreachableError, match=r"axis [1-6] at .* deg, range .* deg"):
            model.inverse_kinematics(narrow)

    @pytest.mark.parametrize(
        "X",
        [
            np.eye(3),
            np.full((4, 4), np.nan),
            np.diag([1.0, 1.0, -1.0, 1.0]),
            np.diag([2.0, 1.0, 1.0, 1.0]),
            np.eye(4) + 0.9 * np.eye(4, k=-3),
        ],
        ids=["shape", "nan", "mirror", "scaled", "transposed"],
    )
    def test_not_a_pose(self, model: irb.Model, X: np.ndarray) -> None:
        with pytest.raises(InputError, match="inverse kinematics"):
            model.inverse_kinematics(X)


def test_a_seed_in_degrees_is_refused() -> None:
    """It decided in silence which of the branches came first."""
    q = np.radians([10.0, 20.0, 10.0, 30.0, 45.0, 0.0])
    with pytest.raises(InputError, match=r"seed: found 45 rad on axis 5.*np\.radians\(seed\)"):
        ARM.inverse_kinematics(ARM.tcp_pose(q), seed=np.degrees(q))
    a_turn_on = q + 2 * np.pi
    assert len(ARM.inverse_kinematics(ARM.tcp_pose(q), seed=a_turn_on)) > 1
