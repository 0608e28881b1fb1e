"""RAPID modules: what is read back equals the plan."""

from __future__ import annotations

import re
from itertools import pairwise

import numpy as np
import numpy.typing as npt
import pytest
from rapid_motions import HOME, WORK, circle, wrist_passage
from scipy.spatial.transform import Rotation, Slerp

import irb2400_ctrl as irb
from irb2400_ctrl.cell import CellTool, with_tool
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.programs.rapid import rapid_data
from irb2400_ctrl.planners.programs.rapid.rapid_check import check_rapid
from irb2400_ctrl.planners.programs.rapid.rapid_program import (
    RapidOptions,
    rapid_program,
)
from irb2400_ctrl.planners.programs.rapid.rapid_reader import read_rapid
from irb2400_ctrl.planners.programs.rapid.rapid_thinning import IN_AIR
from irb2400_ctrl.robot.shape import Sphere

Array = npt.NDArray[np.float64]


@pytest.fixture(scope="module")
def model() -> irb.Model:
    return irb.Model(irb.load_robot("irb2400"))


def angle_deg(R_1: Array, R_2: Array) -> float:
    return float(np.degrees(rapid_data.angle_between(R_1, R_2).max()))


def off_the_move(model: irb.Model, q: Array, X: Array, in_joints: bool) -> tuple[float, float]:
    """How far rows are from one straight move from the first to the last [m, rad]."""
    ends = Rotation.from_matrix(X[[0, -1], :3, :3])
    R = Rotation.from_matrix(X[:, :3, :3])
    step = np.linalg.norm(np.diff(q if in_joints else X[:, :3, 3], axis=0), axis=1)
    if not in_joints:
        step = step + 0.1 * (R[:-1].inv() * R[1:]).magnitude()
    share = np.append(0.0, np.cumsum(step)) / step.sum()
    if in_joints:
        moved = model.tcp_pose(q[0] + np.outer(share, q[-1] - q[0]))
        place = moved[:, :3, 3]
        turn = Rotation.from_matrix(moved[:, :3, :3])
    else:
        place = X[0, :3, 3] + np.outer(share, X[-1, :3, 3] - X[0, :3, 3])
        turn = Slerp([0, 1], ends)(share.clip(0, 1))
    away = np.linalg.norm(place - X[:, :3, 3], axis=1).max()
    return float(away), float((turn.inv() * R).magnitude().max())


def in_single_precision(text: str) -> str:
    """The module with every decimal number as the controller's `num` (32 bits) would keep it."""
    return re.sub(r"-?\d+\.\d+", lambda m: repr(float(np.float32(m[0]))), text)


@pytest.mark.parametrize("X_BW", [None, WORK])
@pytest.mark.parametrize("stored", [str, in_single_precision])
def test_linear_targets_read_back_equal_the_plan(
    model: irb.Model, X_BW: Array | None, stored: object
) -> None:
    time, q = circle(model)
    program = rapid_program(model, time, q, X_BW=X_BW)
    module = read_rapid(stored(program.text))  # type: ignore[operator]
    assert len(module.moves) == len(program.samples) > 10
    planned = q[program.samples]
    assert module.moves[0].q is not None
    assert np.degrees(np.abs(module.moves[0].q - planned[0])).max() < 1e-4
    X = model.tcp_pose(planned[1:])
    read = np.array([move.X_BT for move in module.moves[1:]])
    assert 1e3 * np.abs(read[:, :3, 3] - X[:, :3, 3]).max() < 1e-3
    assert angle_deg(read[:, :3, :3], X[:, :3, :3]) < 1e-4
    # pose and configuration data together lead back to the same joint angles
    assert np.degrees(np.abs(module.joint_angles(model) - planned)).max() < 1e-4
    assert {move.instruction for move in module.moves[1:]} == {"MoveL"}


def test_joint_targets_read_back_equal_the_plan(model: irb.Model) -> None:
    time, q = circle(model)
    program = rapid_program(model, time, q, RapidOptions(motion="joint"))
    module = read_rapid(in_single_precision(program.text))
    assert {move.instruction for move in module.moves} == {"MoveAbsJ"}
    assert np.degrees(np.abs(module.joint_angles(model) - q[program.samples])).max() < 1e-4


