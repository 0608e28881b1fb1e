"""What a diagnosed effect is worth to the controller: the same motion before and after, on an arm that has it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from irb2400_ctrl.codegen import Block
from irb2400_ctrl.controllers import controller as make_controller
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.simulation.result import Simulation
from irb2400_ctrl.simulation.simulate import simulate
from irb2400_ctrl.simulation.trajectory import Trajectory


@dataclass(frozen=True)
class ClosedLoop:
    """Tracking of one motion by the controller of the robot as given and of the robot as diagnosed."""

    controller: str
    motion: str
    plant: Robot
    before: Simulation
    after: Simulation

    @property
    def improvement(self) -> float:
        """RMS TCP error before over after [-]."""
        return rms(self.before) / rms(self.after)


def close_loop(
    given: Robot, diagnosed: Robot, trajectory: Trajectory, *, plant: Robot, controller: str, motion: str
) -> ClosedLoop:
    """Track `trajectory` on `plant` with `controller` made from either description of the robot.

    Args:
        given: the robot before the diagnosis.
        diagnosed: the robot with what the diagnosis found.
        plant: the simulated arm, which has the effect; best one whose other parameters differ from both.
        controller: name of the controller; the same structure and gains rule for both.
        motion: what the trajectory is, in words.
    """

    def run(robot: Robot) -> Simulation:
        block: Block = make_controller(controller, robot)
        return simulate(robot, trajectory, block, plant=plant)

    return ClosedLoop(controller, motion, plant, run(given), run(diagnosed))


def rms(run: Simulation) -> float:
    """RMS TCP error [m]."""
    return float(np.sqrt(np.mean(run.tcp_error**2)))
