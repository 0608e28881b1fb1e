"""Inverse kinematics from the chain: no false branch, none missed, on every family and on none."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from model.second_robots import ur_like
from robots.imported import SIX_AXES, bent, mixed, offset_wrist, robot
from scipy.spatial.transform import Rotation

import irb2400_ctrl as irb
from irb2400_ctrl.codegen import compile_function
from irb2400_ctrl.errors import InputError, UnreachableError
from irb2400_ctrl.model.branch_solver import branch_solver
from irb2400_ctrl.model.characteristic_roots import CharacteristicRoots
from irb2400_ctrl.model.joint_box import JointBox
from irb2400_ctrl.model.newton_branches import NewtonBranches
from irb2400_ctrl.robot import Transform

Array = npt.NDArray[np.float64]
SHIPPED = ("irb2400", "puma560", "ur10e")
NAMES = (
    *SHIPPED,
    *(f"{name} URDF" for name in SIX_AXES),
    "parallelogram",
    "on a wall",
    *(f"{name} slid" for name in ("ur5", "kr16", "irb1200")),
)


def arm(name: str) -> irb.Robot:
    if name.endswith("URDF"):
        return robot(name.removesuffix(" URDF"))
    if name == "parallelogram":
        big = robot("irb4600")
        A = np.eye(6)
        A[2, 1] = -1.0
        coupling = big.coupling.model_copy(
            update={"matrix": tuple(map(tuple, A.tolist())), "offset_rad": (0.1,) * 6}
        )
        return big.model_copy(update={"coupling": coupling})
    if name == "on a wall":
        tilted = robot("tx90")
        X = np.array([[0, 0, 1, 0.2], [0, 1, 0, 0.1], [-1, 0, 0, 0.5], [0, 0, 0, 1]])
        frame = {"transform": (X @ tilted.links[0].frame.matrix()).tolist()}
        first = {**tilted.links[0].model_dump(), "frame": frame}
        return tilted.model_copy(update={"links": (first, *tilted.links[1:])})
    if name.endswith("slid"):
        return slid(robot(name.removesuffix(" slid")))
    return irb.load_robot(name)


def slid(arm: irb.Robot) -> irb.Robot:
    """The same arm with every frame elsewhere on its joint's axis, as old files of UR have them."""
    frames = [link.frame.matrix() for link in arm.links]
    flange = arm.flange.matrix()
    for k, way in enumerate((0.1, 0.136, -0.12, 0.07, -0.05, 0.03)):
        along = np.eye(4)
        along[2, 3] = way
        frames[k] = frames[k] @ along
        along[2, 3] = -way
        if k < 5:
            frames[k + 1] = along @ frames[k + 1]
        else:
            flange = along @ flange
    links = tuple(
        link.model_copy(update={"frame": Transform.model_validate({"transform": X.tolist()})})
        for link, X in zip(arm.links, frames, strict=True)
    )
    end = Transform.model_validate({"transform": flange.tolist()})
    return arm.model_copy(update={"links": links, "flange": end})


@pytest.mark.parametrize("name", NAMES)
def test_every_branch_reaches_and_the_one_it_came_from_is_among_them(name: str) -> None:
    """From both sides: forward kinematics of every branch, and the configuration it started at."""
    model = irb.Model(arm(name))
    rng = np.random.default_rng(3)
    q = rng.uniform(-np.pi, np.pi, (3000, 6))
    factors = np.abs(model.singularity_factors(q)).min(axis=1)
    q = q[factors > 1e-3]
    X = model.tcp_pose(q)
    found = model.inverse_kinematics_branches(X)
    exists = np.isfinite(found.q).all(axis=2)
    reached = model.tcp_pose(found.q[exists])
    wanted = np.broadcast_to(X[:, None], (*exists.shape, 4, 4))[exists]
    np.testing.assert_allclose(reached, wanted, rtol=0, atol=1e-9)
    away = np.abs(np.exp(1j * found.q) - np.exp(1j * q)[:, None]).max(axis=2)
    assert np.where(exists, away, np.inf).min(axis=1).max() < 1e-7
    # the branches of one pose are different configurations, or they would be counted twice
    assert (exists.sum(axis=1) % 2 == 0).all()
    assert ((found.overreach > 0) == ~exists).all()


