"""How fast can computed torque be made, with 1 ms sampling, one sample of delay and a filtered
speed?"""

import numpy as np

import irb2400_ctrl as irb
from irb2400_ctrl.codegen import compile_block
from irb2400_ctrl.controllers.design import Timing, computed_torque_with, over_poses, shape_loop
from irb2400_ctrl.simulation import from_angles, perturbed_robot, simulate

robot = irb.load_robot("irb2400")
timing = Timing(sample_time=0.001, delay_samples=1, speed_filter_Hz=250.0)
designs = [shape_loop(w, np.radians(60), timing) for w in (90, 90, 90, 120, 120, 120)]
controller = computed_torque_with(robot, designs)
time = np.linspace(0, 3, 61)
swing = np.sin(time)[:, None] ** 2 * [0.8, 0.3, -0.2, 1.0, 0.7, -1.0]
motion = from_angles(time, swing + np.array([0, 0.2, -0.1, 0, 0.6, 0]))
run = simulate(robot, motion, controller, plant=perturbed_robot(robot, seed=1))
print("joint 1:", designs[0].margins)
print(
    "all joints, stretched wrist:", over_poses(robot, controller, [0, 0.2, -0.1, 0.3, 0, 0], timing)
)
print(
    f"TCP error {1e3 * run.tcp_error.max():.2f} mm at most, {run.real_time_factor:.0f} times real "
    "time"
)
print(
    "torque of one step in C:", compile_block(controller).step([], np.zeros(30))[1].round(1), "Nm"
)
