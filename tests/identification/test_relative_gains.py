"""Torque channels that do not read alike are told by the bodies that all joints feel."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from identification.test_gains import GAIN, ROBOT, log

import irb2400_ctrl as irb
from irb2400_ctrl.identification import Identification, validate
from irb2400_ctrl.identification.fitting.moments import Moments
from irb2400_ctrl.identification.fitting.relative_gains import relative_gains


@cache
def identified(*factors: float) -> Identification:
    """Of torques that are read so many times as large."""
    raw = log(1, 0.0)
    return irb.identify(ROBOT, replace(raw, tau=raw.tau / GAIN * factors))


@pytest.mark.parametrize(
    "gain",
    [
        pytest.param((1.0, 1.12, 0.91, 1.0, 1.06, 1.0), marks=pytest.mark.slow),
        (1.2, 0.9, 0.9, 1.3, 0.8, 1.0),
        pytest.param((1, 1, 1, 1.7, 1, 1), marks=pytest.mark.slow),
    ],
)
def test_what_the_channels_have_apart_is_found(gain: tuple[float, ...]) -> None:
    gains = identified(*gain).gains
    assert gains is not None
    assert gains.source == "other joints"
    apart = np.array(gain) / np.median(gain)
    assert gains.known[np.abs(apart - 1.0) > 0.1].all()
    assert (gains.values[~gains.known] == 1.0).all()
    off = np.abs(gains.values / apart - 1.0)[gains.known]
    # the middle one has an error of its own
    assert (off < 3.0 * gains.errors[gains.known] + 0.02).all()


def test_the_arm_is_that_of_torques_that_were_read_right() -> None:
    gain = (1.0, 1.0, 1.0, 1.4, 1.0, 1.0)
    found = identified(*gain)
    right = identified(*(1.0,) * 6)
    names = found.layout.names()
    off = (found.theta - right.theta) / np.sqrt(np.diag(found.covariance))
    worst = int(np.argmax(np.abs(off)))
    # with the errors that the gains leave
    assert abs(off[worst]) < 2.5, names[worst]
    told = {e.joint: e.gain for e in found.robot.effects if e.kind == "torque_gain"}
    assert told[4] == pytest.approx(1.4, rel=0.03)
    assert found.to_json()["gains"]["source"] == "other joints"
    (line,) = [note for note in found.notes if "torque channels" in note]
    assert "1 stands for the middle one" in line
    again = validate(found.robot, replace(log(1, 0.0), tau=log(1, 0.0).tau / GAIN * gain))
    alike = validate(right.robot, replace(log(1, 0.0), tau=log(1, 0.0).tau / GAIN))
    assert (again.error.rmse < 1.05 * alike.error.rmse * gain).all()


@pytest.mark.parametrize("factor", [1.0, 1.25])
def test_channels_that_read_alike_have_none(factor: float) -> None:
    """A factor of all is one of the bodies."""
    found = identified(*(factor,) * 6)
    assert found.gains is None
    assert not any(e.kind == "torque_gain" for e in found.robot.effects)


PHI = 10.0
"""torque of the one body that all joints feel [Nm]"""


def fit_of(gains: list[float], noise: float, samples: list[int]) -> Any:
    """A fit whose joints read one body through gains, with noise [Nm] and so many samples each."""
    n = len(gains)
    count = np.tile(np.array(samples, dtype=float), (10, 1))
    read = PHI * np.array(gains)
    sums = Moments(
        count[:, :, None, None], (count * read)[:, :, None], count * (read**2 + noise**2), count
    )
    layout: Any = SimpleNamespace(n=n, count=1, inertial=1)
    prior: Any = SimpleNamespace(mean=np.zeros(1), precision=lambda kappa: 1e-6 * np.eye(1))
    free: Any = SimpleNamespace(sigma=np.full(n, noise))
    return SimpleNamespace(layout=layout, sums=sums, prior=prior, free=free, correlation=np.ones(n))


MANY = [1000] * 6


def test_other_gains_go_with_one_that_is_clear() -> None:
    """Those known to 2 %, and from two standard errors on; of a joint that hardly says anything the
    gain stays one."""
    fit = fit_of([1.0, 1.0, 1.0, 1.3, 1.03, 1.04, 1.1], 1.0, [*MANY[:5], 1, 1])
    values, errors = relative_gains(fit)
    middle = 1.03
    assert values[[3, 4, 6]] == pytest.approx(np.array([1.3, 1.03, 1.1]) / middle, abs=0.012)
    assert (errors[:5] < 0.02).all()
    assert 0.02 < errors[6] < 0.04
    assert values[5] == 1.0
    assert errors[5] == np.inf


@pytest.mark.parametrize(
    ("gains", "noise", "samples"),
    [
        # clear and worth it, but within what torque constants are known to
        ([1.0, 1.0, 1.0, 1.04, 1.0, 1.0], 0.1, MANY),
        # six per cent, three standard errors
        ([1.0, 1.0, 1.0, 1.06, 1.0, 1.0], 0.6, [*MANY[:3], 1, *MANY[4:]]),
        # clear, but no joint is predicted a fifth better
        ([1.0, 1.0, 1.0, 1.08, 1.0, 1.0], 2.0, MANY),
        # the middle one of two is none
        ([1.0, 1.3], 0.1, MANY[:2]),
    ],
)
def test_no_gain_is_told_that_is_not_clear_and_worth_it(
    gains: list[float], noise: float, samples: list[int]
) -> None:
    values, errors = relative_gains(fit_of(gains, noise, samples))
    assert (values == 1.0).all()
    assert (errors == np.inf).all()
    # the same a little further off, on as many joints as it takes
    far = [1.0 + 5.0 * (g - 1.0) for g in gains] + [1.0] * (6 - len(gains))
    values, _ = relative_gains(fit_of(far, min(noise, 0.5), MANY))
    assert (values != 1.0).any()
