"""The guard lets a sound arm follow a plan whose torque changes as fast as the planner allows."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from simulation.guard_steps import MODEL, ZERO, Q, T, block, step

from irb2400_ctrl import load_robot
from irb2400_ctrl.controllers import controller, guarded
from irb2400_ctrl.planners import Plan, plan_path
from irb2400_ctrl.planners.toolpath import builders
from irb2400_ctrl.simulation import simulate

ROBOT = load_robot("ur10e")


@cache
def corner() -> Plan:
    """Two fast lines: the torque changes by 50 limits a second."""
    points = np.array([[0.5, -0.3, 0.3], [0.5, 0.3, 0.3], [0.8, 0.3, 0.3]])
    path = builders.way_points(points, np.tile([0.0, 0.0, 1.0], (3, 1)))
    return plan_path(ROBOT, path, free_tool_rotation=False)


def brake_closed(name: str, **gains: float) -> float | None:
    run = simulate(ROBOT, corner().trajectory, guarded(controller(name, ROBOT), ROBOT), gains=gains)
    found: float | None = run.summary()["bounds_reached"]["brake_closed_s"]
    return found


@pytest.mark.parametrize("name", ["computed_torque", "feedforward_pid"])
def test_no_brake_closes_where_the_torque_changes_as_fast_as_planned(name: str) -> None:
    assert brake_closed(name) is None
    # held against a speed that is not late, it did
    assert brake_closed(name, speed_lag=0.0) is not None


def test_the_torque_is_as_late_as_the_speed() -> None:
    both = block(consistency=True)
    before = MODEL.gravity(Q)
    now = before + 10.0
    given = {"tau_last": now, "tau_seen": before}
    share = T / (T + 0.00076)
    found = step(both, **given)["tau_seen"]
    np.testing.assert_allclose(found, before + 10.0 * share, rtol=1e-12)
    np.testing.assert_allclose(step(both, **given, speed_lag=0.0)["tau_seen"], now, rtol=1e-12)
    # begun anew it is what acts
    np.testing.assert_allclose(step(both, **given, running=0.0)["tau_seen"], now, rtol=1e-12)
    # and the observers add up this one
    for band in ("", "_slow"):
        gained = step(both, **given)[f"explained{band}"] - step(both, qd=ZERO)[f"explained{band}"]
        np.testing.assert_allclose(gained, T * 10.0 * share, rtol=1e-9)
