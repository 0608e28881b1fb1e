"""The motion of a log as a reference: smooth to its ends, cut where the command was."""

from __future__ import annotations

import numpy as np
import pytest

from irb2400_ctrl.measurement import Log, recorded_motion

TIME = np.arange(2001) / 250.0
WAVE = np.sin(1.3 * TIME[:, None] + np.arange(6))
ACCELERATION = -1.69 * WAVE


def _log(q_ref: np.ndarray) -> Log:
    printed = np.radians(np.round(np.degrees(q_ref), 5))
    return Log(TIME, printed, np.zeros_like(q_ref), q_ref=printed, name="a log")


def test_a_record_in_full_motion_keeps_its_accelerations_to_the_ends() -> None:
    motion = recorded_motion(_log(WAVE))
    assert len(motion.time) == len(TIME)
    assert np.abs(motion.q - WAVE).max() < 2e-4
    # a record says nothing of what was before and after: the acceleration begins and ends near none
    error = np.abs(motion.qdd - ACCELERATION)
    assert error[40:-40].max() < 0.02
    assert (error < np.abs(ACCELERATION) + 0.2).all()


def test_a_command_that_was_cut_off_ends_there() -> None:
    cut = WAVE.copy()
    cut[-4:] = cut[-4]
    motion = recorded_motion(_log(cut))
    assert len(TIME) - 6 <= len(motion.time) <= len(TIME) - 4
    assert np.abs(motion.qdd).max() < 1.9


@pytest.mark.parametrize("dwell", [1, 100])
def test_a_motion_that_comes_to_rest_is_kept_whole(dwell: int) -> None:
    s = np.linspace(0.0, 1.0, len(TIME) - dwell)[:, None]
    rest = np.vstack([s**3 * (10 - 15 * s + 6 * s**2) * np.ones(6), np.ones((dwell, 6))])
    motion = recorded_motion(_log(rest))
    assert len(motion.time) == len(TIME)
    np.testing.assert_allclose(motion.q[-1], 1.0, atol=1e-5)
