"""The main job: plan a part, track it, find what the model lacks, close the loop. Every step on
committed input."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import resources
from pathlib import Path

from irb2400_ctrl.codegen import Verification, export_package
from irb2400_ctrl.controllers import controller, guarded
from irb2400_ctrl.diagnosis import Diagnosis, diagnose
from irb2400_ctrl.measurement import Log, read_log, recorded_motion
from irb2400_ctrl.planners import Plan, plan_path, read_path
from irb2400_ctrl.robot import Robot, load_robot
from irb2400_ctrl.simulation import Simulation, perturbed_robot, simulate
from irb2400_ctrl.simulation.close_the_loop import ClosedLoop, close_loop
from irb2400_ctrl.simulation.perturb import PLANT_SEED
from irb2400_ctrl.typed import typed

DATA = Path(str(resources.files("irb2400_ctrl") / "data"))
TOOLPATH = DATA / "freeform.apt"
ARM = DATA / "arm"
TRACKED_WITH = ("pid", "feedforward_pid", "computed_torque")
GENERATED = ("computed_torque", "feedforward_pid")
# what the planner may use of the torque limits; the rest is the controller's, for what the model
# does not know
TORQUE_SHARE = 0.9


@dataclass(frozen=True)
class MainJob:
    """Everything the report shows."""

    robot: Robot
    plan: Plan
    packages: dict[str, Verification]
    tracking: dict[str, Simulation]
    log: Log
    diagnosis: Diagnosis
    closed_loop: ClosedLoop


@typed
def run_main_job(out: Path, say: Callable[[str], None] = lambda text: None) -> MainJob:
    """Run every step and write its files under `out`; `say` is told what is going on."""
    robot = load_robot("irb2400")

    say("planning the toolpath")
    plan = plan_path(robot, read_path(TOOLPATH), torque_share=TORQUE_SHARE)
    plan.write(out / "plan")

    packages = {}
    for name in GENERATED:
        say(f"generating C: {name}")
        block = guarded(controller(name, robot), robot)
        packages[name] = export_package(block, out / "c" / name, target="host")

    # it differs from the model within the uncertainty of the data sheet
    plant = perturbed_robot(robot, PLANT_SEED)
    tracking = {}
    for name in TRACKED_WITH:
        say(f"closed loop: {name}")
        block = guarded(controller(name, robot), robot)
        tracking[name] = simulate(robot, plan.trajectory, block, plant=plant)
        tracking[name].write(out / "tracking" / name)

    say("comparing log and model")
    log = read_log(ARM / "identification.csv.gz")
    validation = read_log(ARM / "validation.csv.gz")
    diagnosis = diagnose(robot, log, validation=validation)
    diagnosis.write(out / "diagnosis")

    say("closing the loop")
    loop = close_loop(robot, diagnosis.robot, recorded_motion(log))
    return MainJob(robot, plan, packages, tracking, log, diagnosis, loop)
