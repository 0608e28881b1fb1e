"""An arm in MuJoCo: compiled from its text, moved in closed loop, or asked for the torque of a
motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import mujoco
import numpy as np
from independent_plant.parameters import RANGES, TORQUE_LIMITS, Arm

from .forces import Law, State
from .mjcf import STEP, TO_LINKS, Drive, Spring, mjcf

RATE = 1000.0
"""of references, laws and records [Hz]"""
RUNAWAY = 30.0
"""speed of an axis that no arm reaches [rad/s]"""
TO_MOTORS = np.linalg.inv(TO_LINKS)
"""q = TO_MOTORS @ theta"""


class RanAway(RuntimeError):
    """The drives do not hold the arm that was drawn."""


@dataclass(frozen=True)
class Machine:
    """Bodies, gravity and rotors of the arm; friction (6, 4) as in `parameters.FRICTION`; bristle
    stiffness over static friction [1/rad]; the servo's bandwidth and lag per axis."""

    arm: Arm
    friction: np.ndarray
    bristle: np.ndarray
    bandwidth: np.ndarray
    lag: np.ndarray
    cogging: tuple[tuple[float, int, float], ...] = ((0.0, 1, 0.0),) * 6
    spring: Spring | None = None

    @staticmethod
    def drawn(rng: np.random.Generator, arm: Arm, friction: np.ndarray) -> Machine:
        """A good drive on every axis."""
        return Machine(
            arm,
            friction,
            bristle=rng.uniform(1500.0, 4000.0, 6),
            bandwidth=rng.uniform(180.0, 300.0, 6),
            lag=rng.uniform(0.005, 0.015, 6),
        )

    @cached_property
    def inertia(self) -> np.ndarray:
        """Of each axis alone in a common pose [kg m2], (6,)."""
        return np.asarray(np.diag(self.mass_matrix(np.array([0.0, 0.2, 0.1, 0.3, 0.6, 0.0]))))

    @cached_property
    def least_inertia(self) -> np.ndarray:
        """What a motor feels at least, the other axes free to follow [kg m2], (6,)."""
        poses = np.random.default_rng(7).uniform(RANGES[:, 0], RANGES[:, 1], (60, 6))
        felt = [1.0 / np.diag(np.linalg.inv(self.mass_matrix(q))) for q in poses]
        return np.asarray(np.min(felt, axis=0))

    def mass_matrix(self, q: np.ndarray) -> np.ndarray:
        """Of the motor angles, without a transmission, (6, 6)."""
        data = mujoco.MjData(self._rigid)
        data.qpos[:] = TO_LINKS @ q
        mujoco.mj_forward(self._rigid, data)
        full = np.zeros((6, 6))
        mujoco.mj_fullM(self._rigid, data, full)
        return np.asarray(TO_LINKS.T @ full @ TO_LINKS)

    @cached_property
    def _rigid(self) -> Any:
        """Masses alone: no friction, no transmission."""
        drives = tuple(Drive(0, 0, 0, 1e4, (0, 0, 0, 0, 1), 0) for _ in range(6))
        text = mjcf(drives, self.arm.gravity)
        return _with_masses(mujoco.MjModel.from_xml_string(text), replace(self, spring=None))

    def drives(self) -> tuple[Drive, ...]:
        """PID gains from inertia and bandwidth, friction of each axis."""
        found = []
        for j in range(6):
            inertia = max(float(self.inertia[j]), 0.5)
            rate = self.bandwidth[j]
            if self.spring is not None and self.spring.axis == j:
                inertia = self.spring.rotor
            static, coulomb, viscous, stribeck = self.friction[j]
            stiffness = self.bristle[j] * static
            damping = 0.4 * np.sqrt(stiffness * inertia)
            found.append(
                Drive(
                    kp=inertia * rate**2 / 4,
                    ki=inertia * rate**3 / 40,
                    kd=inertia * rate,
                    limit=2.0 * TORQUE_LIMITS[j],
                    bristle=(stiffness, min(damping, viscous), coulomb, static, stribeck),
                    damping=viscous,
                    cogging=self.cogging[j],
                )
            )
        return tuple(found)

    @cached_property
    def model(self) -> Any:
        """The compiled model with this arm's masses."""
        text = mjcf(self.drives(), self.arm.gravity, self.spring)
        return _with_masses(mujoco.MjModel.from_xml_string(text), self)

    def rigid_torque(self, q: np.ndarray, qd: np.ndarray, qdd: np.ndarray) -> np.ndarray:
        """What a motion (n, 6) asks of the motors without friction (n, 6): `mj_inverse`."""
        data = mujoco.MjData(self._rigid)
        tau = np.empty_like(q)
        motion = (np.asarray(x @ TO_LINKS.T) for x in (q, qd, qdd))
        for i, (p, v, a) in enumerate(zip(*motion, strict=True)):
            data.qpos[:] = p
            data.qvel[:] = v
            data.qacc[:] = a
            mujoco.mj_inverse(self._rigid, data)
            tau[i] = data.qfrc_inverse
        return np.asarray(tau @ TO_LINKS)

    def friction_torque(self, qd: np.ndarray) -> np.ndarray:
        """Of a steady motion (n, 6); zero at rest."""
        static, coulomb, viscous, stribeck = self.friction.T
        dry = coulomb + (static - coulomb) * np.exp(-((qd / stribeck) ** 2))
        return np.asarray(dry * np.sign(qd) + viscous * qd)

    def closed_loop(self, laws: Sequence[Law], reference: np.ndarray, start: float) -> np.ndarray:
        """Along a reference (n, 6) at 1 kHz: motor angles, speeds, torques of the drives
        (n, 18)."""
        data = mujoco.MjData(self.model)
        ctrl = self._setpoints(reference)
        motor = _Motors(self.spring)
        motor.start(data, ctrl[0, 0::3], ctrl[0, 1::3])
        state = State(STEP, TipForce(self.model, data))
        extra = np.zeros(6)
        load = ctrl[0, 2::3]
        record = np.empty((len(ctrl), 18))
        for i, setpoint in enumerate(ctrl):
            data.ctrl[:] = setpoint
            q, qd = motor.seen(data)
            if laws:
                state.at(start + i * STEP, q, qd, load)
                extra[:] = 0.0
                for law in laws:
                    law.add(state, extra)
                motor.apply(data, extra)
            mujoco.mj_step(self.model, data)
            load = data.actuator_force[:6]
            record[i] = np.concatenate([q, qd, load])
            if not abs(qd).max() < RUNAWAY:
                raise RanAway("the simulated arm ran away: its drives do not suit it")
        return record[:: round(1.0 / RATE / STEP)]

    def _setpoints(self, reference: np.ndarray) -> np.ndarray:
        """Position, speed and torque fed forward of each drive at every step, (m, 18)."""
        wanted, speed = lagged(reference, self.lag)
        rates = np.gradient(speed, 1.0 / RATE, axis=0)
        parts = round(1.0 / RATE / STEP)
        fine = np.arange(parts * (len(wanted) - 1) + 1) / parts
        coarse = np.arange(len(wanted))
        ctrl = np.empty((len(fine), 18))
        weight = self.rigid_torque(wanted[:1], 0 * wanted[:1], 0 * wanted[:1])[0]
        for j in range(6):
            forward = weight[j] + 0.8 * self.inertia[j] * rates[:, j]
            for k, signal in enumerate((wanted[:, j], speed[:, j], forward)):
                ctrl[:, 3 * j + k] = np.interp(fine, coarse, signal)
        return ctrl


