"""Torque channels that do not read alike are told by the bodies that all joints feel."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from identification.test_gains import GAIN, ROBOT, log

import irb2400_ctrl as irb
from irb2400_ctrl.identification import Identification, validate


@cache
def identified(*factors: float) -> Identification:
    """Of torques that are read so many times as large."""
    raw = log(1, 0.0)
    return irb.identify(ROBOT, replace(raw, tau=raw.tau / GAIN * factors))


@pytest.mark.parametrize(
    "gain",
    [(1.0, 1.12, 0.91, 1.0, 1.06, 1.0), (1.2, 0.9, 0.9, 1.3, 0.8, 1.0), (1, 1, 1, 1.7, 1, 1)],
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
    assert "the middle one as 1" in line
    again = validate(found.robot, replace(log(1, 0.0), tau=log(1, 0.0).tau / GAIN * gain))
    alike = validate(right.robot, replace(log(1, 0.0), tau=log(1, 0.0).tau / GAIN))
    assert (again.error.rmse < 1.05 * alike.error.rmse * gain).all()


@pytest.mark.parametrize("factor", [1.0, 1.25])
def test_channels_that_read_alike_have_none(factor: float) -> None:
    """A factor of all is one of the bodies."""
    found = identified(*(factor,) * 6)
    assert found.gains is None
    assert not any(e.kind == "torque_gain" for e in found.robot.effects)
