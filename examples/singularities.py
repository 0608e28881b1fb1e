"""How many singularities has the arm? The paper says exactly two; det J has three factors.

Draws both curves of the paper's eq. 36 in the plane of q2 and q3, and the arm in one pose of each.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import irb2400_ctrl as irb


def draw(model: irb.Model, path: Path) -> Path:
    """Save the figure: shoulder factor r = 0 and elbow factor k = 0 inside the joint box."""
    from matplotlib.figure import Figure

    robot = model.robot
    q2, q3 = (np.linspace(robot.q_min[i], robot.q_max[i], 200) for i in (1, 2))
    grid = np.zeros((q2.size * q3.size, 6))
    grid[:, 1], grid[:, 2] = (axis.ravel() for axis in np.meshgrid(q2, q3))
    grid[:, 4] = 1.0
    factors = model.singularity_factors(grid).reshape(q3.size, q2.size, 3)
    r = factors[:, :, 1]
    k = factors[:, :, 2]

    figure = Figure(figsize=(11, 4.6), layout="constrained")
    plane, *sketches = figure.subplots(1, 3, width_ratios=[1.5, 1, 1])
    x = np.degrees(q2)
    y = np.degrees(q3)
    shades = plane.contourf(x, y, np.abs(r * k), levels=12, cmap="Greys_r")
    figure.colorbar(shades, ax=plane, label="|r k| of eq. 36 [m²]")
    curves = {"shoulder: r = 0": (r, "tab:orange"), "elbow: k = 0": (k, "tab:blue")}
    for name, (factor, colour) in curves.items():
        plane.contour(x, y, factor, levels=[0.0], colors=colour, linewidths=2.5)
        plane.plot([], [], colour, linewidth=2.5, label=name)
    plane.set(xlabel="q2 [deg]", ylabel="q3 [deg]", title="eq. 36 vanishes on two curves, not one")
    plane.legend(loc="upper right")

    for axes, (name, (factor, colour)) in zip(sketches, curves.items(), strict=True):
        row, column = nearest_zero(factor)
        q = np.array([0.0, q2[column], q3[row], 0.0, 0.6, 0.0])
        draw_arm(axes, model, q, colour)
        axes.set_title(f"{name}\nq2 = {np.degrees(q[1]):.0f}°, q3 = {np.degrees(q[2]):.0f}°")
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=130)
    return path


def nearest_zero(factor: np.ndarray) -> tuple[int, int]:
    """Grid point on the middle of the curve where the factor changes sign."""
    crossings = np.argwhere(np.diff(np.sign(factor), axis=0) != 0)
    row, column = crossings[len(crossings) // 2]
    return int(row), int(column)


def draw_arm(axes, model: irb.Model, q: np.ndarray, colour: str) -> None:
    """Side view of the arm at q1 = 0: axis 1, shoulder, elbow, wrist centre, flange."""
    g = model.arm_geometry
    c2 = np.cos(q[1])
    s2 = np.sin(q[1])
    c3 = np.cos(q[2])
    s3 = np.sin(q[2])
    points = np.array(
        [
            [0.0, 0.0],
            [0.0, g.d1],
            [g.a1, g.d1],
            [g.a1 + g.a2 * s2, g.d1 + g.a2 * c2],
            [g.a1 + g.a2 * s2 + g.a3 * s3 + g.d4 * c3, g.d1 + g.a2 * c2 + g.a3 * c3 - g.d4 * s3],
        ]
    )
    flange = model.flange_pose(q)[[0, 2], 3]
    axes.axvline(0.0, color="0.6", linestyle="--", linewidth=1)
    axes.plot(*np.vstack([points, flange]).T, "-o", color="0.25", linewidth=3, markersize=5)
    axes.plot(*points[-1], "o", color=colour, markersize=10, label="wrist centre")
    axes.set(xlabel="x [m]", ylabel="z [m]", xlim=(-1.2, 1.9), ylim=(-0.6, 2.3), aspect="equal")
    axes.legend(loc="lower right", fontsize=8)


if __name__ == "__main__":
    target = Path(sys.argv[1] if len(sys.argv) > 1 else "out/singularities.png")
    print(draw(irb.Model(irb.load_robot("irb2400")), target))
