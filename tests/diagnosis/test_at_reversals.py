"""An offset and friction that is larger one way are the same while a joint moves; where it turns,
friction passes through nothing."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from diagnosis.test_names import ROBOT, names
from mujoco_plant.suites import suite

from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.diagnosis.comparison.at_reversals import MOST, AtReversals, Dip, log_odds
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.measurement import Log

STEP = 0.004
TIME = np.arange(0.0, 30.0, STEP)
ANGLE = 0.4 * np.sin(1.7 * TIME) + 0.1 * np.sin(4.1 * TIME)
TRAVEL = 8e-4


def bristle(q: Any) -> Any:
    """Share of its level that dry friction has, Dahl: ds/dq = (1 - s sgn(dq)) / travel."""
    share = np.empty(len(q))
    s = -1.0
    for k, dq in enumerate(np.diff(q, prepend=q[0])):
        s = np.sign(dq) + (s - np.sign(dq)) * np.exp(-abs(dq) / TRAVEL) if dq else s
        share[k] = s
    return share


def turns(left: Any, q: Any = ANGLE, **changed: Any) -> AtReversals:
    """Of one joint that leaves this torque."""
    motion = SimpleNamespace(
        q=q[:, None],
        qd=np.gradient(q, STEP)[:, None],
        step=STEP,
        starts=(0,),
        recorders=(None,),
    )
    for name, value in changed.items():
        setattr(motion, name, value)
    log: Any = motion
    return AtReversals(log, left[:, None])


def candidate(kind: str, size: float) -> Any:
    law = LIBRARY[kind]
    return SimpleNamespace(joint=1, effects=(law.of(1, **{law.linear[0]: size}),))


NOISE = np.random.default_rng(4).normal(scale=1.0, size=len(TIME))
DRY = 30.0 * (bristle(ANGLE) - np.sign(np.gradient(ANGLE))) + 40.0 * ANGLE + NOISE
"""a sharp sign in the place of what builds up, and gravity that is off"""


@pytest.mark.parametrize("size", [8.0, -8.0])
def test_friction_of_two_levels_dips_where_the_joint_turns_and_an_offset_does_not(
    size: float,
) -> None:
    lopsided = turns(DRY + size * np.abs(bristle(ANGLE)))
    assert lopsided.nats(candidate("coulomb_asymmetry", size)) > 5.0
    dip = lopsided.dip(0)
    assert dip is not None
    assert 0.1 < dip.depth / size < 0.6
    offset = turns(DRY + size)
    assert -1.0 < offset.nats(candidate("coulomb_asymmetry", size)) < -0.5
    # a torque that the other sign explains is no dip of this one
    assert lopsided.nats(candidate("coulomb_asymmetry", -size)) < 0.0


def test_others_are_not_asked() -> None:
    lopsided = turns(DRY + 8.0 * np.abs(bristle(ANGLE)))
    assert lopsided.nats(candidate("torque_offset", 8.0)) == 0.0
    every: Any = SimpleNamespace(joint=None, effects=candidate("coulomb_asymmetry", 8.0).effects)
    assert lopsided.nats(every) == 0.0


def test_what_the_log_does_not_show_says_nothing() -> None:
    left = DRY + 8.0 * np.abs(bristle(ANGLE))
    asked = candidate("coulomb_asymmetry", 8.0)
    assert turns(left, recorders=(object(),)).nats(asked) == 0.0  # a filter has smeared it
    few = TIME < 5.0
    assert turns(left[few], ANGLE[few]).dip(0) is None
    # a joint that rests at its turns
    stops = 0.4 * np.clip(2.0 * np.sin(1.7 * TIME), -1, 1)
    assert turns(left, stops).dip(0) is None
    # samples too far apart to see it
    coarse = slice(None, None, 10)
    assert turns(left[coarse], ANGLE[coarse], step=10 * STEP).dip(0) is None
    # where another log begins nothing has turned
    middle = np.flatnonzero(np.diff(np.sign(np.diff(ANGLE))))
    assert turns(left, starts=(0, *(middle + 1))).dip(0) is None


def test_the_dip_is_the_mean_of_both_directions_with_students_error(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    seen = turns(DRY)
    # friction of 20 Nm, opposite at turns of the other kind, and a dip of 3
    both = (np.array([-24.0, -23.0, -22.0]), np.array([16.0, 17.0, 18.0]))
    monkeypatch.setattr(seen, "_contrasts", lambda joint: both)
    dip = seen.dip(0)
    assert dip is not None
    assert dip.depth == pytest.approx(3.0)
    # four degrees of freedom: variance 1 of one contrast, twice as wide a t distribution
    assert dip.error == pytest.approx(0.5 * np.sqrt(2.0 * 1.0 * (1 / 3 + 1 / 3)))


def test_odds_follow_the_error_of_the_dip() -> None:
    assert log_odds(Dip(0.0, 1e6), 5.0) == pytest.approx(0.0, abs=1e-6)
    assert log_odds(Dip(0.0, 0.1), 5.0) == pytest.approx(np.log(0.4), abs=0.1)
    nats = [log_odds(Dip(2.0, error), 5.0) for error in (0.5, 1.0, 2.0, 4.0)]
    assert nats == sorted(nats, reverse=True)
    assert nats[0] > 4.0
    assert 0.0 < nats[-1] < 0.3
    # by hand, one share: exp((d^2 - (d - f s)^2) / 2 w^2) with f s = d
    dip = Dip(3.0, 1.2)
    size = 6.0
    width2 = 1.2**2 + (0.05 * size) ** 2
    shares = np.linspace(0.05, 1.0, 96)
    ratio = np.mean(np.exp((9.0 - (3.0 - shares * size) ** 2) / (2 * width2)))
    assert log_odds(dip, size) == pytest.approx(np.log(0.4 + 0.6 * ratio))
    assert log_odds(Dip(3.0, 0.4), size) == MOST


@pytest.mark.slow
def test_friction_of_two_levels_of_an_arm_that_nobody_tuned_to_is_no_offset() -> None:
    (case,) = suite("single", 2, 1, 20261205)
    read = case.simulate()
    log = Log(read.time, read.q, read.tau, qd=read.qd, q_ref=read.q_ref)
    assert names(diagnose(ROBOT, log)) == [("coulomb_asymmetry", 3)]
    # the same arm with an offset of that size
    (truth,) = case.truth
    plain = replace(case, effects=()).simulate()
    tau = plain.tau.copy()
    tau[:, 2] += truth.size
    moved = Log(plain.time, plain.q, tau, qd=plain.qd, q_ref=plain.q_ref)
    assert names(diagnose(ROBOT, moved)) == [("torque_offset", 3)]
