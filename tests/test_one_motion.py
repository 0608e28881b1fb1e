"""One motion type from end to end, in memory: no step needs a file of the one before."""

from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.excitation import Budget, Excitation, excite
from irb2400_ctrl.measurement import Log, read_log, recorded_motion
from irb2400_ctrl.planners import (
    JointMove,
    Plan,
    builders,
    joint_move,
    optimise_motion,
    plan_path,
    rapid_program,
    read_rapid,
)
from irb2400_ctrl.planners.programs.egm import egm_messages as proto
from irb2400_ctrl.planners.programs.egm.egm_stream import EgmFollower
from irb2400_ctrl.simulation import Simulation, simulate
from irb2400_ctrl.trajectory import Trajectory, load_trajectory, save_trajectory

Array = npt.NDArray[np.float64]
HOME = np.radians([10.0, -15.0, 12.0, 20.0, 50.0, -30.0])
ROBOT = irb.load_robot("irb2400")
MODEL = irb.Model(ROBOT)


def followed(motion: Trajectory, within: float = 1e-3) -> Simulation:
    """The motion under computed torque; the tool stays `within` [m] of it."""
    assert type(motion) is Trajectory
    run = simulate(ROBOT, motion, "computed_torque")
    assert run.tcp_error.max() < within
    return run


@pytest.fixture(scope="module")
def plan() -> Plan:
    path = builders.circle((0.95, 0.0, 0.6), 0.15, feed=0.1)
    return plan_path(ROBOT, path, free_tool_rotation=False)


@pytest.fixture(scope="module")
def run(plan: Plan) -> Simulation:
    return followed(plan.trajectory)


@pytest.fixture(scope="module")
def move() -> JointMove:
    return joint_move(MODEL, HOME, HOME + 0.3)


@pytest.fixture(scope="module")
def excitation() -> Excitation:
    budget = Budget(pool=6, rounds=1, mutations=2)
    return excite(ROBOT, "friction level", joint=3, seconds=12.0, budget=budget)


def test_a_path_is_planned_followed_recorded_and_diagnosed(run: Simulation) -> None:
    # the arm is the model's own
    assert diagnose(ROBOT, run.log()).verdict == "nothing_missing"


def test_the_log_in_memory_is_the_log_of_the_file(run: Simulation, tmp_path: Path) -> None:
    log = run.log()
    read = read_log(run.write(tmp_path)[0])
    assert read.qd is not None
    assert read.q_ref is not None
    assert log.qd is not None
    assert log.q_ref is not None
    np.testing.assert_allclose(log.time, read.time, atol=1e-4)
    np.testing.assert_allclose(log.q, read.q, atol=1e-8)
    np.testing.assert_allclose(log.q_ref, read.q_ref, atol=1e-8)
    np.testing.assert_allclose(log.qd, read.qd, atol=1e-6)
    np.testing.assert_allclose(log.tau, read.tau, atol=1e-3)


def test_a_recorded_log_is_followed_again(run: Simulation) -> None:
    again = recorded_motion(run.log())
    as_planned = np.stack([np.interp(again.time, run.time, q) for q in run.q_ref.T], axis=1)
    assert np.degrees(np.abs(again.q - as_planned)).max() < 0.05
    followed(again)


def test_a_joint_move_is_followed(move: JointMove) -> None:
    assert move.trajectory.duration == move.duration
    followed(move.trajectory)


def test_a_plan_becomes_rapid_and_comes_back(excitation: Excitation) -> None:
    motion = excitation.trajectory()
    followed(motion)
    program = excitation.program()
    back = read_rapid(program.text).trajectory(MODEL)
    np.testing.assert_allclose(back.time, motion.time[program.samples], atol=1e-4)
    np.testing.assert_allclose(back.q, motion.q[program.samples], atol=1e-6)
    followed(back)


def test_a_pause_of_a_program_is_a_pause_of_its_motion(excitation: Excitation) -> None:
    text = excitation.program().text
    first = text.index("MoveAbsJ", text.index("MoveAbsJ", text.index("PROC Part1")) + 1)
    waiting = text[:first] + "WaitTime 1.5;\n    " + text[first:]
    module = read_rapid(waiting)
    plain = read_rapid(text).trajectory(MODEL)
    back = module.trajectory(MODEL)
    assert back.time[1] == 1.5
    np.testing.assert_array_equal(back.q[0], back.q[1])
    np.testing.assert_allclose(back.time[1:], plain.time + 1.5)


def test_a_program_without_times_is_no_motion(plan: Plan) -> None:
    program = rapid_program(MODEL, plan.trajectory)
    assert program.text == rapid_program(MODEL, plan.trajectory.time, plan.trajectory.q).text
    with pytest.raises(InputError, match=r"state_time=True"):
        read_rapid(program.text).trajectory(MODEL)
    with pytest.raises(InputError, match="expected one of them"):
        rapid_program(MODEL, plan.trajectory, plan.trajectory.q)


