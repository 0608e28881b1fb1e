"""What stands between controller and arm: encoders, speed filter, torque path; and what the data
stream adds."""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import Field

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.table import Table

NotNegative = Annotated[float, Field(ge=0)]

CLOSE = 1e-3
"""relative difference to the control rate divided by a whole number that is how one writes it"""


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
    """rate of the data stream, the control rate divided by a whole number; if absent the one of
    these that is next to 250"""

    def streamed(self, control_rate: float) -> Sensors:
        """With the rate that the stream has at a control rate [Hz].

        Raises:
            InputError: another rate is stated.
        """
        asked = control_rate / self.rate_Hz
        every = max(1, round(asked))
        if "rate_Hz" in self.model_fields_set and abs(asked - every) > CLOSE * every:
            slower = control_rate / math.ceil(asked)
            faster = control_rate / max(1, math.floor(asked))
            tries = " or ".join(f"{rate:.7g}" for rate in dict.fromkeys((slower, faster)))
            raise InputError(
                f"sensors: found rate_Hz = {self.rate_Hz:g}; expected the control rate, "
                f"{control_rate:g} Hz, divided by a whole number, because the log holds samples of "
                f"the controller; try {tries}"
            )
        return self.model_copy(update={"rate_Hz": control_rate / every})


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
