"""Which controller for which speed? The same circle of the tool, 200 mm wide, at 30 to 600 mm/s, on
twenty arms that each differ from their model by a few per cent."""

import matplotlib.pyplot as plt
import numpy as np

import irb2400_ctrl as irb
from irb2400_ctrl.simulation import Trajectory, from_angles, make_loop, perturbed_robot

robot = irb.load_robot("irb2400")
model = irb.Model(robot)
plants = [perturbed_robot(robot, seed=seed) for seed in range(20)]
START = np.array([0.1, 0.3, -0.1, 0.3, 0.9, -0.2])


def circle(speed: float, radius: float = 0.1) -> Trajectory:
    """Once around with that mean speed [m/s], from rest to rest."""
    duration = 2 * np.pi * radius / speed
    time = np.linspace(0, duration, int(60 * duration) + 20)
    share = time / duration
    angle = 2 * np.pi * share - np.sin(2 * np.pi * share)
    X_BT = model.tcp_pose(START)
    q = [START]
    for a in angle[1:]:
        X = X_BT.copy()
        X[:3, 3] += radius * np.array([np.cos(a) - 1, np.sin(a), 0])
        q.append(model.inverse_kinematics(X, q[-1])[0])
    return from_angles(time, q)


speeds = [0.03, 0.1, 0.3, 0.6]
names = [
    "pid",
    "gravity_pd",
    "feedforward_pid",
    "computed_torque",
    "computed_torque_integral",
    "adaptive",
]
motions = [circle(speed) for speed in speeds]
figure, axes = plt.subplots(figsize=(9, 4.5))
print("TCP error [mm rms] at", speeds, "m/s: median of 20 arms (least to largest)")
medians = {}
for name in names:
    loop = make_loop(robot, name)
    runs = [[loop.run(motion, plant=plant) for plant in plants] for motion in motions]
    errors = np.array([[1e3 * np.sqrt(np.mean(run.tcp_error**2)) for run in of] for of in runs])
    low, medians[name], high = (np.percentile(errors, share, axis=1) for share in (0, 50, 100))
    told = zip(medians[name], low, high, strict=True)
    print(f"{name:26}", "  ".join(f"{m:6.2f} ({a:.2f} to {b:.2f})" for m, a, b in told))
    (line,) = axes.loglog([1e3 * s for s in speeds], medians[name], "o-", label=name)
    axes.fill_between([1e3 * s for s in speeds], low, high, color=line.get_color(), alpha=0.15)
for k, speed in enumerate(speeds):
    best = sorted(names, key=lambda name: medians[name][k])
    print(f"{1e3 * speed:.0f} mm/s: {best[0]} is best in the median, then {best[1]}")
axes.set(
    xlabel="mean speed of the tool [mm/s]",
    ylabel="TCP error [mm rms]",
    title="Circle, 200 mm across: median and range of 20 arms",
)
axes.set_xticks([1e3 * s for s in speeds], [f"{1e3 * s:.0f}" for s in speeds])
axes.set_yticks(ticks := [0.2, 0.5, 1, 2, 5, 10], [f"{t:g}" for t in ticks])
axes.minorticks_off()
axes.grid(alpha=0.3)
axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
figure.tight_layout()
figure.savefig("control_02_speed.png", dpi=120)
