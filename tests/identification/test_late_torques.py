"""Torques that were recorded later than the angles, all by one delay."""

from __future__ import annotations

from functools import cache
from importlib import import_module

import numpy as np
import pytest
from identification.given_columns import fit_with
from identification.possible_arms import PossibleCase, log_of, possible_robot

import irb2400_ctrl as irb
from irb2400_ctrl.identification import Identification
from irb2400_ctrl.identification.fitting.moments import recordings
from irb2400_ctrl.identification.fitting.motion_source import motion_of
from irb2400_ctrl.identification.identified_robot import fit_base
from irb2400_ctrl.identification.late_torques import (
    Late,
    in_robot,
    in_time,
    late_torques,
    open_by_delay,
)
from irb2400_ctrl.model import Model
from irb2400_ctrl.report.pages.identification_page import lines

identifying = import_module("irb2400_ctrl.identification.identify")
late_fitting = import_module("irb2400_ctrl.identification.late_torques")
ROBOT = possible_robot()
NAMES = [f"{what}_{j}" for what in ("coulomb", "viscous", "rotor") for j in range(1, 7)]


@cache
def case() -> PossibleCase:
    return PossibleCase(ROBOT, 105, 20.0)


@cache
def sound() -> irb.Log:
    """Without the commanded motion: a sampled one has no delay of its own against its angles."""
    raw = log_of(case(), name="sound")
    return irb.Log(raw.time, raw.q, raw.tau, name="sound")


def late(samples: int) -> irb.Log:
    """The torques of `samples` before, at the angles of now; below zero those to come."""
    log = sound()
    later = slice(max(samples, 0), len(log.time) + min(samples, 0))
    before = slice(max(-samples, 0), len(log.time) - max(samples, 0))
    return irb.Log(log.time[later], log.q[later], log.tau[before], name=f"{samples} later")


@cache
def identified(samples: int) -> Identification:
    return irb.identify(ROBOT, late(samples) if samples else sound())


def values(found: Identification) -> tuple[np.ndarray, np.ndarray]:
    places = [found.layout.names().index(name) for name in NAMES]
    return found.theta[places], found.standard_errors[places]


@pytest.mark.parametrize("samples", [4, pytest.param(-4, marks=pytest.mark.slow)])
def test_they_are_taken_at_the_time_of_the_angles(samples: int) -> None:
    found = identified(samples)
    step = float(np.median(np.diff(sound().time)))
    (one,) = found.late
    assert one.delay == pytest.approx(samples * step, abs=1e-3)
    there, errors = values(found)
    true, _ = values(identified(0))
    assert np.abs((there - true) / errors).max() < 1.5
    word = "later" if samples > 0 else "earlier"
    assert any(f"ms {word} than the angles" in line for line in lines(found))
    assert found.to_json()["late_torques"] == [one.to_json()]


def test_the_robot_predicts_them_as_recorded() -> None:
    """A delay of the recorder is no change of the arm on a later day."""
    found = identified(4)
    (delay,) = [e for e in found.robot.effects if e.kind == "time_delay"]
    assert delay.parameters()["delay_s"] == found.late[0].delay
    again, kept = fit_base(found.robot)
    assert not again.effects
    assert "time_delay" not in [e.kind for e in kept.effects]


def test_a_robot_is_as_late_as_all_of_its_logs() -> None:
    near = [Late("a", 0.0161, 2e-4), Late("b", 0.0158, 2e-4)]
    (delay,) = in_robot(ROBOT, near).effects
    assert delay.parameters()["delay_s"] == pytest.approx(0.01595)
    for others in ([*near, None], [*near, Late("c", 0.024, 2e-4)], [None], []):
        assert in_robot(ROBOT, others) == ROBOT


def test_of_a_sound_log_nothing_is_said_or_moved() -> None:
    found = identified(0)
    assert not found.late
    assert found.robot.effects == in_robot(found.robot, [None]).effects
    assert not any("than the angles" in line for line in lines(found))


def test_a_delay_that_settles_slowly_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 20 s with torques 20 ms late it went to and fro by less than its error, and was none."""

    class Slow:
        def step(self, delay: float) -> tuple[float, float]:
            return 1.6 * (0.02 - delay), 2e-3

    monkeypatch.setattr(late_fitting._DelayFit, "of", lambda model, part: Slow())
    (part,) = recordings([motion_of(sound(), "angle")])
    found = late_torques(Model(fit_base(ROBOT)[0]), part)
    assert found is not None
    assert found.delay == pytest.approx(0.02, abs=1e-4)


@pytest.mark.parametrize(("seconds", "told"), [(7.4, False), (9.0, True)])
def test_seconds_that_disagree_have_to_be_several(seconds: float, told: bool) -> None:
    log = late(4)
    some = log.time < log.time[0] + seconds
    model = Model(fit_base(ROBOT)[0])
    motion = motion_of(irb.Log(log.time[some], log.q[some], log.tau[some]), "angle")
    (part,) = recordings([motion])
    assert (late_torques(model, part) is not None) == told


def test_a_late_log_beside_a_sound_one_is_judged_at_its_time() -> None:
    found = irb.identify(ROBOT, sound(), validation=late(6))
    assert [one.name for one in found.late] == ["6 later"]
    here, there = (log.error("unseen").rmse_over_mean_percent for log in found.logs)
    assert (there < 1.1 * here).all()


def test_what_the_delay_leaves_open_is_open_in_the_numbers() -> None:
    """The slope of the numbers over the delay, against fits to torques moved by hand."""
    model = Model(fit_base(ROBOT)[0])
    motion = motion_of(late(4), "angle")
    true = 4 * float(np.median(np.diff(sound().time)))
    fits = {}
    for off in (-1e-3, 0.0, 1e-3):
        parts = recordings([in_time(motion, true + off)])
        fits[off] = fit_with(model, parts)
    (one,) = identified(4).late
    parts = recordings([in_time(motion, true)])
    covariance = open_by_delay(model, fits[0.0], parts, [one])
    places = [fits[0.0].layout.names().index(name) for name in NAMES[6:9]]
    slope = (fits[1e-3].theta - fits[-1e-3].theta)[places] / 2e-3
    expected = one.error * np.abs(slope)
    np.testing.assert_allclose(np.sqrt(np.diag(covariance)[places]), expected, rtol=0.1)
    errors = identified(4).standard_errors
    assert (errors[places] > np.sqrt(np.diag(covariance)[places])).all()


def test_the_standard_errors_hold_what_the_delay_leaves_open(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    known = identified(4).standard_errors
    count = len(known)
    monkeypatch.setattr(identifying, "open_by_delay", lambda *given: np.zeros((count, count)))
    exactly = irb.identify(ROBOT, late(4)).standard_errors
    places = [identified(4).layout.names().index(name) for name in NAMES[6:]]
    assert (known[places] > 1.02 * exactly[places]).any()
    assert (known >= exactly).all()
