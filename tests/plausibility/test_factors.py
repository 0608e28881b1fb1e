"""Speeds whose ratio to dq/dt is no factor: sampled coarsely, truncated, with lost rows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from irb2400_ctrl.measurement import Log
from irb2400_ctrl.plausibility.columns.agreement import speed_problem

AMPLITUDE = np.array([0.25, 0.2, 0.3])


def sines(rate: float, frequency: float) -> Log:
    """Three joints of one frequency [Hz], sampled at a rate [Hz], with exact speeds."""
    time = np.arange(0.0, 40.0, 1.0 / rate)
    omega = 2.0 * np.pi * frequency
    phase = omega * time[:, None] + np.arange(3)
    q = AMPLITUDE * np.sin(phase)
    return Log(time, q, np.cos(phase), qd=AMPLITUDE * omega * np.cos(phase))


def speeds(log: Log, kind: str) -> Log:
    """The log with speeds as drives spoil them."""
    assert log.qd is not None
    chance = np.random.default_rng(4).uniform(size=log.qd.shape)
    limit = 0.7 * np.abs(log.qd).max(axis=0)
    spoilt = {
        "exact": log.qd,
        "truncated": np.trunc(log.qd / 0.1) * 0.1,
        "lost 10 %": np.where(chance < 0.1, 0.0, log.qd),
        "lost 20 %": np.where(chance < 0.2, 0.0, log.qd),
        "cut off": np.clip(log.qd, -limit, limit),
    }
    return replace(log, qd=spoilt[kind])


SPOILT = ["truncated", "lost 10 %", "lost 20 %", "cut off"]


@pytest.mark.parametrize(("rate", "frequency"), [(10.0, 2.0), (10.0, 2.5), (20.0, 4.0)])
def test_exact_speeds_of_quick_sines_are_no_other_clock(rate: float, frequency: float) -> None:
    """Trapezoids cut their peaks."""
    log = sines(rate, frequency)
    assert speed_problem(log) is None
    found = speed_problem(replace(log, time=log.time / 2.0))
    assert found is not None
    assert found.kind == "time_scale"


@pytest.mark.parametrize("kind", SPOILT)
def test_spoilt_speeds_are_no_factor(kind: str) -> None:
    assert speed_problem(speeds(sines(250.0, 0.35), kind)) is None


@pytest.mark.parametrize("kind", ["exact", *SPOILT])
@pytest.mark.parametrize("factor", [0.5, 1.5, 2.0])
def test_a_factor_is_seen_in_spoilt_speeds(kind: str, factor: float) -> None:
    log = speeds(sines(250.0, 0.35), kind)
    found = speed_problem(replace(log, time=log.time / factor))
    assert found is not None
    assert found.kind == "time_scale"
    assert found.fits["factor"] == pytest.approx(factor, rel=0.22)


def test_the_factor_of_speeds_with_lost_rows_is_the_true_one() -> None:
    log = speeds(sines(250.0, 0.35), "lost 20 %")
    assert log.qd is not None
    found = speed_problem(replace(log, qd=log.qd * [1.0, 1.5, 1.0]))
    assert found is not None
    assert (found.kind, found.joints) == ("speed_unit", (2,))
    assert found.fits["factor"] == pytest.approx(1.0 / 1.5, rel=0.01)
    assert found.says.startswith("dq/dt is 0.667 times the recorded speed on joint 2: ")


def test_an_angle_in_a_unit_so_large_that_it_hardly_moves_is_held_against_its_speed() -> None:
    """Radians under degrees on one joint: its dq/dt was that of a joint at rest."""
    log = sines(250.0, 0.15)
    found = speed_problem(replace(log, q=log.q * [1.0, np.pi / 180.0, 1.0]))
    assert found is not None
    assert (found.kind, found.joints) == ("speed_unit", (2,))
    assert found.says.endswith("on joint 2: degrees and radians")
