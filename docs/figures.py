"""Makes the figure of the README again: `make figures`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.measurement import read_log, recorded_motion
from irb2400_ctrl.report.main_job import ARM
from irb2400_ctrl.robot import load_robot
from irb2400_ctrl.simulation.close_the_loop import close_loop

IMAGES = Path(__file__).parent / "images"


def closed_loop_figure() -> Figure:
    """Left: what the model leaves of a measured torque; right: what the finding is worth to the
    controller."""
    robot = load_robot("irb2400")
    log = read_log(ARM / "identification.csv.gz")
    validation = read_log(ARM / "validation.csv.gz")
    found = diagnose(robot, log, validation=validation)
    loop = close_loop(robot, found.robot, recorded_motion(log))
    finding = found.findings[0]
    compared = found.validation
    assert compared is not None
    j = finding.curve.joint - 1

    figure = Figure(figsize=(11.0, 3.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    time = compared.time - compared.time[0]
    for name, model, errors, color in (
        ("model as given", compared.before, compared.error_before, "tab:red"),
        (
            f"with {finding.effect.kind} on joint {j + 1}",
            compared.after,
            compared.error_after,
            "tab:blue",
        ),
    ):
        rest = np.where(compared.known[:, j], compared.measured[:, j] - model[:, j], np.nan)
        left.plot(time, rest, color=color, lw=0.6, label=f"{name}: {errors.rmse[j]:.2f} Nm rms")
    left.set(
        xlabel="time [s]",
        ylabel=f"measured - predicted torque {j + 1} [Nm]",
        title="prediction, another motion",
    )
    for name, run, color in (
        ("as given", loop.before, "tab:red"),
        ("as diagnosed", loop.after, "tab:blue"),
    ):
        error = 1e3 * run.tcp_error
        label = f"controller from the robot {name}: {np.sqrt(np.mean(error**2)):.2f} mm rms"
        right.plot(run.time, error, color=color, lw=0.8, label=label)
    right.set(
        xlabel="time [s]",
        ylabel="TCP error [mm]",
        title="closed loop, simulated arm with the effect",
    )
    for axis in (left, right):
        axis.grid(alpha=0.3)
        low, high = axis.get_ylim()
        axis.set_ylim(low, high + 0.25 * (high - low))  # room for the legend
        axis.legend(loc="upper right", fontsize="small")
    return figure


if __name__ == "__main__":
    IMAGES.mkdir(exist_ok=True)
    closed_loop_figure().savefig(IMAGES / "closed_loop.png", dpi=110, metadata={"Software": None})
    print(f"written: {IMAGES / 'closed_loop.png'}")
