"""Inverse kinematics from the chain: no false branch, none missed, on every family and on none."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from model.second_robots import ur_like
from robots.imported import SIX_AXES, bent, mixed, offset_wrist, robot

import irb2400_ctrl as irb
from irb2400_ctrl.codegen import compile_function
from irb2400_ctrl.errors import InputError, UnreachableError
from irb2400_ctrl.model.branch_solver import branch_solver
from irb2400_ctrl.model.joint_box import JointBox, boxed
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
    # up to the last digits: some processors add the columns of one matrix in another order
    np.testing.assert_allclose(alone, found[0][exists[0]], rtol=0, atol=1e-12)


def test_seven_axes_are_refused_with_a_way_out() -> None:
    with pytest.raises(InputError, match=r"this one has 7; hold one axis"):
        irb.Model(robot("panda")).inverse_kinematics(np.eye(4))


def test_five_axes_are_not_told_to_hold_one() -> None:
    arm = irb.load_robot("puma560")
    kept = {name: getattr(arm, name)[:5] for name in ("links", "joints")}
    eye = tuple(tuple(float(i == j) for j in range(5)) for i in range(5))
    coupling = arm.coupling.model_copy(update={"matrix": eye, "offset_rad": (0.0,) * 5})
    five = arm.model_copy(update={**kept, "coupling": coupling, "effects": ()})
    with pytest.raises(InputError, match=r"this one has 5; with fewer it meets few of the poses"):
        irb.Model(five).inverse_kinematics(np.eye(4))


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


def test_ranges_that_are_degrees_are_asked_about() -> None:
    """54 turns an axis are 10^10 configurations: they filled the memory."""
    box = JointBox(np.full(6, -170.0), np.full(6, 170.0))
    closed_form = irb.Model(irb.load_robot("irb2400")).function("inverse_kinematics")
    assert boxed(closed_form, box) is None
    with pytest.raises(InputError, match="joint ranges of the robot file degrees"):
        box.windings(np.zeros((8, 6)))
