"""Straight lines between a way-point and the clearance plane, from or to a known configuration."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.linking.run import Run
from irb2400_ctrl.planners.plan import Plan
from irb2400_ctrl.planners.plan_path import plan_ways
from irb2400_ctrl.planners.redundancy.known_way import End, known_way
from irb2400_ctrl.planners.toolpath.toolpath import ToolPath


def lead_in(run: Run, q: Array, out: Array, approach: float) -> Plan:
    """From the clearance plane down to the configuration q (n,) [rad] of a run's first way-point.

    Args:
        run: with the limits and the cell of its plan.
        out: places from the way-point up to the plane, shape (k, 3), see `way_out`.
        approach: last part of the way that is driven at the run's feed [m]; none, where the run
            itself begins with a rapid move.

    Raises:
        UnreachableError: the arm does not reach along the line.
    """
    places = list(out[::-1])
    feeds = [np.inf] * len(places)
    if np.isfinite(run.feed):
        side = out[1] - out[0]
        length = float(np.linalg.norm(side))
        if approach < 0.99 * length:
            places.insert(-1, out[0] + approach / length * side)
            feeds.append(np.inf)
        feeds[-1] = run.feed
    path = _path(run, q, np.array(places), np.array(feeds), "lead-in")
    return _planned(run, path, q, "last")


def retract(run: Run, q: Array, out: Array) -> Plan:
    """From the configuration q (n,) [rad] of a run's last way-point up to the clearance plane,
    rapidly.

    Raises:
        UnreachableError: the arm does not reach along the line.
    """
    path = _path(run, q, out, np.full(len(out), np.inf), "retract")
    return _planned(run, path, q, "first")


def _path(run: Run, q: Array, places: Array, feeds: Array, name: str) -> ToolPath:
    """The tool does not turn on the way."""
    R = Model(run.plan.robot).tcp_pose(q)[:3, :3]
    return ToolPath(places, rotation=np.tile(R, (len(places), 1, 1)), feed=feeds, name=name)


def _planned(run: Run, path: ToolPath, q: Array, end: End) -> Plan:
    return plan_ways(
        run.arm,
        path,
        lambda model, orientation, scene: [known_way(model, orientation, q, end, scene)],
        run.options,
        run.timing,
    )
