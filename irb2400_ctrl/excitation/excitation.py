"""`Excitation`: the planned motion, what it promises, and its files."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.excitation.acceleration import AccelerationLimits
from irb2400_ctrl.excitation.alternatives import NOISE, SIZE
from irb2400_ctrl.excitation.feasible import SHARE, Extent
from irb2400_ctrl.excitation.groups import AmbiguityGroup
from irb2400_ctrl.excitation.pair_separability import CLEAR, Separability
from irb2400_ctrl.excitation.room import remark
from irb2400_ctrl.files import write_atomic, write_json
from irb2400_ctrl.model import Model
from irb2400_ctrl.planners.programs.rapid.rapid_options import RapidOptions
from irb2400_ctrl.planners.programs.rapid.rapid_program import RapidProgram, rapid_program
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.trajectory import Trajectory

COARSE_DEG = 0.2
"""tolerance of a RAPID module of a lively motion"""


@dataclass(frozen=True)
class Excitation:
    """The motion that tells the members of a group apart.

    Args:
        course: rows at 250 Hz; tau: torque of the model along it [Nm], (m, n).
        extent: how near to the limits it goes, over densely looked at instants.
        flavours: of its pieces, in order; noise: assumed, per joint [Nm].
        gain: rise of the criterion over the standard motion (of log distances, smallest plus mean).
    """

    robot: Robot
    group: AmbiguityGroup
    joint: int | None
    course: Trajectory
    tau: Array
    extent: Extent
    flavours: tuple[str, ...]
    noise: Array
    table: tuple[Separability, ...]
    gain: float

    def __repr__(self) -> str:
        return f"<Excitation of {self.group.name}: {self.course.duration:.3f} s>"

    def __post_init__(self) -> None:
        self.tau.setflags(write=False)

    @property
    def inseparable(self) -> tuple[Separability, ...]:
        """Pairs that no motion tells apart by itself: what can be said rests on the data sheet, or
        on nothing."""
        return tuple(row for row in self.table if row.reason)

    @property
    def open(self) -> tuple[Separability, ...]:
        """Pairs that a motion may tell apart, but this one does not."""
        return tuple(row for row in self.table if not row.hopeless and not row.separated)

    def summary(self) -> dict[str, Any]:
        """The content of `excitation.json`."""
        smallest = [
            min((row.distance[i] for row in self.table if not row.hopeless), default=0.0)
            for i in (0, 1)
        ]
        return {
            "schema_version": 1,
            "group": self.group.name,
            "members": list(self.group.kinds),
            "joint": self.joint,
            "robot": self.robot.name,
            "duration_s": self.course.duration,
            "pieces": list(self.flavours),
            **self.extent.summary(self.robot),
            "assumed": {
                "size_of_each_effect_over_joint_rms_torque": SIZE,
                "noise_over_torque_limit": NOISE,
                "noise_Nm": [float(v) for v in self.noise],
                "separated_from_distance": CLEAR,
            },
            "smallest_distance_before": smallest[0],
            "smallest_distance_after": smallest[1],
            "improves": bool(self.gain > 0),
            "separability": [row.row() for row in self.table],
            "splits": self.group.splits,
            "measure_else": self.group.measure_else if self.inseparable or self.open else "",
        }

    def trajectory(self) -> Trajectory:
        """With torque and the way of the TCP."""
        return with_way(Model(self.robot), self.course, self.tau)

    def program(self) -> RapidProgram:
        """The motion as a RAPID module of joint moves with their times."""
        return rapid_module(Model(self.robot), self.course, "Excitation", COARSE_DEG)

    def lines(self) -> list[str]:
        """For the terminal."""
        assumed = AccelerationLimits.of(self.robot).remark()
        text = [
            f"{self.group.name}: {', '.join(self.group.kinds)}; {self.course.duration:.1f} s",
            f"{self.extent.shares()} ({100 * SHARE:.0f} % of the torque may be used)",
            *remark(self.robot),
            *([assumed] if assumed else []),
            f"{'separation in standard deviations':<58}{'standard':>10}{'planned':>10}",
        ]
        for row in self.table:
            text.append(
                f"  {row.pair:<56}{row.distance[0]:>10.1f}{row.distance[1]:>10.1f}  {row.verdict}"
            )
        for row in self.inseparable:
            text.append(
                f"{row.pair}: {row.reason}; a record of any length shows {row.ceiling:.1f} at most"
            )
        if self.inseparable or self.open:
            text.append(f"measure besides: {self.group.measure_else}")
        return text

    def write(self, out: Path | str) -> list[Path]:
        """Write `trajectory.csv`, `excitation.mod` and `excitation.json`; returns their paths.
        RAPID knows six axes: other arms get no module."""
        folder = Path(out)
        folder.mkdir(parents=True, exist_ok=True)
        return [
            write_atomic(folder / "trajectory.csv", self.trajectory().csv()),
            *([self.program().save(folder / "excitation.mod")] if self.robot.n == 6 else []),
            write_json(folder / "excitation.json", self.summary()),
        ]


def rapid_module(
    model: Model, course: Trajectory, module: str, tolerance_deg: float
) -> RapidProgram:
    """A course as a RAPID module of joint moves with their times.

    Args:
        model: of the arm; course: of six axes.
        module: its name; tolerance_deg: of every joint [deg].
    """
    options = RapidOptions(
        module=module,
        motion="joint",
        tolerance_mm=0.5,
        tolerance_deg=tolerance_deg,
        zone_mm=1.0,
        state_time=True,
    )
    return rapid_program(model, course, options=options)


def with_way(model: Model, course: Trajectory, tau: Array) -> Trajectory:
    """A course with torque and the way of the TCP.

    Args:
        model: of the arm.
        course: without them.
        tau: [Nm], shape (m, n).
    """
    points = model.tcp_pose(course.q)[:, :3, 3]
    way = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1)))
    return Trajectory(course.time, course.q, course.qd, course.qdd, tau, way)
