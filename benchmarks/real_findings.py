"""What two real robots have and their rigid-body data lack: KUKA KR300 (B validates A), Staubli
TX40 (blocks).

    python -m benchmarks.real_findings FOLDER OUT

FOLDER holds kr300/ and tx40/ with robot.json and the recordings (public data, not part of this
project).
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.real_robots import kr300, tx40
from irb2400_ctrl.diagnosis import Diagnosis, diagnose
from irb2400_ctrl.diagnosis.comparison.criteria import Criteria


def told(found: Diagnosis) -> str:
    """A readable account."""
    lines = [
        f"{found.given.name}: {found.verdict}; noise floor "
        f"{np.round(found.noise_floor, 2).tolist()} Nm"
    ]
    for f in found.findings:
        values: dict[str, Any] = {
            k: np.round(v, 4).tolist() for k, v in f.effect.parameters().items() if k != "shape"
        }
        lines.append(
            f"  {f.effect.kind} {f.effect.joint or ''} {values} confidence {f.confidence:.2f} "
            f"share {f.share.max():.3f} or {', '.join(f.alternatives) or 'nothing else'}"
        )
    lines.append(f"  friction: Coulomb {np.round(found.robot.friction[:, 1], 2).tolist()} Nm, ")
    lines[-1] += f"viscous {np.round(found.robot.friction[:, 2], 2).tolist()} Nm s/rad"
    lines += [
        f"  unexplained: joint {u.joint}, {u.depends_on}, {u.rmse:.2f} Nm"
        for u in found.unexplained
    ]
    for name, one in (("identification", found.identification), ("validation", found.validation)):
        if one is not None:
            for what, error in (("before", one.error_before), ("after", one.error_after)):
                rmse = np.round(error.rmse, 2).tolist()
                lines.append(
                    f"  {name} {what}: RMSE {rmse} Nm, "
                    f"{np.round(error.rmse_over_mean_percent, 1).tolist()} %"
                )
    return "\n".join(lines)


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--most", type=int, default=30)
    args = parser.parse_args()
    # so much is missing that a flexible law would take the place of several effects: names first
    criteria = Criteria(most=args.most, unknown=1e9)
    for case in (kr300(args.folder), tx40(args.folder)):
        found = diagnose(case.robot, case.logs[0], case.others[0], criteria=criteria)
        found.write(args.out / case.name)
        print(told(found), flush=True)


if __name__ == "__main__":
    main()
