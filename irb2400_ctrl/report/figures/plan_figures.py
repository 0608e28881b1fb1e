"""Figures of a planned motion: torque, speed and angles against their limits, margins, feed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell.external_axes import axis_names
from irb2400_ctrl.model import Model
from irb2400_ctrl.model.arm_family import has_singularity_factors
from irb2400_ctrl.planners import Plan
from irb2400_ctrl.report.elements.arm_view import Colouring
from irb2400_ctrl.report.elements.plots import Line, joint_plots, over_time
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.trajectory import Trajectory

MARGINS = (
    ("wrist", "wrist |sin q5| [-]"),
    ("shoulder", "shoulder |r| [m]"),
    ("elbow", "elbow |k| [m]"),
)


def tip_speed(motion: Trajectory) -> Array:
    """Speed of the TCP [mm/s], shape (m,)."""
    assert motion.s is not None  # the way of the TCP: every plan has it
    return np.abs(np.gradient(1e3 * motion.s, motion.time))


def torque_figures(motion: Trajectory, limits: Array) -> list[Figure]:
    """Torque of each joint; limits (n,) [Nm]."""
    assert motion.tau is not None
    return joint_plots(
        motion.time, [Line(motion.tau)], "torque {joint} [Nm]", limits=(-limits, limits)
    )


def speed_figures(motion: Trajectory, robot: Robot) -> list[Figure]:
    """Speed of each joint."""
    limit = np.degrees(robot.qd_max)
    lines = [Line(np.degrees(motion.qd))]
    return joint_plots(motion.time, lines, "speed {joint} [deg/s]", limits=(-limit, limit))


def acceleration_figures(motion: Trajectory, limits: Array) -> list[Figure]:
    """Acceleration of each joint; limits (n,) [rad/s2]."""
    limit = np.degrees(limits)
    lines = [Line(np.degrees(motion.qdd))]
    label = "acceleration {joint} [deg/s²]"
    return joint_plots(motion.time, lines, label, limits=(-limit, limit))


def angle_figures(motion: Trajectory, robot: Robot) -> list[Figure]:
    """Angle of each joint and the ends of its range."""
    ends = (np.degrees(robot.q_min), np.degrees(robot.q_max))
    return joint_plots(
        motion.time, [Line(np.degrees(motion.q))], "angle {joint} [deg]", limits=ends
    )


def external_figures(motion: Trajectory) -> list[Figure]:
    """Places of the carriage and angles of the positioner; none where they stand."""
    rows = motion.external
    if rows is None:
        return []
    slides = len(rows.lengths)
    names = axis_names(rows.q.shape[1], slides)
    found = []
    for j, name in enumerate(names):
        values, unit = (
            (1e3 * rows.q[:, j], "mm") if j < slides else (np.degrees(rows.q[:, j]), "deg")
        )
        found.append(over_time(motion.time, [Line(values)], f"{name} [{unit}]"))
    return found


def margin_figures(motion: Trajectory, robot: Robot, least: dict[str, float]) -> list[Figure]:
    """The three singularity factors, with their smallest values over the continuous path.

    Args:
        motion: its angles.
        robot: the arm.
        least: smallest factor by name: wrist [-], shoulder [m], elbow [m].
    """
    factors = np.abs(Model(robot).singularity_factors(motion.q))
    return [
        over_time(motion.time, [Line(values)], label, [least[name]], floor=0.0)
        for (name, label), values in zip(MARGINS, factors.T, strict=True)
    ]


FEED_SHOWN = 1.5
"""of the programmed feed, where the figure of speeds ends: a rapid move would leave of it a line"""


def feed_figure(motion: Trajectory, plan: Plan | None, feed: float | None) -> Figure:
    """Speed of the TCP, and what the file programs; at most `feed` is programmed [mm/s].

    Args:
        motion: with its way.
        plan: with the programmed feed; None of a motion without one.
        feed: [mm/s].
    """
    speed = tip_speed(motion)
    lines = [Line(speed, label="driven")]
    if plan is not None and np.isfinite(plan.path.feed).any():
        # the feed of a point holds on the way to it
        later = np.searchsorted(plan.point_times, motion.time)
        asked = 1e3 * plan.path.feed[np.minimum(later, len(plan.path.feed) - 1)]
        programmed = Line(np.where(np.isfinite(asked), asked, np.nan), "0.6", "programmed", 2.0)
        lines.insert(0, programmed)
    figure = over_time(motion.time, lines, "TCP speed [mm/s]", floor=0.0)
    if feed is not None and speed.max() > FEED_SHOWN * feed:
        figure.axes[0].set_ylim(top=FEED_SHOWN * feed)
    return figure


def programmed_feed(plans: Sequence[Plan]) -> float | None:
    """The largest feed that the files state [mm/s]; None where none does."""
    stated = np.concatenate([plan.path.feed[np.isfinite(plan.path.feed)] for plan in plans])
    return 1e3 * float(stated.max()) if len(stated) else None


def colourings(
    motion: Trajectory, robot: Robot, limits: Array, feed: float | None = None
) -> tuple[Colouring, ...]:
    """What the tool's way may be coloured by; speed and torque where the motion has them.

    Args:
        motion: to look at.
        robot: the arm.
        limits: of its torques [Nm], shape (n,); infinite where unknown.
        feed: at which the colours end [mm/s], so that a rapid move does not hide how the feed is
            held.
    """
    found = []
    if motion.s is not None:
        name = "TCP speed" if feed is None else "feed, rapid moves cut off"
        found.append(Colouring(name, "mm/s", tip_speed(motion), high=feed))
    if motion.tau is not None and np.isfinite(limits).any():
        found.append(Colouring("torque share", "%", _largest_share(motion.tau, limits)))
    if np.isfinite(robot.qd_bound).any():
        found.append(Colouring("speed share", "%", _largest_share(motion.qd, robot.qd_bound)))
    return (*found, *_margins(Model(robot), motion.q))


def _margins(model: Model, q: Array) -> tuple[Colouring, ...]:
    """How far the arm is from its singularities along the angles q [rad], shape (m, n)."""
    if not has_singularity_factors(model.robot):
        least = model.smallest_singular_value(q)
        return (Colouring("smallest singular value", "", least, 2),)
    factors = np.abs(model.singularity_factors(q))
    return (
        Colouring("wrist margin |sin q5|", "", factors[:, 0], 2),
        Colouring("shoulder margin", "m", factors[:, 1], 2),
        Colouring("elbow margin", "m", factors[:, 2], 2),
    )


def _largest_share(values: Array, limits: Array) -> Array:
    """Of the limits, over the axes [%], shape (m,); one axis after the other: the rows of a long
    motion are many MB."""
    found = np.zeros(len(values))
    for column, limit in zip(values.T, limits, strict=True):
        np.maximum(found, np.abs(column / limit), out=found)
    return 100 * found
