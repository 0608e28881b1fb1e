"""Which friction is said to be another than the file's."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
from diagnosis.plain_motion import ROBOT, motion

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.numbers import friction_is_another, friction_level, numbers
from irb2400_ctrl.diagnosis.preparation.base_prior import BasePrior
from irb2400_ctrl.effects import LIBRARY, Effect
from irb2400_ctrl.robot import Uncertainty

N = ROBOT.n
PRIOR = replace(BasePrior.of(ROBOT, Uncertainty(), motion()), common_friction=0.3)


def told(change: Array, effects: Sequence[Effect] = ()) -> tuple[list[tuple[str, str]], str]:
    """Places and names of what is told of dry (static as well) and viscous friction changed so, of
    the file's, and the sentence of its level."""
    deviations = np.zeros(len(PRIOR.sigmas()))
    deviations[-3 * N : -N] = np.ravel(change) / Uncertainty().friction_relative
    deviations[-N:] = change[0] / Uncertainty().static_relative
    z = np.linalg.solve(PRIOR.root, deviations)
    fit: Any = SimpleNamespace(z=z, z_covariance=1e-6 * np.eye(len(z)), effects=effects)
    after = PRIOR.updated(deviations)
    counts = np.ones(N, dtype=bool)
    found = numbers(PRIOR, fit, after, change=False, friction_counts=counts)
    return [(one.place, one.name) for one in found], friction_level(PRIOR, fit)


def test_a_cold_arm_has_a_level_and_no_number_of_its_own() -> None:
    """Dry friction of all joints 30 % up was six numbers of which "other arms have none"."""
    level = np.array([[0.3], [0.2]]) + np.zeros((2, N))
    assert told(level)[0] == []
    assert "dry +30 %, viscous +20 %" in told(level)[1]
    assert told(0.1 * level)[1] == ""
    one = level.copy()
    one[0, 3] = 0.6
    assert told(one)[0] == [("joint 4", "coulomb_Nm")]


def test_joints_whose_friction_is_another_do_not_move_the_level_of_the_others() -> None:
    """Beside a motor that two wrist axes turn, 88 and 50 % more viscous, axis 1 was told to have
    5.3 standard deviations less: the mean of all had moved by 20 %."""
    level = np.array([[0.3], [0.1]]) + np.zeros((2, N))
    level[1, 3:5] = 0.6, 1.1
    found, sentence = told(level)
    assert found == [("joint 4", "viscous_Nms_rad"), ("joint 5", "viscous_Nms_rad")]
    assert "dry +30 %, viscous +10 %" in sentence


def test_of_friction_that_bends_the_straight_part_is_no_number_of_its_own() -> None:
    """Viscous friction was 60 % less beside the law that had taken its place: together they were
    the file's."""
    less = np.zeros((2, N))
    less[1, 3] = -0.6
    assert ("joint 4", "viscous_Nms_rad") in told(less)[0]
    bends = LIBRARY["viscous_power"].of(4, coefficient=4.2, exponent=0.7)
    assert told(less, [bends])[0] == []


def test_a_line_that_lies_otherwise_through_the_same_friction_is_none() -> None:
    """Friction that bends with speed was 14 % less dry and 26 % more viscous on another motion."""
    speeds = np.linspace(-2.0, 2.0, 401)[:, None] * np.ones(N)
    known = np.ones(speeds.shape, dtype=bool)

    def another(dry: float, viscous: float, qd: Array = speeds) -> bool:
        def with_friction(scale: Sequence[float]) -> Any:
            lines = np.array([1.0, 4.0, 1.5, 0.05]) * [1.0, *scale, 1.0]
            return SimpleNamespace(friction=np.tile(lines, (N, 1)))

        felt: Any = SimpleNamespace(qd=qd, known=known)
        found = friction_is_another(with_friction((1, 1)), with_friction((dry, viscous)), felt)
        assert len(set(found.tolist())) == 1
        return bool(found[0])

    assert not another(0.86, 1.26)
    assert another(0.6, 1.26)
    # one of both, or both the same way, is another friction however little this motion shows
    assert another(1.0, 1.4, 0.1 * speeds)
    assert another(1.06, 1.1)
