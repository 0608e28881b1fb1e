"""A short push at the tool of arms on which nothing else is missing: how often it is named, and how
far off its force is.

    python -m benchmarks.knocks [--seed S] [--count 12]

Clean arms of the third plant, whose kinematics also make the torque of the push (its power in a
displacement of each joint). Force (20 to 80 N), direction, beginning and duration (0.3 to 0.8 s)
are drawn; `step`: constant; `swells`: as sin^2. Off: |F - F_true| / |F_true| in the axes it is told
in, of the mean of F_true over the window that is told.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis import Finding, diagnose
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import load_robot

SHAPES = ("step", "swells")
STEP = 1e-6
"""[rad] of the displacement"""
MARGIN = 3.0
"""[s] of a record, at either end, in which nothing pushes"""


def held(q: Array, force: Array) -> Array:
    """Torque of the drives against forces at the tool: -F . dp / dq, (m, n) [Nm].

    Args:
        q: actuator angles [rad], (m, n).
        force: along the axes of the base [N], (m, 3).
    """
    from third_plant.arm import tool_places

    found = np.zeros_like(q)
    for j in range(q.shape[1]):
        there = q.copy()
        there[:, j] += STEP
        moved = tool_places(there)[1] - tool_places(q)[1]
        found[:, j] = -np.sum(force * moved, axis=1) / STEP
    return found


def pushed(case: Any, shape: str, seed: list[int]) -> tuple[Log, Array]:
    """A log with a push, and its force [N], (m, 3)."""
    seen = case.identification()
    rng = np.random.default_rng(seed)
    force = rng.normal(size=3)
    force *= rng.uniform(20.0, 80.0) / np.linalg.norm(force)
    lasts = rng.uniform(0.3, 0.8)
    since = (seen.time - rng.uniform(MARGIN, seen.time[-1] - MARGIN - lasts)) / lasts
    size = ((since >= 0.0) & (since < 1.0)) * (
        1.0 if shape == "step" else np.sin(np.pi * since) ** 2
    )
    acts = size[:, None] * force
    tau = seen.tau + held(seen.q, acts)
    return Log(seen.time, seen.q, tau, qd=seen.qd, q_ref=seen.q_ref, name=case.name), acts


def off(name: Finding, log: Log, acts: Array, model: Model) -> float:
    """How far the force that is told is from the one that was there [-]."""
    effect: Any = name.effect
    told = np.array([effect.force_x_N, effect.force_y_N, effect.force_z_N])
    inside = np.any([(log.time >= a) & (log.time < b) for a, b in effect.windows_s], axis=0)
    there = acts[inside]
    if effect.in_tool_frame:
        axes = np.asarray(model.tcp_pose(log.q[inside]))[:, :3, :3]
        there = np.einsum("mji,mj->mi", axes, there)
    true = there.mean(axis=0)
    return float(np.linalg.norm(told - true) / max(np.linalg.norm(true), 1e-3))


def main() -> None:
    """Command line."""
    from third_plant.case import Case
    from third_plant.suites import plan

    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seed", type=int, default=int(np.random.default_rng().integers(2**31)))
    parser.add_argument("--count", type=int, default=12, help="arms, 12 at most")
    args = parser.parse_args()
    print(f"seed {args.seed}")
    print("| push | arms | named | with another name | without | force off: median, most [%] |")
    print("| --- | --- | --- | --- | --- | --- |", flush=True)
    robot = load_robot("irb2400")
    model = Model(robot)
    arms = [arm for arm in plan(args.seed) if arm.suite == "clean"][: args.count]
    for shape in SHAPES:
        wrong = []
        others = 0
        for k, arm in enumerate(arms):
            log, acts = pushed(Case(arm), shape, [args.seed, k])
            names = diagnose(robot, log).findings
            forces = [f for f in names if f.effect.kind == "process_force"]
            others += len(forces) < len(names)
            wrong += [min(off(f, log, acts, model) for f in forces)] if forces else []
        percent = 100.0 * np.array(wrong or [np.nan])
        said = f"{np.median(percent):.0f}, {percent.max():.0f}"
        without = len(arms) - len(wrong)
        print(
            f"| {shape} | {len(arms)} | {len(wrong)} | {others} | {without} | {said} |", flush=True
        )


if __name__ == "__main__":
    with threadpool_limits(limits=1, user_api="blas"):
        main()
