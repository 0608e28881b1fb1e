"""Torques that a recorder low-passed: found, imitated, and no reason for a name."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from independent_plant import Case, Effect
from scipy.signal import butter, sosfiltfilt

from irb2400_ctrl.diagnosis import Diagnosis, diagnose
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.identification import identify, validate
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.measurement.joined_log import prepare_together
from irb2400_ctrl.measurement.prepared_log import prepare
from irb2400_ctrl.measurement.torque_filter import TorqueFilter, _possible, find_torque_filter
from irb2400_ctrl.plausibility import check_log
from irb2400_ctrl.report.pages.diagnosis_page import lines
from irb2400_ctrl.report.pages.validation_page import lines as validation_lines
from irb2400_ctrl.robot import load_robot

STEP = 0.004
TIME = np.arange(0.0, 24.0, STEP)


def both_ways(tau: np.ndarray, cutoff: float, order: int = 4) -> np.ndarray:
    """As scipy filters forwards and backwards."""
    return np.asarray(sosfiltfilt(butter(order, cutoff, fs=1 / STEP, output="sos"), tau, axis=0))


def motion(joints: int = 3) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Angles, speeds, accelerations of swings with many reversals."""
    w = 1.1 + 0.4 * np.arange(joints)
    angle = w * TIME[:, None]
    return np.sin(angle), w * np.cos(angle), -(w**2) * np.sin(angle)


def torque(friction: float, noise: float) -> np.ndarray:
    q, qd, qdd = motion()
    drawn = np.random.default_rng(5).standard_normal(q.shape)
    return 20 * np.sin(q) + 3 * qdd + 4 * qd + friction * np.sign(qd) + noise * drawn


@pytest.mark.parametrize(
    ("cutoff", "order"), [(0.8, 4), (1.5, 2), (2.0, 4), (3.0, 3), (5.0, 4), (1.8, 8)]
)
def test_a_filter_is_found(cutoff: float, order: int) -> None:
    found = find_torque_filter(both_ways(torque(8.0, 0.5), cutoff, order), *motion(), STEP)
    assert found is not None
    assert found.cutoff == pytest.approx(cutoff, rel=0.1)


@pytest.mark.parametrize("noise", [0.0, 0.5])
def test_none_is_where_none_was(noise: float) -> None:
    assert find_torque_filter(torque(8.0, noise), *motion(), STEP) is None


def test_a_log_of_few_samples_a_second_was_not_filtered() -> None:
    """Above half its rate there is nothing of itself, and not for a filter."""
    slow = slice(None, None, 20)
    q, _, _ = motion()
    log = Log(TIME[slow], q[slow], torque(8.0, 1.0)[slow])
    assert not any(prepare(log).recorders)


@pytest.mark.parametrize("width", [0.03, 0.1, 0.3])
def test_smooth_friction_of_a_simulation_is_not_a_filter(width: float) -> None:
    _, qd, _ = motion()
    smooth = torque(0.0, 0.0) + 8.0 * np.tanh(qd / width)
    assert find_torque_filter(smooth, *motion(), STEP) is None


def test_a_smooth_torque_without_dry_friction_is_not_a_filtered_one() -> None:
    assert find_torque_filter(torque(0.0, 0.0), *motion(), STEP) is None


def test_nothing_is_said_of_an_arm_at_rest_or_a_short_log() -> None:
    q = np.ones((len(TIME), 2))
    assert find_torque_filter(both_ways(q, 2.0), q, 0 * q, 0 * q, STEP) is None
    short = slice(0, 900)
    signals = [signal[short] for signal in motion()]
    assert find_torque_filter(both_ways(torque(8.0, 0.5), 2.0)[short], *signals, STEP) is None


def test_a_signal_that_holds_more_than_the_filter_lets_through_did_not_pass_it() -> None:
    """Slow friction steps on one joint, and a fast true torque: no slow filter made that."""
    beside = 6.0 * np.sin(2 * np.pi * 4.5 * TIME)[:, None]
    found = find_torque_filter(both_ways(torque(0.5, 0.1) + beside, 6.0), *motion(), STEP)
    assert found is None or found.cutoff > 3.0


def test_it_is_what_scipy_does_forwards_and_backwards() -> None:
    tau = torque(8.0, 0.0)
    made = TorqueFilter(2.0, 4.0)(tau, STEP)
    inside = slice(500, -500)
    np.testing.assert_allclose(made[inside], both_ways(tau, 2.0)[inside], atol=0.05)
    assert made.shape == tau.shape
    constant = np.full((800, 2, 3), 7.0)
    np.testing.assert_allclose(TorqueFilter(2.0, 4.0)(constant, STEP), constant, rtol=1e-12)
    assert TorqueFilter(2.0, 4.0)(np.empty((800, 2, 0)), STEP).shape == (800, 2, 0)


def filtered(log: Log, cutoff: float | None) -> Log:
    return log if cutoff is None else replace(log, tau=both_ways(log.tau, cutoff))


