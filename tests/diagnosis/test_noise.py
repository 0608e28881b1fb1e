"""Whether what is left is noise, in numbers that are found by hand: residuals that jump between two
values, predictions that rise, and stretches that nobody knows."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.stats import truncnorm

import irb2400_ctrl as irb
from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.preparation import noise_test as module
from irb2400_ctrl.diagnosis.preparation.noise_test import NoiseTest, noise_test, trimmed_rms
from irb2400_ctrl.diagnosis.preparation.quick_rests import QuickRests
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.measurement.torque_filter import TorqueFilter
from irb2400_ctrl.measurement.uniform import derivative_margin

ROBOT = irb.load_robot("irb2400")
PERIOD = 0.004
STEP = 0.010
"""[s] of the log, and of the motion that was predicted: no sample lies half way between two"""
GRID = 1600
BEGIN = 17.0
"""[s] when the log begins"""
KEPT = truncnorm(-2.3263478740408408, 2.3263478740408408).std()
"""standard deviation of a normal variable between its first and its last percent"""
OFFSET = 3.0
JUMP = 0.25


def start() -> float:
    return BEGIN + derivative_margin(STEP) * STEP


def grid() -> Array:
    return start() + STEP * np.arange(GRID)


def motion(known: Array | None = None, *, instrumented: bool = True, before: int = 0) -> Any:
    """A prepared log of one part of GRID samples, behind `before` others that are unknown."""
    mask = np.ones((GRID, 2), dtype=bool) if known is None else known
    return SimpleNamespace(
        step=STEP,
        known=np.vstack([np.zeros((before, 2), dtype=bool), mask]),
        instrumented=instrumented,
        q=np.zeros((before + GRID, 2)),
        n=2,
        parts=(slice(before, before + GRID),),
        recorders=(None,),
    )


def predicted() -> Array:
    """It rises by 100 and by -200 Nm in a second."""
    return np.outer(grid() - start(), [100.0, -200.0])


def log(left: Array | None = None, time: Array | None = None) -> Log:
    """The prediction and what is left: by default OFFSET and a jump up and down at every sample;
    where nothing is predicted the torque is enormous."""
    if time is None:
        time = BEGIN + PERIOD * np.arange(2 * derivative_margin(STEP) + 2.5 * GRID + 60)
    if left is None:
        sign = (-1.0) ** np.round((time - BEGIN) / PERIOD)
        left = OFFSET + JUMP * np.outer(sign, [1.0, 2.0])
    inside = (time > start() - 1e-9) & (time < grid()[-1] + 1e-9)
    tau = np.outer(time - start(), [100.0, -200.0]) + left
    tau[~inside] += 1e5 * (1 + np.arange(np.sum(~inside)))[:, None]
    return Log(time, np.zeros_like(tau), tau)


def judged(
    given: Log,
    moved: Any,
    *,
    departure: tuple[float, float] = (0.0, 0.0),
    noise: tuple[float, float] | None = None,
    unsure: tuple[float, float] = (0.0, 0.0),
    digit: tuple[float, float] = (0.0, 0.0),
) -> NoiseTest:
    """What is said of a log, with what the angles cost and the last digit as given."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "_by_departure", lambda *_: np.array(departure))
        patch.setattr(
            module,
            "torque_from_angle_noise",
            lambda *_: None if noise is None else np.array(noise),
        )
        patch.setattr(module, "digit", lambda tau: np.array(digit))
        part = moved.parts[0]
        return module._on_log(ROBOT, given, moved, part, predicted(), np.array(unsure))


