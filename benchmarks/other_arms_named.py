"""Names of what has changed on drawn arms of other makes, each identified first.

    python -m benchmarks.other_arms_named [--arms 24] [--first 1]

The arms are those of `benchmarks.other_arms`: six or seven axes, torques of pinocchio, a file whose
bodies are wrong by 10 to 40 %. Two logs identify the arm; a third, of the same arm, and a fourth,
to which one effect has come, are diagnosed with the robot file that came out. Right: the effect's
kind and joint are named. False: another kind, but for those that every arm has here and no robot
file keeps (`OWN`); on the third log, any other.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from benchmarks.other_arms import (
    DrawnArm,
    Motion,
    arm,
    as_file,
    bodies,
    frames,
    misread,
    motion,
    moved,
    seeds,
)
from irb2400_ctrl.diagnosis import Diagnosis, diagnose
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.identification import identify
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.robot import Robot

OWN = {"hysteresis", "gear_ripple", "load_friction", "viscous_power"}
"""presliding, ripple, friction that grows with load, and with a power of speed"""
KINDS = (
    *("payload", "torque_offset", "torque_gain", "time_delay", "coulomb_change"),
    *("viscous_change", "coulomb_asymmetry", "cable_spring", "encoder_zero", "rotor_inertia"),
    "process_force",
)
WHOLE = {"payload", "time_delay", "process_force"}
"""of no joint alone"""
LEVER = 0.12
"""[m] of a load behind the flange"""
PUSH = (0.3, 0.55)
"""shares of the log between which a force acts"""


@dataclass(frozen=True)
class Drawn:
    """An arm's file, the logs it is identified from, one like them, and one with an effect."""

    robot: Robot
    logs: tuple[Log, Log]
    same: Log
    changed: Log
    kind: str
    joint: int | None


