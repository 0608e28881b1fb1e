"""What a diagnosed effect is worth to the controller: the same motion before and after, on an arm
that has it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from irb2400_ctrl.codegen import Block
from irb2400_ctrl.controllers import controller as make_controller
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.simulation.perturb import PLANT_SEED, perturbed_robot
from irb2400_ctrl.simulation.simulate import simulate
from irb2400_ctrl.simulation.simulation import Simulation
from irb2400_ctrl.trajectory import Trajectory
from irb2400_ctrl.typed import typed

LEFT_OPEN = 0.25
"""share of the data sheet's uncertainty that a log leaves: with it the simulated arm is followed as
well as arms of the independent plant are by controllers made from their diagnosis"""


@dataclass(frozen=True)
class ClosedLoop:
    """Tracking of one motion by a controller made from three descriptions of the arm.

    Args:
        before: from the robot as given.
        recalibrated: from the same with the parameters of the diagnosis, but without the effects it
            found.
        after: from the robot as diagnosed.
    """

    controller: str
    plant: Robot
    before: Simulation
    recalibrated: Simulation
    after: Simulation

    @property
    def runs(self) -> dict[str, Simulation]:
        """The runs by the name of their description."""
        return {"given": self.before, "recalibrated": self.recalibrated, "diagnosed": self.after}

    def summary(self) -> dict[str, Any]:
        """The content of `closed_loop.json`: the figures of all runs."""
        runs = {"before": self.before, "recalibrated": self.recalibrated, "after": self.after}
        return {name: run.summary() for name, run in runs.items()}


@typed
def close_loop(
    given: Robot,
    diagnosed: Robot,
    trajectory: Trajectory,
    *,
    controller: str = "feedforward_pid",
    plant: Robot | None = None,
) -> ClosedLoop:
    """Track `trajectory` with `controller` made from each description, on this library's arm that
    has what was found.

    It shows what a finding is worth if it is right. Whether it is right, the validation log says;
    what findings are worth on arms that share no code with this library, `benchmarks/close_loop.py`
    does.

    Args:
        given: the robot before the diagnosis.
        diagnosed: the robot with what the diagnosis found; of it, what is lasting
            (`Robot.lasting`).
        controller: name of the controller; the same structure and design rule for all.
        plant: the simulated arm; default the diagnosed robot with masses, centres of mass, inertias
            and friction drawn anew within what a log leaves open, so that it has exactly the effect
            and no controller knows the rest.
        trajectory: the motion that is followed.
    """
    diagnosed = diagnosed.lasting()
    plant = perturbed_robot(diagnosed, PLANT_SEED, share=LEFT_OPEN) if plant is None else plant

    def run(robot: Robot) -> Simulation:
        block: Block = make_controller(controller, robot)
        return simulate(robot, trajectory, block, plant=plant)

    recalibrated = diagnosed.model_copy(update={"effects": given.effects})
    return ClosedLoop(controller, plant, run(given), run(recalibrated), run(diagnosed))
