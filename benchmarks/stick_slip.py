"""How exactly the plant follows stick and slip: all axes driven by torques about gravity, from 20
drawn poses, against 32 times finer steps.

    python benchmarks/stick_slip.py [POSES] [SEED]

Prints, per time step, the median and the largest of the poses' angle errors over 0.5 s [rad].
"""

from __future__ import annotations

import sys

import numpy as np

import irb2400_ctrl as irb
from irb2400_ctrl.codegen import compile_block
from irb2400_ctrl.simulation.plant import plant_block

PERIOD = 1e-3
STEPS = (1, 2, 4, 8)
FINE = 32
SIZE_NM = np.array([150.0, 150, 80, 25, 45, 14])
RATE_HZ = np.array([2.0, 2.3, 3.1, 4.3, 2.7, 3.9])


def main(poses: int, seed: int) -> None:
    """Run all poses with every step and print the table."""
    robot = irb.load_robot("irb2400")
    model = irb.Model(robot)
    rng = np.random.default_rng(seed)
    time = np.arange(500)[:, None] * PERIOD
    plants = {
        steps: compile_block(plant_block(robot, PERIOD / steps, sweeps=6 if steps == FINE else 2))
        for steps in (*STEPS, FINE)
    }
    errors = []
    for _ in range(poses):
        q = rng.uniform(0.6 * robot.q_min, 0.6 * robot.q_max)
        swing = SIZE_NM * np.sin(2 * np.pi * (RATE_HZ * time + rng.uniform(size=6)))
        tau = model.gravity(q) + swing
        angles = {}
        for steps, plant in plants.items():
            x0 = plant.initial_state
            x0[:6] = q
            states, _ = plant.rollout(np.repeat(tau, steps, axis=0), x0=x0)
            angles[steps] = plant.split(plant.block.states, states[::steps])["q"]
        errors.append([np.abs(angles[steps] - angles[FINE]).max() for steps in STEPS])
    print(f"{poses} poses, seed {seed}; largest angle error over 0.5 s [rad]")
    for steps, median, worst in zip(
        STEPS, np.median(errors, axis=0), np.max(errors, axis=0), strict=True
    ):
        print(f"{1e3 * PERIOD / steps:6.3f} ms: median {median:.1e}, largest {worst:.1e}")


if __name__ == "__main__":
    given = [int(word) for word in sys.argv[1:]]
    main(*given, *(20, 1)[len(given) :])
