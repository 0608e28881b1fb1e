"""How far a configuration is from the wrist, shoulder and elbow singularities, as one number."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.model import Model

Array = npt.NDArray[np.float64]

NAMES = ("wrist", "shoulder", "elbow")
COMFORTABLE = 0.3
"""relative margin beyond which more distance from a singularity is worth nothing (sin 17 deg at the
wrist)"""


def scales(model: Model) -> Array:
    """Largest values of (sin q5, r, k) over all configurations, shape (3,) [-, m, m]."""
    g = model.arm_geometry
    return np.array([1.0, g.a1 + g.a2 + g.forearm, g.forearm])


def relative_margins(model: Model, q: Array) -> Array:
    """|sin q5|, |r|, |k| of eqs. 34-36, each as a part of its largest value, shape (n, 3) [-]."""
    g = model.arm_geometry
    q2 = q[..., 1]
    q3 = q[..., 2]
    r = g.a1 + g.a2 * np.sin(q2) + g.a3 * np.sin(q3) + g.d4 * np.cos(q3)
    k = g.d4 * np.cos(q2 - q3) - g.a3 * np.sin(q2 - q3)
    factors = np.abs(np.stack([np.sin(q[..., 4]), r, k], axis=-1))
    relative: Array = factors / scales(model)
    return relative
