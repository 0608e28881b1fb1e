"""What is said of a log where a robot and its columns fit, but not well."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from sound_logs import sound_log

from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.diagnosis.sound_logs import sound_logs
from irb2400_ctrl.identification.understood_logs import said_of, understood_logs
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.plausibility import LogCheck, check_log, log_problem
from irb2400_ctrl.plausibility.columns.channels import channel_problem
from irb2400_ctrl.plausibility.evidence import Fit, Nominal
from irb2400_ctrl.plausibility.log_check import _beyond_limits, _perhaps, examined
from irb2400_ctrl.plausibility.reading import as_labelled, motion_readings, torque_readings
from irb2400_ctrl.plausibility.rows import rows_of
from irb2400_ctrl.plausibility.search import Understanding
from irb2400_ctrl.plausibility.travel import fastest
from irb2400_ctrl.plausibility.tried_readings import TriedReadings
from irb2400_ctrl.robot import load_robot

ROBOT = load_robot("irb2400")
LOG = sound_log(601, plain=True).log


def crude(signs: tuple[float, ...] = (1.0,) * 6) -> LogCheck:
    """A sound log of an arm of which the model misses a third of the torque; `signs`: of the torque
    columns."""
    rng = np.random.default_rng(4)
    size = np.sqrt(np.mean(LOG.tau**2, axis=0))
    slow = np.sin(LOG.time[:, None] * rng.uniform(0.5, 2.0, 6) + rng.uniform(0, 6, 6))
    tau = LOG.tau + 0.42 * size * slow
    return check_log(ROBOT, replace(LOG, tau=np.array(signs) * tau, q_ref=None))


def test_of_a_rough_arm_the_nearest_reading_is_said_beside_another_robot() -> None:
    """Of a hobby arm, of which the model leaves 10 to 20 % and more on two joints, every wrong sign
    was "another robot", which no reading fits."""
    assert crude().sound
    found = crude((1.0, -1.0, 1.0, 1.0, 1.0, 1.0))
    assert found.problem is not None
    assert found.problem.kind == "not_this_robot"
    assert "nearest to it: the torque of joint 2 looks turned over" in found.problem.says
    assert found.problem.fits["nearest"] == {"kind": "torque_sign", "joints": [2], "factor": -1.0}


def test_what_is_remarkable_about_a_sound_log_is_told_by_every_command() -> None:
    """Of a clock 1.5 times too fast, and of a reading that fits better where the columns fit."""
    times = 1.5 / float(fastest(ROBOT, LOG).max())
    quick = Log(LOG.time / times, LOG.q, LOG.tau)
    told = _beyond_limits(ROBOT, quick)
    assert told[0] == "joint 1 moves at 1.5 times the speed limit of the robot file"
    assert all("times the speed limit" in one for one in told)
    turned = next(one for one in torque_readings(ROBOT) if one.joints == (5,))
    labelled = Fit(250.0, 250.0, np.array([0.1, 0.1, 0.1, 0.1, 0.4, 0.1]))
    best = Fit(160.0, 160.0, np.full(6, 0.1))
    (said,) = _perhaps(None, Understanding(labelled, best, turned, None))
    assert said.startswith("the robot fits better otherwise: the torque of joint 5 looks turned")
    assert (
        "(10, 10, 10, 10, 10, 10 % of the joints' torques left in the place of 10, 10, 10" in said
    )
    assert not _perhaps(None, Understanding(best, best, as_labelled(6), None))
    sound = examined(ROBOT, LOG)
    assert (sound.problem, sound.remarkable) == (None, ())


def test_a_diagnosis_and_an_identification_say_it() -> None:
    first, *rest = ROBOT.joints
    assert first.limits.speed_deg_s is not None
    slow = 0.4 * first.limits.speed_deg_s
    limits = first.limits.model_copy(update={"speed_deg_s": slow})
    robot = ROBOT.model_copy(
        update={"joints": (first.model_copy(update={"limits": limits}), *rest)}
    )
    told = "joint 1 moves at 1.2 times the speed limit of the robot file"
    assert sound_logs(robot, [LOG]).remarkable == (told,)
    assert said_of(understood_logs(robot, [LOG])) == [f"{LOG.name}: {told}"]
    few = LOG.time < LOG.time[0] + 8.0
    parts = {name: getattr(LOG, name)[few] for name in ("time", "q", "tau")}
    assert told in diagnose(robot, Log(**parts)).weak
    again = replace(LOG, tau=LOG.tau * 1.0001)  # no copy of the other
    assert sound_logs(robot, [LOG, again]).remarkable == (f"{LOG.name}: {told}",) * 2


def test_nothing_is_said_of_the_angle_of_a_joint_that_rests() -> None:
    """Of a log in which one axis moves the angles of another looked like radians."""
    q = np.tile(LOG.q[0], (len(LOG.time), 1))
    q[:, 1] = LOG.q[:, 1]
    log = replace(LOG, q=q, qd=None, q_ref=None)
    rows = rows_of(log)
    assert rows is not None
    search = TriedReadings(Nominal(ROBOT), log, rows)
    kinds = {"angle_unit", "angle_sign", "axis_sign", "angle_zero"}
    of_one = [one for one in motion_readings(ROBOT) if one.kind in kinds and len(one.joints) == 1]
    assert {one.joints for one in of_one if search._shows(one)} == {(2,)}
    assert {one.joints for one in of_one} == {(j,) for j in range(1, 7)}
    # what holds it says how its torque is to be read
    assert all(search._shows(one) for one in torque_readings(ROBOT))
    whole = TriedReadings(Nominal(ROBOT), LOG, rows)
    gone = [one for one in of_one if not whole._shows(one)]
    assert {one.kind for one in gone} <= {"angle_unit"}


def test_an_angle_is_not_read_so_that_its_joint_leaves_its_range() -> None:
    """A wrist of small loads that turned 95 deg was "radians under the name of degrees": 5,440 deg
    of a joint of 720."""
    rows = rows_of(LOG)
    assert rows is not None
    readings = [one for one in motion_readings(ROBOT) if one.kind == "angle_unit"]
    larger = [one for one in readings if one.fits["factor"] > 10.0]
    smaller = [one for one in readings if one.fits["factor"] < 1.0]
    assert len(larger) == len(smaller) == 7
    search = TriedReadings(Nominal(ROBOT), LOG, rows)
    assert not any(map(search._shows, larger))
    assert all(map(search._shows, smaller))
    # degrees that the file calls radians, and radians that it calls degrees
    for factor, there in ((57.3, smaller), (1 / 57.3, larger)):
        read_so = TriedReadings(Nominal(ROBOT), replace(LOG, q=factor * LOG.q, q_ref=None), rows)
        assert all(map(read_so._shows, there))


def test_a_packet_that_came_late_is_no_jump() -> None:
    """Its step takes hardly any time by the stamps; rows that are read seldom are held ones."""
    thin = {name: getattr(LOG, name)[::12] for name in ("time", "q", "tau")}
    time = np.array(thin.pop("time"))
    fastest_at = np.abs(np.diff(thin["q"], axis=0)).max(axis=1).argmax()
    time[fastest_at] = time[fastest_at + 1] - 0.02 * np.median(np.diff(time))
    assert channel_problem(Log(time, **thin)) is None
    held = np.arange(len(LOG.time)) // 30 * 30
    found = channel_problem(replace(LOG, q=LOG.q[held], tau=LOG.tau[held], qd=None, q_ref=None))
    assert found is not None
    assert found.kind == "held_samples"


def test_a_joint_that_was_to_stand_is_not_stuck() -> None:
    """Of slow runs of one axis after the other, as `excite` plans them, the other axes stand."""
    q = np.array(LOG.q)
    start = int(np.argmax(np.abs(np.gradient(q[:, 0])[2000:4000]))) + 2000
    q[start:, 0] = q[start, 0]
    asked = q.copy()
    for command, kind in ((asked, None), (LOG.q, "stuck_encoder")):
        found = channel_problem(replace(LOG, q=q, qd=None, q_ref=command))
        assert (found.kind if found else None) == kind


def test_two_axes_that_turn_the_other_way_are_named_together() -> None:
    signs = np.array([1.0, -1.0, 1.0, 1.0, -1.0, 1.0])
    problem = log_problem(ROBOT, Log(LOG.time, signs * LOG.q, signs * LOG.tau))
    assert problem is not None
    assert (problem.kind, problem.joints) == ("axis_sign", (2, 5))
    assert problem.says.startswith("the axes of joints 2, 5 look turned over, angle and torque")