def test_an_optimised_motion_is_followed_and_starts_another(move: JointMove) -> None:
    points = np.array([HOME, HOME + 0.3])
    found = optimise_motion(ROBOT, points, start=move.trajectory, intervals=30)
    same = optimise_motion(ROBOT, points, start=move, intervals=30)
    assert found.duration == same.duration
    # its torque jumps from limit to limit
    followed(found.trajectory(MODEL), within=0.02)


def test_a_plan_is_streamed_by_egm(plan: Plan) -> None:
    t = plan.trajectory
    follower = EgmFollower(ROBOT, t)
    degrees = tuple(np.degrees(t.q[0]))
    for k in range(4):
        state = {"mci_state": proto.MCI_RUNNING, "motor_state": proto.MOTORS_ON}
        answer = follower.answer(proto.RobotMessage(k, 4 * k, degrees, **state))
    assert answer is not None
    np.testing.assert_allclose(answer.q_deg, np.degrees(t.q[3]), atol=1e-6)
    with pytest.raises(InputError, match="expected one of them"):
        EgmFollower(ROBOT, t, t.q, t.qd)


def test_every_house_gives_the_same_class(plan: Plan, run: Simulation) -> None:
    from irb2400_ctrl import planners, simulation

    assert planners.Trajectory is simulation.Trajectory is Trajectory
    assert type(plan.trajectory) is type(run.reference) is Trajectory
    assert simulation.load_trajectory is load_trajectory


@pytest.mark.parametrize("name", ["trajectory.csv", "trajectory.csv.gz"])
def test_the_file_holds_all_of_it(plan: Plan, tmp_path: Path, name: str) -> None:
    t = plan.trajectory
    path = save_trajectory(t, tmp_path / name)
    data = path.read_bytes()
    assert (gzip.decompress(data) if name.endswith("gz") else data) == t.csv().encode()
    back = load_trajectory(path)
    assert back.tau is not None
    assert back.s is not None
    np.testing.assert_allclose(back.q, t.q, atol=1e-8)
    np.testing.assert_allclose(back.tau, plan.tau, rtol=1e-8, atol=1e-8)
    np.testing.assert_allclose(back.s, t.s, atol=1e-8)
    bare = Trajectory(t.time, t.q, t.qd, t.qdd)
    assert bare.csv().splitlines()[0] == ",".join(t.csv().splitlines()[0].split(",")[:19])


def test_rows_too_far_apart_are_given_but_not_followed() -> None:
    turns = builders.circle((0.95, 0.0, 0.6), 0.15, sweep=6 * np.pi)
    pytest.importorskip("toppra")
    sparse = plan_path(ROBOT, turns, rate=3.0, free_tool_rotation=False, timing="toppra")
    with pytest.raises(InputError, match="sample it more often"):
        simulate(ROBOT, sparse.trajectory, "computed_torque")


def test_what_is_no_motion_is_refused_with_a_reason(plan: Plan) -> None:
    t = plan.trajectory
    with pytest.raises(InputError, match=r"found a Plan, expected a Trajectory"):
        simulate(ROBOT, plan, "computed_torque")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="torques"):
        Trajectory(t.time, t.q, t.qd, t.qdd, plan.tau[:-1])
    with pytest.raises(InputError, match="found s"):
        Trajectory(t.time, t.q, t.qd, t.qdd, s=t.time[:-1])
    with pytest.raises(InputError, match="NaN"):
        Trajectory(t.time, t.q, t.qd, t.qdd, np.nan * plan.tau)
    still = joint_move(MODEL, HOME, HOME)
    with pytest.raises(InputError, match="n >= 2"):
        still.trajectory.at_rate(1000.0)


def test_a_log_needs_no_file(plan: Plan) -> None:
    t = plan.trajectory
    again = recorded_motion(Log(t.time, t.q, plan.tau))
    assert abs(again.duration - t.duration) < 0.01


def test_a_trajectory_shares_what_nobody_writes_to_and_copies_the_rest() -> None:
    time = np.arange(3.0)
    q = np.zeros((3, 6))
    motion = Trajectory(time, q, q, q)
    q[0, 0] = 1.0
    assert motion.q[0, 0] == 0.0, "its own"
    again = Trajectory(motion.time, motion.q, motion.qd, motion.qdd)
    assert again.q is motion.q
    hidden = q.view()
    hidden.setflags(write=False)
    other = Trajectory(time, hidden, hidden, hidden, check_speeds=False)
    q[0, 0] = 2.0
    assert other.q[0, 0] == 1.0, "a view of what may be written to is copied"
