"""A milling force at the tool: how far does it push the tool of twenty arms that differ from their
model by a few per cent, also when it ends, and does the momentum observer see it?"""

import matplotlib.pyplot as plt
import numpy as np

import irb2400_ctrl as irb
from irb2400_ctrl.codegen import compile_block
from irb2400_ctrl.controllers import momentum_observer
from irb2400_ctrl.simulation import from_angles, make_loop, perturbed_robot

robot = irb.load_robot("irb2400")
plants = [perturbed_robot(robot, seed=seed) for seed in range(20)]
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

after = fine.time >= 3.0


def told(values: list[float]) -> str:
    """Median of the arms, and their range."""
    return f"{np.median(values):.2f} mm ({min(values):.2f} to {max(values):.2f})"


figure, (top, bottom) = plt.subplots(2, 1, figsize=(8, 6.5), sharex=True)
for name in ("computed_torque", "computed_torque_integral"):
    loop = make_loop(robot, name, wrench=True)
    pushed = []
    for plant in plants:
        run = loop.run(motion, wrench=wrench, plant=plant)
        free = loop.run(motion, plant=plant)
        pushed.append(1e3 * np.linalg.norm(run.p_BT - free.p_BT, axis=1))
    print(
        f"{name}: while it acts the force moves the tool by {told([p[cut].max() for p in pushed])} "
        f"at most, by {told([p[cut].mean() for p in pushed])} in mean; when it ends, by "
        f"{told([p[after].max() for p in pushed])} at most"
    )
    (line,) = top.plot(run.time, np.median(pushed, axis=0), label=name)
    top.fill_between(run.time, np.min(pushed, axis=0), np.max(pushed, axis=0), alpha=0.2)
top.set(ylabel="displacement of the TCP [mm]", title="Milling force of 80, -40, 120 N in mean")
top.legend()

observer = compile_block(momentum_observer(robot, bandwidth=60.0))
middle = (fine.time > 1.3) & (fine.time < 2.8)
truth = wrench[middle, :3].mean(axis=0)
loop = make_loop(robot, "computed_torque_integral", wrench=True)
off = []
for plant in plants:
    run = loop.run(motion, wrench=wrench, plant=plant)
    seen = np.hstack([run.signals["q_seen"], run.signals["qd_seen"], run.tau])
    force = observer.split(observer.block.outputs, observer.rollout(seen)[1])["wrench"][:, :3]
    off.append(float(np.linalg.norm(force[middle].mean(axis=0) - truth)))
print(
    f"mean force {truth.round(0)} N: the estimate is off by {np.median(off):.0f} N in the median "
    f"of 20 arms ({min(off):.0f} to {max(off):.0f}): what their torques differ from the model's"
)
for axis, (label, colour) in enumerate(zip("xyz", ("C0", "C1", "C2"), strict=True)):
    bottom.plot(run.time, wrench[:, axis], colour, alpha=0.3, label=f"acting F{label}")
    bottom.plot(run.time, force[:, axis], colour, lw=0.8, label=f"estimated F{label}")
bottom.set(xlabel="time [s]", ylabel="force on the tool [N]", ylim=(-100, 300))
bottom.legend(loc="upper right", ncols=3, title="the last of the arms")
for axes in (top, bottom):
    axes.grid(alpha=0.3)
figure.tight_layout()
figure.savefig("control_04_milling_force.png", dpi=120)
