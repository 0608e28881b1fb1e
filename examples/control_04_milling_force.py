"""A milling force at the tool: how far does it push the tool, and does the momentum observer see
it?"""

import matplotlib.pyplot as plt
import numpy as np

import irb2400_ctrl as irb
from irb2400_ctrl.codegen import compile_block
from irb2400_ctrl.controllers import momentum_observer
from irb2400_ctrl.simulation import from_angles, make_loop

robot = irb.load_robot("irb2400")
time = np.linspace(0, 4, 81)
way = (time / 4 - np.sin(2 * np.pi * time / 4) / (2 * np.pi))[:, None] * np.array(
    [0.9, 0.5, -0.4, 1.2, 0.8, -1.2]
)
motion = from_angles(time, way + np.array([-0.4, 0.0, 0.1, 0.2, 0.5, -0.2]))
fine = motion.at_rate(1000.0)

# mean cutting force, and a tooth that passes 40 times a second (two teeth, 1200 turns a minute)
cut = (fine.time > 1.0) & (fine.time < 3.0)
tooth = 1 + 0.5 * np.sin(2 * np.pi * 40 * fine.time)
wrench = np.zeros((len(fine.time), 6))
wrench[:, :3] = (cut * tooth)[:, None] * np.array([80.0, -40.0, 120.0])

figure, (top, bottom) = plt.subplots(2, 1, figsize=(8, 6.5), sharex=True)
for name in ("computed_torque", "computed_torque_integral"):
    loop = make_loop(robot, name, wrench=True)
    run = loop.run(motion, wrench=wrench)
    free = loop.run(motion)
    pushed = 1e3 * np.linalg.norm(run.p_BT - free.p_BT, axis=1)
    print(
        f"{name}: the force moves the tool by {pushed[cut].max():.2f} mm at most, "
        f"{pushed[cut].mean():.2f} mm in mean"
    )
    top.plot(run.time, pushed, label=name)
top.set(ylabel="displacement of the TCP [mm]", title="Milling force of 80, -40, 120 N")
top.legend()

observer = compile_block(momentum_observer(robot, bandwidth=60.0))
_, outputs = observer.rollout(np.hstack([run.signals["q_seen"], run.signals["qd_seen"], run.tau]))
force = observer.split(observer.block.outputs, outputs)["wrench"][:, :3]
for axis, (label, colour) in enumerate(zip("xyz", ("C0", "C1", "C2"), strict=True)):
    bottom.plot(run.time, wrench[:, axis], colour, alpha=0.3)
    bottom.plot(run.time, force[:, axis], colour, lw=0.8, label=f"estimated F{label}")
middle = (fine.time > 1.3) & (fine.time < 2.8)
estimate, truth = (values[middle, :3].mean(axis=0).round(0) for values in (force, wrench))
print(f"mean force estimated {estimate} N, true {truth} N")
bottom.set(xlabel="time [s]", ylabel="force on the tool [N]", ylim=(-300, 400))
bottom.legend(loc="upper right")
for axes in (top, bottom):
    axes.grid(alpha=0.3)
figure.tight_layout()
figure.savefig("control_04_milling_force.png", dpi=120)
