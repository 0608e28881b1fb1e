"""EGM: the follower's decisions."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from egm_motion import AXIS_1, CYCLE, ROBOT, START, SWEEP, follower, message, planned

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.planners.programs.egm.egm_stream import (
    EgmError,
    EgmFollower,
    EgmOptions,
)

Array = npt.NDArray[np.float64]


def test_before_egm_runs_the_start_is_held() -> None:
    f = follower()
    for sequence in range(5):
        answer = f.answer(message(sequence, START, state=2))
        assert answer is not None
        assert np.radians(answer.q_deg) == pytest.approx(START)
        assert answer.qd_deg_s == (0.0,) * 6
    assert not f.running
    assert f.answer(message(5, START)) is not None
    assert f.running
    assert f.plan_time == 0.0


def test_references_are_the_plan_on_the_controllers_clock() -> None:
    f = follower(rate=25.0)
    f.answer(message(0, START))
    for sequence in range(1, 200):
        if sequence % 3:
            continue
        q, qd = planned(np.array(sequence * CYCLE))
        answer = f.answer(message(sequence, q))
        assert answer is not None
        # rows every 40 ms are joined by cubics
        assert np.abs(np.radians(answer.q_deg) - q).max() < 2e-5
        assert np.abs(np.radians(answer.qd_deg_s) - qd).max() < 3e-3
    assert f.report().lost == 2 * 66


def test_numbers_that_wrap_go_on() -> None:
    f = follower()
    top = (1 << 32) - 3
    for k in range(8):
        answer = f.answer(
            message((top + k) % (1 << 32), START, time_ms=((1 << 32) - 10 + 4 * k) % (1 << 32))
        )
        assert answer is not None
    assert f.plan_time == pytest.approx(7 * CYCLE)
    assert (f.report().lost, f.report().late) == (0, 0)


def test_late_and_double_messages_are_not_answered() -> None:
    f = follower()
    f.answer(message(10, START))
    f.answer(message(12, START))
    t = f.plan_time
    assert f.answer(message(11, START)) is None
    assert f.answer(message(12, START)) is None
    assert f.plan_time == t
    assert (f.report().lost, f.report().late) == (1, 2)


@pytest.mark.parametrize(
    ("messages", "text"),
    [
        ([(0, START + AXIS_1, 3, 0)], r"axis 1 stands 5\.00 deg from the plan's start"),
        ([(0, START, 3, 0), (1, START, 2, 4)], r"EGM left the running state \(state 2"),
        ([(0, START, 3, 0), (1, START + 6 * AXIS_1, 3, 4)], r"axis 1 is 30\.0 deg from the plan"),
        (
            [(0, START, 3, 0), (50, START, 3, 200)],
            r"49 messages of the controller got lost in a row",
        ),
        ([(0, START[:5], 3, 0)], "sends 5 axes, expected 6"),
        ([(0, START * [1, np.nan, 1, 1, 1, 1], 2, 0)], "angle of axis 2 is nan, expected a number"),
        (
            [(0, START, 3, 0), (1, START * [1, 1, 1, np.inf, 1, 1], 3, 4)],
            r"at 0\.000 s of 1\.000 s: the measured angle of axis 4 is inf",
        ),
        ([(0, START, 3, 100), (1, START, 3, 96)], "the controller's clock runs backwards"),
    ],
)
def test_what_is_not_as_planned_ends_the_stream(
    messages: list[tuple[int, Array, int, int]], text: str
) -> None:
    f = follower()
    for sequence, q, state, clock in messages[:-1]:
        f.answer(message(sequence, q, state, clock))
    with pytest.raises(EgmError, match=text) as caught:
        f.answer(message(*messages[-1]))
    assert caught.value.report.outcome == "failed"


def test_an_arm_that_never_arrives_is_reported() -> None:
    f = follower(EgmOptions(settle_timeout=0.1))
    f.answer(message(0, START))

    def beside_the_plan() -> None:
        for sequence in range(1, 400):
            f.answer(message(sequence, planned(np.array(sequence * CYCLE))[0] + 0.002))

    with pytest.raises(
        EgmError,
        match=r"at 1\.000 s of 1\.000 s: axis \d is still 0\.115 deg from the end after 0\.1 s",
    ):
        beside_the_plan()


def test_a_stop_stays_on_the_path_and_comes_to_rest() -> None:
    f = follower(EgmOptions(stop_time=0.2))
    f.answer(message(0, START))
    references = []
    speeds = []
    for sequence in range(1, 200):
        if sequence == 100:
            f.stop()
        answer = f.answer(message(sequence, f.reference(f.plan_time)[0]))
        assert answer is not None
        references.append(np.radians(answer.q_deg))
        speeds.append(np.radians(answer.qd_deg_s))
        if f.done:
            break
    # slowed down evenly over 0.2 s: half of the way that full speed would have made
    assert f.plan_time == pytest.approx(99 * CYCLE + 0.1, abs=CYCLE)
    share = (np.array(references) - START) / SWEEP
    assert np.ptp(share, axis=1).max() < 1e-9
    difference = np.diff(np.array(references), axis=0) / CYCLE
    middle = 0.5 * (np.array(speeds)[1:] + np.array(speeds)[:-1])
    assert np.abs(difference - middle).max() < 0.03
    assert np.abs(speeds[-1]).max() == 0.0
    assert f.report().outcome == "stopped"


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"time": np.linspace(1, 0, 251)}, "time does not increase at row 2"),
        ({"q": np.zeros((251, 5))}, "expected"),
        ({"qd": np.zeros((250, 6))}, "expected"),
        ({"q": np.full((251, 6), np.nan)}, "not finite"),
        ({"q": np.full((251, 6), 1.5)}, "axis 3 is outside its range at row 1: 85.94 deg"),
        ({"qd": np.full((251, 6), 3.0)}, "axis 1 is faster than its limit"),
        ({"qd": np.full((251, 6), 0.1)}, "does not start and end at rest"),
    ],
)
def test_wrong_plans_are_refused(change: dict[str, Array], text: str) -> None:
    time = np.linspace(0, 1, 251)
    q, qd = planned(time)
    with pytest.raises(InputError, match=text):
        EgmFollower(ROBOT, **({"time": time, "q": q, "qd": qd} | change))  # type: ignore[arg-type]


def test_a_clock_that_stands_still_times_out() -> None:
    f = follower(EgmOptions(timeout=0.1))
    for sequence in range(11):
        f.answer(message(sequence, f.reference(f.plan_time)[0]))
    # 25 cycles of 4 ms are 0.1 s: so long it may stand
    for sequence in range(11, 36):
        assert f.answer(message(sequence, f.reference(f.plan_time)[0], time_ms=40)) is not None
    with pytest.raises(
        EgmError, match=r"at 0\.040 s of 1\.000 s: the controller's clock has stood still for 26"
    ):
        f.answer(message(36, f.reference(f.plan_time)[0], time_ms=40))


def test_a_clock_that_goes_on_in_time_is_no_fault() -> None:
    f = follower(EgmOptions(timeout=0.1))
    for sequence in range(100):
        f.answer(message(sequence, f.reference(f.plan_time)[0], time_ms=80 * (sequence // 20)))
    assert f.plan_time == pytest.approx(0.32)