class Change:
    """An effect of a kind on a joint (from 0), of a share of its torque."""

    def __init__(
        self,
        rng: np.random.Generator,
        kind: str,
        drawn: DrawnArm,
        chain: list[np.ndarray],
        true: np.ndarray,
    ) -> None:
        self.rng = rng
        self.kind = kind
        self.drawn = drawn
        self.chain = chain
        self.true = true
        self.joint = int(rng.integers(len(chain)))
        if kind == "encoder_zero":
            # no torque changes with the angle of an upright first axis
            self.joint = max(self.joint, 1)
        self.share = float(rng.uniform(0.12, 0.3))

    def __call__(
        self, m: Motion, tau: np.ndarray, dry: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Angles and torques that are recorded."""
        j = self.joint
        size = self.share * self.drawn.scale[j]
        seen = m.q.copy()
        tau = tau.copy()
        match self.kind:
            case "payload":
                tau += moved(self.chain, self._loaded(), m.q).tau - m.tau
            case "process_force":
                tau += self._pushed(m)
            case "torque_gain":
                tau[:, j] *= 1.0 - self.share
            case "time_delay":
                late = int(self.rng.integers(8, 25))
                tau = np.vstack([np.repeat(tau[:1], late, axis=0), tau[:-late]])
            case "encoder_zero":
                seen[:, j] -= np.radians(self.rng.uniform(1.5, 4.0))
            case _:
                tau[:, j] += size * self._shape(m, dry)
        return seen, tau

    def _shape(self, m: Motion, dry: np.ndarray) -> np.ndarray:
        """Of one on a joint's torque, (m,), about one large."""
        j = self.joint
        angle = m.q[:, j]
        shapes = {
            "torque_offset": np.ones_like(angle),
            "coulomb_change": dry[:, j],
            "viscous_change": m.qd[:, j] / self.drawn.speed[j],
            "coulomb_asymmetry": np.abs(dry[:, j]),
            "cable_spring": (angle - angle.mean() - 0.2) / angle.std(),
            "rotor_inertia": m.qdd[:, j] / self.drawn.push[j],
        }
        return shapes[self.kind]

    def _loaded(self) -> np.ndarray:
        """Bodies with a load of two to five per cent of the arm's mass behind the last axis."""
        rows = self.true.copy()
        last = rows[-1]
        mass = 0.15 * self.share * rows[:, 0].sum()
        at = np.array([0.0, 0.0, LEVER])
        total = last[0] + mass
        reduced = last[0] * mass / total
        r = at - last[1:4]
        inertia = reduced * ((r @ r) * np.eye(3) - np.outer(r, r))
        last[4:] += (*np.diag(inertia), inertia[0, 1], inertia[0, 2], inertia[1, 2])
        last[1:4] = (last[0] * last[1:4] + mass * at) / total
        last[0] = total
        return rows

    def _pushed(self, m: Motion) -> np.ndarray:
        """Torques of a force on the flange that acts for some seconds, along axes of the base."""
        import pinocchio as pin

        model = pin.Model()
        parent = 0
        for X in self.chain:
            parent = model.addJoint(parent, pin.JointModelRZ(), pin.SE3(X), f"j{parent}")
        data = model.createData()
        reach = sum(np.linalg.norm(X[:3, 3]) for X in self.chain)
        force = self.rng.normal(size=3) * self.share * self.drawn.scale[1] / (0.5 * reach)
        first, last = (round(share * len(m.q)) for share in PUSH)
        tau = np.zeros_like(m.q)
        for i in range(first, last):
            pin.computeJointJacobians(model, data, m.q[i])
            J = pin.getJointJacobian(model, data, parent, pin.LOCAL_WORLD_ALIGNED)
            tau[i] = -J[:3].T @ force
        return tau


def drawn_arm(seed: int) -> Drawn:
    """The arm of a seed, and an effect of the kind whose turn it is."""
    rng = np.random.default_rng([seed, 2401])
    n = 7 if rng.random() < 0.35 else 6
    chain = frames(rng, n)
    true = bodies(rng, n, rng.uniform(0.4, 1.8))
    wrong = float(np.exp(rng.uniform(np.log(0.1), np.log(0.4))))
    robot = arm(f"drawn {seed}", chain, as_file(misread(rng, true, wrong)))
    rate = float(rng.choice([100.0, 125.0, 250.0]))
    kinds = ("sines", str(rng.choice(["sines", "poses"])), "poses", "sines")
    motions = [moved(chain, true, motion(rng, n, 30.0, kind)) for kind in kinds]
    drawn = DrawnArm(rng, chain, motions)
    change = Change(rng, KINDS[seed % len(KINDS)], drawn, chain, true)
    logs = [
        drawn.log(rng, one, rate, f"motion {k + 1}", change if k == 3 else None)
        for k, one in enumerate(motions)
    ]
    joint = None if change.kind in WHOLE else change.joint + 1
    return Drawn(robot, (logs[0], logs[1]), logs[2], logs[3], change.kind, joint)


def names(found: Diagnosis) -> set[tuple[str, int | None]]:
    """Kind and joint of every effect that is named."""
    return {(one.effect.kind, one.effect.joint) for one in found.findings}


def main() -> None:
    """Command line."""
    right = 0
    false = [0, 0]
    arms = 0
    for seed in seeds(__doc__ or ""):
        one = drawn_arm(seed)
        try:
            robot = identify(one.robot, one.logs).robot
            told = [diagnose(robot, log) for log in (one.same, one.changed)]
        except InputError as error:
            print(f"{seed:4d} refused: {str(error).split(';')[0]}", flush=True)
            continue
        arms += 1
        truth = (one.kind, one.joint)
        found = [names(each) for each in told]
        right += truth in found[1]
        beside = [found[0], found[1] - {truth}]
        wrong = [{name for name in each if name[0] not in OWN} for each in beside]
        false = [count + bool(more) for count, more in zip(false, wrong, strict=True)]
        print(
            f"{seed:4d} {one.kind} {one.joint or ''}: "
            f"{'named' if truth in found[1] else 'not named'}, {told[1].verdict}; false "
            f"{sorted(map(str, wrong[1])) or '-'}; without it {told[0].verdict}, false "
            f"{sorted(map(str, wrong[0])) or '-'}",
            flush=True,
        )
    print(
        f"{right} of {arms} effects named; a false name beside one on {false[1]} logs, without "
        f"on {false[0]}"
    )


if __name__ == "__main__":
    main()
