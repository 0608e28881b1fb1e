"""A hysteresis beside another effect of its joint is none where reversals stay as they were."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from third_plant.case import Case
from third_plant.suites import plan

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.diagnosis.comparison.acceptance import Acceptance
from irb2400_ctrl.diagnosis.estimation.reversals import reversal_rows, sticks_beside
from irb2400_ctrl.measurement import Log, prepare
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.robot import load_robot

WRIST = 3
"""joint 4, from 0"""


def turning(seconds: float = 12.0) -> PreparedLog:
    """Joint 4 turns to and fro."""
    time = np.arange(0.0, seconds, 0.004)
    q = np.zeros((len(time), 6))
    q[:, WRIST] = 0.4 * np.sin(2 * np.pi * 0.25 * time)
    tau = np.random.default_rng(4).normal(size=q.shape)
    return prepare(Log(time, q, tau, name="turns"))


def residual(motion: PreparedLog, near: float) -> Array:
    """Of one Newton metre rms on joint 4, near its reversals of `near`, (rows, 6) [Nm]."""
    left = np.random.default_rng(5).normal(size=motion.row_known.shape)
    left[:, WRIST] *= np.where(reversal_rows(motion)[:, WRIST], near, 1.0)
    return left


@pytest.mark.parametrize(
    ("left", "without", "sticks"),
    [
        (4.0, 5.0, True),
        (5.0, 5.0, True),  # it says nothing there
        (6.8, 10.0, False),  # it says most of it, though much is left
        (2.0, 2.4, False),  # as much as elsewhere
    ],
)
def test_what_is_left_near_reversals_tells(left: float, without: float, sticks: bool) -> None:
    motion = turning()
    told = residual(motion, left), residual(motion, without)
    assert sticks_beside(motion, WRIST, *told) == sticks


def test_of_one_reversal_nothing_is_told() -> None:
    motion = turning(4.0)
    near = np.flatnonzero(motion.row_known[:, WRIST] & reversal_rows(motion)[:, WRIST])
    motion.row_known[near[10:], WRIST] = False
    assert not sticks_beside(motion, WRIST, residual(motion, 5.0), residual(motion, 5.0))
    motion.row_known[near[10], WRIST] = True
    assert sticks_beside(motion, WRIST, residual(motion, 5.0), residual(motion, 5.0))


def test_a_hysteresis_is_held_against_what_all_others_leave() -> None:
    motion = turning()
    hysteresis, spring, other = (
        SimpleNamespace(candidate=SimpleNamespace(kind=kind, joint=WRIST + 1))
        for kind in ("hysteresis", "cable_spring", "hysteresis")
    )
    steps: Any = [spring, hysteresis]
    fits = {1: residual(motion, 5.0), 2: residual(motion, 4.0)}
    asked: list[Any] = []

    def fitted(chosen: Any) -> Any:
        asked.append(chosen)
        return SimpleNamespace(residual=fits[len(chosen)])

    acceptance: Any = Acceptance.__new__(Acceptance)
    acceptance.fitter = SimpleNamespace(motion=motion, fit=fitted)
    fit: Any = SimpleNamespace(residual=fits[2])
    assert not acceptance._builds_up(steps, fit, 1)
    assert asked == [[spring.candidate]]
    assert acceptance._builds_up(steps, fit, 0)
    fits[2] = residual(motion, 1.5)
    assert acceptance._builds_up(steps, SimpleNamespace(residual=fits[2]), 1)
    other.candidate.joint = None
    assert acceptance._builds_up([spring, other], fit, 1)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("seed", "name", "said"),
    [
        (20263681, "single/33", {("cable_spring", 4)}),
        (20263691, "pairs/9", {("cable_spring", 5), ("gear_ripple", 1)}),
        (20263701, "single/14", {("viscous_warmup", 4)}),
        (20263681, "pairs/6", {("load_friction", 4), ("hysteresis", 1)}),
    ],
)
def test_what_sticks_beside_another_effect_has_no_name(
    seed: int, name: str, said: set[tuple[str, int]]
) -> None:
    """The first three had a hysteresis of axis 4 besides: 0.75, 0.89 and 0.89."""
    (arm,) = (arm for arm in plan(seed) if arm.name == name)
    seen = Case(arm).identification()
    log = Log(seen.time, seen.q, seen.tau, qd=seen.qd, q_ref=seen.q_ref, name=name)
    found = diagnose(load_robot("irb2400"), log)
    assert {(one.effect.kind, one.effect.joint) for one in found.findings} == said
