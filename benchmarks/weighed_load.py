"""Gains of the torque channels from a load that was weighed: do the true ones lie where is said?

    python benchmarks/weighed_load.py [--arms 20] [--first 32000]

Arms of the independent plant whose bodies can exist, each drawn within the uncertainty of a data
sheet, whose channels read a gain drawn from exp(N(0, 0.15^2)). A motion without a load, and another
one with 3 to 12 kg of which mass and centre are stated, not the inertia; that day all friction is
0.8 to 1.1 times as large, and the channels have other offsets. Printed: how far the gains found are
off, in their standard errors, and how many lie inside their 95 % intervals.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from identification.possible_arms import PossibleCase, log_of, possible_robot
from independent_plant.arm_changes import _lump
from independent_plant.machine import Machine
from independent_plant.parameters import FLANGE_OFFSET

import irb2400_ctrl as irb
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.identification.gains import Gains
from irb2400_ctrl.identification.known_load.gains_from_load import weighed_load
from irb2400_ctrl.robot import Body

SPREAD = 0.15
SECONDS = 30.0
INSIDE = 1.96


def drawn(robot: irb.Robot, seed: int) -> tuple[irb.Log, irb.Log, Body, np.ndarray]:
    """A log without and one with a load, the load as stated, and the true gains (n,)."""
    rng = np.random.default_rng([seed, 80])
    gains = np.exp(SPREAD * rng.standard_normal(robot.n))
    mass = rng.uniform(3.0, 12.0)
    centre = rng.uniform([-0.08, -0.08, 0.03], [0.08, 0.08, 0.2])
    case = PossibleCase(robot, seed, SECONDS)
    light = log_of(case, name="without")
    machine = case.machine
    flange = np.array([0.0, 0.0, FLANGE_OFFSET])
    load = _lump(mass, centre + flange, rng.uniform(0.03, 0.12))
    other = PossibleCase(robot, seed + 500_000, SECONDS)
    friction = machine.friction.copy()
    friction[:, :3] *= rng.uniform(0.8, 1.1)
    arm = replace(machine.arm, payload=load)
    other.__dict__["machine"] = Machine(arm, friction, machine.servo)
    heavy = log_of(other, name="with the load")
    offset = 0.01 * rng.standard_normal(robot.n) * np.abs(light.tau).max(axis=0)
    stated = Body(mass_kg=mass, com_m=tuple(centre), inertia_kgm2=(0.0,) * 6)
    read = replace(light, tau=light.tau * gains)
    return read, replace(heavy, tau=heavy.tau * gains + offset), stated, gains


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--arms", type=int, default=20)
    parser.add_argument("--first", type=int, default=32000)
    args = parser.parse_args()
    robot = possible_robot()
    off: list[float] = []
    percent: list[float] = []
    refused = 0
    for seed in range(args.first, args.first + args.arms):
        light, heavy, load, true = drawn(robot, seed)
        try:
            found: Gains = weighed_load(robot, [light], [heavy], load)[0]
        except InputError as error:
            refused += 1
            print(f"arm {seed}: refused: {error}", flush=True)
            continue
        z = ((found.values - true) / found.errors)[found.known]
        off += z.tolist()
        percent += (100.0 * (found.values / true - 1.0))[found.known].tolist()
        told = " ".join(f"{v:+.1f}" for v in z)
        print(f"arm {seed}, {load.mass_kg:.1f} kg: {len(z)} known, off by {told}", flush=True)
    size = np.abs(np.array(off))
    print(
        f"{len(size)} gains known on {args.arms - refused} arms, {refused} refused; "
        f"{100 * np.mean(size < INSIDE):.1f} % inside, {size.max():.1f} standard errors at most; "
        f"off by {np.median(np.abs(percent)):.2f} % in the median, {np.abs(percent).max():.1f} at "
        "most"
    )


if __name__ == "__main__":
    main()
