"""The motions to identify an arm by: within every limit, better conditioned, and they close."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from identification.possible_arms import PossibleCase, log_of, possible_robot, scores_of

import irb2400_ctrl as irb
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.excitation import Budget, IdentificationMotion, excite_identification
from irb2400_ctrl.excitation.feasible import SHARE
from irb2400_ctrl.identification.constant_runs import runs_of
from irb2400_ctrl.planners.programs.rapid.rapid_reader import read_rapid
from irb2400_ctrl.report.pages.identification_motion_page import number_rows

SMALL = Budget(pool=24, rounds=1, mutations=8)
ROBOT = possible_robot()


@cache
def planned() -> IdentificationMotion:
    return excite_identification(ROBOT, budget=SMALL)


def test_it_shows_more_than_the_usual_motion() -> None:
    found = planned()
    before, after = found.distances
    assert after[0] > 1.5 * before[0]
    assert found.condition[1] < 0.8 * found.condition[0]


def test_both_motions_keep_every_limit() -> None:
    found = planned()
    model = irb.Model(found.robot)
    for course in (found.course, found.runs.course):
        assert (course.q >= ROBOT.q_min).all()
        assert (course.q <= ROBOT.q_max).all()
        assert (np.abs(course.qd) <= ROBOT.qd_max).all()
        torque = model.inverse_dynamics(course.q, course.qd, course.qdd)
        assert (np.abs(torque) <= (SHARE + 0.01) * ROBOT.tau_max).all()
        assert model.tcp_pose(course.q[::10])[:, 2, 3].min() > 0.09
        # speeds and accelerations are those of the angles
        h = course.time[1] - course.time[0]
        speed = np.gradient(course.q, h, axis=0)
        np.testing.assert_allclose(speed, course.qd, atol=0.5 * h * np.abs(course.qdd).max() + 1e-6)


def test_every_joint_runs_at_every_speed_both_ways() -> None:
    runs = planned().runs
    course = runs.course
    log = irb.Log(course.time, course.q, runs.tau)
    found = runs_of(log)
    for j, speeds in enumerate(runs.speeds):
        own = np.array([run.speed for run in found if run.joint == j + 1])
        for speed in speeds:
            assert np.isclose(own, speed, rtol=0.02).any(), (j + 1, speed)
            assert np.isclose(own, -speed, rtol=0.02).any(), (j + 1, -speed)


def test_the_files_hold_the_motions(tmp_path: Path) -> None:
    found = planned()
    paths = {path.name: path for path in found.write(tmp_path)}
    told = json.loads(paths["excitation.json"].read_text())
    assert told["condition_number"]["planned"] == pytest.approx(found.condition[1])
    slow = read_rapid(paths["friction_runs.mod"].read_text()).trajectory(irb.Model(ROBOT))
    # a run of half a degree must still be one: the controller moves straight between targets
    q = np.column_stack(
        [np.interp(slow.time, found.runs.course.time, c) for c in found.runs.course.q.T]
    )
    assert np.degrees(np.abs(slow.q - q).max()) < 0.1
    assert paths["trajectory.csv"].stat().st_size > 1e5


def test_what_the_motion_cannot_show_is_said_in_words() -> None:
    """The terminal said by how many thousandths of a standard error a number stood out, and only
    the file how near the motion comes to the ends of the joints' ranges."""
    found = planned()
    told = "\n".join(found.lines())
    assert f"{np.degrees(found.extent.box):.1f} deg or more inside the ranges used" in told
    assert "cannot be seen" not in told
    own = found.alone[1].copy()
    own[3] = 0.004
    blind = replace(found, alone=(found.alone[0], own))
    told = "\n".join(blind.lines())
    assert "stands out" not in told
    assert f"cannot be seen in this motion: {found.numbers[3]}\n" in told
    assert f"of {len(own)} numbers of the arm surely" in told
    assert number_rows(blind)[1][0][::2] == [found.numbers[3], "cannot be seen"]


def test_another_duration_is_refused() -> None:
    with pytest.raises(InputError, match="found 5 seconds"):
        excite_identification(ROBOT, seconds=5.0)


def test_plan_run_identify_closes() -> None:
    """An arm nobody has seen, in closed loop: true numbers inside the stated intervals;
    `benchmarks/plan_run_identify.py` has more arms."""
    case = PossibleCase(ROBOT, 611, 40.0)
    logs = [log_of(case, planned().course), log_of(case, planned().runs.course, "runs")]
    found = irb.identify(ROBOT, logs)
    assert {curve.joint for curve in found.friction} == {1, 2, 3, 4, 5, 6}
    assert sum(curve.shows_rise for curve in found.friction) >= 2
    _, z = scores_of(ROBOT, case, found)
    known = np.isfinite(z)
    assert np.mean(np.abs(z[known]) < 1.96) > 0.85
    for curve in (curve for curve in found.friction if curve.shows_rise):
        truth = case.machine.friction[curve.joint - 1]
        np.testing.assert_allclose(curve.law[:2], truth[:2], rtol=0.03)


def test_the_next_command_is_for_the_robot_that_was_given() -> None:
    """As printed it identified the IRB 2400 from the logs of another arm."""
    assert planned().lines()[-1].endswith("identify MOTION_LOG RUNS_LOG --out arm")
    named = planned().lines("my arm.toml")[-1]
    assert named.endswith("identify MOTION_LOG RUNS_LOG --robot 'my arm.toml' --out arm")