class TipForce:
    """Motor torques (6,) that hold the arm against a force [N, base frame] at the tool's tip."""

    def __init__(self, model: Any, data: Any) -> None:
        self.model = model
        self.data = data
        self.site = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, "tip")
        self.jacobian = np.zeros((3, model.nv))

    def __call__(self, force: np.ndarray) -> np.ndarray:
        mujoco.mj_jacSite(self.model, self.data, self.jacobian, None, self.site)
        return np.asarray(-(force @ self.jacobian[:, :6]) @ TO_LINKS)


class _Motors:
    """Motor side of the model's state, with or without a rotor of its own."""

    def __init__(self, spring: Spring | None) -> None:
        self.spring = spring

    def start(self, data: Any, q: np.ndarray, qd: np.ndarray) -> None:
        data.qpos[:6] = TO_LINKS @ q
        data.qvel[:6] = TO_LINKS @ qd
        if self.spring is not None:
            data.qpos[6] = q[self.spring.axis]
            data.qvel[6] = qd[self.spring.axis]

    def seen(self, data: Any) -> tuple[np.ndarray, np.ndarray]:
        q = TO_MOTORS @ data.qpos[:6]
        qd = TO_MOTORS @ data.qvel[:6]
        if self.spring is not None:
            q[self.spring.axis] = data.qpos[6]
            qd[self.spring.axis] = data.qvel[6]
        return q, qd

    def apply(self, data: Any, extra: np.ndarray) -> None:
        """`extra` is what the motors must give more: the plant feels it against the motion."""
        data.qfrc_applied[:6] = -(TO_MOTORS.T @ extra)


def _with_masses(model: Any, machine: Machine) -> Any:
    """Bodies as drawn: they need not be possible ones one by one, as the paper's are not."""
    packed = machine.arm.packed()
    for i in range(6):
        mass, x, y, z, xx, yy, zz, xy, xz, yz = packed[10 * i : 10 * i + 10]
        moments, axes = np.linalg.eigh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        if np.linalg.det(axes) < 0.0:
            axes[:, 0] *= -1.0
        quaternion = np.empty(4)
        mujoco.mju_mat2Quat(quaternion, np.ascontiguousarray(axes).ravel())
        model.body_mass[i + 1] = mass
        model.body_ipos[i + 1] = (x, y, z)
        model.body_inertia[i + 1] = moments
        model.body_iquat[i + 1] = quaternion
    spring = machine.spring
    model.actuator_armature[:6] = machine.arm.rotor
    if spring is not None:
        model.actuator_armature[spring.axis] += spring.rotor
        if spring.axis == 2:
            model.tendon_armature[0] = -spring.rotor
        else:
            model.dof_armature[spring.axis] = -spring.rotor
    mujoco.mj_setConst(model, mujoco.MjData(model))
    return model


def lagged(reference: np.ndarray, lag: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A critically damped second-order filter on each axis (delay `lag` [s]): angles, speeds."""
    from scipy.signal import lfilter

    wanted = np.empty_like(reference)
    for j in range(reference.shape[1]):
        pole = np.exp(-2.0 / (lag[j] * RATE))
        x = reference[:, j] - reference[0, j]
        once = lfilter([1 - pole], [1, -pole], x)
        wanted[:, j] = lfilter([1 - pole], [1, -pole], once) + reference[0, j]
    return wanted, np.gradient(wanted, 1.0 / RATE, axis=0)
