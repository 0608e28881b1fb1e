"""How far a configuration is from the wrist, shoulder and elbow singularities, as one number."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.model import Model
from irb2400_ctrl.model.geometry import singularity_factors

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
    factors = singularity_factors(model.arm_geometry, np.moveaxis(q, -1, 0))
    relative: Array = np.abs(np.stack(factors, axis=-1)) / scales(model)
    return relative
