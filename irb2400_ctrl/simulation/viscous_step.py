"""How fine the plant's time steps have to be for viscous friction, which brakes light joints fast.

The step is explicit in viscous friction, v' = v - h W F_v (3 v - v_before) / 2: it swings without
end once h times the largest eigenvalue of W F_v reaches one, W the inverse of the mass matrix.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from irb2400_ctrl.model import Model
from irb2400_ctrl.model.elasticity import elastic_joints
from irb2400_ctrl.robot import Robot

STEP_SHARE = 0.6
"""largest time step that is taken unasked, over the time in which friction stops a joint [-]"""
LONGEST_STEP = 0.001
"""[s] of a time step that is taken unasked, whatever the period of the controller"""
MOST_SUBSTEPS = 20
"""more are not taken unasked"""
_POSES = 24


@lru_cache(maxsize=64)
def braking_rate(robot: Robot) -> float:
    """Largest eigenvalue of W F_v over drawn poses and the one of zeros [1/s]: how fast viscous
    friction stops some motion of the joints. That of elastic joints brakes their rotors, and is
    left out.
    """
    viscous = np.array(robot.friction[:, 2])
    viscous[list(elastic_joints(robot))] = 0.0
    if not viscous.any():
        return 0.0
    draw = np.random.default_rng(0)
    low = np.maximum(robot.q_min, -2 * np.pi)
    high = np.minimum(robot.q_max, 2 * np.pi)
    poses = draw.uniform(low, high, (_POSES, robot.n))
    poses = np.vstack([np.clip(0.0, low, high), poses])
    root = np.sqrt(viscous)
    mobility = np.linalg.inv(Model(robot).mass_matrix(poses))
    return float(np.linalg.eigvalsh(root[:, None] * mobility * root).max())


def usual_substeps(robot: Robot, period: float) -> int:
    """Time steps per control period that are taken unasked: none longer than `LONGEST_STEP`, and
    as short as viscous friction asks for, but no more than `MOST_SUBSTEPS`.
    """
    fine = min(math.ceil(period / LONGEST_STEP - 1e-9), MOST_SUBSTEPS)
    needed = needed_substeps(robot, period)
    return max(fine, needed if needed <= MOST_SUBSTEPS else 1)


def needed_substeps(robot: Robot, period: float) -> int:
    """Time steps per control period that viscous friction asks for."""
    return max(1, math.ceil(period * braking_rate(robot) / STEP_SHARE))
