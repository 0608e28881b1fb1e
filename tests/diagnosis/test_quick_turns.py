"""A loop shows behind quick turns, once the joint slides again, though what happens while it sticks
is not resolved."""

from __future__ import annotations

import importlib
from dataclasses import replace

import numpy as np
import pytest
from third_plant.case import Case
from third_plant.suites import plan

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.diagnosis.estimation.reversals import _where_they_slide, reversal_rows
from irb2400_ctrl.diagnosis.preparation.quick_turns import (
    QUICK,
    SLIDES,
    TAKEN,
    left_by_a_loop,
    quick_turns,
)
from irb2400_ctrl.diagnosis.regressors.bases import Bases
from irb2400_ctrl.measurement import Log, prepare
from irb2400_ctrl.measurement.partial_low_pass import PartialLowPass
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.measurement.uniform import LowPass
from irb2400_ctrl.robot import load_robot

module = importlib.import_module("irb2400_ctrl.diagnosis.preparation.quick_turns")
ROBOT = load_robot("irb2400")
BASES = Bases(ROBOT)
STEP = 0.004
WRIST = 5
"""joint 6, from 0"""
LOOP = 1.0
"""[Nm]"""


def turning(amplitude: float = 0.4, seconds: float = 12.0) -> PreparedLog:
    """Joint 6 turns to and fro under noise alone."""
    rng = np.random.default_rng(4)
    time = np.arange(0.0, seconds, STEP)
    q = np.zeros((len(time), 6))
    q[:, WRIST] = amplitude * np.sin(2 * np.pi * 0.7 * time)
    return prepare(Log(time, q, 0.02 * rng.normal(size=q.shape), name="turns"))


def loop(motion: PreparedLog, width: float) -> Array:
    """Dahl's loop of that width [rad] in the place of as much dry friction, (m,) [Nm]."""
    (law,) = BASES.columns("hysteresis", WRIST + 1, motion, [{"width_rad": width}], filtered=False)
    return np.asarray(LOOP * (law.values[:, 0, 0] - np.sign(motion.qd[:, WRIST])))


def share(motion: PreparedLog, added: Array) -> float:
    """What a loop leaves of a torque (m,) beside noise."""
    return left_by_a_loop(BASES, motion, motion.tau[:, WRIST] + added, WRIST)


def sticks(motion: PreparedLog) -> Array:
    """What no model follows: 15 Nm before a turn, as much the other way behind it."""
    speed = motion.qd[:, WRIST]
    return np.asarray(np.where(np.abs(speed) < 0.9 * SLIDES, -15.0 * np.sign(speed), 0.0))


@pytest.mark.parametrize("width", [2e-3, 4e-3])
def test_a_loop_is_seen_past_what_sticks(width: float) -> None:
    motion = turning()
    assert share(motion, sticks(motion) + loop(motion, width)) < 0.5 * TAKEN


def test_what_sticks_is_no_loop() -> None:
    motion = turning()
    assert share(motion, sticks(motion)) > 0.9


def test_neither_is_what_contacts_do_nor_a_torque_of_the_other_sign() -> None:
    motion = turning()
    assert share(motion, loop(motion, 5e-4)) > 0.9
    assert share(motion, -loop(motion, 3e-3)) > 0.9


def test_nor_what_is_smooth_or_grows_with_the_speed() -> None:
    motion = turning()
    q = motion.q[:, WRIST]
    speed = motion.qd[:, WRIST]
    assert share(motion, 3.0 * speed + 20.0 * q + 2.0 * np.sign(speed)) > 0.9


def test_nor_is_it_one_that_leaves_more_than_noise(monkeypatch: pytest.MonkeyPatch) -> None:
    """As of a link that swings on its spring: a loop took 60 % of that."""
    motion = turning()
    swing = 0.1 * np.sin(2 * np.pi * 9.0 * motion.time + 0.3)
    assert share(motion, loop(motion, 3e-3) + swing) == 1.0
    monkeypatch.setattr(module, "AS_NOISE", np.inf)
    assert share(motion, loop(motion, 3e-3) + swing) < TAKEN


