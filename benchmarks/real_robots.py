"""Five real arms and their recordings, as a user would have them: what is known and no more.

Public data, not part of this project: a folder with kr300/, tx40/, ur10/, panda/, lwa4p/.
"""

from __future__ import annotations

import json
import sqlite3
import struct
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from irb2400_ctrl.measurement import Log, read_log
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.robot.importing.chain_robot import DRAWN
from irb2400_ctrl.robot.link import Transform

UNKNOWN = "assumption: not known, wide"


@dataclass(frozen=True)
class Case:
    """A robot, the logs it is identified from, and others that judge it."""

    name: str
    robot: Robot
    logs: Sequence[Log]
    others: Sequence[Log]


def part_of(log: Log, start: float, stop: float) -> Log:
    """The samples between two shares of the duration."""
    share = (log.time - log.time[0]) / log.duration
    rows = (share >= start) & (share < stop)
    qd = None if log.qd is None else log.qd[rows]
    name = f"{log.name} {start:.1f}-{stop:.1f}"
    return Log(log.time[rows], log.q[rows], log.tau[rows], qd=qd, name=name)


def arm(
    name: str,
    frames: Sequence[np.ndarray],
    bodies: Sequence[dict[str, object]],
    flange: np.ndarray | None = None,
    gravity: Sequence[float] = (0.0, 0.0, -9.81),
    uncertainty: dict[str, float] | None = None,
) -> Robot:
    """A serial arm of which frames and bodies are known, as surely as `uncertainty` says."""
    n = len(frames)
    limits = {
        "range_deg": (-400.0, 400.0),
        "speed_deg_s": 1000.0,
        "range_source": UNKNOWN,
        "torque_Nm": 1e5,
        "torque_source": UNKNOWN,
    }
    friction = {
        "static_Nm": 0,
        "coulomb_Nm": 0,
        "viscous_Nms_rad": 0,
        "stribeck_rad_s": 0.01,
        "source": UNKNOWN,
    }
    return Robot.model_validate(
        {
            "name": name,
            "source": "public data",
            "uncertainty": uncertainty or {},
            "gravity_m_s2": tuple(gravity),
            "gravity_source": "public data",
            "links": [
                {"name": f"l{i}", "frame": {"transform": X.tolist()}, "body": body, "source": "-"}
                for i, (X, body) in enumerate(zip(frames, bodies, strict=True))
            ],
            "joints": [{"name": f"j{i}", "friction": friction, "limits": limits} for i in range(n)],
            "coupling": {
                "matrix": np.eye(n).tolist(),
                "offset_rad": [0.0] * n,
                "source": "serial arm",
            },
            "flange": {"transform": (np.eye(4) if flange is None else flange).tolist()},
        }
    )


def robot_of(path: Path, uncertainty: dict[str, float] | None = None) -> Robot:
    """An arm from a file of rigid-body data alone; `uncertainty` as of `arm`."""
    data = json.loads(path.read_text())
    frames = []
    bodies: list[dict[str, object]] = []
    for joint in data["joints"]:
        xx, xy, xz, yy, yz, zz = np.array(joint["inertia_about_com_kgm2"])[np.triu_indices(3)]
        six = (xx, yy, zz, xy, xz, yz)
        frames.append(np.array(joint["parent_to_joint"]))
        bodies.append({"mass_kg": joint["mass_kg"], "com_m": joint["com_m"], "inertia_kgm2": six})
    flange = np.array(data.get("last_joint_to_flange", np.eye(4)))
    return arm(data["name"], frames, bodies, flange, data["gravity_m_s2"], uncertainty)


def blocks(log: Log, seconds: float = 2.25, gap: float = 0.05) -> tuple[Log, Log]:
    """Even and odd blocks of a record, with a pause between them that no filter bridges."""
    place = np.floor((log.time - log.time[0]) / seconds).astype(int)
    inside = (log.time - log.time[0]) % seconds < seconds - gap
    parts = []
    for side in (0, 1):
        rows = inside & (place % 2 == side)
        name = f"{log.name}, {('even', 'odd')[side]} blocks"
        parts.append(Log(log.time[rows], log.q[rows], log.tau[rows], name=name))
    return parts[0], parts[1]


