"""Faults of a controller's inputs on the independent plant, with a brake that takes its time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from independent_plant import native
from independent_plant.case import Case
from independent_plant.machine import Machine
from independent_plant.native import RECORD_RATE
from independent_plant.parameters import TORQUE_LIMITS

from irb2400_ctrl.codegen.controller import HostController
from irb2400_ctrl.codegen.package import Package

T = 1.0 / RECORD_RATE
BRAKE_DELAY = 20
"""samples from the signal until the brake holds"""
SPEED_CORNER = 2 * np.pi * 250.0
Angles = list[np.ndarray]
Fault = Callable[[int, Angles, Angles], np.ndarray | None]
"""(samples since the fault began, true angles up to now, angles that arrived before) -> angles that
arrive, None: lost"""


@dataclass(frozen=True)
class Outcome:
    """What a fault did; angles in degrees."""

    brake_ms: float | None
    """from the fault to the signal; None: no brake"""
    largest_error_deg: float
    """of any axis, from its reference, which stands still once the brake is signalled"""
    largest_step_Nm: float
    """of the command from one sample to the next"""
    faults: int
    """samples that the package itself refused"""


class _Brake:
    """Holds each axis where it has come to rest; slips at the torque limit."""

    def __init__(self, arm: np.ndarray) -> None:
        self.arm = arm
        self.at: np.ndarray | None = None

    def torque(self, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
        if self.at is None:
            self.at = q.copy()
        mass, bias = native.equations_of_motion(self.arm, q, qd)
        felt = 1 / np.diag(np.linalg.inv(mass))
        # as stiff as samples of a millisecond allow
        wanted = bias + felt * (0.04 * (self.at - q) / T**2 - 0.3 * qd / T)
        self.at = np.where(np.abs(wanted) > TORQUE_LIMITS, q, self.at)
        return np.clip(wanted, -TORQUE_LIMITS, TORQUE_LIMITS)


def run_with_fault(case: Case, package: Package, begin: int, fault: Fault) -> Outcome:
    """The validation motion by a block's C package; `fault` acts from sample `begin` on."""
    reference = case.motions[1].q
    speed = np.gradient(reference, T, axis=0)
    acceleration = np.gradient(speed, T, axis=0)
    controller = HostController(package)
    brake = _Brake(case.machine.arm.packed())
    share = 1 - np.exp(-SPEED_CORNER * T)
    seen: Angles = []
    moving: Angles = [np.zeros(6)]
    true: Angles = []
    commands: Angles = []
    braked: list[int] = []
    refused = [0]

    def measured(sample: int, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
        arrives = q if sample < begin else fault(sample - begin, true, seen)
        # what is lost is lost on its way: the drive has seen it
        angles = q if arrives is None else arrives
        good = np.isfinite(angles)
        before = seen[-1] if seen else q
        difference = np.where(good, angles, 0.0) - np.where(np.isfinite(before), before, 0.0)
        moving.append(moving[-1] + share * (difference / T - moving[-1]))
        seen.append(angles)
        return angles, np.where(good, moving[-1], np.nan), float(arrives is not None)

    def drive(sample: int, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
        true.append(q)
        if braked and sample >= braked[0] + BRAKE_DELAY:
            commands.append(commands[-1])
            return brake.torque(q, qd)
        angles, speeds, fresh = measured(sample, q)
        known = {
            "q": angles,
            "qd": speeds,
            "q_ref": reference[sample],
            "qd_ref": speed[sample],
            "qdd_ref": acceleration[sample],
            "fresh": np.array([fresh]),
        }
        out, status = controller.step(np.concatenate([known[f.name] for f in package.block.inputs]))
        refused[0] += int(status != 0)
        commands.append(out[:6].astype(float))
        if len(out) > 6 and out[6] > 0.5 and not braked:
            braked.append(sample)
        return commands[-1]

    case.drive(drive)
    stop = braked[0] if braked else len(reference)
    rows = np.minimum(np.arange(len(true)), stop)
    error = np.abs(np.degrees(np.array(true) - reference[np.minimum(rows, len(reference) - 1)]))
    return Outcome(
        brake_ms=float(braked[0] - begin) if braked else None,
        largest_error_deg=float(error.max()),
        largest_step_Nm=float(np.abs(np.diff(commands[100:], axis=0)).max()),
        faults=refused[0],
    )


def off_model(case: Case, load: float, friction: float) -> Case:
    """The case with a load that nobody told [kg], 165 mm from the flange, and `friction` times its
    friction."""
    drawn = case.machine
    body = np.array([load, 0, 0, 0.25, *[0.01 * load] * 3, 0, 0, 0])
    table = drawn.friction * np.array([friction, friction, friction, 1.0])
    # a cached property: what is asked of the case from now on asks this machine
    carries = replace(drawn.arm, payload=body if load else None)
    case.__dict__["machine"] = Machine(carries, table, drawn.servo)
    return case


def _spoilt(q: np.ndarray, axis: int, value: float) -> np.ndarray:
    wrong = q.copy()
    wrong[axis] = value
    return wrong


def scaled(axis: int, share: float) -> Fault:
    """The axis reports that share of what it has moved since the fault."""

    def fault(k: int, true: Angles, seen: Angles) -> np.ndarray:
        at_first = float(true[-1 - k][axis])
        return _spoilt(true[-1], axis, at_first + share * (float(true[-1][axis]) - at_first))

    return fault


def drifting(axis: int, rate: float) -> Fault:
    """The axis reports its angle and `rate` [rad/s] times the time since the fault."""
    return lambda k, true, seen: _spoilt(true[-1], axis, float(true[-1][axis]) + rate * T * k)


def _nothing(q: np.ndarray) -> np.ndarray:
    return np.full_like(q, np.nan)


PASSING: dict[str, Fault] = {
    "none": lambda k, true, seen: true[-1],
    "lost, 15 samples": lambda k, true, seen: None if k < 15 else true[-1],
    "no numbers, 10 samples": lambda k, true, seen: _nothing(true[-1]) if k < 10 else true[-1],
    "zeroed, 10 samples": lambda k, true, seen: 0 * true[-1] if k < 10 else true[-1],
}
"""what the arm has to work through"""
LASTING: dict[str, Fault] = {
    "lost for ever": lambda k, true, seen: None,
    "no numbers for ever": lambda k, true, seen: _nothing(true[-1]),
    "infinite, one axis": lambda k, true, seen: _spoilt(true[-1], 4, np.inf),
    "late by 3 samples": lambda k, true, seen: true[-4],
    "late by 30 samples": lambda k, true, seen: true[-31],
    "the same sample for ever": lambda k, true, seen: seen[-1],
    "repeated, every second": lambda k, true, seen: seen[-1] if k % 2 else true[-1],
    "stuck, axis 1": lambda k, true, seen: _spoilt(true[-1], 0, float(seen[-1][0])),
    "stuck, axis 5": lambda k, true, seen: _spoilt(true[-1], 4, float(seen[-1][4])),
    "zeroed": lambda k, true, seen: 0 * true[-1],
    "sign flipped": lambda k, true, seen: -true[-1],
    "corrupted, every third": lambda k, true, seen: true[-1] + 0.7 * (k % 3 == 0),
    "lies: creeps by 0.3 rad/s": drifting(1, 0.3),
    "lies: half of every move": scaled(1, 0.5),
}
"""what has to close the brake"""
LIES: dict[str, Callable[[int], Fault]] = {
    "half of every move": lambda axis: scaled(axis, 0.5),
    "0.8 of every move": lambda axis: scaled(axis, 0.8),
    "wrong sign": lambda axis: scaled(axis, -1.0),
    "drifts by 5 deg/s": lambda axis: drifting(axis, float(np.radians(5.0))),
}
"""what the encoder of an axis (0-5) may do"""
