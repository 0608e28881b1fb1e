"""Axes 4 and 6 that turn one motor, without the gears of their neighbours."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from irb2400_ctrl.diagnosis.comparison.scan import Scan
from irb2400_ctrl.diagnosis.estimation.candidate import Candidate
from irb2400_ctrl.diagnosis.regressors.bases import RegressorColumns

SPEEDS = np.random.default_rng(4).normal(size=(500, 2))
BENDS = np.random.default_rng(5).normal(size=(500, 2))


def drags_both(*numbers: float) -> bool:
    """Of I, D, D', F and F'."""
    values = np.zeros((500, 2, 5))
    for here, other in ((0, 1), (1, 0)):
        values[:, here, 0] = BENDS[:, other]
        values[:, here, 1 + here] = SPEEDS[:, other]
        values[:, here, 3 + here] = np.sign(SPEEDS[:, other])
    score: Any = SimpleNamespace(coefficients=np.array(numbers), discrepancy=())
    law = RegressorColumns((3, 5), values)
    candidate = Candidate("far_wrist_coupling", 4, "", (), (), law, None, score)
    scan: Any = Scan.__new__(Scan)
    scan.motion = SimpleNamespace(n=6)
    return scan._drags_both(candidate)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_what_one_motor_does_to_two_axes_has_one_sign(sign: float) -> None:
    assert drags_both(*(sign * np.array([0.1, 0.3, 0.3, 0.5, 0.5])))
    assert drags_both(sign * 0.2, 0.0, 0.0, 0.0, 0.0)
    assert drags_both(*(sign * np.array([0.0, 0.4, 0.4, -0.02, 0.03])))


def test_numbers_that_speak_against_each_other_are_of_no_motor() -> None:
    """Of a UR10, each joint of which has a motor of its own, the two halves of a record had
    D = 0.28, D' = -0.36 and D = -0.44, D' = 0.39 Nm s/rad."""
    assert not drags_both(-0.10, 0.15, -0.44, 0.02, 0.45)
    assert not drags_both(0.0, 0.4, -0.4, 0.0, 0.0)


def test_what_one_axis_alone_feels_is_of_no_shaft_through_both() -> None:
    assert not drags_both(0.0, 0.4, 0.0, 0.6, 0.02)