@cache
def simulated(*effects: Effect) -> tuple[Log, Log]:
    case = Case(31, effects, duration=25.0, validation_duration=12.0)
    one, other = (
        Log(run.time, run.q, run.tau, q_ref=run.q_ref, name=name)
        for run, name in zip(case.simulate(), ("first", "second"), strict=True)
    )
    return one, other


@cache
def diagnosed(*effects: Effect) -> Diagnosis:
    return diagnose(load_robot("irb2400"), filtered(simulated(*effects)[0], 2.5))


def test_a_sound_arm_stays_one_and_the_filter_is_said() -> None:
    found = diagnosed()
    assert found.verdict == "nothing_missing"
    (told,) = (line for line in lines(found) if "low-passed" in line)
    assert "about 2.5 Hz" in told


@pytest.mark.slow
def test_an_effect_is_named_through_the_filter() -> None:
    found = diagnosed(Effect("torque_gain", 5, 0.1))
    assert [(f.effect.kind, f.effect.joint) for f in found.findings] == [("torque_gain", 5)]


def test_predictions_of_each_log_go_through_its_own_filter() -> None:
    one, other = simulated()
    slow = prepare(filtered(one, 2.0))
    fast = prepare(other)
    (recorder,) = slow.recorders
    assert recorder is not None
    assert fast.recorders == (None,)
    both = prepare_together([filtered(one, 2.0), other])
    assert both.recorders == (recorder, None)
    steps = np.sign(both.qd)
    shown = both.as_recorded(steps)
    np.testing.assert_array_equal(shown[both.starts[1] :], steps[both.starts[1] :])
    np.testing.assert_allclose(shown[: both.starts[1]], recorder(steps[: both.starts[1]], STEP))
    rows = np.concatenate([slow.filtered(np.sign(slow.qd)), fast.filtered(np.sign(fast.qd))])
    np.testing.assert_allclose(both.filtered(steps), rows)
    assert both.rows == slow.rows + fast.rows == len(both.row_known)
    # the same as one filter after the other, to the ends, which the recorder took to last
    rng = np.random.default_rng(2)
    wild = np.cumsum(rng.standard_normal((len(slow.time), 3)), axis=0) + 5.0
    np.testing.assert_allclose(slow.filtered(wild), slow.low_pass(slow.as_recorded(wild)))
    # rows stand as far apart as the log tells something new
    assert slow.rows < 0.5 * prepare(one).rows


def test_what_came_before_a_log_and_standstills_smear_into_it() -> None:
    one = simulated()[0]
    known, smeared = (prepare(log).known for log in (one, filtered(one, 2.0)))
    reach = round(0.3 / (2.0 * STEP))
    assert not smeared[: reach - 10].any()
    assert not smeared[-reach + 10 :].any()
    assert not (smeared & ~known).any()
    assert smeared.mean() > 0.7


def test_identification_and_validation_take_the_same_filter() -> None:
    robot = load_robot("irb2400")
    one, _ = simulated()
    plain, through = (identify(robot, filtered(one, cutoff)) for cutoff in (None, 2.0))
    assert any("low-passed" in note for note in through.notes)
    assert not any("low-passed" in note for note in plain.notes)
    # dry friction is what the unfiltered log says of it
    np.testing.assert_allclose(through.robot.friction[:, 1], plain.robot.friction[:, 1], rtol=0.05)
    result = validate(through.robot, filtered(one, 2.0))
    assert any("low-passed" in line for line in validation_lines(result))
    np.testing.assert_allclose(result.error.rmse, through.logs[0].error("fitted").rmse, rtol=1e-6)


def test_a_checked_log_says_it() -> None:
    one = simulated()[0]
    robot = load_robot("irb2400")
    assert any("low-passed" in remark for remark in check_log(robot, filtered(one, 2.0)).remarks)
    assert not any("low-passed" in remark for remark in check_log(robot, one).remarks)


def test_a_log_too_short_to_be_prepared_is_still_refused() -> None:
    one = simulated()[0]
    rows = slice(0, 520)
    short = Log(one.time[rows], one.q[rows], both_ways(one.tau, 2.0)[rows])
    with pytest.raises(InputError, match="expected at least 2 s"):
        prepare(replace(short, time=short.time[:400], q=short.q[:400], tau=short.tau[:400]))


def test_a_joint_that_hardly_moves_is_no_hindrance() -> None:
    q, qd, qdd = motion()
    still = np.array([1.0, 1.0, 2e-3])
    found = find_torque_filter(
        both_ways(torque(8.0, 0.5), 2.0), q * still, qd * still, qdd * still, STEP
    )
    assert found is not None
    assert found.cutoff == pytest.approx(2.0, rel=0.1)


@pytest.mark.parametrize(("above", "sharpest"), [(0.01, 8.0), (0.03, 4.0)])
def test_a_sharp_filter_leaves_hardly_anything_above_its_cut_off(
    above: float, sharpest: float
) -> None:
    power = np.array([[1.0], [above**2]])
    found = _possible(np.array([0.2, 30.0]), power)
    assert max(one.order for one in found) == sharpest
