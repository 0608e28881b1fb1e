"""What a diagnosed effect is worth to the controller: the same motion before and after, on an arm that has it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from irb2400_ctrl.codegen import Block
from irb2400_ctrl.controllers import controller as make_controller
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.simulation.perturb import perturbed_robot
from irb2400_ctrl.simulation.result import Simulation
from irb2400_ctrl.simulation.simulate import simulate
from irb2400_ctrl.simulation.trajectory import Trajectory

PLANT_SEED = 7
"""only makes the result repeatable"""


@dataclass(frozen=True)
class ClosedLoop:
    """Tracking of one motion by the controller of the robot as given and of the robot as diagnosed."""

    controller: str
    plant: Robot
    before: Simulation
    after: Simulation

    def summary(self) -> dict[str, Any]:
        """The figures of both runs, as in simulation.json."""
        return {"before": self.before.summary(), "after": self.after.summary()}


def close_loop(
    given: Robot,
    diagnosed: Robot,
    trajectory: Trajectory,
    *,
    controller: str = "feedforward_pid",
    plant: Robot | None = None,
) -> ClosedLoop:
    """Track `trajectory` with `controller` made from either description, on an arm that has what was found.

    Args:
        given: the robot before the diagnosis.
        diagnosed: the robot with what the diagnosis found.
        controller: name of the controller; the same structure and design rule for both.
        plant: the simulated arm; default the diagnosed robot with masses, centres of mass, inertias and friction drawn
            anew within data-sheet uncertainty, so that it has the effect and neither controller knows it exactly.
    """
    plant = perturbed_robot(diagnosed, PLANT_SEED) if plant is None else plant

    def run(robot: Robot) -> Simulation:
        block: Block = make_controller(controller, robot)
        return simulate(robot, trajectory, block, plant=plant)

    return ClosedLoop(controller, plant, run(given), run(diagnosed))
