"""An interval function holds what the function is at every point inside."""

from __future__ import annotations

import casadi as ca
import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from irb2400_ctrl.planners.enclosure.interval import interval_function


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**6))
def test_intervals_hold_for_points_inside(seed: int) -> None:
    x = ca.SX.sym("x")
    y = ca.SX.sym("y")
    f = ca.Function(
        "f",
        [x, y],
        [
            ca.fabs(x) ** 0.6 * ca.sign(x) / (2 + ca.sin(1) * y**2),
            ca.exp(-(x**2)) * ca.sqrt(ca.fabs(y)) - x * y,
            ca.if_else(x < y, ca.fmin(x, y**3), ca.log(1 + x**2)),
            ca.logic_and(x > 0, ca.logic_not(y > 0)) * x,
        ],
    )
    rng = np.random.default_rng(seed)
    ends = np.sort(rng.normal(size=(2, 2)), axis=1)
    found = interval_function(f)([(e[:1], e[1:]) for e in ends])
    for point in rng.uniform(ends[:, 0], ends[:, 1], (50, 2)):
        for (low, high), value in zip(found, f(*point), strict=True):
            assert low[0] - 1e-12 <= float(value) <= high[0] + 1e-12
