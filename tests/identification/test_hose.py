"""A hose or a cable that pulls a joint towards one angle is found by `identify`."""

from __future__ import annotations

from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from diagnosis.plain_motion import motion
from identification.possible_arms import PossibleCase, as_read, log_of, possible_robot
from independent_plant.effects import Effect

import irb2400_ctrl as irb
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.identification import Identification
from irb2400_ctrl.identification.fitting.choice import candidates
from irb2400_ctrl.identification.fitting.columns import ColumnLayout, Extra, columns
from irb2400_ctrl.identification.fitting.moments import Moments
from irb2400_ctrl.identification.identified_robot import _extra_effects, fit_base
from irb2400_ctrl.identification.odd_logs import odd_logs

HOSE = Extra("spring", 5)
SAID = "is pulled towards one angle"


@cache
def identified(*hoses: int) -> tuple[Identification, PossibleCase]:
    effects = (Effect("cable_spring", joint, 0.08) for joint in hoses)
    case = PossibleCase(possible_robot(), 71001, 30.0, *effects)
    judge = as_read(case.recorded(1), "judge")
    return irb.identify(possible_robot(), log_of(case), validation=judge), case


def stiffnesses(robot: irb.Robot) -> dict[int | None, float]:
    return {e.joint: e.stiffness_Nm_rad for e in robot.effects if e.kind == "cable_spring"}


def test_a_hose_is_a_hose_and_no_reading_without_what_accelerates() -> None:
    """Of a motion at few frequencies k q looks like -k / w^2 qdd: four arms with a dress pack at
    the wrist "read their torque without part of what accelerates it"."""
    found, _ = identified(5)
    assert set(stiffnesses(found.robot)) == {5}
    (line,) = [note for note in found.notes if SAID in note]
    assert line.startswith("joint 5 ")
    assert not any("accelerates" in note for note in found.notes)
    (judged,) = [log for log in found.logs if log.role == "validation"]
    ratio = judged.error("unseen").rmse / judged.error("plain").rmse
    assert ratio[4] < 0.8
    assert ratio.max() < 1.05


def test_an_arm_without_a_hose_has_none() -> None:
    found, _ = identified()
    assert stiffnesses(found.robot) == {}
    assert not any(SAID in note for note in found.notes)


def test_where_a_balancer_pulls_no_hose_is_looked_for() -> None:
    """One of axis 2 took the place of the balancer that a KR300 has there, and left more."""
    sought = [extra.joint for extra in candidates(6) if extra.kind == "spring"]
    assert sought == [1, 4, 5, 6]


def test_the_column_is_the_effect() -> None:
    model = irb.Model(fit_base(irb.load_robot("irb2400"))[0])
    here = motion()
    layout = ColumnLayout(6, (HOSE,))
    found = columns(model, layout, here.q, here.qd, here.qdd)[:, :, layout.extra(HOSE)]
    (written,) = _extra_effects(HOSE, [7.0])
    assert written == LIBRARY["cable_spring"].of(5, stiffness_Nm_rad=7.0, source="identified")
    expected = np.zeros_like(here.q)
    expected[:, 4] = 7.0 * here.q[:, 4]
    np.testing.assert_allclose(7.0 * found[:, :, 0], expected, atol=1e-12)


@pytest.mark.parametrize("has", [True, False])
def test_logs_that_agree_beside_a_hose_do_not_disagree(has: bool) -> None:
    """Three logs about other angles of a joint with a hose had other zeros of its torque, though
    the fit had the hose."""
    rng = np.random.default_rng(0)
    whole = ColumnLayout(2, (Extra("spring", 2),))
    (hose,) = range(whole.count)[whole.extra(whole.extras[0])]
    zero = whole.drive("offset").start + 1
    theta = np.ones(whole.count)
    theta[hose] = 9.0
    blocks = []
    for about in (1.0, -1.0, 0.0):
        for _ in range(6):
            rows = rng.standard_normal((2, 200, whole.count))
            rows[:, :, hose] *= 0.1
            rows[1, :, hose] += about * rows[1, :, zero]
            rows[0][:, [zero, hose]] = 0.0
            tau = rows @ theta + rng.standard_normal((2, 200))
            H = np.swapaxes(rows, 1, 2) @ rows
            g = np.einsum("nmp,nm->np", rows, tau)
            blocks.append((H, g, (tau**2).sum(axis=1), np.full(2, 200.0)))
    sums = Moments(*map(np.array, zip(*blocks, strict=True)))
    layout = whole if has else ColumnLayout(2)
    found: Any = SimpleNamespace(
        layout=layout, sums=sums.part(layout.within(whole)), samples=np.ones(2)
    )
    parts: Any = [
        SimpleNamespace(block=6 * k + np.arange(6), motion=SimpleNamespace(name=f"log {k + 1}"))
        for k in range(3)
    ]
    said = " ".join(odd_logs(found, parts))
    assert ("the zeros of the torques are not the same" in said) == (not has)
