"""Channels that hold their last value between samples: which rows are new, and what becomes of the
others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from irb2400_ctrl.measurement import Log
from irb2400_ctrl.measurement.motion.held_samples import new_rows, released
from irb2400_ctrl.measurement.prepared_log import prepare
from irb2400_ctrl.plausibility.columns.channels import channel_problem

RATE = 250.0
TIME = np.arange(0.0, 12.0, 1.0 / RATE)
FREQUENCIES = np.array([0.7, 0.9, 1.3])


def moved(time: np.ndarray) -> np.ndarray:
    return np.sin(2 * np.pi * FREQUENCIES * time[:, None] + [0.0, 1.0, 2.0])


def log(noise: float = 0.3) -> Log:
    rng = np.random.default_rng(4)
    q = moved(TIME)
    tau = 40.0 * np.cos(q) + 3.0 * np.sign(np.gradient(q, axis=0))
    return Log(TIME, q, tau + noise * rng.standard_normal(q.shape))


def held(values: np.ndarray, rows: int, first: int = 0) -> np.ndarray:
    place = (np.arange(len(values)) - first) // rows * rows + first
    return np.asarray(values[np.clip(place, 0, None)])


@pytest.mark.parametrize("rows", [2, 5, 10])
def test_the_rows_with_new_torques_are_used(rows: int) -> None:
    whole = log()
    fresh, said = released(replace(whole, tau=held(whole.tau, rows)))
    assert fresh.rate == pytest.approx(RATE / rows)
    # the first row may hold what was new long before
    assert fresh.time[0] == pytest.approx(rows / RATE)
    place = np.searchsorted(whole.time, fresh.time - 1e-6)
    assert np.array_equal(fresh.tau, whole.tau[place])
    assert np.array_equal(fresh.q, whole.q[place])
    assert said == (
        f"torques are new in {100 / rows:.0f} % of the rows only, and held in the others: the rows "
        f"with new torques are used, {RATE / rows:.4g} a second"
    )


def test_how_many_are_new_a_second_is_their_mean() -> None:
    """Of a host that polls by chance the smallest distance is one row: it was all 250."""
    rng = np.random.default_rng(5)
    whole = log()
    place = np.maximum.accumulate(np.arange(len(TIME)) + rng.integers(-2, 2, len(TIME)))
    place = np.clip(place, 0, len(TIME) - 1)
    fresh, said = released(replace(whole, q=whole.q[place], tau=whole.tau[place]))
    mean = float(said.rsplit(", ", 1)[1].split()[0])
    assert mean == pytest.approx((len(fresh.time) - 1) / fresh.duration, rel=1e-3)
    assert mean < 0.7 * RATE


def test_angles_that_are_new_in_other_rows_are_interpolated() -> None:
    """They were taken for half a period early or late: a delay of all joints."""
    whole = log()
    q = held(whole.q, 5)
    late = replace(whole, q=q, qd=held(np.gradient(whole.q, TIME, axis=0), 5), q_ref=q)
    fresh, said = released(replace(late, tau=held(whole.tau, 5, 2)))
    assert fresh.rate == pytest.approx(50.0)
    assert "torques are new in 20 % of the rows only, angles are new in 20 %" in said
    assert np.abs(fresh.q - moved(fresh.time)).max() < 2e-4
    assert fresh.q_ref is not None
    assert fresh.qd is not None
    assert np.array_equal(fresh.q_ref, fresh.q)
    assert np.abs(fresh.qd - np.gradient(moved(TIME), TIME, axis=0)[7:-7:5]).max() < 0.05
    # written several times together, they are new together, and nothing is interpolated
    fresh, _ = released(replace(whole, q=q, tau=held(whole.tau, 5)))
    assert np.array_equal(fresh.q, whole.q[5::5][: len(fresh.q)])


def test_topics_joined_row_by_row_at_their_own_times() -> None:
    rng = np.random.default_rng(8)
    whole = log()
    every = np.arange(len(TIME))

    def last(values: np.ndarray) -> np.ndarray:
        own = np.sort(rng.choice(every[1:], len(every) * 2 // 5, replace=False))
        place = np.searchsorted(own, every, side="right") - 1
        return np.asarray(values[np.where(place < 0, 0, own[place])])

    fresh, said = released(replace(whole, q=last(whole.q), tau=last(whole.tau)))
    assert said
    assert np.abs(fresh.q - moved(fresh.time)).max() < 2e-3


def test_what_a_channel_keeps_by_itself_is_not_held() -> None:
    whole = log()
    assert released(whole) == (whole, "")
    # torques in coarse steps keep their value as well, of a digit or two at a time
    coarse = replace(whole, tau=np.round(whole.tau))
    assert new_rows(coarse.tau, TIME) is None
    # and so do the angles of a slow motion
    slow = np.round(moved(TIME / 30.0), 3)
    assert new_rows(slow, TIME) is None
    # of one joint alone, too, by a digit at a time
    alone = np.zeros((len(TIME), 3))
    alone[:, 0] = np.round(moved(TIME / 8.0)[:, 0], 2)
    assert (np.diff(alone, axis=0) == 0.0).all(axis=1).mean() > 0.5
    assert new_rows(alone, TIME) is None
    # joints that are read each at times of its own repeat now and then all together
    rng = np.random.default_rng(6)
    every = np.arange(len(TIME))
    columns = []
    for column in whole.tau[:, :2].T:
        read = np.where(rng.uniform(size=len(TIME)) < 0.4, every, 0)
        columns.append(column[np.maximum.accumulate(read)])
    assert new_rows(np.column_stack(columns), TIME) is None
    # an arm that rests without noise, now and then
    rests = log(0.0)
    asleep = (TIME > 4.0) & (TIME < 7.0)
    tau = np.where(asleep[:, None], rests.tau[1000], rests.tau)
    assert new_rows(tau, TIME) is None
    # a tenth of the rows read twice
    twice = np.arange(len(TIME)) - (np.arange(len(TIME)) % 10 == 3)
    assert new_rows(whole.q[twice], TIME) is None


def test_rows_are_kept_while_the_arm_rests() -> None:
    """There nothing is new, and a gap of seconds would be a gap of the record."""
    whole = log(0.0)
    asleep = (TIME > 4.0) & (TIME < 7.0)
    tau = np.where(asleep[:, None], whole.tau[1000], held(whole.tau, 5))
    fresh, said = released(replace(whole, tau=tau))
    assert said
    assert np.diff(fresh.time).max() < 0.05


def test_too_few_new_samples_are_refused_and_the_others_remarked_on() -> None:
    whole = log()
    slow = replace(whole, tau=held(whole.tau, 20))
    assert released(slow) == (slow, "")
    found = channel_problem(slow)
    assert found is not None
    assert found.kind == "held_samples"
    enough = replace(whole, tau=held(whole.tau, 8))
    assert channel_problem(enough) is None
    assert prepare(enough).remarks[0] == released(enough)[1]
    assert prepare(whole).remarks == ()


def test_frames_that_freeze_now_and_then_are_left_out() -> None:
    """Torques that stood still for 48 ms twice a second were pushes at 0.95 to 0.98."""
    whole = log()
    tau = whole.tau.copy()
    starts = [200, 700, 1500, 2400]
    for start in starts:
        tau[start + 1 : start + 13] = tau[start]
    fresh, said = released(replace(whole, tau=tau))
    assert said == (
        "all torques stand still 4 times while the arm moves, for 48 ms in the mean: these rows, "
        "1.6 % of all, are left out"
    )
    stale = np.concatenate([np.arange(s + 1, s + 13) for s in starts])
    np.testing.assert_array_equal(fresh.time, np.delete(TIME, stale))
    np.testing.assert_array_equal(fresh.tau, np.delete(whole.tau, stale, axis=0))
    # whole frames: the angles stand still too, and jump to where they have come
    q = whole.q.copy()
    for start in starts:
        q[start + 1 : start + 13] = q[start]
    frames = replace(whole, q=q, tau=tau)
    assert len(released(frames)[0].time) == len(TIME) - len(stale)
    assert channel_problem(frames) is None
    # an encoder that slips while torques go on is one
    slipped = channel_problem(replace(whole, q=q))
    assert slipped is not None
    assert slipped.kind == "angle_jump"
    remarks = prepare(replace(whole, tau=tau)).remarks
    assert remarks[0] == said


def test_what_stands_still_by_chance_or_at_rest_stays() -> None:
    whole = log()
    tau = whole.tau.copy()
    tau[200:203] = tau[200]  # two rows that repeat
    assert released(replace(whole, tau=tau))[1] == ""
    # one joint's sensor alone
    tau[300:400, 1] = tau[300, 1]
    assert released(replace(whole, tau=tau))[1] == ""
    # an arm that rests
    q = whole.q.copy()
    q[300:400] = q[300] + 1e-6 * np.random.default_rng(1).standard_normal((100, 3))
    tau[300:400] = tau[300]
    q[400:] += q[399] - q[400]
    assert released(replace(whole, q=q, tau=tau))[1] == ""
    # nor one that creeps, however well its encoders read
    q = whole.q.copy()
    q[300:400] = q[300] + 0.01 * (TIME[300:400, None] - TIME[300])
    q[400:] += q[399] - q[400]
    assert released(replace(whole, q=q, tau=tau))[1] == ""
    # steps as coarse as the noise: now and then all torques stay the same by chance
    coarse = np.round(whole.tau / 0.5) * 0.5
    assert released(replace(whole, tau=coarse))[1] == ""
    assert released(Log(TIME, whole.q[:, :2], coarse[:, :2]))[1] == ""
    # steps so coarse that torques seldom change
    coarse = np.round(whole.tau / 30.0) * 30.0
    assert released(replace(whole, tau=coarse))[1] == ""
    # a simulated axis that turns about the vertical at constant speed, without noise
    speed = np.where((TIME > 3.0) & (TIME < 3.4), 0.0, np.sin(TIME))
    q = np.zeros((len(TIME), 3))
    q[:, 0] = TIME
    smooth = np.column_stack([speed, 2.0 * speed, np.zeros(len(TIME))]) + 7.0
    assert released(Log(TIME, q, smooth))[1] == ""


@pytest.mark.parametrize("joints", [1, 2, 3])
def test_frames_freeze_on_arms_of_any_number_of_joints(joints: int) -> None:
    whole = log()
    tau = whole.tau[:, :joints].copy()
    starts = np.arange(100, 2900, 60)
    for start in starts:
        tau[start + 1 : start + 16] = tau[start]
    fresh, said = released(Log(TIME, whole.q[:, :joints], tau))
    assert said.startswith(f"all torques stand still {len(starts)} times")
    assert len(fresh.time) == len(TIME) - 15 * len(starts)


def test_an_arm_at_rest_is_no_frame_that_froze_however_its_encoders_flicker() -> None:
    rng = np.random.default_rng(7)
    whole = log()
    q = whole.q.copy()
    tau = np.round(whole.tau, 1)
    q[500:1500] = q[500]
    q[1500:] += q[500] - q[1500]
    tau[500:1500] = tau[500]
    q += 2e-4 * rng.standard_normal(q.shape)
    assert released(replace(whole, q=q, tau=tau))[1] == ""
    six = np.hstack([tau, np.roll(tau, 1, axis=1)])
    six[500:1500] = np.round(six[500] + 0.025 * rng.standard_normal((1000, 6)), 1)
    assert released(Log(TIME, np.hstack([q, q]), six))[1] == ""
    # nor is what a host reads again within a few milliseconds
    tau = whole.tau.copy()
    for start in range(100, 2900, 200):
        tau[start + 1 : start + 5] = tau[start]
    assert released(replace(whole, time=TIME / 4.0, tau=tau))[1] == ""
    assert released(replace(whole, tau=tau))[1] != ""
    # nor is a stretch that lasts
    tau = whole.tau.copy()
    tau[500:630] = tau[500]
    assert released(replace(whole, tau=tau))[1] == ""
