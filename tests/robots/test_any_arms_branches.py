"""Branches of arms without a closed form: roots, displaced axes, pairs about to meet."""

from __future__ import annotations

import numpy as np
import pytest
from model.second_robots import ur_like
from robots.imported import mixed, offset_wrist
from scipy.spatial.transform import Rotation

import irb2400_ctrl as irb
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model.characteristic_roots import CharacteristicRoots
from irb2400_ctrl.model.newton_branches import NewtonBranches


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_roots_of_a_general_arm_are_its_branches(seed: int) -> None:
    """Without Newton's method: each drawn configuration is a root of its own pose."""
    robot_ = mixed(seed)
    model = irb.Model(robot_)
    q = np.random.default_rng(10).uniform(-np.pi, np.pi, (200, 6))
    regular = model.smallest_singular_value(q) > 0.02
    start, owner = CharacteristicRoots(robot_, 1.0).starts(model.flange_pose(q))
    assert np.bincount(owner).max() <= 16
    away = np.abs(np.exp(1j * start) - np.exp(1j * q[owner])).max(axis=1)
    nearest = np.full(len(q), np.inf)
    np.minimum.at(nearest, owner, away)
    assert regular.sum() > 100
    assert nearest[regular].max() < 1e-5


def test_the_numbers_of_a_line_are_mapped_linearly() -> None:
    """Fourteen, of any motion of space: one matrix for all lines."""
    roots = CharacteristicRoots(mixed(), 1.0)
    rng = np.random.default_rng(11)
    R = Rotation.random(31, rng=rng).as_matrix()
    X = np.zeros((31, 4, 4))
    X[:, :3, :3] = R
    X[:, :3, 3] = rng.normal(size=(31, 3))
    X[:, 3, 3] = 1
    lines = roots._of_last_axis(X[1:])
    moved = roots._of_last_axis(X[0] @ X[1:])
    # p and d of no length are a fifteenth, constant number
    known = np.column_stack([lines, np.ones(30)])
    matrix = np.linalg.lstsq(known[:20], moved[:20])[0]
    np.testing.assert_allclose(known[20:] @ matrix, moved[20:], rtol=0, atol=1e-9)


@pytest.mark.parametrize("robot_", [mixed(), offset_wrist("along")], ids=["skew", "offset wrist"])
def test_a_pose_out_of_reach_has_no_branch(robot_: irb.Robot) -> None:
    X = irb.Model(robot_).flange_pose(np.zeros((4, 6)))
    # the last far enough for a round without a single root
    X[:, 1, 3] = [3.0, 10.0, 30.0, 1000.0]
    for pose in X:
        assert not np.isfinite(NewtonBranches(robot_).many(pose[None], None).q).any()


@pytest.mark.parametrize("free", [True, False])
def test_no_path_is_planned_for_them(free: bool) -> None:
    """It was a fault of the library's own: an array of another shape."""
    path = irb.planners.builders.line((0.4, 0.0, 0.4), (0.4, 0.1, 0.4), feed=0.1)
    with pytest.raises(InputError, match=r"no closed-form .* known are arms with a"):
        irb.plan_path(mixed(), path, free_tool_rotation=free)


def test_a_pair_of_branches_that_many_starts_seldom_reach_is_found() -> None:
    robot_ = offset_wrist("along")
    q = np.array([-0.12447, -0.87583, 2.88878, -2.97242, -0.36301, -1.44193])
    found = NewtonBranches(robot_).one(irb.Model(robot_).flange_pose(q), None)[0]
    assert len(found) == 8
    assert np.abs(np.exp(1j * found) - np.exp(1j * q)).max(axis=1).min() < 1e-7


@pytest.mark.parametrize(
    ("robot_", "q"),
    [
        (offset_wrist("across"), [1.47345, 0.27121, -1.63504, 2.10966, -0.16522, 0.73490]),
        (offset_wrist("across"), [-0.83569, -3.08348, -1.52085, -0.57853, -0.19468, -1.05794]),
        (ur_like(), [-0.11597, -2.69969, 1.95348, -2.22819, -3.07032, 0.02427]),
    ],
    ids=["signs do not balance", "signs do not balance, less", "a pair across a singularity"],
)
def test_two_of_four_branches_are_not_taken_for_all(robot_: irb.Robot, q: list[float]) -> None:
    _has_branches(robot_, q, 4)


@pytest.mark.parametrize(
    ("robot_", "q", "branches"),
    [
        (mixed(1), [-0.5136566, 2.271953809, 1.54282975, -1.61845659, 1.63370784, -0.32627556], 4),
        (mixed(1), [-1.9568129, -2.86544581, 2.23316421, -0.81697027, -1.10432005, -2.76859101], 8),
        (
            offset_wrist("along"),
            [-2.55335536, -2.24288966, 1.70209904, 1.77960203, 0.18926105, -0.30831027],
            4,
        ),
        (
            offset_wrist("along"),
            [-2.81033747, -1.9328094, -0.64665238, -0.84076129, -3.02274447, 1.55708847],
            8,
        ),
        (
            ur_like(),
            [
                -0.6265482838753949,
                1.7370844323087145,
                -0.8906155564853555,
                -2.8129066394875144,
                1.6370279889836663,
                -2.1323920331491237,
            ],
            4,
        ),
    ],
    ids=["skew", "skew, eight", "about to meet", "lost to rounding", "one of each pair found"],
)
def test_pairs_about_to_meet_are_found(robot_: irb.Robot, q: list[float], branches: int) -> None:
    """Two were missed by Newton's method from many starts, two with axes displaced by 1e-4, of
    one the partner of each that was found, 0.04 rad across a singularity."""
    _has_branches(robot_, q, branches)


def _has_branches(robot_: irb.Robot, q: list[float], branches: int) -> None:
    found = NewtonBranches(robot_).one(irb.Model(robot_).flange_pose(np.array(q)), None)[0]
    assert len(found) == branches
    assert np.abs(np.exp(1j * found) - np.exp(1j * np.array(q))).max(axis=1).min() < 1e-6
