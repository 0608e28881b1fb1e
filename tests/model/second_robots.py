"""Two more arms with explicit transforms: one like a UR, one read from measured data when it is
there."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

import irb2400_ctrl as irb

Array = npt.NDArray[np.float64]

# measured data may lie beside the project; nothing of them is part of it
KR300 = Path(__file__).resolve().parents[3] / "shared" / "measured" / "kr300" / "robot.json"


def _transform(
    roll: float, position: tuple[float, float, float], yaw: float = 0.0
) -> dict[str, Any]:
    c = np.cos(roll)
    s = np.sin(roll)
    cy = np.cos(yaw)
    sy = np.sin(yaw)
    R = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]]) @ np.array(
        [[1, 0, 0], [0, c, -s], [0, s, c]]
    )
    X = np.eye(4)
    X[:3, :3] = R
    X[:3, 3] = position
    return {"transform": tuple(tuple(float(v) for v in row) for row in X)}


def _joint(number: int) -> dict[str, Any]:
    source = "assumption: invented for the test"
    return {
        "name": f"axis_{number}",
        "friction": {
            "static_Nm": 2.0,
            "coulomb_Nm": 1.0,
            "viscous_Nms_rad": 3.0,
            "stribeck_rad_s": 0.02,
            "source": source,
        },
        "limits": {
            "range_deg": (-180.0, 180.0),
            "speed_deg_s": 180.0,
            "range_source": source,
            "torque_Nm": 500.0,
            "torque_source": source,
        },
    }


def _robot(
    name: str, links: list[dict[str, Any]], flange: dict[str, Any], offset: tuple[float, ...]
) -> irb.Robot:
    n = len(links)
    return irb.Robot.model_validate(
        {
            "name": name,
            "source": "built in the test",
            "gravity_m_s2": (0.0, 0.0, -9.81),
            "gravity_source": "standard value",
            "links": links,
            "joints": [_joint(i + 1) for i in range(n)],
            "coupling": {
                "matrix": np.eye(n).tolist(),
                "offset_rad": offset,
                "source": "serial arm",
            },
            "flange": flange,
        }
    )


def ur_like(seed: int = 0) -> irb.Robot:
    """Three parallel axes, no spherical wrist, skew offsets; masses and tensors of random
    bodies."""
    rng = np.random.default_rng(seed)
    frames = [
        _transform(0.0, (0.0, 0.0, 0.16)),
        _transform(np.pi / 2, (0.0, 0.0, 0.0)),
        _transform(0.0, (-0.61, 0.0, 0.0)),
        _transform(0.0, (-0.57, 0.0, 0.17), yaw=0.4),
        _transform(np.pi / 2, (0.0, -0.12, 0.0)),
        _transform(-np.pi / 2, (0.0, 0.12, 0.0), yaw=-0.3),
    ]
    links = []
    for i, frame in enumerate(frames):
        points = rng.normal(0.0, 0.1, (8, 3))
        masses = rng.uniform(0.2, 1.0, 8)
        m = masses.sum()
        c = masses @ points / masses.sum()
        Sigma = np.einsum("k,ki,kj->ij", masses, points - c, points - c)
        tensor = np.trace(Sigma) * np.eye(3) - Sigma
        six = (tensor[0, 0], tensor[1, 1], tensor[2, 2], tensor[0, 1], tensor[0, 2], tensor[1, 2])
        body = {"mass_kg": m, "com_m": tuple(c), "inertia_kgm2": tuple(float(v) for v in six)}
        links.append(
            {"name": f"link_{i + 1}", "frame": frame, "body": body, "source": "random bodies"}
        )
    return _robot(
        "like a UR", links, _transform(0.2, (0.0, 0.0, 0.1)), (0.0, 0.3, 0.0, -np.pi / 2, 0.0, 0.1)
    )


def kr300() -> irb.Robot:
    """The KUKA KR300 of the measured data."""
    data = json.loads(KR300.read_text())
    links = []
    for joint in data["joints"]:
        tensor = np.array(joint["inertia_about_com_kgm2"])
        six = (tensor[0, 0], tensor[1, 1], tensor[2, 2], tensor[0, 1], tensor[0, 2], tensor[1, 2])
        body = {
            "mass_kg": joint["mass_kg"],
            "com_m": tuple(joint["com_m"]),
            "inertia_kgm2": tuple(float(v) for v in six),
        }
        frame = {"transform": tuple(tuple(row) for row in joint["parent_to_joint"])}
        links.append(
            {
                "name": joint["name"],
                "frame": frame,
                "body": body,
                "source": "the measured data's model file",
            }
        )
    flange = {"transform": tuple(tuple(row) for row in data["last_joint_to_flange"])}
    return _robot(data["name"], links, flange, (0.0,) * len(links))