def rms_of(values: Array) -> float:
    """`trimmed_rms` by a second way: 98 of a hundred, over what is kept of a normal variable."""
    kept = np.sort(np.abs(values))[: -(-98 * len(values) // 100)]
    return float(np.linalg.norm(kept) / np.sqrt(len(kept)) / KEPT)


def test_the_parts_of_floor_left_and_means() -> None:
    """Neighbours are 2 JUMP apart, so that white noise of sqrt(2) JUMP is in them; means over fifty
    samples are OFFSET."""
    found = judged(log(), motion())
    jumps = np.array([0.25, 0.5])
    np.testing.assert_allclose(found.floor, np.sqrt(2) * jumps / KEPT, rtol=1e-6)
    two = [OFFSET + jump * (-1.0) ** np.arange(int(2.5 * GRID) - 2) for jump in jumps]
    np.testing.assert_allclose(found.left, [rms_of(values) for values in two], rtol=1e-3)
    np.testing.assert_allclose(found.means, OFFSET / (np.sqrt(2) * jumps) * np.sqrt(50), rtol=1e-6)
    assert found.beyond == (1, 2)
    # angles and their noise are white, the last digit and open numbers are not
    found = judged(
        log(),
        motion(instrumented=False),
        departure=(3.0, 4.0),
        noise=(4.0, 3.0),
        unsure=(0.5, 0.0),
        digit=(0.0, np.sqrt(12.0)),
    )
    white = np.sqrt(2 * jumps**2 / KEPT**2 + 25.0)
    lasting = np.array([0.5, 1.0])
    np.testing.assert_allclose(found.floor, np.hypot(white, lasting), rtol=1e-6)
    usual = np.hypot(white / np.sqrt(50), lasting)
    np.testing.assert_allclose(found.means, OFFSET / KEPT / usual, rtol=1e-6)
    # a commanded motion has no noise of the angles, one of a log too short none that is known
    alone = np.hypot(np.hypot(np.sqrt(2) * jumps / KEPT, [3.0, 4.0]), 0.0)
    for moved, noise in ((motion(), (4.0, 3.0)), (motion(instrumented=False), None)):
        found = judged(log(), moved, departure=(3.0, 4.0), noise=noise)
        np.testing.assert_allclose(found.floor, alone, rtol=1e-6)


def test_where_the_motion_is_not_known_nothing_counts() -> None:
    """Every tenth instant of joint 1 is unknown, and its samples err by far; of joint 2 half of the
    stretches that are averaged are."""
    known = np.ones((GRID, 2), dtype=bool)
    known[5::10, 0] = False
    # fifty samples are twenty instants: every second stretch has one that is not known
    known[10::40, 1] = False
    time = log().time
    place = np.round((time - start()) / STEP)
    sign = (-1.0) ** np.round((time - BEGIN) / PERIOD)
    left = OFFSET + JUMP * np.outer(sign, [1.0, 1.0])
    left[place % 10 == 5, 0] = 500.0 * sign[place % 10 == 5]
    left[place % 40 == 10, 1] = 700.0
    found = judged(log(left), motion(known, before=300))
    np.testing.assert_allclose(found.floor, np.sqrt(2) * JUMP / KEPT, rtol=1e-6)
    values = OFFSET + JUMP * sign[(place >= 0) & (place < GRID)]
    np.testing.assert_allclose(found.left, rms_of(values), rtol=2e-3)
    # no stretch of joint 1 is known as a whole: of nothing nothing is said
    expected = [0.0, OFFSET / (np.sqrt(2) * JUMP) * np.sqrt(50)]
    np.testing.assert_allclose(found.means, expected, rtol=1e-6)


def test_neighbours_across_a_gap_are_none() -> None:
    """Every fifth sample is missing: across a gap the jump is none, beside it it is."""
    time = log().time
    whole = np.round((time - BEGIN) / PERIOD)
    found = judged(log(time=time[whole % 5 != 4]), motion())
    np.testing.assert_allclose(found.floor, np.sqrt(2) * np.array([0.25, 0.5]) / KEPT, rtol=1e-6)


def test_of_several_logs_the_one_that_fits_worst_speaks() -> None:
    """Floor and what is left together, of the log where they are farthest apart; means by
    themselves."""
    first = NoiseTest(np.array([1.0, 2.0]), np.array([3.0, 2.0]), np.array([0.5, 7.0]))
    second = NoiseTest(np.array([9.0, 0.0]), np.array([18.0, 1.0]), np.array([0.6, 6.0]))
    given = iter([(first, (0, 3)), (second, (3, 5))])

    def on_log(
        robot: Any, log: Any, motion: Any, part: slice, rows: Array, unsure: Any, recorder: Any
    ) -> Any:
        answer, (begin, end) = next(given)
        assert recorder is filters[log > 0]
        assert (log, part, unsure) == (begin, slice(begin, end), "open")
        np.testing.assert_array_equal(rows, np.arange(5.0)[begin:end, None] * [1, 1])
        return answer

    filters = (None, TorqueFilter(2.0, 4.0))
    moved: Any = SimpleNamespace(n=2, parts=(slice(0, 3), slice(3, 5)), recorders=filters, tau=0.0)
    rests: list[Any] = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "_on_log", on_log)
        patch.setattr(module, "quick_rests", lambda *given: rests.append(given) or QuickRests())
        logs: Any = [0, 3]
        unsure: Any = "open"
        effects: Any = ["a force"]
        rows = np.arange(5.0)[:, None] * [1, 1]
        found = noise_test(ROBOT, logs, moved, rows, unsure, effects)
    ((_, _, floor, known),) = rests
    assert (known, [*floor]) == (effects, [1.0, 0.0])
    np.testing.assert_array_equal(found.floor, [1.0, 0.0])
    np.testing.assert_array_equal(found.left, [3.0, 1.0])
    np.testing.assert_array_equal(found.means, [0.6, 7.0])
    assert found.beyond == (1, 2)


def test_beyond_is_above_the_bar_and_not_at_it() -> None:
    def beyond(left: float, means: float) -> bool:
        return bool(NoiseTest(np.ones(1), np.array([left]), np.array([means])).beyond)

    assert not beyond(2.0, 3.5)
    assert beyond(2.001, 0.0)
    assert beyond(0.0, 3.501)


def test_what_a_motion_lacks_is_what_it_accelerates_less() -> None:
    """Of a departure of 3 t^2 and 5 t^2 on two of six joints that is 6 and 10 rad/s2."""
    time = BEGIN + PERIOD * np.arange(int(2.5 * GRID) + 200)
    lacks = np.array([3.0, 0, 5.0, 0, 0, 0])
    swing = np.sin(np.arange(6) + np.arange(GRID)[:, None] * STEP)
    measured = np.sin(np.arange(6) + (time - start())[:, None]) + np.outer(
        (time - start()) ** 2, lacks
    )
    moved: Any = SimpleNamespace(q=np.vstack([np.full((7, 6), 9.0), swing]), step=STEP)
    seen = []

    def torque_of(robot: Any, q: Array, acceleration: Array) -> Array:
        np.testing.assert_array_equal(q, swing)
        seen.append(acceleration)
        return np.zeros(6)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "torque_of", torque_of)
        given = Log(time, measured, np.zeros_like(measured))
        module._by_departure(ROBOT, given, moved, slice(7, 7 + GRID), grid())
    inner = seen[0][40:-40]
    np.testing.assert_allclose(inner, np.tile(2 * lacks, (len(inner), 1)), atol=1e-5)


