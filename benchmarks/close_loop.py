"""What a finding is worth to the controller, on arms that share no code with the library.

    python benchmarks/close_loop.py [--arms 3] [--seed 31] [--only gear_ripple …] [--real
    float|double]

Each row: arms of the independent plant with one effect (`tests/independent_plant`, physics at 4
kHz, laws of other shapes) -> their identification logs -> `diagnose` -> the controller's C package
made again -> that C code follows another motion on the same arm. Three descriptions stand behind
the controller: the robot as given; the same with the parameters that the diagnosis found but
without the effect it named; the robot as diagnosed. Each cell has these three. Means over the arms,
rms over 30 s: true angle of the axis with the effect (of all axes for one of the whole arm) [mdeg],
tip of the tool [mm]. Prints Markdown.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from closing_the_loop import CONTROLLERS, Closed, Tracking, close
from independent_plant import Case, Effect

from irb2400_ctrl.robot import load_robot

ROWS: tuple[tuple[str, int | None, float], ...] = (
    ("none", None, 0.0),
    ("gear_ripple", 4, 0.15),
    ("payload", None, 0.4),
    ("balancer", 2, 0.15),
    ("cable_spring", 4, 0.15),
    ("rotor_inertia", 2, 0.15),
    ("load_friction", 2, 0.15),
    ("hysteresis", 3, 0.15),
    ("viscous_change", 1, 0.15),
    ("coulomb_change", 3, 0.15),
    ("coulomb_asymmetry", 5, 0.15),
    ("wrist_coupling", 4, 0.15),
    ("torque_gain", 3, 0.1),
    ("encoder_zero", 3, 0.1),
)
"""kind, joint, rms torque of the effect over that of the joint (of the joint it moves most)"""
DESCRIPTIONS = ("given", "recalibrated", "diagnosed")


def row(kind: str, closed: list[Closed]) -> str:
    """The line of one effect."""
    names = Counter(
        " + ".join(f"{f.effect.kind} {f.effect.joint or ''}".strip() for f in c.diagnosis.findings)
        or "nothing"
        for c in closed
    )
    truth = next((t for c in closed for t in c.case.truth), None)
    axis = "" if truth is None or truth.joint is None else f" {truth.joint}"
    cells = [kind + axis, ", ".join(f"{count} {name}" for name, count in names.most_common())]
    for controller in CONTROLLERS:
        runs = [[getattr(c, d)[controller] for c in closed] for d in DESCRIPTIONS]
        own = [
            1e3 * np.degrees(np.mean([_own_error(c, r) for c, r in zip(closed, of, strict=True)]))
            for of in runs
        ]
        tip = [1e3 * np.mean([r.tip for r in of]) for of in runs]
        cells += [", ".join(f"{x:.0f}" for x in own), ", ".join(f"{x:.2f}" for x in tip)]
    return f"| {' | '.join(cells)} |"


def _own_error(closed: Closed, tracking: Tracking) -> float:
    """Rms error of the axis with the effect [rad]; of all axes where it has none of its own."""
    joint = closed.case.truth[0].joint if closed.case.truth else None
    joints = tracking.joints
    return float(np.sqrt((joints**2).mean())) if joint is None else float(joints[joint - 1])


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--arms", type=int, default=3, help="arms per effect")
    parser.add_argument("--seed", type=int, default=31, help="of the first arm")
    parser.add_argument("--only", nargs="*", default=[], help="kinds; default all")
    parser.add_argument(
        "--real", choices=("float", "double"), default="float", help="precision of the generated C"
    )
    args = parser.parse_args()
    robot = load_robot("irb2400")
    heads = [
        "effect, axis",
        "called (arms)",
        *(f"{c}: {what}" for c in CONTROLLERS for what in ("axis", "tip")),
    ]
    print(f"| {' | '.join(heads)} |\n|{' --- |' * len(heads)}")
    for kind, joint, fraction in ROWS:
        if args.only and kind not in args.only:
            continue
        effects = () if kind == "none" else (Effect(kind, joint, fraction),)
        cases = [Case(args.seed + i, effects) for i in range(args.arms)]
        print(row(kind, [close(case, robot, real=args.real) for case in cases]), flush=True)


if __name__ == "__main__":
    main()
