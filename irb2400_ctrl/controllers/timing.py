"""What sampling, computation, speed filter and current loop do to a control loop."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.typed import typed


@typed
@dataclass(frozen=True)
class Timing:
    """The clockwork of a drive; the defaults are those of the simulated one.

    Args:
        sample_time: [s]; the plant is discretised with a zero-order hold at this period.
        delay_samples: whole periods between reading the encoder and the torque that follows from
            it.
        speed_filter_Hz: corner of the speed filter behind the difference of angles; 0: the true
            speed is known.
        lag_s: time constant of the current loop.
    """

    sample_time: float = 0.001
    delay_samples: int = 1
    speed_filter_Hz: float = 250.0
    lag_s: float = 0.0

    def __post_init__(self) -> None:
        if not (
            self.sample_time > 0
            and self.delay_samples >= 0
            and self.speed_filter_Hz >= 0
            and self.lag_s >= 0
        ):
            raise InputError(f"{self}; expected a positive sample time and no negative value")

    @property
    def filter_share(self) -> float:
        """Share a of the newest difference in the filtered speed: v+ = v + a (dq / T - v)."""
        return 1.0 - math.exp(-2 * math.pi * self.speed_filter_Hz * self.sample_time)

    def speed(self) -> Any:
        """Transfer function from angle to measured speed, discrete (`control.TransferFunction`).

        The trapezoidal derivative stands for a known true speed: what a zero-order-hold double
        integrator has.
        """
        import control

        T = self.sample_time
        if self.speed_filter_Hz == 0:
            return control.tf([2, -2], [T, T], T)
        a = self.filter_share
        return control.tf([a, -a], [T, -T * (1 - a)], T)

    def actuator(self) -> Any:
        """Transfer function from torque command to mean torque over the period, discrete."""
        import control

        T = self.sample_time
        d = self.delay_samples
        delay = control.tf([1], [1] + [0] * d, T)
        if self.lag_s == 0:
            return delay
        # lag behind a zero-order hold, averaged over the period, as in the simulated actuator
        e = math.exp(-T / self.lag_s)
        mean = (1 - e) * self.lag_s / T
        return delay * control.tf([1 - mean, mean - e], [1, -e], T)
