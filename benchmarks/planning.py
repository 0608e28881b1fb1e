"""Planning and timing: limits of the torque rate, ways to choose the tool rotation, cost over the
points. The race with other timings is `benchmarks/timing_race.py`.

    python benchmarks/planning.py [paths]

Violations are looked for 10,000 times a second with the model's own inverse dynamics, Stribeck
friction included.
"""

from __future__ import annotations

import resource
import sys
import time
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

import irb2400_ctrl as irb
from irb2400_ctrl.codegen import compile_function
from irb2400_ctrl.errors import UnreachableError
from irb2400_ctrl.planners import MotionLimits, Plan, ToolPath, plan_path
from irb2400_ctrl.planners.enclosure.path_dynamics import path_dynamics
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing.rate_limited.time_rate_limited import time_rate_limited
from irb2400_ctrl.planners.timing.time_joint_path import time_joint_path
from irb2400_ctrl.planners.toolpath import builders

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from spline_paths import random_path

Array = npt.NDArray[np.float64]

ROBOT = irb.load_robot("irb2400")
DYNAMICS = path_dynamics(ROBOT)
LIMITS = MotionLimits.of(ROBOT)
TORQUE = compile_function(DYNAMICS.model.function("inverse_dynamics"))
SIZES = (1000, 2000, 5000, 10000)


def smooth_table(paths: int, references: int = 3) -> None:
    """Limits of the torque rate: price, violations, and the duration over that of a finer program
    of another kind.

    The reference has 1,000 cells, even in time, and holds at its points only. It does not always
    converge ("nan").
    """
    from smooth_reference import reference_duration

    smooth_torque = compile_function(DYNAMICS.model.function("inverse_dynamics_without_friction"))
    print(
        f"Torque rates limited, in torque limits per second; {paths} random splines, looked at "
        "10,000 times a second"
    )
    print(
        f"{'rate':>6s} {'price':>7s} {'worst':>7s} {'over':>5s} {'torque':>8s} {'rate':>8s} "
        f"{'cells':>6s} {'s':>6s} "
        "  longer than the reference [%], from 100 and 500 cells"
    )
    for rate in (50, 20, 10, 5):
        limits = replace(LIMITS, torque_rate=rate * LIMITS.tau_max)
        rows = []
        longer = []
        for seed in range(paths):
            path = random_path(seed)
            began = time.process_time()
            law = time_rate_limited(DYNAMICS, path, limits)
            seconds = time.process_time() - began
            jumping = time_joint_path(DYNAMICS, path, LIMITS)[0].duration
            t = np.append(np.arange(0, law.duration, 1e-4), law.duration)
            _, q, qd, qdd = law.motion(path, t)
            (tau,) = TORQUE.map(q, qd, qdd, np.zeros(1))
            (bare,) = smooth_torque.map(q, qd, qdd, np.zeros(1))
            change = np.abs(np.diff(bare + ROBOT.friction[:, 2] * qd, axis=0)) / np.diff(t)[:, None]
            torque = (np.abs(tau) / LIMITS.tau_max).max()
            seen = (change / limits.torque_rate).max()
            rows.append((law.duration / jumping - 1, torque, seen, len(law.s) - 1, seconds))
            if seed < references and rate in (20, 10):
                coarse = time_rate_limited(DYNAMICS, path, limits, count=100)
                try:
                    reference = reference_duration(DYNAMICS, path, limits, coarse, 1000)
                except RuntimeError:
                    reference = np.nan
                longer.append(
                    f"{100 * (coarse.duration / reference - 1):.2f} "
                    f"{100 * (law.duration / reference - 1):.2f}"
                )
        price, torque, seen, cells, seconds = np.array(rows).T
        over = ((torque > 1) | (seen > 1 + 1e-6)).sum()
        print(
            f"{rate:6d} {100 * price.mean():6.2f}% {100 * price.max():6.2f}% {over:5d} "
            f"{torque.max():8.5f} "
            f"{seen.max():8.5f} {np.median(cells):6.0f} {np.median(seconds):6.2f}   "
            f"{', '.join(longer)}"
        )
    print()