@pytest.mark.parametrize("name", ["puma560", "ur10e"])
def test_branches_are_those_that_a_search_finds(name: str) -> None:
    """The closed form against the roots of the general arm, which know no family."""
    robot_ = arm(name)
    model = irb.Model(robot_)
    search = NewtonBranches(robot_)
    rng = np.random.default_rng(4)
    compared = 0
    for q in rng.uniform(-np.pi, np.pi, (8, 6)):
        if np.abs(model.singularity_factors(q)).min() < 0.1:
            continue
        X = model.flange_pose(q)
        closed = model.inverse_kinematics_branches(model.tcp_pose(q)[None]).q[0]
        closed = closed[np.isfinite(closed).all(axis=1)]
        numerical, _ = search.one(X, None)
        assert len(numerical) == len(closed)
        away = np.abs(np.exp(1j * closed)[:, None] - np.exp(1j * numerical)).max(axis=2)
        assert away.min(axis=1).max() < 1e-7
        compared += 1
    assert compared >= 3


@pytest.mark.parametrize("robot_", [mixed(), ur_like()], ids=["skew", "axes 5, 6 apart"])
def test_an_arm_of_no_family_is_solved_numerically(robot_: irb.Robot) -> None:
    model = irb.Model(robot_)
    rng = np.random.default_rng(5)
    for q in rng.uniform(robot_.q_min, robot_.q_max, (4, 6)):
        X = model.tcp_pose(q)
        found = model.inverse_kinematics(X, seed=q)
        np.testing.assert_allclose(found[0], q, atol=1e-7)
        np.testing.assert_allclose(
            model.tcp_pose(found), np.broadcast_to(X, (len(found), 4, 4)), atol=1e-8
        )
    with pytest.raises(UnreachableError, match="out of reach"):
        model.inverse_kinematics(
            np.array([[1, 0, 0, 9], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])
        )


@pytest.mark.parametrize("kind", ["along", "across"])
def test_an_offset_wrist_has_every_branch_found(kind: str) -> None:
    """From both sides, as the closed forms; in a batch and one by one the same."""
    robot_ = offset_wrist(kind)
    model = irb.Model(robot_)
    q = np.random.default_rng(9).uniform(-np.pi, np.pi, (300, 6))
    q = q[model.smallest_singular_value(q) > 1e-3]
    X = model.tcp_pose(q)
    found = model.inverse_kinematics_branches(X).q
    exists = np.isfinite(found).all(axis=2)
    wanted = np.broadcast_to(X[:, None], (*exists.shape, 4, 4))[exists]
    np.testing.assert_allclose(model.tcp_pose(found[exists]), wanted, rtol=0, atol=1e-9)
    away = np.abs(np.exp(1j * found) - np.exp(1j * q)[:, None]).max(axis=2)
    assert np.where(exists, away, np.inf).min(axis=1).max() < 1e-6
    counts = exists.sum(axis=1)
    assert (counts % 2 == 0).all()
    assert counts.max() > 8
    alone = NewtonBranches(robot_).one(model.flange_pose(q[0]), None)[0]
    np.testing.assert_array_equal(alone, found[0][exists[0]])


def test_seven_axes_are_refused_with_a_way_out() -> None:
    with pytest.raises(InputError, match=r"this one has 7; hold one axis"):
        irb.Model(robot("panda")).inverse_kinematics(np.eye(4))


@pytest.mark.parametrize("name", SIX_AXES)
def test_the_factors_are_the_determinant(name: str) -> None:
    model = irb.Model(robot(name))
    q = np.random.default_rng(6).uniform(-np.pi, np.pi, (50, 6))
    product = np.abs(model.singularity_factors(q).prod(axis=1)) * model.arm_geometry.a2
    np.testing.assert_allclose(np.abs(np.linalg.det(model.tcp_jacobian(q))), product, atol=1e-12)


def test_the_smallest_singular_value_vanishes_where_the_factors_do() -> None:
    model = irb.Model(robot("ur10e"))
    q = bent(model)
    assert model.smallest_singular_value(q) > 0.05
    g = model.arm_geometry
    for index, value in ((4, 0.0), (2, g.canonical(q)[1])):
        phi = g.canonical(q)
        phi[index] = value
        singular = np.linalg.solve(g.C, phi - g.offset)
        assert model.smallest_singular_value(singular) < 1e-12
    # and it is there for arms without factors
    panda = irb.Model(robot("panda"))
    assert panda.smallest_singular_value(np.array([0.1, 0.2, 0.3, -1.5, 0.2, 1.6, 0.4])) > 0.02


