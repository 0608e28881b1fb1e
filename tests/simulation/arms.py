"""Arms and motions that the simulation and controller tests share."""

from __future__ import annotations

import numpy as np

from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.robot import Joint, Robot, load_robot
from irb2400_ctrl.simulation import Trajectory

FORCE_EFFECTS = (
    ("rotor_inertia", 4, {"inertia_kgm2": 0.3}),
    ("coulomb_asymmetry", 2, {"delta_Nm": 3.0}),
    ("coulomb_change", 3, {"coulomb_Nm": 4.0}),
    ("viscous_change", 1, {"viscous_Nms_rad": 3.0}),
    ("viscous_power", 2, {"coefficient": 5.0, "exponent": 0.6}),
    ("viscous_warmup", 5, {"viscous_Nms_rad": 2.0, "time_constant_s": 20.0}),
    ("load_friction", 3, {"coefficient": 0.05}),
    ("gear_ripple", 4, {"amplitude_Nm": 3.0, "order": 37.0}),
    ("balancer", 2, {"torque_Nm": 200.0}),
    ("cable_spring", 5, {"stiffness_Nm_rad": 8.0}),
    ("wrist_coupling", 4, {"inertia_kgm2": 0.05, "viscous_Nms_rad": 0.5}),
    ("far_wrist_coupling", 4, {"inertia_kgm2": 0.03, "viscous_Nms_rad": 0.4}),
    ("coupled_friction", 5, {"here_Nm": 3.0, "neighbour_Nm": -2.0}),
    ("geared_motor", 6, {"ratio": -1.0, "inertia_kgm2": 0.05, "coulomb_Nm": 3.0}),
    ("base_tilt", None, {"tilt_x_rad": 0.01, "tilt_y_rad": -0.02}),
    ("process_force", None, {"force_x_N": 40.0, "force_z_N": -60.0}),
    ("linkage_inertia", 3, {"inertia_kgm2": 1.0, "moment_kgm": 2.0}),
    ("payload", None, {"mass_kg": 4.0, "com_m": (0.02, 0.0, 0.1)}),
    ("link_inertia", 2, {"mass_kg": 5.0, "com_m": (0.3, 0.0, 0.0)}),
)


def arm() -> Robot:
    """The arm of the paper."""
    return load_robot("irb2400")


def without_friction(robot: Robot) -> Robot:
    """The same arm with no friction at all."""
    nothing = {"static_Nm": 0.0, "coulomb_Nm": 0.0, "viscous_Nms_rad": 0.0}
    joints = tuple(
        j.model_copy(update={"friction": j.friction.model_copy(update=nothing)})
        for j in robot.joints
    )
    return _with_joints(robot, joints)


def _with_joints(robot: Robot, joints: tuple[Joint, ...]) -> Robot:
    # an arm that has been asked for its arrays holds them beside its fields
    fields = {name: getattr(robot, name) for name in Robot.model_fields}
    return Robot.model_validate({**fields, "joints": joints})


def strong(robot: Robot) -> Robot:
    """The same arm with torque limits that are never reached."""
    joints = tuple(
        j.model_copy(update={"limits": j.limits.model_copy(update={"torque_Nm": 1e6})})
        for j in robot.joints
    )
    return _with_joints(robot, joints)


def with_effect(robot: Robot, kind: str, joint: int | None, fields: dict[str, object]) -> Robot:
    """The robot with one more effect."""
    return robot.with_effects(LIBRARY[kind].of(joint, **fields))


def quintic_move(
    start: np.ndarray, stop: np.ndarray, duration: float, rate: float = 250.0
) -> Trajectory:
    """Rest to rest by a fifth-order polynomial."""
    time = np.arange(round(duration * rate) + 1) / rate
    s = (time / duration)[:, None]
    way = stop - start
    q = start + way * s**3 * (10 - 15 * s + 6 * s**2)
    qd = way * (30 * s**2 - 60 * s**3 + 30 * s**4) / duration
    qdd = way * (60 * s - 180 * s**2 + 120 * s**3) / duration**2
    return Trajectory(time, q, qd, qdd)


START = np.array([0.1, 0.2, -0.1, 0.3, 0.8, -0.2])
STOP = np.array([0.6, -0.2, 0.2, -0.6, 1.2, 0.9])
