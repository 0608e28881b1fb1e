"""What does an error in the inertias cost? All masses and tensors of twenty arms scaled against
those of the model, whose friction and other numbers are off by a few per cent besides."""

import matplotlib.pyplot as plt
import numpy as np

import irb2400_ctrl as irb
from irb2400_ctrl.robot import Body, Robot
from irb2400_ctrl.simulation import from_angles, make_loop, perturbed_robot

robot = irb.load_robot("irb2400")
arms = [perturbed_robot(robot, seed=seed) for seed in range(20)]


def scaled(robot: Robot, factor: float) -> Robot:
    """An arm with every body that much heavier."""

    def heavier(body: Body) -> Body:
        tensor = tuple(factor * x for x in body.inertia_kgm2)
        return body.model_copy(update={"mass_kg": factor * body.mass_kg, "inertia_kgm2": tensor})

    links = tuple(link.model_copy(update={"body": heavier(link.body)}) for link in robot.links)
    tool = robot.tool.model_copy(update={"body": heavier(robot.tool.body)})
    return robot.model_copy(update={"links": links, "tool": tool})


time = np.linspace(0, 3, 61)
swing = np.sin(2 * time)[:, None] ** 2 * np.array([1.0, 0.5, -0.4, 1.2, 0.8, -1.2])
motion = from_angles(time, swing + np.array([-0.3, 0.1, 0.0, 0.2, 0.6, -0.2]))
errors = np.array([-0.2, -0.1, -0.05, 0.0, 0.05, 0.1, 0.2])
figure, axes = plt.subplots(figsize=(7, 4.5))
for name in ("feedforward_pid", "computed_torque", "computed_torque_integral", "adaptive"):
    loop = make_loop(robot, name)
    runs = [[loop.run(motion, plant=scaled(arm, 1 + e)) for e in errors] for arm in arms]
    rms = np.array([[1e3 * np.sqrt(np.mean(run.tcp_error**2)) for run in of] for of in runs])
    (line,) = axes.plot(100 * errors, np.median(rms, axis=0), "o-", label=name)
    axes.fill_between(100 * errors, rms.min(axis=0), rms.max(axis=0), alpha=0.15)
    more = 100 * (rms[:, [1, 5]] / rms[:, [3]] - 1)
    print(
        f"{name:26} {np.median(rms[:, 3]):.2f} mm in the median of 20 arms; 10 % too heavy "
        f"{np.median(more[:, 1]):+.0f} % ({more[:, 1].min():+.0f} to {more[:, 1].max():+.0f}), too "
        f"light {np.median(more[:, 0]):+.0f} % ({more[:, 0].min():+.0f} to {more[:, 0].max():+.0f})"
    )
axes.set(
    xlabel="mass of the arm against its model [%]",
    ylabel="TCP error [mm rms]",
    ylim=(0, None),
    title="Median and range of 20 arms",
)
axes.grid(alpha=0.3)
axes.legend()
figure.tight_layout()
figure.savefig("control_05_inertia_error.png", dpi=120)
