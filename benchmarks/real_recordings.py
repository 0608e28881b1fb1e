"""What two real robots have and their rigid-body data lack: KUKA KR300 (B validates A), Staubli
TX40 (blocks).

    python benchmarks/real_recordings.py FOLDER OUT

FOLDER holds kr300/ and tx40/ with robot.json and the recordings (public data, not part of this
project).
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np

from irb2400_ctrl.diagnosis import Diagnosis, diagnose
from irb2400_ctrl.diagnosis.comparison.criteria import Criteria
from irb2400_ctrl.measurement import Log, read_log
from irb2400_ctrl.robot import Robot


def robot_of(path: Path) -> Robot:
    """A robot from rigid-body data alone: no friction, no limits known (wide ones are entered and
    labelled so)."""
    data = json.loads(path.read_text())
    n = len(data["joints"])
    unknown = "assumption: not in the source; wide"
    links = []
    joints = []
    for joint in data["joints"]:
        inertia = np.array(joint["inertia_about_com_kgm2"])
        xx, xy, xz, yy, yz, zz = inertia[np.triu_indices(3)]
        body = {
            "mass_kg": joint["mass_kg"],
            "com_m": joint["com_m"],
            "inertia_kgm2": (xx, yy, zz, xy, xz, yz),
        }
        frame = {"transform": joint["parent_to_joint"]}
        links.append({"name": joint["name"], "frame": frame, "body": body, "source": data["about"]})
        limits = {
            "range_deg": (-400.0, 400.0),
            "speed_deg_s": 1000.0,
            "range_source": unknown,
            "torque_Nm": 1e5,
            "torque_source": unknown,
        }
        friction = {
            "static_Nm": 0,
            "coulomb_Nm": 0,
            "viscous_Nms_rad": 0,
            "stribeck_rad_s": 0.01,
            "source": "not known",
        }
        joints.append({"name": joint["name"], "friction": friction, "limits": limits})
    return Robot.model_validate(
        {
            "name": data["name"],
            "source": data["about"],
            "gravity_m_s2": data["gravity_m_s2"],
            "gravity_source": data["about"],
            "links": links,
            "joints": joints,
            "coupling": {
                "matrix": np.eye(n).tolist(),
                "offset_rad": [0.0] * n,
                "source": "serial arm",
            },
            "flange": {"transform": data.get("last_joint_to_flange", np.eye(4).tolist())},
        }
    )


def blocks(log: Log, seconds: float = 2.25, gap: float = 0.05) -> tuple[Log, Log]:
    """Even and odd blocks of a record, with a pause between them that no filter bridges."""
    place = np.floor((log.time - log.time[0]) / seconds).astype(int)
    inside = (log.time - log.time[0]) % seconds < seconds - gap
    parts = []
    for side in (0, 1):
        rows = inside & (place % 2 == side)
        parts.append(
            Log(
                log.time[rows],
                log.q[rows],
                log.tau[rows],
                name=f"{log.name}, {('even', 'odd')[side]} blocks",
            )
        )
    return parts[0], parts[1]


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
    criteria = Criteria(most=args.most, unknown_share=1e6)
    kr300 = args.folder / "kr300"
    first = diagnose(
        robot_of(kr300 / "robot.json"),
        read_log(kr300 / "A.csv.gz"),
        read_log(kr300 / "B.csv.gz"),
        criteria=criteria,
    )
    first.write(args.out / "kr300")
    print(told(first), flush=True)
    tx40 = args.folder / "tx40"
    second = diagnose(
        robot_of(tx40 / "robot.json"), *blocks(read_log(tx40 / "log.csv.gz")), criteria=criteria
    )
    second.write(args.out / "tx40")
    print(told(second))


if __name__ == "__main__":
    main()