@pytest.mark.parametrize("motion", ["linear", "joint"])
def test_straight_moves_stay_within_the_tolerance_of_every_row(
    model: irb.Model, motion: str
) -> None:
    time, q = circle(model)
    options = RapidOptions(motion=motion, tolerance_mm=0.05, tolerance_deg=0.05)  # type: ignore[arg-type]
    samples = rapid_program(model, time, q, options).samples
    assert samples[0] == 0
    assert samples[-1] == len(q) - 1
    assert len(samples) < len(q) / 4
    X = model.tcp_pose(q)
    for first, last in pairwise(samples):
        rows = slice(first, last + 1)
        distance, angle = off_the_move(model, q[rows], X[rows], motion == "joint")
        assert 1e3 * distance <= 0.05
        assert np.degrees(angle) <= 0.05
    # the sagitta of the chord: an independent figure for a circle of 60 mm
    chord = np.linalg.norm(np.diff(X[samples, :3, 3], axis=0), axis=1).max()
    assert 1e3 * chord**2 / (8 * 0.06) < 0.06


def test_configuration_data_follow_the_quadrants(model: irb.Model) -> None:
    degrees = np.array(
        [
            [0, 0, 0, 0, 10, 0],
            [95, 0, 0, -0.5, -10, 359],
            [-95, 0, 0, 179, 10, -361],
            [-0.001, 0, 0, 89.999, 10, 90.001],
            [0, -60, -60, 0, 10, 0],
            [0, 100, -30, 0, -10, 0],
        ],
        dtype=float,
    )
    expected = [
        [0, 0, 0, 0],
        [1, -1, 3, 1],
        [-2, 1, -5, 0],
        [-1, 0, 1, 0],
        [0, 0, 0, 4],
        [0, 0, 0, 3],
    ]
    assert rapid_data.configuration(model, np.radians(degrees)).tolist() == expected
    # rounding noise at zero does not decide
    noise = np.full((1, 6), -1e-15)
    assert rapid_data.configuration(model, noise)[0, :3].tolist() == [0, 0, 0]


def test_configuration_and_pose_single_out_the_joint_angles(model: irb.Model) -> None:
    """Over the joint box: of all joint angles with a target's pose, exactly one has its
    configuration data."""
    draw = np.random.default_rng(4)
    q = draw.uniform(model.robot.q_min, model.robot.q_max, (300, 6))
    for angles, conf in zip(q, rapid_data.configuration(model, q).tolist(), strict=True):
        every = model.inverse_kinematics(model.tcp_pose(angles))
        same = [
            found
            for found in every
            if rapid_data.configuration(model, found[None])[0].tolist() == conf
        ]
        assert len(same) == 1
        assert np.abs(same[0] - angles).max() < 1e-6


def test_wrist_centre_behind_axis_1_is_in_cfx(model: irb.Model) -> None:
    draw = np.random.default_rng(5)
    q = draw.uniform(model.robot.q_min, model.robot.q_max, (400, 6))
    X = model.flange_pose(q)
    wrist = X[:, :3, 3] - 0.085 * X[:, :3, 2]
    heading = np.column_stack([np.cos(q[:, 0]), np.sin(q[:, 0])])
    behind = (wrist[:, :2] * heading).sum(axis=1) < 0
    assert 0 < behind.sum() < len(q)
    assert ((rapid_data.configuration(model, q)[:, 3] >= 4) == behind).all()


def test_zero_pose_is_abbs(model: irb.Model) -> None:
    """At zero, tool0 of an IRB 2400 is at (940, 0, 1455) mm, [0.7071, 0, 0.7071, 0]: the published
    drawing."""
    X = model.flange_pose(np.zeros(6))
    assert 1e3 * X[:3, 3] == pytest.approx([940.0, 0.0, 1455.0])
    assert rapid_data.quaternion(X[:3, :3]) == pytest.approx([0.5**0.5, 0, 0.5**0.5, 0])


def test_tool_and_work_object(model: irb.Model) -> None:
    time, q = circle(model, 101)
    text = rapid_program(model, time, q, X_BW=WORK).text
    module = read_rapid(text)
    tool = model.robot.tool
    assert tool is not None
    assert np.abs(module.X_FT - model.robot.X_FT).max() < 1e-7
    assert module.mass_kg == tool.body.mass_kg
    assert module.com_m == pytest.approx(tool.body.com_m)
    assert "[0.8" not in text
    assert "[800,-200,400]" in text.replace(" ", "")


