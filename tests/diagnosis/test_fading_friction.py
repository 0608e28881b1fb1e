"""Static friction may fade by another law than the file's, at another speed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from diagnosis.plain_motion import ROBOT, motion
from independent_plant.native import inverse_dynamics
from independent_plant.parameters import paper_arm

from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.diagnosis.preparation.fading_friction import LAW, SPEED, fading_friction
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.measurement import Log

Array = npt.NDArray[np.float64]
Fades = Callable[[Array], Array]

TIME = np.arange(0.0, 20.0, 0.008)
HALF = np.radians([60.0, 35.0, 35.0, 90.0, 70.0, 120.0])
NOISE = np.array([0.6, 0.75, 0.45, 0.15, 0.15, 0.08])
"""[Nm]"""


def gauss(x: Array) -> Array:
    return np.asarray(np.exp(-(x**2)))


def tustin(x: Array) -> Array:
    return np.asarray(np.exp(-x))


def hess_and_soom(x: Array) -> Array:
    return np.asarray(1.0 / (1.0 + x**2))


def friction(j: int, qd: Array, fades: Fades, faster: float = 1.0) -> Array:
    """Of a joint, from 0, along its speed, shape (m,) [Nm]."""
    law = ROBOT.joints[j].friction
    x = np.abs(qd) / (faster * law.stribeck_rad_s)
    level = law.coulomb_Nm + (law.static_Nm - law.coulomb_Nm) * fades(x)
    return np.asarray(level * np.sign(qd) + law.viscous_Nms_rad * qd)


def test_columns_are_the_difference_of_the_laws() -> None:
    when = motion()
    columns = fading_friction(ROBOT, when).reshape(len(when.time), 6, 6, 3)
    for j in range(6):
        qd = when.qd[:, j]
        stated = friction(j, qd, gauss)
        faster, slower = (friction(j, qd, gauss, by) for by in (1.001, 0.999))
        own = columns[:, j, j].T
        np.testing.assert_allclose(own[0], SPEED * (faster - slower) / 0.002, atol=1e-3)
        np.testing.assert_allclose(own[1], LAW * (friction(j, qd, tustin) - stated), atol=1e-9)
        other = friction(j, qd, hess_and_soom) - stated
        np.testing.assert_allclose(own[2], LAW * other, atol=1e-9)
        columns[:, j, j] = 0.0
    assert not columns.any()


def test_without_static_friction_nothing_fades() -> None:
    joints = list(ROBOT.joints)
    bare = joints[2].friction.model_copy(update={"static_Nm": joints[2].friction.coulomb_Nm})
    joints[2] = joints[2].model_copy(update={"friction": bare})
    columns = fading_friction(ROBOT.model_copy(update={"joints": tuple(joints)}), motion())
    assert np.any(columns != 0.0, axis=(0, 2)).tolist() == [True, True, False, True, True, True]


def log(fades: Fades) -> Log:
    """Of the paper's arm, three sines on each joint."""
    rng = np.random.default_rng(12)
    pulse = 2.0 * np.pi * rng.uniform(0.08, 0.35, (3, 1, 6))
    size = HALF * rng.uniform(0.15, 0.4, (3, 1, 6))
    phase = pulse * TIME[:, None] + rng.uniform(0.0, 2.0 * np.pi, (3, 1, 6))
    q = (size * np.sin(phase)).sum(0)
    qd = (size * pulse * np.cos(phase)).sum(0)
    qdd = -(size * pulse**2 * np.sin(phase)).sum(0)
    tau = inverse_dynamics(paper_arm().packed(), q, qd, qdd)
    tau += np.stack([friction(j, qd[:, j], fades) for j in range(6)], axis=1)
    tau += NOISE * np.random.default_rng(13).standard_normal(q.shape)
    return Log(TIME, q, tau, q_ref=q)


@pytest.mark.parametrize("fades", [tustin, hess_and_soom])
def test_a_sound_arm_whose_friction_fades_otherwise_has_nothing(fades: Fades) -> None:
    """By Hess and Soom's law joint 5 had another power of the speed, at 0.91."""
    found = diagnose(ROBOT, log(fades))
    assert found.verdict == "nothing_missing"
    assert not found.findings


def test_a_power_near_dry_or_viscous_friction_is_none() -> None:
    law: Any = LIBRARY["viscous_power"]

    def bend(power: float) -> float:
        (size,) = law.of(5, coefficient=3.0, exponent=power).sizes()
        return float(size)

    assert bend(1.0) == 0.0
    assert abs(bend(1e-3)) < 0.01
    step = 1e-4
    before, there, after = ((1.0 + s * step) ** 1.7 for s in (-1, 0, 1))
    assert bend(1.7) == pytest.approx(3.0 * (before - 2.0 * there + after) / step**2, rel=1e-6)
