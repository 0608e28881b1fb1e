"""What does an elastic gear on axis 1 do to the margins, and does it swing as in the paper's Fig.
12a?"""

import matplotlib.pyplot as plt
import numpy as np

import irb2400_ctrl as irb
from irb2400_ctrl.controllers import controller
from irb2400_ctrl.controllers.linear import LinearLoop
from irb2400_ctrl.controllers.timing import Timing
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.simulation import Trajectory, simulate

robot = irb.load_robot("irb2400")
pose = np.array([0.0, 0.3, -0.1, 0.3, 0.9, -0.2])
block = controller("feedforward_pid", robot)


def elastic(stiffness: float) -> irb.Robot:
    """The arm with an elastic gear on axis 1; the rotor's inertia is an assumption, nobody
    publishes it."""
    return robot.with_effects(
        LIBRARY["elastic_joint"].of(1, stiffness_Nm_rad=stiffness, damping_ratio=0.03),
        LIBRARY["rotor_inertia"].of(1, inertia_kgm2=15.0),
    )


def move(angle: float, duration: float) -> Trajectory:
    """Axis 1 alone, at constant speed between two quick ramps, as in the paper's single-axis
    tests."""
    time = np.linspace(0, duration, int(250 * duration) + 1)
    ramp = 0.15
    speed = angle / (duration - ramp)
    qd = speed * np.clip(np.minimum(time, duration - time) / ramp, 0, 1)
    qdd = np.gradient(qd, time)
    q = np.concatenate([[0], np.cumsum(0.5 * (qd[1:] + qd[:-1]) * np.diff(time))])
    unit = np.eye(6)[0]
    return Trajectory(time, pose + np.outer(q, unit), np.outer(qd, unit), np.outer(qdd, unit))


stiffnesses = [3e4, 1e5, 3e5, 1e6]
figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.5))
for stiffness in stiffnesses:
    loop = LinearLoop(elastic(stiffness), block, pose, Timing())
    margins = loop.joint(1)
    print(f"k = {stiffness:9.0f} Nm/rad: {'stable' if loop.stable else 'UNSTABLE'}, {margins}")
    left.loglog(loop.omega, np.abs(loop.sensitivity[:, 0, 0]), label=f"k = {stiffness:.0e} Nm/rad")
rigid = LinearLoop(robot, block, pose, Timing())
print(f"rigid: {rigid.joint(1)}")
left.loglog(rigid.omega, np.abs(rigid.sensitivity[:, 0, 0]), "k--", label="rigid")
left.set(
    xlabel="frequency [rad/s]", ylabel="|S| of axis 1 [-]", title="Sensitivity", ylim=(1e-2, 10)
)
left.legend()
motion = move(0.8, 1.0)
for plant, label in ((robot, "rigid"), (elastic(1e5), "k = 1e5 Nm/rad")):
    run = simulate(robot, motion, block, plant=plant, hold=0.4)
    right.plot(run.time, run.tau[:, 0], label=label, lw=0.8)
right.set(
    xlabel="time [s]", ylabel="torque of axis 1 [Nm]", title="Single-axis move (as in Fig. 12a)"
)
right.legend()
for axes in (left, right):
    axes.grid(alpha=0.3)
figure.tight_layout()
figure.savefig("control_03_elasticity.png", dpi=120)