def test_a_straight_wrist_of_parallel_axes_takes_its_direction_from_the_seed() -> None:
    model = irb.Model(robot("ur10e"))
    g = model.arm_geometry
    phi = g.canonical(bent(model))
    phi[4] = 0.0
    q = np.linalg.solve(g.C, phi - g.offset)
    X = model.tcp_pose(q)
    for shift in (0.0, 0.1, -0.1):
        seed = np.linalg.solve(g.C, phi + shift * np.eye(6)[3] - g.offset)
        found = model.inverse_kinematics(X, seed=seed)
        np.testing.assert_allclose(
            model.tcp_pose(found), np.broadcast_to(X, (len(found), 4, 4)), atol=1e-9
        )
        assert np.abs(g.canonical(found)[:, 3] - phi[3] - shift).min() < 1e-9


def test_machine_code_and_casadi_agree() -> None:
    robot_ = irb.load_robot("irb2400")
    model = irb.Model(robot_)
    X = model.flange_pose(np.random.default_rng(7).uniform(-2, 2, (50, 6)))
    compiled = branch_solver(robot_).many(X, None)
    for pose, branches in zip(X, compiled.q, strict=True):
        q, overreach = model.function("inverse_kinematics")(pose, np.zeros(6))
        plain = np.where(np.asarray(overreach).ravel()[:, None] > 0, np.nan, np.asarray(q).T)
        np.testing.assert_allclose(branches, plain, rtol=0, atol=1e-13)
    one = branch_solver(robot_).one(X[3], None)
    np.testing.assert_array_equal(one[0], compiled.q[3])
    single = compile_function(model.function("inverse_kinematics"), real="float")
    q, _ = single.map(X, np.zeros(6))
    close = np.abs(np.exp(1j * q.transpose(0, 2, 1)) - np.exp(1j * compiled.q)).max(axis=2)
    assert np.nanmedian(close) < 1e-4


def test_whole_turns_fill_the_box_and_nothing_else() -> None:
    low = np.array([-1.0, -7.0])
    high = np.array([1.0, 7.0])
    branches = np.array([[0.5, 1.0], [2.0, 0.0], [np.nan, np.nan], [-0.5, -3.0]])
    found = JointBox(low, high).windings(branches)
    turn = 2 * np.pi
    expected = [[0.5, 1 - turn], [0.5, 1.0], [-0.5, -3.0], [-0.5, -3 + turn]]
    np.testing.assert_allclose(found, expected)


@pytest.mark.parametrize("name", ["irb2400", "puma560", "kr16 URDF", "ur10e"])
def test_the_joint_box_in_machine_code_is_that_of_windings(name: str) -> None:
    robot_ = arm(name)
    model = irb.Model(robot_)
    solver = branch_solver(robot_)
    counts = set()
    for q in np.random.default_rng(8).uniform(robot_.q_min, robot_.q_max, (200, 6)):
        expected = JointBox.of(robot_).windings(solver.one(model.flange_pose(q), q)[0])
        found = solver.inside(model.tcp_pose(q), q)
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12)
        counts.add(len(found))
    assert len(counts) > 2


def test_an_angle_on_both_ends_of_its_range_has_a_turn_more() -> None:
    """At 0 in a range of -360 to 360 degrees: three angles, and only there."""
    robot_ = irb.load_robot("ur10e")
    model = irb.Model(robot_)
    q = np.array([0.0, -1.2, 1.4, 0.3, 0.8, 0.0])
    X = model.tcp_pose(q)
    found = model.inverse_kinematics(X)
    expected = JointBox.of(robot_).windings(branch_solver(robot_).one(X @ model._X_TF, None)[0])
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12)
    first = found[np.abs(np.exp(1j * found) - np.exp(1j * q)).max(axis=1) < 1e-9]
    # axes 1 and 6 have three each, axes 2, 4 and 5 two, axis 3 (half a turn either way) one
    assert len(first) == 3 * 2 * 1 * 2 * 2 * 3


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
