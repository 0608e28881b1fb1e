"""Errors on stretches that everything is fitted without, in turn."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from irb2400_ctrl.diagnosis.estimation.held_out import FOLDS, HeldOut, Worth, folds
from irb2400_ctrl.effects import LIBRARY


def test_how_a_swing_began_is_not_asked_of_rows_that_do_not_show_it() -> None:
    """A fold without the first seconds found any beginning of an elastic joint 1: 254 Nm were left
    there where 2 are, and a ripple of axis 5 of 736 standard deviations was refused for it."""
    time = np.arange(0.0, 24.0, 0.02)
    rng = np.random.default_rng(3)
    swing = np.exp(-2.0 * time)
    columns = np.column_stack([np.sin(time), 3000.0 * swing, 3000.0 * swing * time])
    y = columns @ [2.0, 1e-3, 2e-3] + rng.normal(scale=0.1, size=len(time)) + 0.1 * np.cos(time)
    elastic = LIBRARY["elastic_joint"].of(1, **LIBRARY["elastic_joint"].example)
    fit: Any = SimpleNamespace(
        y=y[:, None],
        Z=columns[:, None, :],
        owner=np.array([-1, 0, 0]),
        parameters=(),
        effects=(elastic,),
        units=(np.array([3000.0, 3000.0]),),
        noise=(SimpleNamespace(kept=slice(None), whiten=lambda values: values / 0.1),),
    )
    held_out: Any = HeldOut.__new__(HeldOut)
    held_out.fit = fit
    held_out.fold = folds(time)
    left = held_out._left(fit, held_out._solved(fit))
    for fold in range(FOLDS):
        assert np.sqrt(np.mean(left[held_out.fold == fold] ** 2)) < 0.2


@pytest.mark.parametrize("seconds", [3.0, 40.0])
def test_every_fold_sees_the_whole_record(seconds: float) -> None:
    time = np.arange(0.0, seconds, 0.02)
    place = folds(time)
    assert set(place) == set(range(FOLDS))
    for k in range(FOLDS):
        rows = np.flatnonzero(place == k)
        assert rows[0] < 0.35 * len(time)
        assert rows[-1] > 0.65 * len(time)


def test_worth_is_the_log_likelihood_of_unseen_rows() -> None:
    known = np.ones((50, 2), dtype=bool)
    known[:10, 1] = False
    before = np.full((50, 2), 2.0)
    before[:10] = 99.0
    before[:10, 0] = 2.0
    after = np.full((50, 2), [1.0, 4.0])
    worth = Worth.of(before, after, known)
    np.testing.assert_allclose(worth.gain, [50.0, -100.0])
    np.testing.assert_allclose(worth.nats, [50 * np.log(2.0), -40 * np.log(2.0)])


@pytest.mark.parametrize(
    ("noise", "slow", "size", "of_the_fit"),
    [
        (0.5, 0.0, 1.25, True),
        (0.5, 0.0, 0.45, False),  # a law may be less than the noise
        (0.5, 0.9, 1.25, False),  # more than noise is left: a motor that saturates
    ],
)
def test_a_law_that_makes_up_for_the_fit_is_none(
    noise: float, slow: float, size: float, of_the_fit: bool
) -> None:
    """A fit moved numbers of joint 1, whose given ones left 0.55 Nm of noise, and a law of 1.25 Nm
    made up for it: an arm that had not changed was unexplained."""
    time = 0.004 * np.arange(4000)
    wave = np.sqrt(2.0) * np.sin(3.0 * time)
    tau = np.random.default_rng(1).normal(scale=noise, size=(4000, 2))
    tau[:, 0] += slow * wave
    held_out: Any = HeldOut.__new__(HeldOut)
    held_out._known = np.ones((4000, 2), dtype=bool)
    held_out._known[:40] = False
    tau[:40] = 99.0
    parts = ((False, 2), (True, 1), (False, 1))
    held_out.chosen = [SimpleNamespace(known=known, joint=joint) for known, joint in parts]
    held_out.fit = SimpleNamespace(
        effects=("named",),
        non_parametric=(np.outer(wave, [0.0, 9.0]), np.outer(wave, [size, 0.0])),
    )
    held_out.fitter = SimpleNamespace(
        motion=SimpleNamespace(
            tau=tau + 7.0, at_rows=lambda values: values, known=held_out._known, step=0.004
        ),
        predicted=lambda effects: 7.0 * len(effects),
    )
    assert held_out.of_the_fit(2) == of_the_fit
    held_out.chosen[2].joint = None
    assert not held_out.of_the_fit(2)
