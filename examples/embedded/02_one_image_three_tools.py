"""Can one image on the controller board serve three tools? It is compiled once; a table per tool
says what the arm carries and how its hose pulls.

The robot file names the effect that some tool has (a hose that pulls at axis 4) with size zero:
that makes it a row of the table. `three_tools.c` fills three tables, has NAME_init test them and
switches between them from one sample to the next. What it commands is compared with a controller
that was made for the robot with that tool alone.

    python examples/embedded/02_one_image_three_tools.py [FOLDER]

Needs a C compiler.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np

import irb2400_ctrl as irb
from irb2400_ctrl.codegen import compile_block, export_package
from irb2400_ctrl.codegen.machine_code.toolchain import find_compiler
from irb2400_ctrl.controllers import controller

HERE = Path(__file__).parent
folder = Path(sys.argv[1] if len(sys.argv) > 1 else "out/three_tools")
robot = irb.load_robot("irb2400")


def carrying(*effects: dict[str, object]) -> irb.Robot:
    return irb.Robot.model_validate(robot.model_dump() | {"effects": effects})


def payload(mass: float, com: tuple[float, float, float]) -> dict[str, object]:
    return {"kind": "payload", "mass_kg": mass, "com_m": com}


# The image: the hose is in its table, its size zero
hose = {"kind": "cable_spring", "joint": 4, "stiffness_Nm_rad": 0.0}
image = controller("computed_torque", carrying(hose), tables=True)
verification = export_package(image, folder, name="arm", real="float")
print(verification.table())

shutil.copy(HERE / "three_tools.c", folder)
build = [*find_compiler().command, "-std=c99", "-O2", "arm.c", "three_tools.c", "-o", "three_tools"]
subprocess.run(build, cwd=folder, check=True)
lines = subprocess.run(
    [folder.resolve() / "three_tools"], check=True, capture_output=True, text=True
).stdout.splitlines()

# The same three robots, each with a controller of its own, at the input of the C program
q = [0.3, 0.2, -0.1, 0.5, 0.8, 0.4]
qd = [0.2, 0.1, -0.3, 0.4, 0.2, -0.5]
qdd = [1.0, -0.5, 0.5, 2.0, -2.0, 3.0]
tools = {
    "spindle": carrying(),
    "gripper": carrying(payload(4.5, (0.02, -0.01, 0.12))),
    "torch": carrying(
        payload(2.5, (0.05, 0.0, 0.2)), hose | {"stiffness_Nm_rad": 6.0, "neutral_rad": 0.4}
    ),
}
worst = 0.0
for (name, arm), line in zip(tools.items(), lines, strict=True):
    told, status, *torques = line.split()
    made_for = compile_block(controller("computed_torque", arm))
    _, expected = made_for.step(made_for.initial_state, [*q, *qd, *q, *qd, *qdd])
    difference = np.abs(np.array(torques, float) - expected).max()
    worst = max(worst, difference if told == name and status == "0" else np.inf)
    print(f"{name:8} {np.round(expected, 2)} Nm, the image differs by {difference:.1e} Nm at most")
print(f"written: {folder}")
sys.exit(0 if worst < 1e-3 and verification.passed else 1)
