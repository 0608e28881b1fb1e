"""A long path is planned without a limit of the torque's change that nobody stated, and says so."""

from __future__ import annotations

import numpy as np
import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.planners import ToolPath
from irb2400_ctrl.planners.timing import time_choices


def wave(points: int) -> ToolPath:
    """A line over waves of 5 mm, 2 mm from point to point, the tool upright."""
    x = 0.002 * np.arange(points)
    place = np.column_stack([np.full(points, 0.9), x - x[-1] / 2, 0.6 + 0.005 * np.sin(60 * x)])
    return ToolPath(place, axis=np.tile((0.0, 0.0, 1.0), (points, 1)))


@pytest.mark.parametrize(("longest", "noted"), [(20, True), (1000, False)])
def test_the_wait_is_kept_short_and_the_bound_holds(
    monkeypatch: pytest.MonkeyPatch, longest: int, noted: bool
) -> None:
    monkeypatch.setattr(time_choices, "RATES_UP_TO", longest)
    plan = irb.plan_path(irb.load_robot("irb2400"), wave(60), cells=200)
    assert len(plan.certificate.path.knots) > 20
    assert plan.guaranteed
    assert plan.summary()["max_torque_ratio"] <= 1.0
    assert ("rates_note" in plan.summary()) is noted
    assert ("duration_without_rates_s" in plan.summary()) is not noted
