"""What stands between controller and arm: encoders, speed filter, torque path; and what the data
stream adds."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from irb2400_ctrl.table import Table

NotNegative = Annotated[float, Field(ge=0)]


class Sensors(Table):
    """Measuring chain of a drive, as seen by the controller and by the log.

    The speed is the filtered difference of the quantised angle, as drives make it: qd' = 2 pi f
    (dq/dt - qd). Noise on the reported torque does not enter the loop.
    """

    encoder_step_rad: NotNegative = 5e-6
    """resolution on the joint side; 0 switches quantisation off"""
    encoder_noise_rad: NotNegative = 0.0
    """standard deviation of the angle's noise before quantisation; it enters the loop"""
    speed_filter_Hz: NotNegative = 250.0
    """corner of the speed filter; 0 gives the controller the true speed"""
    torque_noise_Nm: NotNegative = 0.0
    """standard deviation of the reported torque's noise"""
    rate_Hz: Annotated[float, Field(gt=0)] = 250.0
    """rate of the data stream"""


class Actuators(Table):
    """The torque path from the controller's output to the arm."""

    delay_samples: Annotated[int, Field(ge=0, le=1)] = 1
    """computation delay: the command of one sample acts at the next (1), or at once (0)"""
    lag_s: NotNegative = 0.0
    """time constant of the current loop"""
    saturate: bool = True
    """cut the torque at the plant's limits"""


IDEAL_SENSORS = Sensors(encoder_step_rad=0.0, speed_filter_Hz=0.0)
IDEAL_ACTUATORS = Actuators(delay_samples=0, saturate=False)