def rotation_table() -> None:
    """Free rotation, best constant rotation, and a joint spline through the way-points alone."""
    centre = np.array([0.9, 0.0, 0.5])
    paths = {
        "line of 400 mm": builders.line((0.9, -0.2, 0.5), (0.9, 0.2, 0.5)),
        "overhead line": builders.line([0.3, -0.1, 1.9], [0.3, 0.1, 1.9], (0, 0, -1)),
        "circle of 300 mm": builders.circle(centre, 0.15),
        "three sides of a box": box(centre),
        "tilting arc": tilting(centre),
    }
    print(
        "Tool rotation: duration [s], smallest relative margin, TCP deviation of the way-point "
        "spline [mm]"
    )
    print(f"{'':22s} {'free':>15s} {'best constant':>15s} {'joint spline':>20s}")
    for name, path in paths.items():
        free = plan_path(ROBOT, path)
        try:
            held = plan_path(ROBOT, path, free_tool_rotation=False)
        except UnreachableError:
            held = None
        cells = [
            "none" if p is None else f"{p.duration:7.3f} {relative(p.singularity_margin):7.2f}"
            for p in (free, held)
        ]
        print(f"{name:22s} {cells[0]:>15s} {cells[1]:>15s} {joint_spline(path, held or free):>20s}")
    print()


def relative(margin: dict[str, float]) -> float:
    """The smallest of the three margins as a part of its largest value."""
    g = DYNAMICS.model.arm_geometry
    return min(
        margin["wrist"], margin["shoulder"] / (g.a1 + g.a2 + g.forearm), margin["elbow"] / g.forearm
    )


def joint_spline(path: ToolPath, plan: Plan) -> str:
    """Duration and TCP deviation of a spline through the joint angles at the way-points only."""
    dense = plan.certificate.path
    s = np.linspace(dense.knots[0], dense.knots[-1], 200001)
    tip = DYNAMICS.model.tcp_pose(dense(s[::50]))[:, :3, 3]
    # a few way-points of the path, as a robot program without straight moves has them
    at = np.linspace(0, len(path) - 1, min(len(path), 5)).round().astype(int)
    nearest = [int(np.argmin(np.linalg.norm(tip - p, axis=1))) for p in path.position[at]]
    nearest[0] = 0
    nearest[-1] = len(tip) - 1
    places = s[::50][np.unique(nearest)]
    spline = JointPath.through(places, dense(places))
    timed, _ = time_joint_path(DYNAMICS, spline, LIMITS)
    reached = DYNAMICS.model.tcp_pose(spline(s[::200]))[:, :3, 3]
    deviation = max(np.linalg.norm(tip - p, axis=1).min() for p in reached)
    return f"{timed.duration:7.3f} s {1e3 * deviation:7.1f} mm"


def box(centre: Array) -> ToolPath:
    """Along the top of a box, the tool at right angles to three of its sides."""
    points = centre + 0.15 * np.array([[-1, -1, 0], [-1, 1, 0], [1, 1, 0], [1, -1, 0]])
    axes = np.array([[-0.5, 0, 1], [-0.5, 0.5, 1], [0.5, 0.5, 1], [0.5, -0.5, 1.0]])
    return builders.way_points(points, axes / np.linalg.norm(axes, axis=1, keepdims=True))


def tilting(centre: Array) -> ToolPath:
    """An arc on which the tool axis tilts from 50 deg to one side to 50 deg to the other."""

    def axis(t: Array) -> Array:
        tilt = np.radians(50) * (2 * t - 1)
        return np.stack([0 * t, np.sin(tilt), np.cos(tilt)], axis=1)

    def position(t: Array) -> Array:
        angle = np.pi * t
        return centre + 0.15 * np.stack([np.cos(angle), np.sin(angle), 0 * t], axis=1)

    return builders.curve(position, axis)


def scale_table() -> None:
    """Cost over the number of way-points."""
    print("Freeform raster from way-points to trajectory (rest to rest, 250 Hz)")
    print(
        f"{'points':>8s} {'seconds':>8s} {'ms/point':>9s} {'of this: rotation':>18s} "
        f"{'timing':>7s} {'MB at most':>11s}"
    )
    for points in SIZES:
        path = builders.raster(
            [0.9, 0, 0.5], 0.2, 0.2, lines=points // 100, points=100, feed=0.2,
            height=lambda x, y: 0.012 * np.sin(2 * np.pi * x / 0.2) * np.cos(np.pi * y / 0.12),
        )  # fmt: skip
        began = time.perf_counter()
        plan = plan_path(ROBOT, path)
        seconds = time.perf_counter() - began
        stages = plan.wall_time
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        print(
            f"{points:8d} {seconds:8.1f} {1e3 * seconds / points:9.2f} "
            f"{stages['branch and rotation']:18.1f} "
            f"{stages['timing']:7.1f} {memory:11.0f}"
        )


def main(paths: int = 50) -> None:
    """Print the tables."""
    warnings.simplefilter("ignore")
    smooth_table(paths)
    rotation_table()
    scale_table()


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 50)
