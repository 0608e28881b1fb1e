"""What stamps, digits and noise of a log make of a sound arm: nothing."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import numpy.typing as npt
from independent_plant import Case

import irb2400_ctrl as irb
from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.diagnosis.estimation.effect_parameters import Parameter, alone
from irb2400_ctrl.diagnosis.preparation.doubtful_accelerations import doubtful_accelerations
from irb2400_ctrl.diagnosis.regressors.effect_states import _followed
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.measurement.prepared_log import prepare
from irb2400_ctrl.model import Model
from irb2400_ctrl.plausibility import log_problem

ROBOT = irb.load_robot("irb2400")


@cache
def sound() -> Log:
    log = Case(77, duration=20.0, validation_duration=3.0).simulate()[0]
    return Log(log.time, log.q, log.tau)


def rounded(signal: npt.NDArray[np.float64], step: float) -> npt.NDArray[np.float64]:
    return step * np.round(signal / step)


def test_stamps_that_scatter_by_half_a_period_are_no_other_robot() -> None:
    log = sound()
    noise = np.random.default_rng(3).uniform(-2e-3, 2e-3, len(log.time))
    stamps = np.sort(log.time + noise) + 1e-10 * np.arange(len(log.time))
    assert log_problem(ROBOT, replace(log, time=stamps)) is None


def test_torque_in_coarse_steps_is_noise() -> None:
    log = sound()
    tau = log.tau.copy()
    tau[:, 0] = rounded(tau[:, 0], 13.0)
    found = diagnose(ROBOT, replace(log, tau=tau))
    assert found.verdict == "nothing_missing"
    assert found.beyond_noise == ()


def test_accelerations_are_doubted_by_the_share_that_is_noise() -> None:
    model = Model(ROBOT)

    def doubted(log: Log) -> npt.NDArray[np.float64]:
        motion = prepare(log)
        columns = doubtful_accelerations(model, [log], motion)
        return np.sqrt(np.mean(columns**2, axis=0))

    log = sound()
    keep = slice(None, None, 5)  # 50 Hz
    coarse = Log(log.time[keep], rounded(log.q[keep], 1e-4), log.tau[keep])
    fine = Log(log.time[keep], rounded(log.q[keep], 1e-7), log.tau[keep])
    assert doubted(coarse)[0].max(initial=0.0) > 1.0
    assert doubted(fine).max(initial=0.0) < 0.2 * doubted(coarse).max()


def test_states_from_a_band_of_equations_are_those_of_step_by_step() -> None:
    rng = np.random.default_rng(0)
    m = 23
    E = [[0.9 * np.eye(2)[i, k] + 0.1 * rng.uniform(size=(m, 3)) for k in range(2)] for i in (0, 1)]
    c = [rng.standard_normal((m, 3)) for _ in range(2)]
    starts = rng.standard_normal((3, 2, 3))
    found = _followed(E, c, [list(start) for start in starts], (m + 1, 3))
    for x, states in zip(starts, found, strict=True):
        for t in range(m):
            x = np.stack([sum(E[i][k][t] * x[k] for k in (0, 1)) + c[i][t] for i in (0, 1)])
            np.testing.assert_allclose([s[t + 1] for s in states], x, rtol=1e-12)


def test_what_two_numbers_of_an_effect_share_is_no_doubt_of_either() -> None:
    shared = np.array([[1.0, 0.99], [0.99, 1.0]])
    one = [Parameter(0, "torque_Nm", None, None), Parameter(0, "free_ratio", None, None)]
    two = [one[0], replace(one[1], effect=1)]
    np.testing.assert_allclose(alone(shared, one), np.sqrt(1.0 - 0.99**2))
    np.testing.assert_allclose(alone(shared, two), 1.0)