def test_the_largest_two_of_a_hundred_are_left_out_and_of_few_values_nothing_is_said() -> None:
    values = np.ones(100)
    values[:2] = 1e6
    assert trimmed_rms(values) == pytest.approx(1 / KEPT, rel=1e-9)
    values[2] = -1e6
    assert trimmed_rms(values) > 1e5
    assert trimmed_rms(np.ones(30)) == pytest.approx(1 / KEPT, rel=1e-9)
    assert trimmed_rms(np.ones(29)) == 0.0


def test_the_first_and_the_last_instant_of_the_motion_belong_to_it() -> None:
    """Thirty samples on thirty instants are enough to be judged, of twenty-nine nothing is said."""
    margin = derivative_margin(STEP)
    instants = 30
    time = STEP * np.arange(margin) - STEP * margin
    time = np.concatenate([time, STEP * np.arange(instants + margin)])
    given = Log(time, np.zeros((len(time), 1)), np.full((len(time), 1), OFFSET))
    moved: Any = SimpleNamespace(
        step=STEP, known=np.ones((instants, 1), dtype=bool), instrumented=True
    )
    moved.q = np.zeros((instants, 1))
    assert time[0] + margin * STEP == 0.0
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "_by_departure", lambda *_: np.zeros(1))
        found = module._on_log(
            ROBOT, given, moved, slice(0, instants), np.zeros((instants, 1)), np.zeros(1)
        )
    np.testing.assert_allclose(found.left, OFFSET / KEPT)


def test_samples_that_a_filter_makes_alike_are_no_neighbours() -> None:
    """What is left turns over 2.5 times a second, what no neighbours disagree about: noise of that
    size where a filter at 2 Hz was, a misfit where none was."""
    time = STEP * np.arange(7500)
    margin = derivative_margin(STEP)
    turned = OFFSET * np.sin(2.0 * np.pi * 2.5 * time)[:, None]
    given = Log(time, np.zeros((len(time), 1)), turned)
    rows = len(time) - 2 * margin
    moved: Any = SimpleNamespace(step=STEP, known=np.ones((rows, 1), dtype=bool), instrumented=True)
    found = {}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "_by_departure", lambda *_: np.zeros(1))
        for recorder in (None, TorqueFilter(2.0, 4.0)):
            found[recorder is None] = module._on_log(
                ROBOT, given, moved, slice(0, rows), np.zeros((rows, 1)), np.zeros(1), recorder
            )
    assert found[True].left == pytest.approx(found[False].left, rel=0.1)
    assert found[True].beyond == (1,)
    assert found[False].beyond == ()


def test_of_some_joints_the_means_alone_say_so() -> None:
    left = np.array([1.9, 2.1, 2.1, 1.0])
    found = NoiseTest(np.ones(4), left, np.array([4.0, 4.0, 0.0, 0.0]))
    assert found.beyond == (1, 2, 3)
    assert found.by_means_alone == (1,)
