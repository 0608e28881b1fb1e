"""Sound logs of many kinds, drawn: for the tests and the benchmark."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from independent_plant import LIBRARY, Case, Effect, Sensors, native

from irb2400_ctrl.measurement import Log
from irb2400_ctrl.robot import Robot, load_robot


@dataclass(frozen=True)
class Drawn:
    """A log, the robot it is held against, and what was drawn."""

    log: Log
    robot: Robot
    text: str


NEXT = 10_000_000
"""from a seed to the one that is drawn in its place"""
SUBSTEP = 0.00025
"""of the plant's servos [s]"""


def chatters(case: Case, q: np.ndarray) -> bool:
    """Whether a speed loop, once a substep, is unstable somewhere: kv DT M^-1 beyond 2.

    Where a light wrist stretches, the torques then jump from limit to limit 2,000 times a second,
    and a record holds one side of it: no log of an arm.
    """
    effects = tuple((drawn, size) for drawn, size, _ in case.sized_effects)
    bodies = len(case.machine.arm.packed())
    packed = case.machine.structures(effects)[0][bodies : 2 * bodies]
    gains = np.diag(SUBSTEP * case.machine.servo.table[:, 3])
    masses = (
        native.equations_of_motion(packed, row, np.zeros(6))[0] for row in q[:: len(q) // 200]
    )
    return max(np.abs(np.linalg.eigvals(np.linalg.solve(M, gains))).max() for M in masses) > 2.0


def sound_log(seed: int, plain: bool = False) -> Drawn:
    """A sound log: arm, effects, payload, motion, rate, digits, jitter, loss, channels drawn.

    Args:
        plain: only the arm, its motion and moderate rates vary (to be corrupted afterwards).
    """
    rng = np.random.default_rng([seed, 77])
    effects: tuple[Effect, ...] = ()
    slow = ("elastic_joint", "transmission_backlash", "time_delay")
    kinds = [k for k in LIBRARY if k not in slow]
    if not plain:
        if rng.uniform() < 0.4:
            effects += (Effect(str(rng.choice(kinds)), None, float(rng.uniform(0.02, 0.15))),)
        if rng.uniform() < 0.4 and not any(e.kind == "payload" for e in effects):
            effects += (Effect("payload", None, float(rng.uniform(0.05, 0.4))),)
    sensors = (
        Sensors()
        if plain
        else Sensors(
            angle_step=float(10.0 ** rng.uniform(-6, -3.3)),
            angle_noise=float(10.0 ** rng.uniform(-6, -4.5)),
            torque_noise=tuple(rng.uniform(0.5, 4.0) * np.array([1.2, 2.0, 1.2, 0.35, 0.3, 0.3])),
            lost=float(rng.choice([0.0, 0.002, 0.05])),
        )
    )
    idle = (int(rng.integers(1, 7)),) if not plain and rng.uniform() < 0.2 else ()
    case = Case(
        seed,
        effects,
        duration=float(rng.uniform(8.0, 40.0)),
        validation_duration=float(rng.uniform(8.0, 30.0)),
        spread=1.0 if plain else float(rng.uniform(0.5, 2.5)),
        idle=idle,
        chirp=bool(rng.uniform() < 0.2),
        sensors=sensors,
    )
    which = int(rng.uniform() < 0.4)
    recorded = case.recorded(which)
    if chatters(case, recorded.q):
        return sound_log(seed + NEXT, plain)
    log = Log(recorded.time, recorded.q, recorded.tau, qd=recorded.qd, q_ref=recorded.q_ref)
    every = int(rng.choice([1, 1, 2, 5] if plain else [1, 1, 2, 5, 10, 20]))
    log = rows_of(log, slice(None, None, every))
    robot = load_robot("irb2400")
    text = f"effects {[e.kind for e in effects]} motion {which} every {every} idle {idle}"
    if not plain:
        log, robot, more = _varied(log, robot, rng)
        text += more
    return Drawn(replace(log, name=f"sound {seed}"), robot, text)


def _varied(log: Log, robot: Robot, rng: np.random.Generator) -> tuple[Log, Robot, str]:
    """Jitter, bursts of loss, torque digits, channels, and a file whose friction is off."""
    jitter = float(rng.choice([0.0, 0.0, 2e-4, 1e-3]))
    shaken = log.time + rng.uniform(-jitter, jitter, len(log.time))
    digit = float(rng.choice([0.0, 0.0, 0.001, 0.01])) * robot.tau_max
    tau = np.where(digit > 0, np.round(log.tau / np.where(digit > 0, digit, 1.0)) * digit, log.tau)
    log = replace(log, time=np.maximum.accumulate(shaken) + 1e-9 * np.arange(len(shaken)), tau=tau)
    if rng.uniform() < 0.3:
        bursts = np.repeat(rng.uniform(size=len(log.time) // 8 + 1) < 0.85, 8)[: len(log.time)]
        bursts[[0, -1]] = True
        log = rows_of(log, bursts)
    if rng.uniform() < 0.5:
        log = replace(log, qd=None)
    if rng.uniform() < 0.5:
        log = replace(log, q_ref=None)
    factor = float(np.exp(rng.uniform(np.log(0.6), np.log(1.6))))
    joints = []
    for joint in robot.joints:
        f = joint.friction
        scaled = {
            "static_Nm": factor * f.static_Nm,
            "coulomb_Nm": factor * f.coulomb_Nm,
            "viscous_Nms_rad": factor * f.viscous_Nms_rad,
        }
        joints.append(joint.model_copy(update={"friction": f.model_copy(update=scaled)}))
    text = f" jitter {1e3 * jitter:.1f} ms digits {digit[1]:.1f} Nm friction x {factor:.2f}"
    return log, robot.model_copy(update={"joints": tuple(joints)}), text


def rows_of(log: Log, keep: slice | np.ndarray) -> Log:
    """Some samples of a log."""
    picked = {k: getattr(log, k) for k in ("q", "tau", "qd", "q_ref")}
    return Log(
        log.time[keep],
        **{k: None if v is None else v[keep] for k, v in picked.items()},
        name=log.name,
    )