def test_principal_axes_of_an_oblique_tool(model: irb.Model) -> None:
    tool = model.robot.tool
    assert tool is not None
    body = tool.body.model_copy(update={"inertia_kgm2": (0.3, 0.25, 0.2, 0.02, -0.01, 0.03)})
    robot = model.robot.model_copy(update={"tool": tool.model_copy(update={"body": body})})
    joined = "".join(rapid_data.tooldata("t", robot)).replace(" ", "")
    numbers = [float(v) for v in re.findall(r"-?[\d.]+", joined.partition("[12.7,")[2])]
    R = Rotation.from_quat(np.roll(numbers[3:7], -1)).as_matrix()
    assert R @ np.diag(numbers[7:10]) @ R.T == pytest.approx(body.tensor(), abs=2e-6)


def test_without_a_tool_the_flange_is_tool0(model: irb.Model) -> None:
    bare = irb.Model(model.robot.model_copy(update={"tool": None}))
    time, q = circle(model, 101)
    program = rapid_program(bare, time, q)
    assert "tool0\\WObj:=wobj0;" in program.text
    assert "tooldata" not in program.text
    assert (
        np.degrees(np.abs(read_rapid(program.text).joint_angles(bare) - q[program.samples])).max()
        < 1e-4
    )


def test_wrist_passage_runs_under_singarea(model: irb.Model) -> None:
    time, q = wrist_passage(model)
    program = rapid_program(model, time, q)
    module = read_rapid(program.text)
    crossing = int(np.flatnonzero(q[1:, 4] * q[:-1, 4] <= 0)[0])
    for move, first, last in zip(
        module.moves[1:], program.samples[:-1], program.samples[1:], strict=True
    ):
        assert move.wrist == (first <= crossing < last), (first, last)
    assert program.text.count("SingArea\\Wrist;") == 1
    assert program.text.rindex("SingArea\\Off;") > program.text.index("SingArea\\Wrist;")
    # on both sides the configuration data tell the two signs of axis 5 apart
    signs = {
        move.configuration[3] & 1 for move in module.moves[1:] if move.configuration is not None
    }
    assert signs == {0, 1}
    flagged = np.zeros(len(q), dtype=bool)
    flagged[100:120] = True
    stated = read_rapid(rapid_program(model, time, q, wrist_crossing=flagged).text)
    assert [move.wrist for move in stated.moves].count(True) >= 1
    assert "Wrist" not in rapid_program(model, time, q, RapidOptions(motion="joint")).text


def test_moves_of_the_joints_need_no_target_beside_the_wrist_singularity(model: irb.Model) -> None:
    # the arm comes from home, where axis 5 is at zero
    move = irb.planners.joint_move(model, np.zeros(6), np.radians([20.0, 10.0, 5.0, 30, 40, 20]))
    assert len(rapid_program(model, move.trajectory, options=RapidOptions(motion="joint")).q) == 2
    time, q = wrist_passage(model)
    joints = RapidOptions(motion="joint")
    never = np.zeros(len(q), dtype=bool)
    passed = rapid_program(model, time, q, joints).samples
    np.testing.assert_array_equal(
        passed, rapid_program(model, time, q, joints, wrist_crossing=never).samples
    )


def test_speeds_times_and_stops(model: irb.Model) -> None:
    time, q = circle(model)
    program = rapid_program(model, time, q, RapidOptions(state_time=True))
    moves = read_rapid(program.text).moves[1:]
    p = model.tcp_pose(q)[:, :3, 3]
    planned = 1e3 * np.linalg.norm(np.diff(p, axis=0), axis=1) * 250.0
    for move, first, last in zip(moves, program.samples[:-1], program.samples[1:], strict=True):
        assert move.speed_mm_s == pytest.approx(max(planned[first:last].max(), 0.1), abs=1e-3)
    assert sum(move.duration or 0.0 for move in moves) == pytest.approx(4.0, abs=1e-3)
    assert [move.stops for move in moves] == [False] * (len(moves) - 1) + [True]
    assert all(
        move.stops
        for move in read_rapid(rapid_program(model, time, q, RapidOptions(zone_mm=0.0)).text).moves
    )


