"""The guarded controller's C package under every fault of its inputs, on the independent plant."""

from __future__ import annotations

from functools import cache

import pytest
from independent_plant.case import Case

import irb2400_ctrl as irb
from irb2400_ctrl.codegen.package import Package
from irb2400_ctrl.controllers import controller, guarded

from .faults import LASTING, LIES, PASSING, off_model, run_with_fault

BEGIN = 3500
# the first moves axis 2 fast, the second the wrist
CASES = {seed: Case(seed, duration=1.0, validation_duration=4.0) for seed in (3, 6)}
LONGER = Case(6, duration=1.0, validation_duration=8.0)
NEAR_DEG = 10.0
SLOW = [(9, 0), (4, 1), (8, 1), (6, 2)]


@cache
def package() -> Package:
    robot = irb.load_robot("irb2400")
    return Package(guarded(controller("computed_torque", robot), robot), "float")


@pytest.mark.parametrize("seed", CASES)
@pytest.mark.parametrize("name", PASSING)
def test_what_passes_is_worked_through(name: str, seed: int) -> None:
    outcome = run_with_fault(CASES[seed], package(), BEGIN, PASSING[name])
    assert outcome.brake_ms is None
    assert outcome.largest_error_deg < 0.5
    assert outcome.faults == 0


@pytest.mark.parametrize("seed", CASES)
@pytest.mark.parametrize("name", LASTING)
def test_what_lasts_closes_the_brake_in_time(name: str, seed: int) -> None:
    outcome = run_with_fault(CASES[seed], package(), BEGIN, LASTING[name])
    assert outcome.brake_ms is not None
    assert 0 <= outcome.brake_ms <= 20
    assert outcome.largest_error_deg < NEAR_DEG
    # the command goes on at its rate: 100 kNm/s
    assert outcome.largest_step_Nm < 100.01
    assert outcome.faults == 0


def test_without_a_guard_a_fault_is_what_it_was() -> None:
    """The plant would show it: the bare controller goes far away."""
    bare = Package(controller("computed_torque", irb.load_robot("irb2400")), "float")
    outcome = run_with_fault(CASES[6], bare, BEGIN, LASTING["the same sample for ever"])
    assert outcome.brake_ms is None
    assert outcome.largest_error_deg > 3 * NEAR_DEG


# a drift of the wrist shows when the axis turns back or stands, on some arms later than 10 degrees
@pytest.mark.parametrize(
    ("name", "axis"),
    [*(("wrong sign", axis) for axis in range(6)), *(("drifts by 5 deg/s", a) for a in range(3))],
)
def test_an_encoder_that_lies_is_found_in_time(name: str, axis: int) -> None:
    outcome = run_with_fault(LONGER, package(), BEGIN, LIES[name](axis))
    assert outcome.brake_ms is not None
    assert outcome.largest_error_deg < NEAR_DEG


@pytest.mark.parametrize("axis", [3, 4, 5])
def test_a_drift_of_the_wrist_is_found(axis: int) -> None:
    outcome = run_with_fault(LONGER, package(), BEGIN, LIES["drifts by 5 deg/s"](axis))
    assert outcome.brake_ms is not None


# arms whose axis moves slowly as the lie begins: no speed jumps
@pytest.mark.parametrize(("seed", "axis"), SLOW)
def test_a_lie_that_grows_slowly_is_found(seed: int, axis: int) -> None:
    case = Case(seed, duration=1.0, validation_duration=8.0)
    outcome = run_with_fault(case, package(), BEGIN, LIES["half of every move"](axis))
    assert outcome.brake_ms is not None
    assert outcome.brake_ms > 100
    assert outcome.largest_error_deg < NEAR_DEG


@pytest.mark.parametrize("friction", [0.7, 1.0, 1.3])
@pytest.mark.parametrize("load", [0.0, 3.0, 12.0])
def test_load_and_friction_that_nobody_told_are_no_lie(load: float, friction: float) -> None:
    case = off_model(Case(LONGER.seed, duration=1.0, validation_duration=8.0), load, friction)
    outcome = run_with_fault(case, package(), BEGIN, PASSING["none"])
    assert outcome.brake_ms is None
    assert outcome.faults == 0
