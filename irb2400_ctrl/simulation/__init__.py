"""The simulated arm: plant, instruments, closed loop in generated C, and what came out."""

from irb2400_ctrl.simulation.close_the_loop import ClosedLoop, close_loop
from irb2400_ctrl.simulation.instruments import IDEAL_ACTUATORS, IDEAL_SENSORS, Actuators, Sensors
from irb2400_ctrl.simulation.perturb import perturbed_robot
from irb2400_ctrl.simulation.plant import plant_block
from irb2400_ctrl.simulation.simulate import Loop, make_loop, simulate
from irb2400_ctrl.simulation.simulation import Simulation
from irb2400_ctrl.trajectory import Trajectory, from_angles, load_trajectory

__all__ = [
    "IDEAL_ACTUATORS",
    "IDEAL_SENSORS",
    "Actuators",
    "ClosedLoop",
    "Loop",
    "Sensors",
    "Simulation",
    "Trajectory",
    "close_loop",
    "from_angles",
    "load_trajectory",
    "make_loop",
    "perturbed_robot",
    "plant_block",
    "simulate",
]
