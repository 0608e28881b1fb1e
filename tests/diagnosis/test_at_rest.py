"""Joints that rest bear witness: what is found must not make their torque worse than friction
holds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from independent_plant import Case

from irb2400_ctrl.diagnosis import Diagnosis, diagnose
from irb2400_ctrl.diagnosis.at_rest import worse_at_rest
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.report.pages.diagnosis_page import AT_REST, verdict_sentence
from irb2400_ctrl.robot import load_robot

ROBOT = load_robot("irb2400")


def test_only_beyond_its_friction_and_only_where_that_is_stated() -> None:
    held = ROBOT.friction[:, 0]
    before = np.full(6, 2.0)
    assert worse_at_rest(ROBOT, (4, 5), before, before + 0.9 * held) == ()
    assert worse_at_rest(ROBOT, (4, 5), before, before + 1.1 * held) == (4, 5)
    assert worse_at_rest(ROBOT, (4,), before, before - 2.0 * held) == ()
    joints = [
        j.model_copy(update={"friction": j.friction.model_copy(update={"coulomb_Nm": None})})
        for j in ROBOT.joints
    ]
    unstated = ROBOT.model_copy(update={"joints": tuple(joints)})
    assert worse_at_rest(unstated, (4, 5), before, before + 1.1 * held) == ()


@pytest.fixture(scope="module")
def log() -> Log:
    seen = Case(79, duration=12.0, validation_duration=3.0).simulate()[0]
    return Log(seen.time, seen.q, seen.tau, qd=seen.qd, q_ref=seen.q_ref)


def test_a_note_names_the_joint(log: Log, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Diagnosis, "worse_at_rest", (4, 5))
    said = "more than its friction can hold (joint 4, joint 5)"
    assert any(said in note for note in diagnose(ROBOT, log).weak)


def test_the_verdict_is_not_explained_then(log: Log) -> None:
    """On a clean Panda of which three joints moved, a balancer and 3.5 kg were "explained" while
    two resting joints went from 2.6 to 8.4 and from 0.3 to 3.0 Nm."""
    found = diagnose(ROBOT, log)
    assert found.verdict == "nothing_missing"
    error = found.identification.error_after
    rmse = error.rmse.copy()
    rmse[3] += 3.0 * ROBOT.friction[3, 0]
    compared = replace(found.identification, error_after=replace(error, rmse=rmse))
    worse = replace(found, identification=compared, not_excited=(4,))
    assert worse.worse_at_rest == (4,)
    assert worse.verdict == "unexplained"
    assert verdict_sentence(worse) == AT_REST