def test_a_pause_becomes_a_stop_and_a_wait(model: irb.Model) -> None:
    _, q = circle(model, 201)
    paused = np.concatenate([q[:120], np.repeat(q[119:120], 50, axis=0), q[120:]])
    program = rapid_program(model, np.arange(len(paused)) * 0.02, paused)
    module = read_rapid(program.text)
    assert module.pauses == pytest.approx((1.0,))
    assert sum(move.stops for move in module.moves) == 3
    assert np.degrees(np.abs(module.joint_angles(model) - paused[program.samples])).max() < 1e-4


def test_external_axes(model: irb.Model) -> None:
    time, q = circle(model, 101)
    text = rapid_program(model, time, q, external=(30.0, -45.5)).text
    assert {move.external for move in read_rapid(text).moves} == {(30.0, -45.5)}
    assert {move.external for move in read_rapid(rapid_program(model, time, q).text).moves} == {()}


def test_several_tools_in_one_module(model: irb.Model) -> None:
    shape = Sphere(kind="sphere", radius_mm=5)
    drill = CellTool(name="drill", offset_mm=(3, 0, 40), shapes=(shape,))
    other = irb.Model(with_tool(model.robot, drill))
    _, q = circle(model, 201)
    across = HOME + np.linspace(0, 0.1, 41)[1:, None]
    back = HOME + 0.1 - np.linspace(0, 0.1, 101)[1:, None]
    rows = np.concatenate([q, across, back])
    times = np.arange(len(rows)) * 0.02
    joints = np.zeros(len(rows), dtype=bool)
    joints[201:241] = True
    stops = np.zeros(len(rows), dtype=bool)
    stops[[200, 240]] = True
    changed = rapid_program(
        model, times, rows, joint_rows=joints, stops=stops, tools=[(200, other)]
    )
    assert check_rapid(changed.text) == ()
    assert changed.text.count("PERS tooldata") == 2
    module = read_rapid(changed.text)
    assert np.degrees(abs(module.joint_angles(model) - rows[changed.samples])).max() < 1e-4
    first = [
        move.X_FT for move, row in zip(module.moves, changed.samples, strict=True) if row <= 200
    ]
    assert all(X is not None and np.allclose(X, model.robot.X_FT, atol=1e-6) for X in first)
    last = module.moves[-1].X_FT
    assert last is not None
    assert np.allclose(last, other.robot.X_FT, atol=1e-6)
    # the tip of the other tool is where its targets are
    X = module.moves[-1].X_BT
    assert X is not None
    assert np.allclose(X, other.tcp_pose(rows[-1]), atol=1e-5)
    # the tip jumps by 40 mm within a row, the arm does not move for it
    assert max(move.speed_mm_s for move in module.moves) < 400.0
    with pytest.raises(InputError, match="no move of the joints follows"):
        rapid_program(model, times, rows, stops=stops, tools=[(200, other)])


def test_joints_that_move_over_the_part_have_few_targets(model: irb.Model) -> None:
    """A bent way of half a second was 40 MoveAbsJ of 10 ms each."""
    _, q = circle(model, 201)
    share = np.linspace(0, 1, 126)[1:, None]
    bend = np.radians([6.0, -12.0, 5.0, 0.0, 10.0, 0.0])
    rows = np.concatenate([q, q[-1] + 0.3 * share + share * (1.0 - share) * bend])
    times = np.arange(len(rows)) * 0.004
    joints = np.arange(len(rows)) > 200
    found = rapid_program(model, times, rows, joint_rows=joints)
    targets = found.samples[found.samples >= 200]
    assert 3 < len(targets) < 15
    away = 0.0
    for first, last in pairwise(targets):
        between = rows[first : last + 1]
        move, _ = off_the_move(model, between, model.tcp_pose(between), in_joints=True)
        away = max(away, 1e3 * move)
    assert 0.02 < away <= IN_AIR * 0.02 + 1e-6
    # joints that move all the way are as exact as lines
    close = rapid_program(model, times, rows, options=RapidOptions(motion="joint"))
    assert np.sum(close.samples >= 200) > 2 * len(targets)
