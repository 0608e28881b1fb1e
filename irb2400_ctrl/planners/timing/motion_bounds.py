"""What is known of a timed motion over all times, as parts of its limits."""

from __future__ import annotations

from dataclasses import dataclass

from irb2400_ctrl.arrays import Array


@dataclass(frozen=True)
class Checked:
    """Upper bounds over all times, not samples."""

    torque_ratio: float
    """largest |tau| / tau_max; inf where nothing can be said"""
    velocity_ratio: float
    """largest |qd| / qd_max"""
    torque_at: tuple[float, int]
    """where: length [m] and axis 1…n"""
    acceleration_ratio: float = 0.0
    """largest |qdd| / qdd_max; zero without a limit"""
    torque_rate_ratio: float = 0.0
    jerk_ratio: float = 0.0
    """of a motion without jumps, as parts of their limits; zero where there is none"""

    def holds(self, tolerance: float = 1e-9) -> bool:
        """Whether all bounds are at most one."""
        rates = (self.acceleration_ratio, self.torque_rate_ratio, self.jerk_ratio)
        return max(self.torque_ratio, self.velocity_ratio, *rates) <= 1 + tolerance


@dataclass(frozen=True)
class Peaks:
    """Largest values of each axis on the law's own cells."""

    torque: Array
    """upper bounds of |tau| [Nm], shape (n,)"""
    torque_rate_ratio: float
    """largest |dtau/dt| over its limit, of samples where it has no bound; zero where the
    acceleration jumps"""
