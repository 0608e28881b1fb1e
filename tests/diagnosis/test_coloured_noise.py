"""Torque sensors behind the gear have noise with a colour: a sound arm with it lacks nothing."""

from __future__ import annotations

import numpy as np
from scipy.signal import lfilter

from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import load_robot
from irb2400_ctrl.trajectory import from_angles

ROBOT = load_robot("irb2400")
TIME = np.arange(0.0, 20.0, 0.002)
PHASE = np.outer(TIME, 1.0 + 0.17 * np.arange(6))
REST = np.sin(np.pi * TIME / TIME[-1])[:, None] ** 2
Q = 0.6 * REST * np.sin(PHASE) + [0.1, 0.2, -0.1, 0.0, 0.5, 0.0]
SIZE = np.array([3.0, 4.0, 3.0, 0.7, 0.7, 0.4])
"""[Nm]"""


def log(*, colour: float = 0.85, more: float = 0.0) -> Log:
    """So much of the noise passes a low-pass of 12 Hz; `more` of its size has axis 4 besides, with
    a period of its own."""
    rng = np.random.default_rng(5)
    m = from_angles(TIME, Q)
    a = np.exp(-2.0 * np.pi * 12.0 * 0.002)
    white = rng.standard_normal((2, *Q.shape))
    slow = lfilter([np.sqrt(1.0 - a**2)], [1.0, -a], white[1], axis=0)
    noise = np.sqrt(1.0 - colour**2) * white[0] + colour * slow
    noise[:, 3] += more * np.sqrt(2.0) * np.sin(2.0 * np.pi * 0.83 * TIME)
    tau = np.asarray(Model(ROBOT).inverse_dynamics(m.q, m.qd, m.qdd)) + SIZE * noise
    return Log(TIME, Q, tau)


def test_a_sound_arm_with_coloured_noise_lacks_nothing() -> None:
    """Three sound arms of seven axes were told that something is left which no effect makes."""
    found = diagnose(ROBOT, log())
    assert not found.findings
    assert found.noise is not None
    assert found.noise.beyond == found.noise.by_means_alone  # by what white noise would give
    assert len(found.noise.beyond) > 2
    assert not found.beyond_noise
    assert found.verdict == "nothing_missing"


def test_what_is_slower_than_noise_is_said() -> None:
    found = diagnose(ROBOT, log(colour=0.3, more=1.0))
    assert found.noise is not None
    assert found.noise.by_means_alone == (4,)
    assert found.beyond_noise == (4,)
    assert found.verdict == "unexplained"
