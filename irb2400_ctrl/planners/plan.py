"""`Plan`: a timed tool path, with everything that was promised about it, and its files."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell.external_axes import ExternalAxes
from irb2400_ctrl.files import write_atomic, write_json
from irb2400_ctrl.notebook import Displayed
from irb2400_ctrl.planners.clearance.clearance import unknown
from irb2400_ctrl.planners.external_bounds import AxisBounds
from irb2400_ctrl.planners.redundancy.rotation_map import RotationMap
from irb2400_ctrl.planners.timing.certificate import Certificate
from irb2400_ctrl.planners.timing.feed_use import FeedUse
from irb2400_ctrl.planners.timing.sampled_reference import SampledReference
from irb2400_ctrl.planners.timing.sampled_reference.interpolation import DEFAULT, Interpolation
from irb2400_ctrl.planners.toolpath.toolpath import ToolPath
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.trajectory import Trajectory

SCHEMA_VERSION = 2
"""of `plan.json`: 2 says everything of the rows as they are read, 1 said it of the time law"""


@dataclass(frozen=True, repr=False)
class Plan(Displayed):
    """What `plan_path` found."""

    robot: Robot
    path: ToolPath
    trajectory: Trajectory
    """at even times, at rest in the first and the last row; with torque and the TCP's way"""
    length: float
    """length of the TCP's way [m]"""
    certificate: Certificate
    """the joint path, its time law and the limits: checked again with `certificate.check`"""
    duration: float
    """[s]"""
    guaranteed: bool
    """the torque bound holds at every instant by construction for the rows of the trajectory under
    the interpolation, and was re-checked"""
    timing: str
    """"certified" or "toppra" """
    max_tcp_deviation: float
    """upper bound over all times of the rows as they are read: motion from the polygon of
    way-points, and way-points from the motion, rounding of corners included [m]"""
    max_tool_axis_deviation: float
    """upper bound over all times, in the same way, of the angle to the tool axis stated at the
    nearest place [rad]"""
    singularity_margin: dict[str, float]
    """lower bounds of |sin q5| [-], |r| [m], |k| [m] everywhere; of what, `margins_of` says"""
    max_torque_ratio: float
    max_velocity_ratio: float
    """over all times of the rows as they are read, as parts of the robot's own limits"""
    max_acceleration_ratio: float | None
    """likewise, the column of accelerations included; None where the robot states no limit"""
    max_feed_ratio: float | None
    """speed of the TCP over the feed, upper bound over all times; None without a feed"""
    chosen: str
    """how the tool rotation was chosen: "given orientation", "constant rotation", "free rotation"
    """
    branch: int
    rotation: Array
    """free tool rotation at the rows of the trajectory [rad]"""
    point_times: Array
    """when each way-point is passed [s], shape (len(path),)"""
    feed_use: FeedUse | None = None
    """where the programmed feed is held, and what keeps it below elsewhere; None without a feed"""
    clearance: dict[str, Any] = field(default_factory=lambda: unknown("not asked for"))
    """smallest distance over the continuous path [mm], between which bodies, where; or why it is
    not known"""
    rail: float | None = None
    """where on its rail the carriage stands all the time [m]; None without a rail, and where it
    moves"""
    positioner: tuple[float, float] | None = None
    """(tilt, turn) at which the positioner stands all the time [deg]; None without one, and where
    it moves"""
    carried: ExternalAxes | None = None
    """axes that turn the part or carry the arm on the way; None where none does"""
    external: tuple[AxisBounds, ...] = ()
    """bounds of the axes of `carried`, over all times of the rows"""
    deflection: dict[str, Any] | None = None
    """how far the tip gives way to the cutting force, at samples of the path; None without one"""
    rotation_map: RotationMap | None = None
    """what other tool rotations would bring; None where it was not asked for"""
    margins_of: str = "path"
    """what singularity margins and clearance are bounds of: the "rows" as they are read, or the
    continuous "path" that they were taken from, where there are very many"""
    interpolation: Interpolation = DEFAULT
    """how the controller reads the rows"""
    torque_share: float = 1.0
    """part of the torque limits that was allowed"""
    guarantee_note: str = ""
    """why the bound is not guaranteed; empty where it is"""
    alternatives: tuple[dict[str, Any], ...] = ()
    """the candidates that were compared: kind, branch, margin, duration_s"""
    passages: tuple[dict[str, Any], ...] = ()
    """where the path comes close to the wrist singularity, and what is done there"""
    remedies: tuple[dict[str, Any], ...] = ()
    """what could be done there, cheapest first: duration_s, position_mm, angle_deg, allowed"""
    rates: dict[str, Any] = field(default_factory=dict)
    """limits of torque rate and jerk, upper bounds of both, and the price; empty where they are not
    limited"""
    wall_time: dict[str, float] = field(default_factory=dict)
    """[s] per stage"""

    @property
    def tau(self) -> Array:
        """Torque of the model along the trajectory, friction and effects included [Nm], shape
        (k, n)."""
        assert self.trajectory.tau is not None
        return self.trajectory.tau

    @property
    def carried_names(self) -> tuple[str, ...]:
        """Of the axes that move beside the arm: rail, tilt, turn, as far as they do."""
        return () if self.carried is None else self.carried.names

    @property
    def reference(self) -> SampledReference:
        """The rows as the controller reads them."""
        return SampledReference(self.trajectory.together(), self.interpolation)

    def summary(self) -> dict[str, Any]:
        """The content of `plan.json`."""
        return {
            "schema_version": SCHEMA_VERSION,
            "path": self.path.name,
            "robot": self.robot.name,
            "points": len(self.path),
            "length_mm": 1e3 * self.length,
            "duration_s": self.duration,
            "reachable": True,
            "max_tcp_deviation_mm": 1e3 * self.max_tcp_deviation,
            "max_tool_axis_deviation_deg": float(np.degrees(self.max_tool_axis_deviation)),
            "margins_of": self.margins_of,
            "singularity_margin": self.singularity_margin,
            "clearance_mm": self.clearance,
            "rail_mm": None if self.rail is None else 1e3 * self.rail,
            "positioner_deg": None if self.positioner is None else list(self.positioner),
            "external_axes": [
                axis.summary(name)
                for name, axis in zip(self.carried_names, self.external, strict=True)
            ],
            "deflection": self.deflection,
            "max_torque_ratio": self.max_torque_ratio,
            "max_velocity_ratio": self.max_velocity_ratio,
            "max_acceleration_ratio": self.max_acceleration_ratio,
            "max_feed_ratio": self.max_feed_ratio,
            "feed": None if self.feed_use is None else self.feed_use.summary(),
            "torque_share": self.torque_share,
            "interpolation": self.interpolation,
            "guaranteed": self.guaranteed,
            "guarantee_note": self.guarantee_note,
            "timing": self.timing,
            "tool_rotation": self.chosen,
            "tool_rotation_deg": [
                float(np.degrees(v)) for v in (self.rotation.min(), self.rotation.max())
            ],
            "branch": self.branch,
            "compared": list(self.alternatives),
            "peak_torque_Nm": [float(v) for v in np.abs(self.tau).max(axis=0)],
            "wrist_passages": list(self.passages),
            "wrist_remedies": list(self.remedies),
            **self.rates,
            "wall_time_s": self.wall_time,
        }

    def write(self, out_dir: Path | str) -> tuple[Path, Path]:
        """Write `trajectory.csv` and `plan.json` into a folder, beside them `rotation_map.json` if
        there is a map; returns the paths of the first two."""
        folder = Path(out_dir)
        if self.rotation_map is not None:
            text = json.dumps(self.rotation_map.summary())
            write_atomic(folder / "rotation_map.json", text + "\n")
        trajectory = write_atomic(folder / "trajectory.csv", self.trajectory.csv_parts())
        return trajectory, write_json(folder / "plan.json", self.summary())
