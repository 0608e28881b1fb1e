"""How far a configuration is from the wrist, shoulder and elbow singularities, as one number."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.codegen import CompiledFunction, compile_function
from irb2400_ctrl.model import Model

NAMES = ("wrist", "shoulder", "elbow")
COMFORTABLE = 0.3
"""relative margin beyond which more distance from a singularity is worth nothing (sin 17 deg at the
wrist)"""


def scales(model: Model) -> Array:
    """Largest values of (sin phi5, r, k) over all configurations, shape (3,) [-, m, m]."""
    g = model.arm_geometry
    return np.array([1.0, abs(g.a1) + g.a2 + g.forearm_reach(), g.forearm])


def relative_margins(model: Model, q: Array) -> Array:
    """|sin phi5|, |r|, |k| of eqs. 34-36, each as a part of its largest value, shape (n, 3) [-]."""
    flat = _factors(model).map(q.reshape(-1, q.shape[-1]))[0]
    # where a branch does not exist nothing is near or far
    flat[~np.isfinite(q).all(axis=-1).ravel()] = np.nan
    relative: Array = np.abs(flat).reshape(*q.shape[:-1], 3) / scales(model)
    return relative


def reach_left(model: Model, q: Array) -> Array:
    """How far the end of upper arm and forearm is from where they are stretched, or folded, shape
    (...) [m] for q (..., n)."""
    g = model.arm_geometry
    phi = g.canonical(q)
    out = g.a2 * np.sin(phi[..., 1]) + g.a3 * np.sin(phi[..., 2])
    up = g.a2 * np.cos(phi[..., 1]) + g.a3 * np.cos(phi[..., 2])
    if g.spherical:
        out = out + g.d4 * np.cos(phi[..., 2])
        up = up - g.d4 * np.sin(phi[..., 2])
    distance = np.hypot(out, up)
    return np.asarray(np.minimum(g.a2 + g.forearm - distance, distance - abs(g.a2 - g.forearm)))


@lru_cache(maxsize=8)
def _factors(model: Model) -> CompiledFunction:
    """`Model.singularity_factors` as machine code."""
    return compile_function(model.function("singularity_factors"))
