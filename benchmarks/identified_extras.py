"""What `identify` takes on beside bodies and friction, on arms that have one such thing or none.

    python benchmarks/identified_extras.py [--arms 20] [--first 34000]
        [--kinds load_friction wrist_coupling none]

Arms of the independent plant whose bodies can exist, each drawn within the uncertainty of a data
sheet, with one effect on a drawn joint that makes 2 to 8 % of its torque, and 30 s of motion; the
laws' shapes are drawn as well. Printed: of how many arms the robot file that comes out has the
effect on that joint, and of how many it has an effect on another joint, or of another kind; the
RMSE on another motion over that of plain least squares (base parameters, friction, offset, rotor),
on the joint and on all; of motors that another axis turns, by how much their ratios are off.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from identification.possible_arms import PossibleCase, as_read, possible_robot
from independent_plant.effects import KINDS, Effect

import irb2400_ctrl as irb

SECONDS = 30.0
FRACTIONS = (0.02, 0.08)
ALWAYS = ("rotor_inertia", "torque_offset")
"""effects that every identified arm has"""


def case_of(robot: irb.Robot, seed: int, kind: str) -> tuple[PossibleCase, int | None]:
    """An arm, and the joint of its effect."""
    if kind == "none":
        return PossibleCase(robot, seed, SECONDS), None
    rng = np.random.default_rng([seed, 80])
    joints = KINDS[kind].joints
    joint = int(rng.choice(joints)) if joints else None
    size = float(np.exp(rng.uniform(*np.log(FRACTIONS))))
    return PossibleCase(robot, seed, SECONDS, Effect(kind, joint, size)), joint


def ratios_off(case: PossibleCase, robot: irb.Robot) -> list[float]:
    """By how much the ratio of the motor that an arm's coupling turns is off, where it is found."""
    return [
        abs(effect.ratio - drawn.shape[0])
        for drawn, _, _ in case.sized_effects
        for effect in robot.effects
        if drawn.effect.kind == "wrist_coupling"
        and (effect.kind, effect.joint) == ("geared_motor", drawn.partner)
    ]


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--arms", type=int, default=20)
    parser.add_argument("--first", type=int, default=34000)
    parser.add_argument("--kinds", nargs="+", default=["load_friction", "none"])
    args = parser.parse_args()
    robot = possible_robot()
    for kind in args.kinds:
        right = 0
        others = 0
        ratios = []
        own = []
        off: list[float] = []
        for seed in range(args.first, args.first + args.arms):
            case, joint = case_of(robot, seed, kind)
            fitted, judge = (as_read(case.recorded(which), "log") for which in (0, 1))
            found = irb.identify(robot, fitted, validation=judge)
            told = {(e.kind, e.joint) for e in found.robot.effects if e.kind not in ALWAYS}
            (judged,) = [log for log in found.logs if log.role == "validation"]
            ratio = judged.error("unseen").rmse / judged.error("plain").rmse
            expected = {(kind, joint)}
            if kind == "wrist_coupling" and joint is not None:
                # the plant's: the next joint's motor turns along
                expected.add(("geared_motor", joint + 1))
            right += bool(told & expected)
            off += ratios_off(case, found.robot)
            others += bool(told - expected)
            ratios.append(ratio)
            if joint is not None:
                own.append(ratio[joint - 1])
            said = " ".join(f"{k}_{j}" for k, j in sorted(told)) or "nothing"
            here = "" if joint is None else f" on joint {joint}"
            print(f"arm {seed}: {kind}{here}; found {said}; {np.round(ratio, 2)}", flush=True)
        every = np.array(ratios)
        print(
            f"{kind}: found on {right}, something else on {others} of {args.arms}; error over that "
            f"of plain least squares {np.exp(np.log(every).mean()):.3f}, at most {every.max():.2f},"
            f" {(every > 1.05).sum()} of {every.size} joints above 1.05"
        )
        if own:
            print(
                f"  on the joint that has it {np.exp(np.log(own).mean()):.3f}, "
                f"{min(own):.2f} to {max(own):.2f}"
            )
        if off:
            print(f"  ratios of motors off by {np.median(off):.3f}, at most {max(off):.3f}")


if __name__ == "__main__":
    main()