def test_slow_turns_say_nothing() -> None:
    motion = turning(amplitude=0.05)
    assert len(quick_turns(motion, WRIST).between) == 0
    assert share(motion, loop(motion, 3e-3)) == 1.0


def test_neither_do_a_few() -> None:
    motion = turning(seconds=3.2)
    assert 3 <= len(quick_turns(motion, WRIST).between) <= 4
    assert share(motion, loop(motion, 3e-3)) == 1.0


def test_the_samples_of_a_turn() -> None:
    motion = turning()
    found = quick_turns(motion, WRIST)
    speed = motion.qd[:, WRIST]
    assert len(found.between) == len(np.flatnonzero(np.diff(speed > 0.0)))
    assert (np.abs(speed[found.rows]) > SLIDES).all()
    for k, stands in enumerate(found.between):
        assert (np.abs(speed[stands]) <= SLIDES).all()
        assert (stands.stop - stands.start) * motion.step <= QUICK
        own = found.rows[found.turn == k]
        assert own.min() < stands.start <= stands.stop <= own.max()


def test_rows_about_quick_turns_hold_nothing_of_what_sticks() -> None:
    motion = turning()
    stuck = motion.tau.copy()
    stuck[:, WRIST] += sticks(motion)
    rows = _where_they_slide(replace(motion, tau=stuck, tau_smooth=stuck), [WRIST])
    plain = _where_they_slide(motion, [WRIST])
    np.testing.assert_array_equal(rows.row_known, plain.row_known)
    known = rows.row_known[:, WRIST]
    assert known[reversal_rows(motion)[:, WRIST] & motion.row_known[:, WRIST]].mean() > 0.5
    found = rows.filtered_reading(rows.tau_smooth)[known, WRIST]
    np.testing.assert_allclose(found, plain.filtered_reading(plain.tau_smooth)[known, WRIST])


def test_rows_about_other_turns_are_left_out() -> None:
    slow = turning(amplitude=0.05)
    near = reversal_rows(slow)[:, WRIST]
    assert near.any()
    assert not _where_they_slide(slow, [WRIST]).row_known[near, WRIST].any()


def test_samples_that_do_not_count_change_nothing() -> None:
    whole = LowPass(10.0, STEP)
    counts = np.ones(400, dtype=bool)
    counts[150:158] = False
    counts[250:300] = False
    part = PartialLowPass.of(whole, counts)
    time = np.arange(400) * STEP
    signal = np.column_stack([np.full(400, 2.0), np.sin(2 * time)])
    broken = np.where(counts[:, None], signal, 1e6)
    rows = part(broken)
    np.testing.assert_allclose(rows, part(signal))
    np.testing.assert_allclose(rows[part.known, 0], 2.0)
    np.testing.assert_allclose(rows[part.known, 1], whole(signal)[part.known, 1], atol=0.02)
    times = part.instants(time)
    assert part.known[(times > 0.55) & (times < 0.7)].all()
    assert not part.known[(times > 1.04) & (times < 1.16)].any()
    np.testing.assert_allclose(
        PartialLowPass.of(whole, np.ones(400, dtype=bool))(signal), whole(signal), atol=0.01
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("seed", "name", "joint"), [(20263691, "single/33", 6), (20263681, "single/3", 4)]
)
def test_a_loop_of_the_wrist_is_named(seed: int, name: str, joint: int) -> None:
    """Static friction there is twice Coulomb's: these arms showed nothing, and a friction."""
    (planned,) = (one for one in plan(seed) if one.name == name)
    seen = Case(planned).identification()
    log = Log(seen.time, seen.q, seen.tau, qd=seen.qd, q_ref=seen.q_ref, name=name)
    (found,) = diagnose(ROBOT, log).findings
    assert (found.effect.kind, found.effect.joint) == ("hysteresis", joint)
    assert found.confidence > 0.85
