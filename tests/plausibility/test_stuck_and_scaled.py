"""Channels that stand while others go on, torques that were hardly recorded, speeds of another
unit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter
from sound_logs import sound_log

from irb2400_ctrl.measurement import Log
from irb2400_ctrl.plausibility import LogProblem, log_problem
from irb2400_ctrl.plausibility.columns.agreement import speed_problem
from irb2400_ctrl.plausibility.columns.channels import channel_problem
from irb2400_ctrl.plausibility.log_check import examined

STEP = 0.004


def waves(seconds: float = 40.0) -> Log:
    """Three joints of slow sines with noise on the torques, a speed, and a command that they follow
    20 ms late."""
    rng = np.random.default_rng(6)
    time = np.arange(0.0, seconds, STEP)
    omega = np.array([0.9, 1.3, 1.7])
    tau = 20.0 * np.cos(0.7 * time[:, None] + np.arange(3)) + rng.standard_normal((len(time), 3))
    return Log(
        time,
        np.round(np.sin(time[:, None] * omega), 5),
        np.round(tau, 3),
        qd=omega * np.cos(time[:, None] * omega) + 0.01 * rng.standard_normal((len(time), 3)),
        q_ref=np.sin((time[:, None] + 0.02) * omega),
    )


def stopped(log: Log, joints: list[int], first: float, last: float) -> Log:
    """Angles that stand from where the joint turns next, so that nothing breaks off.

    Args:
        log: the record; joints: from 0; first, last: times after and until which they stand [s].
    """
    q = np.array(log.q)
    start = int(np.searchsorted(log.time, first))
    stop = int(np.searchsorted(log.time, last))
    for j in joints:
        turn = start + int(np.argmin(np.abs(np.diff(q[start : start + 900, j]))))
        q[turn:stop, j] = q[turn, j]
    return replace(log, q=q)


def kind(problem: LogProblem | None) -> str | None:
    return None if problem is None else problem.kind


@pytest.mark.parametrize("share", [0.3, 0.45, 0.6])
def test_a_torque_that_is_stuck_for_most_of_the_record_is_named(share: float) -> None:
    """The median of its noise is zero from half of the rows on."""
    log = waves()
    start = int(share * len(log.time))
    tau = np.array(log.tau)
    tau[start:, 1] = tau[start, 1]
    found = channel_problem(replace(log, tau=tau))
    assert found is not None
    assert (found.kind, found.joints) == ("constant_torque", (2,))
    assert found.fits["from_s"] == pytest.approx(log.time[start], abs=0.01)
    assert found.fits["to_s"] == pytest.approx(log.time[-1])


def test_a_torque_that_is_stuck_at_its_largest_value_is_no_limit() -> None:
    log = waves()
    tau = np.array(log.tau)
    tau[3000:, 1] = 30.0
    assert kind(channel_problem(replace(log, tau=tau))) == "constant_torque"


@pytest.mark.parametrize("rows", [3, 8, 12])
def test_a_torque_that_is_stuck_but_for_a_few_rows_is_named(rows: int) -> None:
    """Of so few no noise is known."""
    log = waves()
    tau = np.array(log.tau)
    tau[rows:, 1] = tau[rows, 1]
    assert kind(channel_problem(replace(log, tau=tau))) == "constant_torque"
    # a channel of coarse steps has no other rows, either
    tau[:, 1] = np.where(log.time % 8.0 < 4.0, 1.0, 2.0)
    assert kind(channel_problem(replace(log, tau=tau))) is None


def test_torques_that_stay_for_good_reasons_are_no_stuck_channel() -> None:
    """Coarse steps, channels read seldom, brakes that hold a joint."""
    log = waves()
    coarse = replace(log, tau=np.round(log.tau / 15.0) * 15.0)
    seldom = replace(log, tau=log.tau[np.arange(len(log.tau)) // 5 * 5])
    braked = stopped(log, [0, 1, 2], 15.0, 40.0)
    begin = 5000
    tau = np.array(log.tau)
    tau[begin:] = tau[begin]
    still = np.array(braked.q)
    still[begin:] = still[begin]
    held = replace(braked, q=still, tau=tau, qd=None, q_ref=None)
    for one in (log, coarse, seldom, held):
        assert kind(channel_problem(one)) is None


@pytest.mark.parametrize("told_by", ["qd", "q_ref", "both"])
def test_an_angle_that_stands_while_another_signal_goes_on_is_named(told_by: str) -> None:
    """It stopped where the joint turned: nothing breaks off."""
    log = stopped(waves(), [1], 18.0, 40.0)
    if told_by != "both":
        log = replace(log, **{"q_ref" if told_by == "qd" else "qd": None})
    found = channel_problem(log)
    assert found is not None
    assert (found.kind, found.joints) == ("stuck_encoder", (2,))
    assert found.fits["to_s"] == pytest.approx(log.time[-1])
    assert 18.0 < found.fits["from_s"] < 22.0
    told = "commanded angle" if told_by == "q_ref" else "recorded speed"
    assert f"while its {told} goes on" in found.says


def test_an_angle_that_flickers_by_a_digit_stands() -> None:
    log = stopped(waves(), [1], 18.0, 40.0)
    q = np.array(log.q)
    q[6000:, 1] += 1e-5 * np.random.default_rng(1).integers(0, 2, len(q) - 6000)
    assert kind(channel_problem(replace(log, q=q))) == "stuck_encoder"


@pytest.mark.parametrize("told_by", ["qd", "q_ref"])
def test_a_joint_that_crawls_does_not_stand(told_by: str) -> None:
    """In half a second it moves by a digit; only its way back is quicker."""
    log = waves()
    q = np.array(log.q)
    reached = np.minimum(0.0018 * log.time, 0.006 * (44.2 - log.time))
    q[:, 1] = np.round(reached, 3)
    qd = np.array(log.qd)
    qd[:, 1] = np.gradient(reached, log.time)
    ref = np.array(log.q_ref)
    ref[:, 1] = reached
    told = replace(log, q=q, qd=qd, q_ref=ref)
    crawls = replace(told, q_ref=None) if told_by == "qd" else replace(told, qd=None)
    assert kind(channel_problem(crawls)) is None


def test_joints_that_stand_rightly_are_not_stuck() -> None:
    """One that was to stand, its speed with an offset and noise; an arm that was stopped while the
    controller went on commanding; rows that a host wrote again for half a second."""
    whole = waves()
    assert whole.qd is not None
    assert whole.q_ref is not None
    one = stopped(whole, [1], 18.0, 40.0)
    stands = np.diff(one.q, axis=0, prepend=0.0) == 0.0
    noise = np.random.default_rng(2).standard_normal(stands.shape)
    speed = np.where(stands, 0.0, whole.qd) + 0.05 + 0.02 * noise
    commanded = replace(one, qd=speed, q_ref=np.where(stands, one.q, whole.q_ref))
    halted = replace(stopped(whole, [0, 1, 2], 18.0, 40.0), qd=None)
    rows = np.arange(len(whole.time))
    slow = int(np.argmin(np.abs(whole.qd[3000:4000, 1]))) + 3000
    rows[slow : slow + 125] = slow
    again = Log(whole.time, whole.q[rows], whole.tau[rows], qd=whole.qd[rows])
    for log in (whole, commanded, halted):
        assert kind(channel_problem(log)) is None
    # all columns at once are another thing
    assert kind(channel_problem(again)) == "frozen"


def test_a_joint_that_stands_to_the_end_is_remarked_on_where_nothing_says_that_it_was_to() -> None:
    log = stopped(waves(), [1], 18.0, 41.0)
    assert log.qd is not None
    speed = np.where(np.diff(log.q, axis=0, prepend=0.0) == 0.0, 0.0, log.qd)
    alone = replace(log, qd=np.round(speed, 3), q_ref=None)
    short = replace(waves(15.0), qd=None, q_ref=None)
    assert examined(None, stopped(short, [1], 8.0, 16.0)).remarkable == ()
    (said,) = examined(None, alone).remarkable
    assert said.startswith("joint 2 stands at one value from ")
    assert examined(None, alone).problem is None
    for other in (replace(alone, q_ref=log.q + 1e-5), replace(waves(), q_ref=None)):
        assert examined(None, other).remarkable == ()


def test_joints_that_move_in_turn_are_not_remarked_on() -> None:
    """Runs for friction: each axis moves once, then stands to the end."""
    whole = waves(60.0)
    part = np.clip(whole.time[:, None] - [0.0, 20.0, 40.0], 0.0, 20.0)
    log = replace(whole, q=np.round(0.4 - 0.4 * np.cos(part * np.pi / 10.0), 5), qd=None)
    alone = replace(log, q_ref=None)
    assert examined(None, alone).remarkable == ()
    # of one that stands while two others move an encoder may have stuck
    q = np.array(alone.q)
    q[:, 1:] += 0.3 * np.sin(whole.time[:, None] * [0.9, 1.3])
    (said,) = examined(None, replace(alone, q=q)).remarkable
    assert said.startswith("joint 1 stands at one value from ")


def test_a_speed_that_breaks_off_is_that_of_a_stuck_encoder() -> None:
    """Of a Tiago the angle stood for 55 of 80 s and the drive's speed with it; with coarse angles
    the break of the angle alone is none."""
    whole = waves()
    assert whole.qd is not None
    # angles as coarse as those of a slow encoder: their bends are digits
    q = np.round(whole.q, 3)
    smooth = np.cos(whole.time[:, None] * [0.9, 1.3, 1.7]) * [0.9, 1.3, 1.7]
    start = int(np.argmax(np.abs(smooth[4500:5500, 1]) > 1.2)) + 4500
    q[start:, 1] = q[start, 1]
    speed = np.array(smooth)
    speed[start:, 1] = 0.0
    log = replace(whole, q=q, qd=speed, q_ref=None)
    found = channel_problem(log)
    assert found is not None
    assert (found.kind, found.joints) == ("stuck_encoder", (2,))
    assert kind(channel_problem(replace(log, qd=None))) is None


@pytest.mark.parametrize("factor", [0.5, 0.8, 1.25, 2.0])
def test_a_clock_a_little_off_is_told_by_the_recorded_speed(factor: float) -> None:
    found = speed_problem(replace(waves(), time=waves().time * factor))
    assert found is not None
    assert found.kind == "time_scale"
    assert found.fits["factor"] == pytest.approx(1.0 / factor, rel=0.02)


def test_the_factor_of_a_clock_is_that_of_the_recorded_speed() -> None:
    """The model tries few: of a clock 1.75 times too fast it was 2.5."""
    drawn = sound_log(601, plain=True)
    assert drawn.log.qd is not None
    found = log_problem(drawn.robot, replace(drawn.log, time=drawn.log.time / 1.75))
    assert found is not None
    assert found.kind == "time_scale"
    assert found.fits["factor"] == pytest.approx(1.75, rel=0.02)


def test_a_clock_is_told_by_the_speeds_where_the_torques_fit_nothing() -> None:
    """It was "these columns do not fit the robot", with readings of the torques to choose from."""
    drawn = sound_log(601, plain=True)
    log = replace(drawn.log, time=2.5 * drawn.log.time, tau=drawn.log.tau[::-1])
    found = log_problem(drawn.robot, log)
    assert found is not None
    assert found.kind == "time_scale"
    assert found.fits["factor"] == pytest.approx(0.4, rel=0.02)


def test_a_clock_that_speeds_agree_with_is_said_with_them() -> None:
    """Torques of a faster motion: that the clock is wrong is not all that can be."""
    drawn = sound_log(601, plain=True)
    assert drawn.log.qd is not None
    log = replace(drawn.log, time=drawn.log.time / 1.75)
    found = log_problem(drawn.robot, replace(log, qd=1.75 * drawn.log.qd))
    assert found is not None
    assert found.kind == "time_scale"
    assert "by the torques, but the recorded speeds are dq/dt by this clock" in found.says
    silent = log_problem(drawn.robot, replace(log, qd=None))
    assert silent is not None
    assert "but" not in silent.says


def test_a_factor_on_one_speed_is_a_unit_and_a_late_or_filtered_speed_is_none() -> None:
    log = waves()
    assert log.qd is not None
    found = speed_problem(replace(log, qd=log.qd * [1.0, 1.0, 1.5]))
    assert found is not None
    assert (found.kind, found.joints) == ("speed_unit", (3,))
    assert "gear ratio" in found.says
    late = np.roll(log.qd, round(0.19 / STEP), axis=0)
    late[: round(0.19 / STEP)] = 0.0
    assert kind(speed_problem(replace(log, qd=late))) is None
    # takes 13 % of the quickest joint's speed away
    slow = lfilter([STEP / 0.4], [1.0, STEP / 0.4 - 1.0], log.qd, axis=0)
    assert np.std(slow[1000:, 2]) < 0.87 * np.std(log.qd[1000:, 2])
    for speed in (slow, np.round(log.qd, 1), 1.05 * log.qd):
        assert kind(speed_problem(replace(log, qd=speed))) is None
    # a clock is seen behind a late speed, too
    assert kind(speed_problem(replace(log, time=0.5 * log.time, qd=late))) == "time_scale"


def test_a_contact_does_not_make_coarse_torques_unrecorded() -> None:
    """A wrist whose torques are below half a digit, and one peak."""
    log = waves()
    tau = np.array(log.tau)
    tau[:, 1] = np.round(0.35 * np.cos(log.time) + 0.1 * tau[:, 1] / 20.0)
    tau[2000:2060, 1] = np.round(12.0 * np.sin(np.linspace(0.0, np.pi, 60)))
    assert np.mean(tau[:, 1] == 0.0) > 0.9
    assert kind(channel_problem(replace(log, tau=tau))) is None


def test_torques_that_are_hardly_recorded_are_named_and_not_another_robot() -> None:
    """Of a Tiago the currents of the wrist are zero in nine rows of ten."""
    log = waves()
    tau = np.array(log.tau)
    kept = np.random.default_rng(3).uniform(size=tau.shape) < 0.12
    tau[:, 1:] = np.where(kept, tau, 0.0)[:, 1:]
    found = channel_problem(replace(log, tau=tau))
    assert found is not None
    assert (found.kind, found.joints) == ("zero_torque", (2, 3))
    assert "Record it, or make the joint fixed" in found.says
    # torques that are small beside their digit are zero, too
    coarse = 15.0 * np.round(log.tau / 15.0)
    coarse[:, 1] = np.where(np.abs(log.tau[:, 1]) > 21.0, coarse[:, 1], 0.0)
    assert np.mean(coarse[:, 1] == 0.0) > 0.8
    assert kind(channel_problem(replace(log, tau=coarse))) is None
