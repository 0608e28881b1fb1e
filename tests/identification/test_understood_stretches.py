"""A stretch that does not go with the rest for want of a motor is not told once it is found."""

from __future__ import annotations

from functools import cache

import numpy as np

import irb2400_ctrl as irb
from irb2400_ctrl.diagnosis.sound_logs import SortedLogs
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.identification.understood_logs import said_of
from irb2400_ctrl.plausibility.log_check import Examined
from irb2400_ctrl.plausibility.search import understand

STEP = 0.01
"""[s] between two samples"""
SAYS = "does not go with the rest of the log"


def file() -> irb.Robot:
    """Without the motor."""
    return irb.load_robot("irb2400")


def arm() -> irb.Robot:
    """Axis 5 turns motor 6."""
    motor = LIBRARY["geared_motor"].of(
        6, ratio=-0.6, coulomb_Nm=20.0, viscous_Nms_rad=3.0, inertia_kgm2=0.0
    )
    return file().with_effects(motor)


@cache
def found() -> SortedLogs:
    """A log of the arm, held against the file; axis 6 creeps for six of thirty seconds."""
    rng = np.random.default_rng(3)
    time = np.arange(0.0, 30.0, STEP)
    w = 2.0 * np.pi * rng.uniform(0.1, 0.3, size=(6, 2))
    phase = rng.uniform(0.0, 6.0, size=(6, 2))
    clock = np.tile(time[:, None], 6)
    slow = np.tanh((time - 16.0) / 0.8) - np.tanh((time - 22.0) / 0.8)
    clock[:, 5] = STEP * np.cumsum(1.0 - 0.49 * slow)
    size = np.array([0.5, 0.3, 0.3, 0.6, 0.5, 0.8]) / 1.3
    about = np.array([0.0, 0.2, 0.1, 0.0, 0.6, 0.0])
    q = about + sum(size * np.sin(w[:, k] * clock + phase[:, k]) for k in (0, 1))
    qd = np.gradient(q, STEP, axis=0)
    qdd = np.gradient(qd, STEP, axis=0)
    torque = np.asarray(irb.Model(arm()).inverse_dynamics(q, qd, qdd))
    torque += np.array([1.0, 1.7, 1.0, 0.3, 0.25, 0.25]) * rng.normal(size=q.shape)
    log = irb.Log(time, q, torque, name="a.csv")
    seen = understand(file(), log)
    assert seen is not None
    # as of an arm whose file is less far off
    return SortedLogs([(log, Examined(None, seen, (seen.over_time, "something else")))])


def test_without_the_motor_it_is_told() -> None:
    for said in (said_of(found()), said_of(found(), robot=file())):
        (stretch,) = [one for one in said if SAYS in one]
        assert stretch.startswith("a.csv: from ")
        assert "torque of joint 6" in stretch


def test_what_the_identified_arm_explains_is_not_told() -> None:
    """`identify` found the motor, and bade cut the log all the same."""
    said = said_of(found(), robot=arm())
    assert said == ["a.csv: something else"]
