"""Whole programs as one motion: what is promised of it, looked at with other means."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from rapid_events import SIGNALS
from toolpath_cases.programs import PROGRAMS

from irb2400_ctrl import load_robot
from irb2400_ctrl.arrays import Array
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners import ProgramMotion, ProgramPlan, check, plan_program, read_program
from irb2400_ctrl.planners.linking.joint_plan import JointPlan
from irb2400_ctrl.planners.programs.rapid import RapidOptions, check_rapid, read_rapid
from irb2400_ctrl.planners.programs.rapid.rapid_of_plan import (
    JOINT_MOVES,
    rapid_of_motion,
    rapid_of_plan,
)
from irb2400_ctrl.planners.toolpath.work_frame import work_frame

ROBOT = load_robot("irb2400")
MODEL = Model(ROBOT)
FRAME = work_frame("900,-20,450,0,0,0")
UP = np.array([0.0, 0.0, 1.0])


MORE = ("drilling pattern", "pocket with walls")
Planned = Callable[[str], ProgramPlan]


@pytest.fixture(scope="module")
def planned(tmp_path_factory: pytest.TempPathFactory) -> Planned:
    """A named program, planned when it is first asked for."""
    folder = tmp_path_factory.mktemp("programs")

    @cache
    def plan(name: str) -> ProgramPlan:
        suffix, text = PROGRAMS[name]
        file = folder / f"{name.replace(' ', '_')}{suffix}"
        file.write_text(text)
        return plan_program(ROBOT, read_program(file), work_frame=FRAME)

    return plan


@pytest.fixture(
    params=[pytest.param(name, marks=[pytest.mark.slow] * (name in MORE)) for name in PROGRAMS]
)
def motion(request: pytest.FixtureRequest, planned: Planned) -> ProgramMotion:
    found = planned(request.param)
    assert [o.refused for o in found.operations] == [""] * len(found.operations)
    assert found.motion is not None, found.refused_links
    return found.motion


def heights(q: Array) -> Array:
    """Of the TCP over the base [m]."""
    return np.asarray(MODEL.tcp_pose(q)[:, 2, 3])


def test_every_segment_keeps_its_limits_at_every_instant(motion: ProgramMotion) -> None:
    assert motion.guaranteed
    for segment in motion.segments:
        piece = segment.piece
        limits = piece.certificate.limits
        assert check(piece.certificate, MODEL).holds()
        # what the controller reads, ten thousand times a second, with the model's own dynamics
        end = piece.trajectory.time[-1]
        q, qd, qdd = piece.reference.states(np.linspace(0, end, int(min(1e4 * end, 4e4)) + 2))
        needed = np.abs(MODEL.inverse_dynamics(q, qd, qdd))
        assert (needed <= limits.tau_max).all()
        assert (needed / ROBOT.tau_max).max() <= piece.max_torque_ratio
        assert (np.abs(qd) <= limits.qd_max * (1 + 1e-9)).all()
        assert (q >= ROBOT.q_min - 1e-9).all()
        assert (q <= ROBOT.q_max + 1e-9).all()


def test_segments_meet_at_rest_and_the_file_is_all_of_them(motion: ProgramMotion) -> None:
    for before, after in zip(motion.segments[:-1], motion.segments[1:], strict=True):
        assert np.abs(before.piece.trajectory.q[-1] - after.piece.trajectory.q[0]).max() < 1e-6
        assert before.end == pytest.approx(after.start)
    for segment in motion.segments:
        assert (segment.piece.trajectory.qd[[0, -1]] == 0).all()
    rows = motion.trajectory
    assert rows.duration == pytest.approx(motion.duration)
    assert np.allclose(np.diff(rows.time), 1 / 250.0)
    assert rows.s is not None
    assert (np.diff(rows.s) >= -1e-12).all()
    # no row jumps: what a controller at this rate receives
    assert (np.abs(np.diff(rows.q, axis=0)) <= ROBOT.qd_max / 250.0 * (1 + 1e-6)).all()
    assert np.abs(rows.q[0]).max() == 0.0
    assert np.abs(rows.q[-1]).max() < 1e-12


def test_the_joints_only_move_above_the_clearance_plane(motion: ProgramMotion) -> None:
    cut = max(
        float(plan.path.position[:, 2].max())
        for plan in motion.plans
        if np.isfinite(plan.path.feed).any()
    )
    assert motion.plane.up == pytest.approx(UP, abs=0.05)
    moves = [s for s in motion.segments if isinstance(s.piece, JointPlan)]
    assert {s.kind for s in moves} >= {"approach", "return"}
    for segment in moves:
        piece = segment.piece
        assert isinstance(piece, JointPlan)
        law = piece.certificate.law
        _, q, _, _ = law.motion(piece.certificate.path, np.linspace(0, law.duration, 2000))
        above = (MODEL.tcp_pose(q)[:, :3, 3] @ motion.plane.up) - motion.plane.height
        assert above.min() >= -2e-3
        assert above.min() >= piece.lowest - 1e-9
    assert motion.plane.height >= cut * 0.99


def test_order_of_two_tools_and_a_stop(planned: Planned) -> None:
    motion = planned("two tools and a stop").motion
    assert motion is not None
    kinds = [(s.kind, s.operation) for s in motion.segments]
    assert kinds[0] == ("approach", 1)
    assert kinds[-1][0] == "return"
    assert [k for k in kinds if k[0] == "operation"] == [("operation", n) for n in (1, 2, 3)]
    # the arm leaves the part before it waits, and comes back along the tool axis
    assert kinds[1:8] == [
        ("lead-in", 1), ("operation", 1), ("retract", 1), ("link", 2), ("lead-in", 2),
        ("operation", 2), ("retract", 2),
    ]  # fmt: skip
    told = {(e.kind, e.text): e for e in motion.events}
    stop = next(e for e in motion.events if e.kind == "stop")
    second = next(e for e in motion.events if e.kind == "tool" and e.text.startswith("2"))
    assert stop.line == 10
    assert 0 < stop.time < second.time < motion.duration
    assert ("spindle", "6000 1/min clockwise") in told
    rows = motion.trajectory
    for event in motion.events:
        if event.at_rest:
            row = int(np.argmin(np.abs(rows.time - event.time)))
            assert (rows.qd[row] == 0).all()
            if event.time > 0:
                place = MODEL.tcp_pose(rows.q[row])[:3, 3]
                assert motion.plane.above(place) > -1e-4


def test_the_last_part_of_a_lead_in_is_driven_at_the_feed(
    planned: Planned,
) -> None:
    motion = planned("two tools and a stop").motion
    assert motion is not None
    # operation 2 goes on cutting after the stop, at 20 mm/s
    line = next(s for s in motion.segments if s.kind == "lead-in" and s.operation == 2)
    law = line.piece.certificate.law
    time = np.linspace(0, law.duration, 4000)
    _, q, _, _ = law.motion(line.piece.certificate.path, time)
    z = heights(q)
    speed = np.abs(np.diff(z)) / np.diff(time)
    low = z[1:] < z[-1] + 0.0099
    assert speed[low].max() <= 0.02 * 1.001
    assert speed[~low].max() > 0.1
    # straight down
    places = MODEL.tcp_pose(q)[:, :2, 3]
    assert np.ptp(places, axis=0).max() < 1e-5


def test_the_dome_is_unwound_where_it_costs_least(planned: Planned) -> None:
    found = planned("spiral over a dome")
    motion = found.motion
    assert motion is not None
    assert len(motion.unwindings) >= 1
    runs = found.operations[0].runs
    assert len(runs) == len(motion.unwindings) + 1
    # all way-points are passed, the ones where parts meet twice
    points = np.concatenate([run.points for run in runs])
    assert set(points[points >= 0]) == set(range(420))
    for run in runs:
        assert run.plan.max_tcp_deviation < 2e-3
    said = motion.summary()["unwindings"][0]
    assert "lifted at point" in said["says"]
    assert "axis" in runs[0].because
    assert "range" in runs[0].because
    # the arm is lifted by the clearance before it turns
    for segment in motion.unwindings:
        assert isinstance(segment.piece, JointPlan)
        assert segment.piece.lowest > -2e-3


def test_program_json_and_the_folders(planned: Planned, tmp_path: Path) -> None:
    found = planned("spiral over a dome")
    found.write(tmp_path)
    assert (tmp_path / "trajectory.csv").is_file()
    assert (tmp_path / "01_DOME" / "part_1" / "plan.json").is_file()
    summary = found.summary()
    assert summary["linked"] is True
    assert summary["transfers_not_planned"] == []
    assert summary["operations"][0]["parts"] == len(found.operations[0].runs)


def test_a_whole_program_as_rapid_reads_back(planned: Planned) -> None:
    found = planned("two tools and a stop")
    motion = found.motion
    assert motion is not None
    options = RapidOptions(signals=SIGNALS, targets_per_module=100)
    program = rapid_of_motion(motion, options, X_BW=FRAME)
    texts = [program.text, *program.parts.values()]
    for one in texts:
        assert check_rapid(one, *(other for other in texts if other != one)) == ()
    module = read_rapid(program.text, program.parts)
    q = motion.trajectory.q
    assert np.degrees(np.abs(module.joint_angles(MODEL) - q[program.samples])).max() < 1e-3
    # each move is of the kind of its segment, and every segment ends in a stop
    ends = np.array([segment.end for segment in motion.segments])
    times = motion.trajectory.time[program.samples]
    for move, time in zip(module.moves[1:], times[1:], strict=True):
        segment = motion.segments[int(np.searchsorted(ends, time - 1e-6))]
        assert (move.instruction == "MoveAbsJ") == (segment.kind in JOINT_MOVES), segment.kind
    stopped = times[[move.stops for move in module.moves]]
    assert all(np.abs(stopped - end).min() < 1e-6 for end in ends)
    said = [text for _, text in module.actions]
    assert said.count("PulseDO doChange") == 2
    assert said.count("Stop") == 1
    assert [text for text in said if "aoSpeed" in text] == [
        "SetAO aoSpeed,3000",
        # the change of tool
        "SetAO aoSpeed,0",
        "SetAO aoSpeed,6000",
        "SetAO aoSpeed,0",
    ]
    with pytest.raises(InputError, match="comes and goes by itself"):
        rapid_of_motion(motion, RapidOptions(approach_mm=10.0))
    first = found.operations[0]
    assert first.plan is not None
    alone = rapid_of_plan(first.plan, first.operation, RapidOptions(signals=SIGNALS))
    assert check_rapid(alone.text) == ()
    assert "SetAO aoSpeed,3000" in [text for _, text in read_rapid(alone.text).actions]
