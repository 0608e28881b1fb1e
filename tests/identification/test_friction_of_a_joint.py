"""Friction of a joint that is another one as a whole, told along the motion as one number."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from identification.possible_arms import PossibleCase
from identification.test_change import ROBOT, known, log
from independent_plant.machine import Machine

import irb2400_ctrl as irb
from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis import Diagnosis, Number, friction_test
from irb2400_ctrl.diagnosis.comparison.criteria import Criteria
from irb2400_ctrl.diagnosis.numbers import RATIO
from irb2400_ctrl.diagnosis.preparation.noise import Noise
from irb2400_ctrl.identification import change, diagnose_change
from irb2400_ctrl.identification.another_day.reference_error import has_changed
from irb2400_ctrl.report.pages.diagnosis_page import lines

JOINT = 3


def stiffer(factor: float) -> irb.Log:
    """`log(2)` of `test_change`, the friction of one joint so many times as large."""
    case = PossibleCase(ROBOT, 104, 20.0)
    machine = case.machine
    rubbing = machine.friction.copy()
    rubbing[JOINT - 1, :3] *= factor
    case.__dict__["machine"] = Machine(machine.arm, rubbing, machine.servo)
    raw = case.simulate(PossibleCase(ROBOT, 2, 20.0).motions[0])[0]
    return irb.Log(raw.time, raw.q, raw.tau, q_ref=raw.q_ref, name=f"friction {factor}")


@cache
def found(factor: float) -> Diagnosis:
    """Against a reference that leaves ten times what is left of today's log."""
    patch = pytest.MonkeyPatch()
    before = irb.diagnose(known().robot, log(1), criteria=Criteria(most=0))
    ask = change.diagnose

    def diagnose(robot: Any, logs: Any, *others: Any, **more: Any) -> Diagnosis:
        return ask(robot, logs, *others, **more) if others else before

    def left(*reference: object) -> Array:
        return np.asarray(10.0 * known().logs[0].error("unseen").rmse)

    with patch.context() as patched:
        patched.setattr(change, "identify", lambda robot, logs: known())
        patched.setattr(change, "diagnose", diagnose)
        patched.setattr(change, "unseen_error", left)
        return diagnose_change(ROBOT, stiffer(factor), [log(1)])


def test_what_is_little_sample_by_sample_is_told_along_the_motion() -> None:
    """Two fifths more friction of one joint were silent where a model leaves as much."""
    told = [n for n in found(1.4).numbers if n.list == "changed"]
    assert {n.place for n in told} == {f"joint {JOINT}"}
    (ratio,) = (n for n in told if n.name == RATIO)
    assert ratio.before == 1.0
    assert ratio.after == pytest.approx(1.4, abs=0.08)
    assert abs(ratio.after - 1.4) < 3.0 * ratio.standard_error < 0.4
    assert "all friction over the reference's" in "\n".join(lines(found(1.4)))
    assert "but" in lines(found(1.4))[0]


@pytest.mark.slow
def test_an_unchanged_joint_has_no_other_friction() -> None:
    assert found(1.0).numbers == ()
    assert "Nothing has changed" in lines(found(1.0))[0]


@pytest.mark.parametrize(("bends", "told"), [(0.0, [1.25]), (1.0, [])])
def test_one_part_of_it_against_the_others_is_no_other_friction(
    monkeypatch: pytest.MonkeyPatch, bends: float, told: list[float]
) -> None:
    """Of an arm whose friction grows with another power of the speed than the reference's law all
    friction was 0.8 of the reference's, beside a load, where it was 0.97."""
    rng = np.random.default_rng(1)
    parts = rng.standard_normal((2000, 3))
    law = parts.sum(axis=1)
    y = 0.25 * law - bends * 0.25 * parts[:, :2].sum(axis=1) + 0.3 * rng.standard_normal(2000)
    motion = SimpleNamespace(n=1, filtered=lambda columns: columns)
    fitter = SimpleNamespace(
        robot=SimpleNamespace(identified=object()),
        bases=None,
        motion=motion,
        own=2,
        widened=np.ones(2),
    )
    noise = Noise(np.ones(1), np.full(2000, 1.0 / 0.3), np.arange(2000))
    fit = SimpleNamespace(noise=[noise], Z=0.3 * parts[:, None, :2], y=y[:, None])
    monkeypatch.setattr(friction_test, "friction_along", lambda *_: law[:, None])
    found = friction_test.moved_as_all_friction(cast(Any, fitter), cast(Any, fit), change=True)
    assert [number.after for number in found] == pytest.approx(told, abs=0.03)


def test_of_a_joint_whose_friction_is_another_its_numbers_have_changed() -> None:
    worse = np.zeros(6, dtype=bool)
    dry = Number("changed", "joint 3", "coulomb_Nm", 10.0, 14.0, 1.0, 4.0)
    assert not has_changed(dry, worse)
    assert has_changed(dry, worse, {"joint 3"})
    assert not has_changed(dry, worse, {"joint 2"})
    assert not has_changed(replace(dry, name="offset_Nm"), worse, {"joint 3"})
