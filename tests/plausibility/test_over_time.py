"""A log of which a stretch does not go with the rest."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from other_arm_logs import other_arm_log
from sound_logs import Drawn, sound_log

from irb2400_ctrl.plausibility import check_log
from irb2400_ctrl.plausibility.evidence import Nominal
from irb2400_ctrl.plausibility.over_time import disagreement, stretches
from irb2400_ctrl.plausibility.rows import Rows, rows_of

Change = Callable[[np.ndarray], np.ndarray]
CHANGES: dict[str, Change] = {
    "stuck at a value of coarse steps": lambda tau: np.full_like(tau, np.round(tau[0])),
    "turned over": lambda tau: -tau,
    "read in another unit": lambda tau: 2.2 * tau,
    "lost": lambda tau: 0.0 * tau,
}
SEEDS = (700203, 700205)


@cache
def drawn(seed: int) -> Drawn:
    """A sound log of one of the public arms."""
    return other_arm_log(seed)


def rows_from(one: Drawn) -> Rows:
    """Of a log that is long enough for some."""
    rows = rows_of(one.log)
    assert rows is not None
    return rows


def third_quarter(rows: Rows) -> slice:
    """A stretch in the second half."""
    return slice(len(rows.tau) // 2, 3 * len(rows.tau) // 4)


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
@pytest.mark.parametrize("seed", SEEDS)
def test_a_stretch_that_does_not_go_with_the_rest_is_told(seed: int, change: Change) -> None:
    one = drawn(seed)
    rows = rows_from(one)
    joint = 3
    inside = third_quarter(rows)
    tau = rows.tau.copy()
    tau[inside, joint] = change(tau[inside, joint])
    said = disagreement(Nominal(one.robot), rows.with_torque(tau))
    start, stop = rows.time[inside][[0, -1]]
    assert "the torque of joint 4 does not go with the rest of the log" in said
    words = said.split()
    found = [float(words[words.index(at) + 1]) for at in ("from", "to")]
    np.testing.assert_allclose(found, [start, stop], atol=one.log.duration / 12.0)
    assert "gears of the wrist" not in said


def test_gears_of_the_wrist_are_told_where_they_would_explain_a_stretch() -> None:
    """The friction of motor 6, which axis 5 turns, too, while axis 6 creeps for a quarter of it."""
    one = drawn(SEEDS[0])
    rows = rows_from(one)
    late = third_quarter(rows)
    qd = rows.qd.copy()
    qd[:, 4] *= 0.3
    qd[late, 5] *= 0.05
    tau = rows.tau.copy()
    tau[:, 5] += 3.0 * rows.size[5] * np.sign(qd[:, 5] + qd[:, 4])
    said = disagreement(Nominal(one.robot), replace(rows, qd=qd, turn=np.sign(qd), tau=tau))
    assert "joint 6 does not go with the rest" in said
    assert "gears of the wrist" in said


def test_what_goes_on_to_the_end_has_one_edge() -> None:
    one = drawn(SEEDS[0])
    late = 3 * len(one.log.time) // 5
    tau = one.log.tau.copy()
    tau[late:, 3] *= -1.0
    told = check_log(one.robot, replace(one.log, tau=tau))
    assert told.sound
    assert not told.whole
    (said,) = (r for r in told.remarks if "does not go with the rest of the log" in r)
    at = float(said.split(" s on the torque of joint 4")[0].removeprefix("from "))
    assert at == pytest.approx(one.log.time[late], abs=one.log.duration / 12.0)


def test_a_log_in_two_units_is_not_another_robots_alone() -> None:
    one = drawn(SEEDS[0])
    tau = one.log.tau.copy()
    tau[len(tau) // 2 :] *= 9.81
    told = check_log(one.robot, replace(one.log, tau=tau))
    assert told.problem is not None
    assert told.problem.kind == "not_this_robot"
    assert "; or from " in told.problem.says
    assert "joints 1, 2, 3, 4, 5, 6 does not go with the rest" in told.problem.says
    assert not any("with the rest of the log" in remark for remark in told.remarks)


def test_a_second_that_differs_is_no_stretch() -> None:
    """Axis 5 of this sound log leaves half of its torque for a second of thirty."""
    one = sound_log(700105)
    rows = rows_from(one)
    worst = max(stretches(Nominal(one.robot), rows), key=lambda found: found.gain)
    assert worst.gain > 15.0
    assert worst.share > 0.3
    assert not worst.told


@pytest.mark.parametrize("make", [other_arm_log, sound_log], ids=["other arms", "IRB 2400"])
def test_nothing_is_told_of_sound_logs(make: Callable[[int], Drawn]) -> None:
    for seed in range(820000, 820004):
        one = make(seed)
        rows = rows_of(one.log)
        assert rows is not None
        assert disagreement(Nominal(one.robot), rows) == "", one.text


def test_a_motion_that_is_nowhere_else_needs_numbers_that_nothing_else_has_told() -> None:
    """Two wrist joints that move for a seventh of the log, each with a rotor of no file."""
    one = drawn(SEEDS[1])
    rows = rows_from(one)
    moves = np.zeros(len(rows.q), dtype=bool)
    moves[len(moves) // 2 : len(moves) // 2 + len(moves) // 7] = True
    still = ~moves[:, None] & np.array([False, False, False, True, True, True])
    q, qd, qdd, turn = (
        np.where(still, rest, signal)
        for rest, signal in (
            (rows.q[0], rows.q),
            *((0.0, signal) for signal in (rows.qd, rows.qdd, rows.turn)),
        )
    )
    held = replace(rows, q=q, qd=qd, qdd=qdd, turn=turn, still=rows.still | still)
    nominal = Nominal(one.robot)
    push = np.sqrt(np.mean(held.qdd**2, axis=0))
    size = np.sqrt(np.mean(nominal.columns(held)[0] ** 2, axis=0))
    rotors = np.where(still.any(axis=0), 2.0 * size / push, 0.0)
    noise = 0.02 * size * np.random.default_rng(4).standard_normal(q.shape)
    tau = nominal.columns(held)[0] + rotors * held.qdd + noise
    told = stretches(nominal, held.with_torque(tau))
    assert not any(found.told for found in told)


def test_dry_friction_may_hold_anything_at_rest() -> None:
    one = drawn(SEEDS[1])
    rows = rows_from(one)
    rests = third_quarter(rows)
    tau = rows.tau.copy()
    tau[rests, 3] += 2.0 * rows.size[3]
    assert "joint 4" in disagreement(Nominal(one.robot), rows.with_torque(tau))
    still = rows.still.copy()
    still[rests, 3] = True
    held = replace(rows.with_torque(tau), still=still)
    assert disagreement(Nominal(one.robot), held) == ""


def test_half_of_a_torque_is_enough_in_a_long_log() -> None:
    one = drawn(SEEDS[0])
    rows = rows_from(one)
    tau = rows.tau.copy()
    tau[2 * len(tau) // 3 :, 3] *= 1.5
    (found,) = (s for s in stretches(Nominal(one.robot), rows.with_torque(tau)) if s.told)
    assert found.joint == 4
    assert found.share < 0.5
