"""What happens when a motion is planned right up to the torque limit, or beyond it?

The same move, faster and faster, until the model says that an axis needs 70 … 120 % of its torque.
Twenty arms differ from the model by a few per cent and the controller needs some torque for itself:
how much should a planner leave?"""

import matplotlib.pyplot as plt
import numpy as np

import irb2400_ctrl as irb
from irb2400_ctrl.simulation import Trajectory, make_loop, perturbed_robot

robot = irb.load_robot("irb2400")
model = irb.Model(robot)
start = np.array([-0.9, -0.5, 0.3, -0.8, 0.4, 0.6])
stop = np.array([0.9, 0.8, -0.2, 0.9, 1.2, -0.8])


def move(duration: float) -> Trajectory:
    """Rest to rest by a fifth-order polynomial."""
    time = np.linspace(0, duration, 301)
    s = (time / duration)[:, None]
    q = start + (stop - start) * s**3 * (10 - 15 * s + 6 * s**2)
    qd = (stop - start) * (30 * s**2 - 60 * s**3 + 30 * s**4) / duration
    qdd = (stop - start) * (60 * s - 180 * s**2 + 120 * s**3) / duration**2
    return Trajectory(time, q, qd, qdd)


def torque_ratio(motion: Trajectory) -> float:
    """Largest torque over its limit that the model asks for."""
    return float(
        (np.abs(model.inverse_dynamics(motion.q, motion.qd, motion.qdd)) / robot.tau_max).max()
    )


def duration_for(ratio: float) -> float:
    """Duration at which the move needs that share of the torque (bisection)."""
    low = 0.15
    high = 3.0
    while high - low > 1e-4:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if torque_ratio(move(middle)) > ratio else (low, middle)
    return high


ratios = np.array([0.7, 0.8, 0.9, 0.95, 1.0, 1.05, 1.1, 1.2])
motions = [move(duration_for(ratio)) for ratio in ratios]
plants = [perturbed_robot(robot, seed=seed) for seed in range(20)]
full = list(ratios).index(1.0)
figure, axes = plt.subplots(figsize=(7, 4.5))
print("largest TCP error [mm]: median of 20 arms (least to largest)")
for name in ("feedforward_pid", "computed_torque", "computed_torque_integral"):
    loop = make_loop(robot, name)
    runs = [[loop.run(motion, plant=plant, hold=0.3) for plant in plants] for motion in motions]
    errors = np.array([[1e3 * run.tcp_error.max() for run in of] for of in runs])
    low, median, high = (np.percentile(errors, share, axis=1) for share in (0, 50, 100))
    told = [
        f"{100 * r:.0f} %: {m:.2f} ({a:.2f} to {b:.2f})"
        for r, m, a, b in zip(ratios, median, low, high, strict=True)
    ]
    print(f"{name:26}", "  ".join(told))
    more = errors / errors[full]
    for k in (full + 1, full + 2):
        print(
            f"{name:26} {100 * ratios[k]:.0f} % against 100 %: {np.median(more[k]):.1f} times the "
            f"error ({more[k].min():.1f} to {more[k].max():.1f})"
        )
    (line,) = axes.semilogy(100 * ratios, median, "o-", label=name)
    axes.fill_between(100 * ratios, low, high, color=line.get_color(), alpha=0.15)
axes.axvline(100, color="k", lw=0.8)
axes.set(
    xlabel="torque the plan uses [% of the limit]",
    ylabel="largest TCP error [mm]",
    title="Median and range of 20 arms",
)
axes.grid(which="both", alpha=0.3)
axes.legend()
figure.tight_layout()
figure.savefig("control_07_torque_limit.png", dpi=120)
