"""What the bound of every effect costs: certified timing against an optimum that holds at the ends
of its cells only.

    python benchmarks/effect_bounds.py [paths]

The reference knows the time at which it passes each cell and linearises the model's own inverse
dynamics there, round after round; in between it may exceed the limits, and does. The certified
motion holds at all times, whenever it starts.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import numpy.typing as npt

import irb2400_ctrl as irb
from irb2400_ctrl.codegen import compile_function
from irb2400_ctrl.effects import LIBRARY, Effect
from irb2400_ctrl.planners import MotionLimits
from irb2400_ctrl.planners.enclosure.cells import enclose, grid
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics, path_dynamics
from irb2400_ctrl.planners.joint_path import JointPath
from irb2400_ctrl.planners.timing.motion_limits import speed_bounds
from irb2400_ctrl.planners.timing.piecewise_constant_law import PiecewiseConstantLaw
from irb2400_ctrl.planners.timing.time_joint_path import time_joint_path
from irb2400_ctrl.planners.timing.time_law import TimeLaw
from irb2400_ctrl.planners.timing.two_pass import two_pass

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from spline_paths import random_path

Array = npt.NDArray[np.float64]

ROBOT = irb.load_robot("irb2400")
LIMITS = MotionLimits.of(ROBOT)
ROUNDS = 14
CASES: dict[str, list[Effect]] = {
    "load friction": [LIBRARY["load_friction"].of(j, coefficient=0.08) for j in (2, 3)],
    "hysteresis": [LIBRARY["hysteresis"].of(j, amplitude_Nm=40, width_rad=0.02) for j in (1, 2, 3)],
    "power 0.5": [LIBRARY["viscous_power"].of(j, coefficient=60, exponent=0.5) for j in (1, 2, 3)],
    "power 1.5": [LIBRARY["viscous_power"].of(j, coefficient=60, exponent=1.5) for j in (1, 2, 3)],
    "power 2.5": [LIBRARY["viscous_power"].of(j, coefficient=30, exponent=2.5) for j in (1, 2, 3)],
    "cold gears": [
        LIBRARY["viscous_warmup"].of(j, viscous_Nms_rad=60, time_constant_s=5) for j in (1, 2, 3)
    ],
    "process force": [
        LIBRARY["process_force"].of(None, force_x_N=60, force_z_N=-80, start_s=0.2, stop_s=0.8)
    ],
    "rotor in a window": [LIBRARY["rotor_inertia"].of(2, inertia_kgm2=8, windows_s=((0.1, 0.6),))],
}


def sampled_optimum(dynamics: PathDynamics, path: JointPath, count: int = 4000) -> TimeLaw:
    """The fastest motion whose torque holds just inside both ends of every cell, from time zero."""
    torque = compile_function(dynamics.model.function("inverse_dynamics"))
    s = grid(path, count)
    h = np.diff(s)
    piece = path.piece((s[:-1] + s[1:]) / 2)
    bound = np.minimum(speed_bounds(enclose(dynamics, path, s), LIMITS.qd_max), 1e9)
    bound[[0, -1]] = 0.0
    start = time_joint_path(path_dynamics(ROBOT), path, LIMITS, count=count)[0]
    law = PiecewiseConstantLaw(s, 0.9 * np.interp(s, start.s, start.x))
    for number in range(ROUNDS):
        rows = [row for end in (0.02, 0.98) for row in _rows(torque, path, law, piece, end)]
        room = 1.25 if number < ROUNDS // 2 else 1.05
        near = np.maximum.reduce([law.x, np.roll(law.x, 1), np.roll(law.x, -1)])
        high = np.minimum(bound, room * near + 1e-9)
        passed = two_pass(np.concatenate(rows, axis=1), h, np.zeros_like(high), high)
        if passed.infeasible_cell is not None:
            raise RuntimeError(f"the reference has no motion at cell {passed.infeasible_cell}")
        law = PiecewiseConstantLaw(s, passed.x)
    return law


def _rows(torque, path: JointPath, law: TimeLaw, piece: Array, end: float) -> list[Array]:  # type: ignore[no-untyped-def]
    """tau + d tau/du (u - u_0) + d tau/dx (x - x_0) within the limits at a part of each cell, shape
    (m, n, 3) twice."""
    h = np.diff(law.s)
    u = law.u
    at = law.s[:-1] + end * h
    time = (law.time[:-1] + end * np.diff(law.time))[:, None]
    q, dq, ddq = (path.on_piece(at, piece, order) for order in range(3))
    x = np.maximum(law.x[:-1] + 2 * h * u * end, 1e-12)

    def tau(u: Array, x: Array) -> Array:
        qdd = ddq * x[:, None] + dq * u[:, None]
        return np.asarray(torque.map(q, dq * np.sqrt(x)[:, None], qdd, time)[0])

    du = 1e-4 * (1 + np.abs(u))
    dx = 1e-4 * x
    by_u = (tau(u + du, x) - tau(u - du, x)) / (2 * du)[:, None]
    by_x = (tau(u, x + dx) - tau(u, x - dx)) / (2 * dx)[:, None]
    rest = tau(u, x) - by_u * u[:, None] - by_x * x[:, None]
    both = by_u + by_x * (2 * h * end)[:, None]
    table = [np.stack([k * both, k * by_x, LIMITS.tau_max - k * rest], axis=-1) for k in (1, -1)]
    return [rows / LIMITS.tau_max[:, None] for rows in table]


def worst(dynamics: PathDynamics, path: JointPath, law: TimeLaw, start: float) -> float:
    """Largest torque over its limit, looked for 10,000 times a second in a motion that starts at a
    time [s]."""
    time = np.arange(0, law.duration, 1e-4)
    _, q, qd, qdd = law.motion(path, time)
    return float((np.abs(dynamics.torque(q, qd, qdd, time + start)) / LIMITS.tau_max).max())


def main(paths: int = 4) -> None:
    """Print the table."""
    print(f"{'':20s} {'longer by':>18s} {'reference over':>15s} {'certified over':>15s}")
    for name, effects in CASES.items():
        dynamics = path_dynamics(ROBOT.with_effects(*effects))
        price = []
        reference = 0.0
        certified = 0.0
        for seed in range(paths):
            path = random_path(seed)
            fine = sampled_optimum(dynamics, path)
            timed = time_joint_path(dynamics, path, LIMITS)[0]
            price.append(100 * (timed.duration / fine.duration - 1))
            reference = max(reference, worst(dynamics, path, fine, 0.0) - 1)
            certified = max(
                certified,
                *(worst(dynamics, path, timed, start) - 1 for start in (0.0, 0.3, 1e6)),
            )
        span = f"{min(price):.2f} … {max(price):.2f} %"
        print(
            f"{name:20s} {span:>18s} {100 * reference:13.2f} % {100 * max(certified, 0.0):13.2f} %",
            flush=True,
        )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 4)
