"""Straight lines between a way-point and the clearance plane, from or to a known configuration."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.plan import Plan
from irb2400_ctrl.planners.plan_options import PlanOptions
from irb2400_ctrl.planners.plan_path import plan_ways
from irb2400_ctrl.planners.redundancy.known_way import End, known_way
from irb2400_ctrl.planners.stage_clock import StageClock
from irb2400_ctrl.planners.timing.timing_options import TimingOptions
from irb2400_ctrl.planners.toolpath.toolpath import ToolPath
from irb2400_ctrl.robot import Robot

# how far the corner is cut where a way out turns upwards [m]
TOLERANCE = 5e-5


def lead_in(
    robot: Robot,
    q: Array,
    out: Array,
    approach: float,
    feed: float,
    rate: float,
    timing: TimingOptions,
) -> Plan:
    """From the clearance plane down to the configuration q (n,) [rad] of a first way-point.

    Args:
        out: places from the way-point up to the plane, shape (k, 3), see `way_out`.
        approach: last part of the way that is driven at `feed` [m].
        feed: [m/s]; inf where the operation itself begins with a rapid move.
        rate: rows of the trajectory per second [1/s].
        timing: limits and back-end.

    Raises:
        UnreachableError: the arm does not reach along the line.
    """
    places = list(out[::-1])
    feeds = [np.inf] * len(places)
    if np.isfinite(feed):
        side = out[1] - out[0]
        length = float(np.linalg.norm(side))
        if approach < 0.99 * length:
            places.insert(-1, out[0] + approach / length * side)
            feeds.append(np.inf)
        feeds[-1] = feed
    path = _path(robot, q, np.array(places), np.array(feeds), "lead-in")
    return _planned(robot, path, q, "last", rate, timing)


def retract(robot: Robot, q: Array, out: Array, rate: float, timing: TimingOptions) -> Plan:
    """From the configuration q (n,) [rad] of a last way-point up to the clearance plane, rapidly.

    Raises:
        UnreachableError: the arm does not reach along the line.
    """
    path = _path(robot, q, out, np.full(len(out), np.inf), "retract")
    return _planned(robot, path, q, "first", rate, timing)


def _path(robot: Robot, q: Array, places: Array, feeds: Array, name: str) -> ToolPath:
    """The tool does not turn on the way."""
    R = Model(robot).tcp_pose(q)[:3, :3]
    return ToolPath(places, rotation=np.tile(R, (len(places), 1, 1)), feed=feeds, name=name)


def _planned(
    robot: Robot, path: ToolPath, q: Array, end: End, rate: float, timing: TimingOptions
) -> Plan:
    return plan_ways(
        robot,
        path,
        lambda model, orientation: [known_way(model, orientation, q, end)],
        PlanOptions(rate, False, None, TOLERANCE, 0.0),
        timing,
        StageClock(None),
    )
