"""Joints that rest bear witness: what is found leaves the arm held up, but for what their friction
holds."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from independent_plant import Case

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis import Diagnosis, diagnose
from irb2400_ctrl.diagnosis.at_rest import worse_at_rest
from irb2400_ctrl.diagnosis.estimation.fit import Fit, Fitter
from irb2400_ctrl.diagnosis.estimation.posterior import Posterior
from irb2400_ctrl.diagnosis.preparation.noise import HELD, NoiseModel
from irb2400_ctrl.diagnosis.preparation.resting import Resting
from irb2400_ctrl.diagnosis.regressors.predict import predicted_torque
from irb2400_ctrl.effects.torque_offset import TorqueOffset
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.measurement.prepared_log import PreparedLog, prepare
from irb2400_ctrl.report.pages.verdict import AT_REST, verdict_sentence
from irb2400_ctrl.robot import Robot, load_robot

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
    said = "more than its friction can hold (joints 4 and 5)"
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


ROWS = 400
STEP = 0.05
STILL = np.column_stack([np.ones(ROWS, dtype=bool), np.zeros(ROWS, dtype=bool)])
"""of two joints the second rests"""


def noise_of(holds: float) -> NoiseModel:
    """Of a log of 20 s."""
    return NoiseModel(STILL, ~STILL, np.zeros(2), STEP, holds=np.array([np.inf, holds]))


def test_a_joint_at_rest_counts_as_one_value_a_second() -> None:
    left = np.random.default_rng(1).standard_normal((ROWS, 2))
    for found in (noise_of(5.0).white(left), noise_of(5.0).coloured(left)):
        seconds = ROWS * STEP / HELD
        assert np.sum(found[1].weight ** 2) == pytest.approx(seconds / 5.0**2)
        assert not found[1].a[1:].any()
    assert len(noise_of(np.inf).white(left)[1].kept) == 0


def test_bodies_are_bound_by_what_a_resting_joint_holds() -> None:
    """Two numbers explain the moving joint alike; one of them would ask 500 Nm of the resting one,
    whose friction holds 10."""
    rng = np.random.default_rng(2)
    swing = np.sin(np.arange(ROWS) * STEP)
    columns = np.zeros((ROWS, 2, 3))
    columns[:, 0, 0] = swing
    columns[:, 1, 0] = 100.0
    columns[:, 0, 1] = swing
    columns[:, 1, 2] = 10.0  # the mean of what friction holds
    y = np.zeros((ROWS, 2))
    y[:, 0] = 10.0 * swing + 0.1 * rng.standard_normal(ROWS)

    def asked(holds: float) -> float:
        b = Posterior(y, columns, noise_of(holds).white(y)).mean
        return float(abs(100.0 * b[0]))

    assert asked(np.inf) > 400.0
    assert asked(10.0) < 20.0


@pytest.fixture(scope="module")
def still() -> PreparedLog:
    seen = Case(80, duration=8.0, validation_duration=3.0, idle=(2, 4)).simulate()[0]
    return prepare(Log(seen.time, seen.q, seen.tau, q_ref=seen.q_ref))


def resting(motion: PreparedLog, tau: Array, robot: Robot = ROBOT) -> Resting:
    numbers = np.full((len(motion.time), motion.n, 1), 5.0)
    return Resting.of(replace(motion, tau=tau), robot, predicted_torque(robot, motion), numbers)


def test_a_joint_under_its_brake_is_no_witness(still: PreparedLog) -> None:
    sound = resting(still, still.tau)
    assert np.flatnonzero(np.isfinite(sound.holds)).tolist() == [1, 3]
    np.testing.assert_allclose(sound.holds[[1, 3]], ROBOT.friction[[1, 3], 0])
    assert sound.columns.shape[2] == 2
    for k, j in enumerate((1, 3)):
        means = np.zeros((len(still.time), 6))
        means[:, j] = ROBOT.friction[j, 0]
        np.testing.assert_allclose(sound.columns[:, :, k], means)
    assert not sound.remarks
    braked = still.tau.copy()
    braked[:, 1] = 1000.0 + 0.1 * np.sin(still.time)
    braked[:, 3] = braked[0, 3]  # never changes: no torque at all
    found = resting(still, braked)
    assert not np.isfinite(found.holds).any()
    assert found.columns.shape[2] == 0
    assert len(found.remarks) == 1
    assert found.remarks[0].startswith("joint 2 rests, and its torque is not what holds the arm")


def test_a_remark_on_a_brake_reaches_the_reader() -> None:
    seen = Case(80, duration=8.0, validation_duration=3.0, idle=(4,)).simulate()[0]
    tau = seen.tau + np.array([0.0, 0.0, 0.0, 400.0, 0.0, 0.0])
    found = diagnose(ROBOT, Log(seen.time, seen.q, tau, q_ref=seen.q_ref))
    assert any(note.startswith("joint 4 rests, and its torque") for note in found.weak)


def test_effects_of_the_file_hold_a_joint_too(still: PreparedLog) -> None:
    offset = ROBOT.with_effects(TorqueOffset(joint=2, offset_Nm=400.0))
    assert len(resting(still, still.tau, offset).remarks) == 1
    lifted = still.tau + 400.0 * (np.arange(6) == 1)
    assert np.isfinite(resting(still, lifted, offset).holds[1])


def test_without_stated_friction_a_joint_is_no_witness(still: PreparedLog) -> None:
    """Its unknown friction took the torque: 22,842 Nm s/rad on a sound arm."""
    found = resting(still, still.tau, ROBOT.with_unknown_friction([4]))
    assert np.flatnonzero(np.isfinite(found.holds)).tolist() == [1]
    assert not found.remarks


def test_the_witnesses_reach_the_fit(monkeypatch: pytest.MonkeyPatch) -> None:
    seen = Case(80, duration=8.0, validation_duration=3.0, idle=(2, 4)).simulate()[0]
    bound: list[Array] = []
    kept = NoiseModel.of

    def of(motion: PreparedLog, reversal: Any, wander: Array, holds: Any = None) -> NoiseModel:
        bound.append(holds)
        return kept(motion, reversal, wander, holds)

    monkeypatch.setattr(NoiseModel, "of", of)
    fitted: list[Array] = []
    fits = Fitter.fit

    def fit(self: Fitter, chosen: Any) -> Fit:
        fitted.append(self.Z)
        return fits(self, chosen)

    monkeypatch.setattr(Fitter, "fit", fit)
    found = diagnose(ROBOT, Log(seen.time, seen.q, seen.tau, q_ref=seen.q_ref))
    assert found.not_excited == (2, 4)
    assert len(bound) == 2
    for holds in bound:
        np.testing.assert_allclose(holds[[1, 3]], ROBOT.friction[[1, 3], 0])
    for Z in fitted:
        for j in (1, 3):
            means = np.isclose(Z[:, j], ROBOT.friction[j, 0]).all(axis=0)
            assert means.sum() == 1
    assert abs(found.robot.friction[3, 2] / ROBOT.friction[3, 2] - 1.0) < 0.2
