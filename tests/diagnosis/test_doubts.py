"""Names that are not as sure as their evidence."""

from __future__ import annotations

from dataclasses import replace

import pytest
from diagnosis.test_three_lists import finding

from irb2400_ctrl.diagnosis.doubts import suspected
from irb2400_ctrl.diagnosis.preparation.quick_rests import Moments

MOMENTS = Moments((1, 2), (3.0, 8.0), 0.02, 40.0)


@pytest.mark.parametrize(
    ("kind", "unsettled", "moments", "most"),
    [
        ("time_delay", False, None, 0.9),
        ("time_delay", False, MOMENTS, 0.75),
        ("time_delay", True, MOMENTS, 0.5),
        ("gear_ripple", False, MOMENTS, 0.9),
        ("gear_ripple", True, None, 0.5),
        ("rotor_inertia", True, MOMENTS, 0.9),
    ],
)
def test_a_name_is_as_sure_as_what_speaks_against_it(
    kind: str, unsettled: bool, moments: Moments | None, most: float
) -> None:
    name = replace(finding(kind, 1, 0.5), confidence=0.9)
    (one,) = suspected((name,), unsettled, moments)
    assert one.confidence == most


@pytest.mark.parametrize(
    ("kind", "beside", "joint", "most"),
    [
        ("hysteresis", "cable_spring", 6, 0.75),
        ("hysteresis", "wrist_coupling", 6, 0.75),
        ("hysteresis", "cable_spring", 5, 0.9),
        ("hysteresis", "viscous_change", 6, 0.9),
        ("viscous_change", "viscous_warmup", 6, 0.75),
        ("viscous_change", "viscous_warmup", 5, 0.9),
        ("coulomb_change", "viscous_warmup", 6, 0.9),
    ],
)
def test_what_another_effect_of_the_joint_leaves_may_be_its_own(
    kind: str, beside: str, joint: int, most: float
) -> None:
    """The creep of a cable, the rest of a warm-up."""
    one = replace(finding(kind, 6, 0.5), confidence=0.9)
    other = replace(finding(beside, joint, 0.5), confidence=0.9)
    told = suspected((other, one), False, None)
    assert [each.confidence for each in told] == [0.9, most]


@pytest.mark.parametrize(
    ("windows", "most"),
    [
        (((20.3, 20.49),), 0.75),
        (((20.3, 20.39), (22.0, 22.1)), 0.75),
        (((20.3, 20.39), (22.0, 22.3)), 0.9),
        (((20.3, 1e9),), 0.9),
        ((), 0.9),
    ],
)
def test_what_acts_for_a_moment_may_be_readings_that_stood_still(
    windows: tuple[tuple[float, float], ...], most: float
) -> None:
    name = finding("base_tilt", 1, 0.5)
    effect = name.effect.model_copy(update={"windows_s": windows})
    (told,) = suspected((replace(name, effect=effect, confidence=0.9),), False, None)
    assert told.confidence == most


@pytest.mark.parametrize(("inertia", "most"), [(0.0, 0.5), (0.2, 0.8)])
def test_a_lever_without_inertia_may_be_a_spring_or_a_gain(inertia: float, most: float) -> None:
    name = finding("linkage_inertia", 3, 0.5)
    effect = name.effect.model_copy(update={"inertia_kgm2": inertia, "moment_kgm": -0.6})
    (told,) = suspected((replace(name, effect=effect, confidence=0.8),), False, None)
    assert told.confidence == most
