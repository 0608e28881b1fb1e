"""The parts that keep accelerations below a limit, each by itself."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from irb2400_ctrl.planners.certify import _rates_kept
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing.motion_bounds import Checked
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.timing.rate_limited.rate_limited_grid import first_grid
from irb2400_ctrl.planners.timing.sampled_reference import SampledReference
from irb2400_ctrl.planners.timing.sampled_reference.reference_bounds import ReferenceBounds
from irb2400_ctrl.planners.timing.sampled_reference.settled_reference import Settled

LIMITS = MotionLimits(np.full(2, 1.0), np.full(2, 10.0), np.full(2, 4.0))


def bounds(torque: float, acceleration: float) -> ReferenceBounds:
    """Of one cell, the speeds far below their limit."""
    parts = (np.full((1, 2), size) for size in (torque, 0.1, acceleration))
    return ReferenceBounds(np.array([0.0, 1.0]), *parts)


def test_a_motion_is_slowed_for_its_acceleration_as_for_its_torque() -> None:
    nothing: Any = None
    for torque, acceleration, worst in ((5.0, 6.0, 1.5), (12.0, 2.0, 1.2)):
        found = Settled(nothing, nothing, bounds(torque, acceleration), np.full(2, torque), None)
        assert found.worst(LIMITS) == pytest.approx(worst)
        assert found.slower(LIMITS) == pytest.approx(1.0 + 0.7 * (worst - 1.0))


def test_the_column_of_accelerations_counts_beside_the_cubics() -> None:
    rows: Any = SimpleNamespace(
        time=np.array([0.0, 1.0, 2.0]), qdd=np.array([[0.0, -3.0], [5.0, 0.0], [0.0, 0.0]])
    )
    reference = SampledReference(rows, "cubic")
    time = np.array([0.0, 0.5, 1.0, 2.0])
    nothing = np.zeros((3, 2))
    swing = np.array([[0.0, 0.0], [0.0, 4.0], [6.0, 0.0]])
    found = reference._with_column(ReferenceBounds(time, nothing, nothing, swing), LIMITS)
    np.testing.assert_array_equal(found.acceleration, [[5.0, 3.0], [5.0, 4.0], [6.0, 0.0]])


def test_a_law_above_its_accelerations_is_not_guaranteed_though_nobody_stated_rates() -> None:
    options: Any = SimpleNamespace(rates_stated=False)
    for ratio, kept in ((0.99, True), (1.01, False)):
        checked = Checked(0.5, 0.5, (0.0, 1), acceleration_ratio=ratio, jerk_ratio=9.0)
        assert _rates_kept(checked, options) == kept


def test_no_cell_is_smaller_than_its_rounding() -> None:
    """Of an arm far weaker in acceleration than in torque the first cells were 1e-24 of the path,
    and what was divided by them not a number."""
    path = JointPath.straight(np.array([0.0, 1.0, 2.0]), np.array([[0.0], [1.0], [0.5]]))
    fastest: Any = SimpleNamespace(s=np.array([0.0, 1.0, 2.0]), x=np.array([0.0, 1.0, 0.0]))
    tiny = np.full(2, 1e-9)
    outputs: Any = SimpleNamespace(h=np.ones(2), building_up=lambda x: (tiny, tiny))
    s = first_grid(path, fastest, outputs, 20)
    assert 1e-11 < np.diff(s).min() < 1e-9
