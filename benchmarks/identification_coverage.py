"""How often true numbers lie inside the 95 % intervals that `identify` states.

    python benchmarks/identification_coverage.py [--arms 20] [--first 9100]

Arms of the independent plant (`tests/independent_plant`) whose bodies can exist, each drawn within
the uncertainty of a data sheet, one motion of 40 s each.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from identification.possible_arms import possible_robot, scores


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--arms", type=int, default=20)
    parser.add_argument("--first", type=int, default=9100)
    args = parser.parse_args()
    robot = possible_robot()
    found = []
    names: list[str] = []
    for seed in range(args.first, args.first + args.arms):
        names, z = scores(robot, seed)
        found.append(z)
        share = float(np.mean(np.abs(z) < 1.96))
        print(f"arm {seed}: {100 * share:.1f} % inside", flush=True)
    z = np.array(found)
    inside = np.abs(z) < 1.96
    print(f"all: {100 * inside.mean():.1f} % of {inside.size} numbers inside (95 % wanted)")
    for name, share in zip(names, inside.mean(axis=0), strict=True):
        print(f"  {name:<10} {100 * share:5.1f} %")


if __name__ == "__main__":
    main()
