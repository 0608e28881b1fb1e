"""What friction that bends is held against: the faster half of each joint's own speeds."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from diagnosis.plain_motion import motion

from irb2400_ctrl.identification.fitting.moments import Recording, faster_half


def recording(speed: np.ndarray) -> Recording:
    m = motion()
    count = len(m.time)
    qd = np.zeros((count, m.n))
    qd[:, : speed.shape[1]] = speed[:count]
    known = np.ones((count, m.n), dtype=bool)
    blocks = np.zeros(count, dtype=np.int64)
    return Recording(replace(m, qd=qd, known=known), blocks, np.zeros_like(m.tau))


def known_of(*parts: Recording) -> Any:
    return [part.motion.known for part in faster_half(parts)]


def test_each_joint_has_a_half_of_its_own() -> None:
    count = len(motion().time)
    ramp = np.linspace(0.0, 1.0, count)
    # one that rests but for a few samples in a thousand has those of its motion
    seldom = np.where(np.arange(count) >= count - 9, 0.4, 0.0)
    seldom[-3:] = 0.1
    (known,) = known_of(recording(np.column_stack([ramp, -0.5 * ramp, seldom])))
    np.testing.assert_allclose(known[:, :2].mean(axis=0), 0.5, atol=0.01)
    assert known[:, 2].sum() == 6
    # one that rests has none
    assert not known[:, 3:].any()


def test_the_fastest_log_says_what_is_fast() -> None:
    ramp = np.linspace(0.0, 1.0, len(motion().time))[:, None]
    slow, fast = known_of(recording(0.4 * ramp), recording(ramp))
    assert not slow[:, 0].any()
    assert fast[:, 0].any()
