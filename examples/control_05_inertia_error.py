"""What does an error in the inertias cost? All masses and tensors of the arm scaled against those
of the model."""

import matplotlib.pyplot as plt
import numpy as np

import irb2400_ctrl as irb
from irb2400_ctrl.robot import Body, Robot
from irb2400_ctrl.simulation import from_angles, make_loop

robot = irb.load_robot("irb2400")


def scaled(factor: float) -> Robot:
    """The arm with every body that much heavier."""

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
    rms = [
        1e3 * np.sqrt(np.mean(loop.run(motion, plant=scaled(1 + e)).tcp_error ** 2)) for e in errors
    ]
    axes.plot(100 * errors, rms, "o-", label=name)
    print(
        f"{name:26} exact {rms[3]:.2f} mm, 10 % too heavy {rms[5]:.2f} mm, 10 % too light "
        f"{rms[1]:.2f} mm"
    )
axes.set(
    xlabel="mass of the arm against its model [%]", ylabel="TCP error [mm rms]", ylim=(0, None)
)
axes.grid(alpha=0.3)
axes.legend()
figure.tight_layout()
figure.savefig("control_05_inertia_error.png", dpi=120)
