"""How fast can computed torque be made, with 1 ms sampling, one sample of delay and a filtered
speed, and how far off is the tool of twenty arms that differ from their model by a few per cent?"""

import numpy as np

import irb2400_ctrl as irb
from irb2400_ctrl.codegen import compile_block
from irb2400_ctrl.controllers.design import Timing, computed_torque_with, over_poses, shape_loop
from irb2400_ctrl.simulation import from_angles, make_loop, perturbed_robot

robot = irb.load_robot("irb2400")
timing = Timing(sample_time=0.001, delay_samples=1, speed_filter_Hz=250.0)
designs = [shape_loop(w, np.radians(60), timing) for w in (90, 90, 90, 120, 120, 120)]
controller = computed_torque_with(robot, designs)
time = np.linspace(0, 3, 61)
swing = np.sin(time)[:, None] ** 2 * [0.8, 0.3, -0.2, 1.0, 0.7, -1.0]
motion = from_angles(time, swing + np.array([0, 0.2, -0.1, 0, 0.6, 0]))
loop = make_loop(robot, controller)
runs = [loop.run(motion, plant=perturbed_robot(robot, seed=seed)) for seed in range(20)]
errors = [1e3 * run.tcp_error.max() for run in runs]
print("joint 1:", designs[0].margins)
print(
    "all joints, stretched wrist:", over_poses(robot, controller, [0, 0.2, -0.1, 0.3, 0, 0], timing)
)
print(
    f"TCP error at most {np.median(errors):.2f} mm in the median of 20 arms ({min(errors):.2f} to "
    f"{max(errors):.2f}), {np.median([run.real_time_factor for run in runs]):.0f} times real time"
)
print(
    "torque of one step in C:", compile_block(controller).step([], np.zeros(30))[1].round(1), "Nm"
)
