"""Does the firmware do what the simulation says? The arm is simulated here, its controller runs on
a Cortex-M4F.

The computed-torque controller becomes a C package; the same C file is compiled for this computer
and, as firmware, for an emulated Cortex-M4F. Both steer the same simulated arm along the same
motion for one second. The two recordings must be identical in every bit.

    python examples/embedded/01_processor_in_the_loop.py [FOLDER]

Needs arm-none-eabi-gcc (Debian: gcc-arm-none-eabi) and pip install "irb2400_ctrl[embedded]".
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import irb2400_ctrl as irb
from irb2400_ctrl.codegen import compile_block, export_package
from irb2400_ctrl.codegen.controller import HostController
from irb2400_ctrl.codegen.emulator import TargetController
from irb2400_ctrl.codegen.firmware import build_firmware
from irb2400_ctrl.codegen.in_the_loop import run_in_the_loop
from irb2400_ctrl.codegen.package import Package
from irb2400_ctrl.codegen.targets import find_target
from irb2400_ctrl.controllers import controller
from irb2400_ctrl.simulation.plant import plant_block

STEPS = 1000
HOME = np.radians([0.0, 10.0, 5.0, 0.0, 45.0, 0.0])
SWING = np.radians([10.0, 5.0, 5.0, 15.0, 15.0, 30.0])

folder = Path(sys.argv[1] if len(sys.argv) > 1 else "out/processor_in_the_loop")
robot = irb.load_robot("irb2400")
block = controller("computed_torque", robot)
h = block.sample_time

# The package, verified against the block, and what its step costs on the target
verification = export_package(block, folder, "cortex-m4f")
print(verification.table())

# The plant: the same arm, 3 mrad beside the reference at the start
arm = compile_block(plant_block(robot, h))
start = arm.initial_state
start[:6] = HOME + 3e-3


def plant(x: np.ndarray, tau: np.ndarray) -> np.ndarray:
    return arm.step(x, tau)[0]


def sense(k: int, x: np.ndarray) -> np.ndarray:
    """Measured angles and speeds, then the reference: a swing that starts and ends at rest."""
    phase = np.pi * k / STEPS
    rate = np.pi / (STEPS * h)
    q_ref = HOME + SWING * np.sin(phase) ** 2
    qd_ref = SWING * rate * np.sin(2 * phase)
    qdd_ref = SWING * 2 * rate**2 * np.cos(2 * phase)
    return np.concatenate([x[:12], q_ref, qd_ref, qdd_ref])


package = Package(block, "float")
here = run_in_the_loop(HostController(package), plant, sense, start, STEPS)
firmware = build_firmware(package, find_target("cortex-m4f"))
there = run_in_the_loop(TargetController(firmware), plant, sense, start, STEPS)

time = h * np.arange(STEPS + 1)
reference = np.array([sense(k, start)[12:18] for k in range(STEPS + 1)])
error = np.degrees(there.states[:, :6] - reference)
print(
    f"faults: {np.count_nonzero(there.status)}; largest error after 0.2 s: "
    f"{np.abs(error[200:]).max():.4f} deg"
)
print(f"identical in every bit: {here.same_bits(there)}")

figure = Figure(figsize=(8, 6), layout="constrained")
upper, lower = figure.subplots(2, 1, sharex=True)
upper.plot(time, error, label=[f"axis {i}" for i in range(1, 7)])
upper.set(
    ylabel="angle error [deg]",
    title="Simulated arm, controller as firmware on an emulated Cortex-M4F",
)
upper.legend(ncols=3)
lower.plot(time[:-1], there.outputs)
lower.set(xlabel="time [s]", ylabel="torque command [Nm]")
figure.savefig(folder / "processor_in_the_loop.png", dpi=120)
print(f"written: {folder}")
sys.exit(0 if here.same_bits(there) and verification.passed else 1)
