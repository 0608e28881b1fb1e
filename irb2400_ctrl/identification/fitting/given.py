"""Torque that a robot file knows beside what is fitted: other effects, the rise at low speed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from irb2400_ctrl.diagnosis.regressors.predict import predicted_torque
from irb2400_ctrl.identification.fitting.moments import Recording, recordings
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.robot import Robot


def given_torque(kept: Robot, motions: Sequence[PreparedLog]) -> list[Recording]:
    """Recordings with the torque of the file's other effects and its rise at low speed."""
    bare = kept.model_copy(update={"effects": ()})
    friction = kept.friction
    found = []
    for part in recordings(motions):
        m = part.motion
        rise = np.maximum(friction[:, 0] - friction[:, 1], 0.0)
        given = m.as_recorded(rise * np.sign(m.qd) * np.exp(-((m.qd / friction[:, 3]) ** 2)))
        if kept.effects:
            given += predicted_torque(kept, m) - predicted_torque(bare, m)
        found.append(Recording(m, part.block, given))
    return found
