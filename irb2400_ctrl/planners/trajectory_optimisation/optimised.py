"""`Optimised`: a motion with free geometry, what it costs, and what it is compared with."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.model import Model
from irb2400_ctrl.model.arm_family import has_singularity_factors
from irb2400_ctrl.model.friction import FrictionLaw
from irb2400_ctrl.planners.enclosure.deviation import singularity_margins
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.redundancy.follow import Followed
from irb2400_ctrl.planners.timing.certificate import Certificate, check
from irb2400_ctrl.planners.timing.motion_bounds import Checked
from irb2400_ctrl.trajectory import Trajectory

# instants per second at which energy is summed up, and torque sampled where it has no enclosure
_RATE = 5000.0


@dataclass(frozen=True, repr=False)
class MotionOutcome:
    """One motion and its price."""

    certificate: Certificate
    checked: Checked
    """bounds of torque and speed over all times, from the certificate alone"""
    energy: Array
    """what each drive takes up, integral of max(0, tau qd): braking gives nothing back [J], shape
    (n,)"""
    peak_torque: Array
    """upper bounds of |tau| over all times (of samples, where an effect has no enclosure) [Nm],
    shape (n,)"""
    torque_rate: Array
    """largest change of the torque without dry friction, sampled at 5 kHz [Nm/s]; shape (n,)"""
    margins: dict[str, float]
    """lower bounds of |sin q5| [-], |r| [m], |k| [m] over the continuous path"""
    guaranteed: bool
    """whether an enclosure says so; with effects that have none, the torque was only sampled"""

    def __post_init__(self) -> None:
        for array in (self.energy, self.peak_torque, self.torque_rate):
            array.setflags(write=False)

    @property
    def duration(self) -> float:
        """[s]"""
        return self.certificate.law.duration

    def __repr__(self) -> str:
        """One line: thousands of coefficients are no answer at a prompt."""
        return f"<MotionOutcome: {self.duration:.3f} s, {self.energy.sum():.1f} J>"


@dataclass(frozen=True, repr=False)
class Optimised:
    """What `optimise_motion` found."""

    waypoints: Array
    """[rad], shape (k, n)"""
    waypoint_time: Array
    """when they are passed [s], shape (k,)"""
    objective: str
    motion: MotionOutcome
    reference: MotionOutcome | None
    """the warm start with its geometry fixed: in its fastest certified time, or for energy evenly
    slowed to the longest duration allowed; None where it has no timing within the limits"""
    fell_back: bool
    """whether the motion is the warm start, because the optimiser gave nothing better"""
    message: str
    """how it ended, in words"""
    solver_status: str
    iterations: int
    wall_time: dict[str, float] = field(default_factory=dict)
    """[s] per stage"""
    torque_as_read: float = math.nan
    """largest torque over its limit where the rows of `trajectory` are read as cubics through their
    angles and speeds [-]: more than 1 where the torque jumps, however dense the rows are"""

    def __post_init__(self) -> None:
        for array in (self.waypoints, self.waypoint_time):
            array.setflags(write=False)

    @property
    def duration(self) -> float:
        """[s]"""
        return self.motion.duration

    def __repr__(self) -> str:
        """One line, as of the motion."""
        return (
            f"<Optimised: least {self.objective}, {self.duration:.3f} s, "
            f"{self.motion.energy.sum():.1f} J; {self.message}>"
        )

    @property
    def ratio(self) -> float:
        """Duration over that of the reference; nan without one."""
        return self.duration / self.reference.duration if self.reference else float("nan")

    def trajectory(self, model: Model, rate: float = 1000.0) -> Trajectory:
        """The motion at `rate` rows a second, and one at its end; `s` is the parameter of its joint
        path."""
        rows = np.arange(math.ceil(self.duration * rate - 1e-9)) / rate
        time = np.append(rows, self.duration)
        s, q, qd, qdd = self.motion.certificate.law.motion(self.motion.certificate.path, time)
        tau = model.inverse_dynamics(q, qd, qdd)
        return Trajectory(time, q, qd, qdd, tau, s, check_speeds=False)

    def summary(self) -> dict[str, Any]:
        """Numbers for a report; units in the names."""
        found = self.motion
        fixed = self.reference
        return {
            "objective": self.objective,
            "waypoints": len(self.waypoints),
            "duration_s": self.duration,
            "fixed_geometry_duration_s": fixed.duration if fixed else None,
            "ratio": self.ratio if fixed else None,
            "energy_J": found.energy.tolist(),
            "fixed_geometry_energy_J": fixed.energy.tolist() if fixed else None,
            "peak_torque_Nm": found.peak_torque.tolist(),
            "fixed_geometry_peak_torque_Nm": fixed.peak_torque.tolist() if fixed else None,
            "max_torque_ratio": found.checked.torque_ratio,
            "max_torque_ratio_as_read": self.torque_as_read,
            "max_velocity_ratio": found.checked.velocity_ratio,
            "guaranteed": found.guaranteed,
            "singularity_margin": found.margins,
            "fell_back": self.fell_back,
            "message": self.message,
            "solver_status": self.solver_status,
            "iterations": self.iterations,
            "wall_time_s": self.wall_time,
        }


def torque_as_read(model: Model, rows: Trajectory) -> float:
    """Largest torque over its limit of an arm whose joints are on the cubics through angles and
    speeds of rows [-]; within a cubic the acceleration is largest at a row, before or behind it."""
    path = JointPath.hermite(rows.time, rows.q, rows.qd)
    piece = np.arange(len(rows.time) - 1)
    largest = 0.0
    for time in (rows.time[:-1], rows.time[1:]):
        states = (path.on_piece(time, piece, order) for order in range(3))
        tau = model.inverse_dynamics(*states)
        largest = max(largest, float((np.abs(tau) / model.robot.tau_max).max()))
    return largest


def outcome(certificate: Certificate, dynamics: PathDynamics) -> MotionOutcome:
    """Check a motion and measure it."""
    model = dynamics.model
    law = certificate.law
    path = certificate.path
    steps = int(np.ceil(_RATE * law.duration)) + 1
    time = np.linspace(0.0, law.duration, steps)
    _, q, qd, qdd = law.motion(path, time)
    tau = model.inverse_dynamics(q, qd, qdd)
    power = np.maximum(tau * qd, 0.0)
    dt = law.duration / (steps - 1)
    energy = dt * (power.sum(axis=0) - (power[0] + power[-1]) / 2)
    moving = tau - FrictionLaw.of(model.robot).dry(qd)
    rate = np.abs(np.diff(moving, axis=0)).max(axis=0) / dt
    guaranteed = not dynamics.irregular
    if dynamics.irregular:
        peak = np.abs(tau).max(axis=0)
        ratio = np.abs(tau) / certificate.limits.tau_max
        row, axis = np.unravel_index(int(np.argmax(ratio)), ratio.shape)
        speed = float((np.abs(qd) / certificate.limits.qd_max).max())
        checked = Checked(
            float(ratio.max()), speed, (float(law.at(time[row : row + 1])[0][0]), int(axis) + 1)
        )
    else:
        checked = check(certificate, model, dynamics)
        peaks = law.peaks(path, certificate.limits, dynamics)
        if not np.isfinite(checked.torque_rate_ratio):
            guaranteed = False
            checked = replace(checked, torque_rate_ratio=peaks.torque_rate_ratio)
        # both bounds hold, and the check's comes from smaller cells
        peak = np.minimum(peaks.torque, checked.torque_ratio * certificate.limits.tau_max)
    return MotionOutcome(
        certificate, checked, energy, peak, rate, path_margins(model, path), guaranteed
    )


def path_margins(model: Model, path: JointPath) -> dict[str, float]:
    """Lower bounds of the singularity factors over a joint path, its pieces cut into eight; empty
    for an arm that has none."""
    if not has_singularity_factors(model.robot):
        return {}
    knots = path.knots
    s = np.append(
        (knots[:-1, None] + np.arange(8) / 8 * np.diff(knots)[:, None]).ravel(), knots[-1]
    )
    piece = np.repeat(np.arange(len(knots) - 1), 8)
    taylor = [
        path.on_piece(s[:-1], piece, order) / factor
        for order, factor in enumerate((1.0, 1.0, 2.0, 6.0))
    ]
    fine = JointPath(s, np.stack(taylor))
    return singularity_margins(model, Followed(fine, s, 0.0, 0.0))