def guessed(masses: Sequence[float]) -> list[dict[str, object]]:
    """Bodies of which only a mass is guessed: centre at the frame, the size of a forearm."""
    return [
        {
            "mass_kg": m,
            "com_m": (0.0, 0.0, 0.0),
            "inertia_kgm2": (0.02 * m, 0.02 * m, 0.01 * m, 0.0, 0.0, 0.0),
        }
        for m in masses
    ]


def _rotation_x(angle: float) -> np.ndarray:
    X = np.eye(4)
    c = np.cos(angle)
    s = np.sin(angle)
    X[1:3, 1:3] = [[c, -s], [s, c]]
    return X


def _rotation_z(angle: float) -> np.ndarray:
    X = np.eye(4)
    c = np.cos(angle)
    s = np.sin(angle)
    X[:2, :2] = [[c, -s], [s, c]]
    return X


def _shift(x: float, z: float) -> np.ndarray:
    X = np.eye(4)
    X[0, 3] = x
    X[2, 3] = z
    return X


def modified_dh(rows: Sequence[tuple[float, float, float]]) -> list[np.ndarray]:
    """Frames from (a, alpha, d)."""
    return [_rotation_x(alpha) @ _shift(a, d) for a, alpha, d in rows]


def standard_dh(
    rows: Sequence[tuple[float, float, float, float]],
) -> tuple[list[np.ndarray], np.ndarray]:
    """Frames and flange from (a, alpha, d, offset): what follows a joint precedes the next."""
    frames = []
    before = np.eye(4)
    for a, alpha, d, offset in rows:
        frames.append(before @ _rotation_z(offset))
        before = _shift(a, d) @ _rotation_x(alpha)
    return frames, before


def joint_states(path: Path, period: float) -> Log:
    """`sensor_msgs/JointState` of a ROS 2 bag (SQLite); its stamps jitter: the index is time."""
    rows = sqlite3.connect(path).execute("select data from messages order by timestamp")
    found = np.array([_joint_state(data) for (data,) in rows])
    time = period * np.arange(len(found))
    return Log(time, found[:, 0], found[:, 2], qd=found[:, 1], name=path.name)


def _joint_state(data: bytes) -> list[tuple[float, ...]]:
    """Positions, velocities, efforts of a message in CDR."""
    at = 4 + 8  # encapsulation, stamp
    (length,) = struct.unpack_from("<I", data, at)
    at = 4 + (at + 4 + length - 4 + 3) // 4 * 4
    (count,) = struct.unpack_from("<I", data, at)
    at += 4
    for _ in range(count):
        (length,) = struct.unpack_from("<I", data, at)
        at = 4 + (at + 4 + length - 4 + 3) // 4 * 4
    found = []
    for _ in range(3):
        (size,) = struct.unpack_from("<I", data, at)
        at = 4 + (at + 4 - 4 + 7) // 8 * 8
        found.append(struct.unpack_from(f"<{size}d", data, at))
        at += 8 * size
    return found


def urdf_arm(path: Path) -> Robot:
    """Frames and bodies of a URDF, read by pinocchio."""
    import pinocchio as pin

    model = pin.buildModelFromUrdf(str(path))
    bodies: list[dict[str, object]] = []
    for inertia in list(model.inertias)[1:]:
        I = inertia.inertia  # noqa: E741
        six = (I[0, 0], I[1, 1], I[2, 2], I[0, 1], I[0, 2], I[1, 2])
        bodies.append({"mass_kg": inertia.mass, "com_m": tuple(inertia.lever), "inertia_kgm2": six})
    frames = [X.homogeneous for X in list(model.jointPlacements)[1:]]
    return arm(path.stem, frames, bodies, uncertainty=DRAWN)


