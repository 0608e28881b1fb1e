"""An arm with its drives, moved with or without effects: closed loop, and torque asked by a given
motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from . import arm_changes, native
from .effects import Drawn
from .motion import Motion
from .parameters import Arm, Servo

Sized = tuple[tuple[Drawn, float], ...]  # effects and their sizes
STREAM = 4  # records of 1 kHz per sample of 250 Hz


def below_10_hz(x: np.ndarray) -> np.ndarray:
    """Zero-phase low-pass of (n, 6) at 250 Hz."""
    from scipy.signal import butter, filtfilt

    b, a = butter(3, 10 / 125)
    return np.asarray(filtfilt(b, a, x, axis=0))


def _force_law(drawn: Drawn, size: float) -> list[float]:
    """One effect as the C structure."""
    p = [size, *drawn.shape]
    if drawn.effect.kind == "process_force":
        a, b, c, d, e, f = drawn.spare
        direction = np.array([a, b, c]) / np.linalg.norm([a, b, c])
        p = [*(size * direction), 9.0 + 2 * d, 3.5 + e, 4.0 + f, 0.15]
    law = native.law_index()[drawn.effect.kind]
    return [law, (drawn.joint or 1) - 1, drawn.effect.on_at, *p, *[0.0] * (8 - len(p))]


@dataclass(frozen=True)
class Driven:
    """What came of a motion, n samples at 1 kHz without the run-up: true angles [rad], speeds,
    torques (n, 6) that acted, places of the tool's tip [m] (n, 3), and where the tip and the angles
    should have been."""

    q: np.ndarray
    qd: np.ndarray
    tau: np.ndarray
    tip: np.ndarray
    tip_ref: np.ndarray
    q_ref: np.ndarray

    @property
    def tip_error(self) -> np.ndarray:
        """Distance of the tip from where it should be [m], (n,)."""
        return np.asarray(np.linalg.norm(self.tip - self.tip_ref, axis=1))


@dataclass(frozen=True)
class Machine:
    """An arm, its friction (6, 4) as in `parameters.FRICTION`, its servo."""

    arm: Arm
    friction: np.ndarray
    servo: Servo

    def structures(self, effects: Sized = ()) -> tuple[np.ndarray, np.ndarray]:
        """Plant and force laws as the C structures."""
        after = self.arm
        change_at = -np.inf
        servo = self.servo
        zero = np.zeros(6)
        transmission = arm_changes.RIGID
        laws = []
        for drawn, size in effects:
            j = (drawn.joint or 1) - 1
            match drawn.recipe.where:
                case "arm":
                    after = arm_changes.changed_arm(after, drawn, size)
                    change_at = drawn.effect.on_at
                case "transmission":
                    transmission = arm_changes.transmission(self.arm, drawn, size)
                    servo = servo.detuned(j, transmission[1], transmission[2])
                case "law":
                    laws.append(_force_law(drawn, size))
                case "chain" if drawn.effect.kind == "encoder_zero":
                    zero[j] = size
        tables = self.friction.ravel(), servo.table.ravel(), zero, transmission
        plant = np.concatenate([self.arm.packed(), after.packed(), np.array([change_at]), *tables])
        return plant, np.array(laws, dtype=float).reshape(-1, 11)

    def closed_loop(self, effects: Sized, move: Motion) -> tuple[np.ndarray, np.ndarray]:
        """Times and record (q, qd, reported torque) at 1 kHz, free of noise, without the run-up."""
        record = native.follow(*self.structures(effects), move.start - move.lead, move.q)
        time = move.start - move.lead + np.arange(len(record)) / native.RECORD_RATE
        record[:, 12:] = _reported(time, record[:, 12:], effects)
        skip = round(move.lead * native.RECORD_RATE)
        return time[skip:], record[skip:]

    def driven(self, effects: Sized, move: Motion, drive: native.Drive) -> Driven:
        """A motion that begins at rest, made by somebody's controller; `drive` is asked at 1 kHz
        from the run-up on."""
        encoder = {"encoder_step": 5e-6, "speed_corner": 2 * np.pi * 250.0}
        record = native.driven(
            *self.structures(effects),
            move.start - move.lead,
            move.q[0],
            len(move.q),
            drive,
            **encoder,
        )
        skip = round(move.lead * native.RECORD_RATE)
        q, qd, tau, tip = np.split(record[skip:], (6, 12, 18), axis=1)
        return Driven(q, qd, tau, tip, native.tool_tip(move.q[skip:]), move.q[skip:])

    def asked_torque(
        self, effects: Sized, dt: float, moving: np.ndarray, start: float = 0.0
    ) -> np.ndarray:
        """Reported torque (n, 6) of a motion (n, 18: q, qd, qdd) followed exactly; the transmission
        is rigid."""
        tau = native.prescribed(*self.structures(effects), start, dt, moving)
        return _reported(start + dt * np.arange(len(tau)), tau, effects)

    def unexplained_torque(self, effects: Sized, move: Motion) -> np.ndarray:
        """Reported torque less what the plain arm needs for the motion made, below 10 Hz, 0 near
        standstill."""
        from scipy.ndimage import maximum_filter1d

        record = self.closed_loop(effects, move)[1][::STREAM]
        dt = STREAM / native.RECORD_RATE
        moving = np.hstack([record[:, :12], np.gradient(record[:, 6:12], dt, axis=0)])
        residual = below_10_hz(record[:, 12:] - self.asked_torque((), dt, moving))
        still = maximum_filter1d(np.abs(record[:, 6:12]) < 0.02, 25, axis=0)
        return np.where(still, 0.0, residual)


def _reported(time: np.ndarray, tau: np.ndarray, effects: Sized) -> np.ndarray:
    for drawn, size in effects:
        if drawn.recipe.where == "chain":
            tau = arm_changes.measured_torque(time, tau, drawn, size)
    return tau
