"""Effects that begin in mid-record on arms of an independent plant: one cause, one name."""

from __future__ import annotations

import pytest
from independent_plant import Case, Effect, suite

from irb2400_ctrl.diagnosis import Diagnosis, diagnose
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.robot import load_robot


def diagnosed(case: Case) -> Diagnosis:
    log = next(iter(case.simulate()))
    return diagnose(
        load_robot("irb2400"), Log(log.time, log.q, log.tau, q_ref=log.q_ref, name="identification")
    )


def named(found: Diagnosis) -> list[tuple[str, int | None]]:
    return [(f.effect.kind, f.effect.joint) for f in found.findings]


@pytest.mark.parametrize(
    ("kind", "joint"),
    [
        ("wrist_coupling", 5),
        pytest.param("coulomb_change", 5, marks=pytest.mark.slow),
        # on joint 3 a balancer of an odd shape is as probable
        pytest.param("cable_spring", 4, marks=pytest.mark.slow),
    ],
)
def test_what_begins_in_mid_record_has_one_name_and_its_time(kind: str, joint: int) -> None:
    found = diagnosed(
        Case(11, (Effect(kind, joint, 0.1, on_at=13.0),), duration=25.0, validation_duration=8.0)
    )
    assert named(found) == [(kind, joint)]
    assert found.findings[0].effect.windows_s[0][0] == pytest.approx(13.0, abs=0.5)
    assert found.robot.effects[0].windows_s == ()  # from now on it is always there


@pytest.mark.slow
def test_a_delay_that_only_reversals_show_is_not_named() -> None:
    case = suite("pairs", 31, 2029)[30]
    assert named(diagnosed(case)) == [(t.kind, t.joint) for t in case.truth]


@pytest.mark.slow
def test_what_a_single_second_says_is_no_law() -> None:
    """A joint creeps, sticks and breaks away once; nothing is missing."""
    found = diagnosed(suite("clean", 72, 2029)[71])
    assert (named(found), found.unexplained) == ([], ())


@pytest.mark.slow
def test_a_friction_far_from_its_data_sheet_is_named() -> None:
    found = diagnosed(suite("single", 4, 2029)[3])
    assert named(found) == [("coulomb_change", 1)]
