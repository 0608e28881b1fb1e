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
