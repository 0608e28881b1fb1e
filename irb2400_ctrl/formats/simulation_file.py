"""`simulation.json` and `closed_loop.json`: their keys."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from irb2400_ctrl.robot.numbers import NotNegative, Positive
from irb2400_ctrl.table import Table

Axes = list[int]


class DistanceEntry(Table):
    """A distance of the TCP over the run."""

    rms: NotNegative
    max: NotNegative


class JointErrorEntry(Table):
    """Angle over reference angle, a number a joint."""

    rms: list[NotNegative]
    max: list[NotNegative]


class BoundsEntry(Table):
    """Bounds that were reached: numbers of axes, from 1; empty, 0 and null where none was."""

    reference_outside_joint_box: Axes
    reference_above_speed_limit: Axes
    joint_box: Axes
    speed_limit: Axes
    torque_limit: Axes
    end_stop: Axes
    samples_refused_by_package: int = Field(ge=0, description="by the test of its inputs")
    brake_closed_s: NotNegative | None = Field(description="since when the brake is closed")
    brake_closed_far_from_reference: Axes = Field(
        default=[], description="why: these got farther from the reference than the guard allows"
    )


class SensorsEntry(Table):
    """Measuring chain of a drive."""

    encoder_step_rad: NotNegative = Field(description="resolution on the joint side; 0: none")
    encoder_noise_rad: NotNegative = Field(description="standard deviation, before the resolution")
    speed_filter_Hz: NotNegative = Field(description="corner; 0: the true speed")
    torque_noise_Nm: NotNegative = Field(description="standard deviation of the reported torque")
    rate_Hz: Positive = Field(description="of the data stream")


class ActuatorsEntry(Table):
    """From the controller's output to the arm."""

    delay_samples: Literal[0, 1] = Field(description="of computation")
    lag_s: NotNegative = Field(description="time constant of the current loop")
    saturate: bool = Field(description="whether the torque is cut at the plant's limits")


class SimulationFile(Table):
    """How well a controller followed a motion on a simulated arm; `log.csv` holds the record."""

    schema_version: Literal[1]
    controller: str = Field(description="its name")
    robot: str = Field(description="name of the robot that the controller knows")
    plant: str = Field(description="name of the arm that it moved")
    duration_s: Positive
    control_rate_Hz: Positive
    tcp_error_mm: DistanceEntry = Field(description="from where the TCP should be at that time")
    contour_error_mm: DistanceEntry = Field(description="from the path, whatever the time along it")
    joint_error_deg: JointErrorEntry
    max_torque_ratio: list[NotNegative | None] = Field(
        description="of each joint, over its limit; null where that is unknown"
    )
    saturated_share: list[NotNegative] = Field(description="of each joint: time at its limit")
    bounds_reached: BoundsEntry
    sensors: SensorsEntry
    actuators: ActuatorsEntry
    seed: int = Field(description="of the noise")
    real_time_factor: Positive = Field(description="simulated over elapsed time")


class ClosedLoopFile(Table):
    """The log's motion, followed by the controller made from three descriptions of the arm."""

    before: SimulationFile = Field(description="the robot as given")
    recalibrated: SimulationFile = Field(description="its numbers as diagnosed, without effects")
    after: SimulationFile = Field(description="the robot as diagnosed")