def kr300(folder: Path) -> Case:
    """A validated by B."""
    robot = robot_of(folder / "kr300/robot.json")
    logs = [read_log(folder / f"kr300/{name}.csv.gz") for name in "AB"]
    return Case("kr300", robot, logs[:1], logs[1:])


def tx40(folder: Path) -> Case:
    """Even blocks validated by odd ones."""
    even, odd = blocks(read_log(folder / "tx40/log.csv.gz"))
    return Case("tx40", robot_of(folder / "tx40/robot.json", DRAWN), [even], [odd])


def ur10(folder: Path) -> Case:
    """First half validated by the second; bodies of its sister's URDF."""
    log = joint_states(folder / "ur10/joint_states.db3", 0.008)
    robot = urdf_arm(folder / "ur10/ur10e.urdf")
    return Case("ur10", robot, [part_of(log, 0, 0.5)], [part_of(log, 0.5, 1.01)])


CB3_LENGTHS = {
    0: (0.0, 0.0, 0.1273),
    2: (-0.612, 0.0, 0.0),
    3: (-0.5723, 0.0, 0.163941),
    4: (0.0, -0.1157, 0.0),
    5: (0.0, 0.0922, 0.0),
}
"""[m] where the joints of a UR10 (CB3) sit in the link before, as its maker states"""


def ur10_cb3(folder: Path) -> Case:
    """The same with the arm's own lengths, bodies still of its sister."""
    case = ur10(folder)
    links = list(case.robot.links)
    for place, lengths in CB3_LENGTHS.items():
        X = np.array(links[place].frame.transform)
        X[:3, 3] = lengths
        links[place] = links[place].model_copy(update={"frame": Transform(transform=X.tolist())})
    return replace(case, robot=case.robot.model_copy(update={"links": tuple(links)}))


def panda(folder: Path) -> Case:
    """First half validated by the second; masses of Gaz et al. 2019, the rest guessed."""
    h = np.pi / 2
    rows = [
        (0.0, 0.0, 0.333),
        (0.0, -h, 0.0),
        (0.0, h, 0.316),
        (0.0825, h, 0.0),
        (-0.0825, -h, 0.384),
        (0.0, h, 0.0),
        (0.088, h, 0.0),
    ]
    masses = [4.97, 0.65, 3.23, 3.59, 1.23, 1.67, 0.74]
    log = read_log(folder / "panda/log.csv.gz")
    robot = arm("panda", modified_dh(rows), guessed(masses))
    return Case("panda", robot, [part_of(log, 0, 0.5)], [part_of(log, 0.5, 1.01)])


def lwa4p(folder: Path) -> Case:
    """Every fifth run validated by the others; bodies guessed."""
    h = np.pi / 2
    rows = [
        (0.0, -h, 0.205, 0.0),
        (0.35, np.pi, 0.0, -h),
        (0.0, -h, 0.0, -h),
        (0.0, h, 0.305, 0.0),
        (0.0, -h, 0.0, 0.0),
        (0.0, 0.0, 0.075, 0.0),
    ]
    frames, flange = standard_dh(rows)
    robot = arm("lwa4p", frames, guessed([3.0, 3.0, 2.0, 2.0, 1.0, 0.5]), flange)
    logs = [read_log(path) for path in sorted((folder / "lwa4p").glob("*.gz"))]
    logs = [log for log in logs if log.duration > 2.2]
    return Case("lwa4p", robot, logs[::5], [log for k, log in enumerate(logs) if k % 5])


CASES: dict[str, Callable[[Path], Case]] = {
    "kr300": kr300,
    "tx40": tx40,
    "ur10": ur10,
    "panda": panda,
    "lwa4p": lwa4p,
}
VARIANTS: dict[str, Callable[[Path], Case]] = {"ur10_cb3": ur10_cb3}
"""of the same recordings, with something of the robot's file set right"""
