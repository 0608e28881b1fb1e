"""No arm at hand? One that is not what its file says stands in for it, to record logs from.

    python examples/another_arm/stand_in.py my_arm.toml motion/trajectory.csv monday.csv

Its bodies are off by 15 %, and it has friction, rotors and offsets that the file knows nothing of;
`--effect` gives it more, as a table of a robot file in JSON. It follows the motion as a maker's
drive makes it. `--gears` writes what a recorder of motors would: turns and torques at the motor.
"""

import argparse
import json
from dataclasses import replace
from pathlib import Path

import numpy as np

import irb2400_ctrl as irb
from irb2400_ctrl.effects import LIBRARY, effect_class
from irb2400_ctrl.measurement import Log, write_log
from irb2400_ctrl.robot import Friction
from irb2400_ctrl.simulation import perturbed_robot, simulate
from irb2400_ctrl.trajectory import load_trajectory

NOISE = 0.001
"""of the torque, over the drive's limit"""
ROTOR = 0.007
"""[s2] reflected inertia of a rotor over the drive's limit"""


def drawn(file: irb.Robot, seed: int) -> irb.Robot:
    """The arm as it is: bodies, dry and viscous friction, rotors, offsets of the torque."""
    arm = perturbed_robot(file, seed, mass=0.15, com_m=0.02, inertia=0.2)
    most = file.tau_max
    joints = []
    for joint, torque, speed in zip(file.joints, most, file.qd_max, strict=True):
        friction = Friction(
            static_Nm=0.033 * torque,
            coulomb_Nm=0.03 * torque,
            viscous_Nms_rad=0.03 * torque / speed,
            stribeck_rad_s=0.03,
        )
        joints.append(joint.model_copy(update={"friction": friction}))
    arm = arm.model_copy(update={"joints": tuple(joints)})
    offsets = 0.004 * most * np.random.default_rng(seed).standard_normal(arm.n)
    effects = []
    for j in range(arm.n):
        effects.append(LIBRARY["rotor_inertia"].of(j + 1, inertia_kgm2=ROTOR * most[j]))
        effects.append(LIBRARY["torque_offset"].of(j + 1, offset_Nm=offsets[j]))
    return arm.with_effects(*effects)


def at_the_motors(log: Log, gears: np.ndarray, path: Path) -> None:
    """Turns and torques of the motors, in thousandths of a second."""
    n = log.n
    names = [f"Motor {j + 1} {what}" for what in ("turns", "torque") for j in range(n)]
    turns = log.q / (2 * np.pi) * gears
    table = np.column_stack([1000.0 * log.time, turns, log.tau / gears])
    np.savetxt(path, table, "%.6f", ",", header=",".join(["Time", *names]), comments="")


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("robot", help="its file, or a name")
    parser.add_argument("motion", help="trajectory.csv")
    parser.add_argument("log", help="to be written")
    parser.add_argument("--effect", action="append", default=[], help="JSON, may be given again")
    parser.add_argument("--gears", help="motor turns per joint turn: 100,-120,...")
    parser.add_argument("--seed", type=int, default=1, help="of the arm")
    args = parser.parse_args()
    file = irb.load_robot(args.robot)
    tables = [json.loads(text) for text in args.effect]
    effects = [effect_class(table["kind"]).model_validate(table) for table in tables]
    arm = drawn(file, args.seed).with_effects(*effects)
    log = simulate(arm, load_trajectory(args.motion), "feedforward_pid").log()
    rng = np.random.default_rng(sum(map(ord, args.log)))  # another log, another noise
    noise = NOISE * file.tau_max * rng.standard_normal(log.tau.shape)
    log = replace(log, tau=log.tau + noise)
    path = Path(args.log)
    if args.gears:
        at_the_motors(log, np.array([float(g) for g in args.gears.split(",")]), path)
    else:
        write_log(log, path)
    print(f"{path}: {log.duration:.0f} s of an arm that is not what {args.robot} says")


if __name__ == "__main__":
    main()
