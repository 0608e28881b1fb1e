"""The public arms as robots, imported once."""

from __future__ import annotations

import tempfile
from functools import cache
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from robots.public_arms import arms, urdf

import irb2400_ctrl as irb
from irb2400_ctrl.robot.importing import import_robot

Array = npt.NDArray[np.float64]
SIX_AXES = tuple(name for name, arm in arms().items() if len(arm.axes) == 6)
FEW = ("ur10e", "kr16", "tx90", "puma560")
MOST = [pytest.param(a, marks=[pytest.mark.slow] * (a not in FEW)) for a in SIX_AXES]
"""what costs seconds an arm is tried on a few makers' each time, on all by `make test-all`"""


@cache
def robot(name: str) -> irb.Robot:
    """One of the nine arms."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"{name}.urdf"
        path.write_text(urdf(arms()[name]))
        return import_robot(path).robot


def bent(model: irb.Model) -> Array:
    """A configuration with the tool in front of the arm, far from singularities."""
    g = model.arm_geometry
    down = np.array([0.1, 0.1, 0.15, 0.0, np.pi / 2, 0.0])
    if not g.spherical:
        down = np.array([0.1, 0.0, 2.0, np.pi / 2, -np.pi / 2, 0.0])
    return np.asarray(np.linalg.solve(g.C, down - g.offset))


def mixed(seed: int = 0) -> irb.Robot:
    """Six axes of no family: skew angles and offsets everywhere."""
    from irb2400_ctrl.robot import ModifiedDH

    rng = np.random.default_rng(seed)
    base = robot("irb1200")
    links = tuple(
        link.model_copy(
            update={
                "frame": ModifiedDH(
                    a_m=float(rng.uniform(0.05, 0.4)),
                    alpha_rad=float(rng.uniform(0.4, 2.0) * rng.choice([-1, 1])),
                    d_m=float(rng.uniform(-0.2, 0.3)),
                )
            }
        )
        for link in base.links
    )
    return base.model_copy(update={"links": links, "name": "no family"})


def offset_wrist(kind: str) -> irb.Robot:
    """An arm whose axes 4, 5, 6 do not meet, lengths as of a cobot of 10 kg.

    Args:
        kind: "along" parts axes 4 and 6 along axis 5 (up to 16 branches), "across" axis 5 from axis
            4 at right angles to both.
    """
    from irb2400_ctrl.robot import ModifiedDH

    half = np.pi / 2
    d5, a4 = {"along": (0.15, 0.0), "across": (0.0, 0.08)}[kind]
    rows = (
        (0.0, 0.0, 0.25), (0.0, -half, 0.0), (0.71, 0.0, 0.0), (0.0, -half, 0.54),
        (a4, half, d5), (0.0, -half, 0.16),
    )  # fmt: skip
    base = robot("irb1200")
    links = tuple(
        link.model_copy(update={"frame": ModifiedDH(a_m=a, alpha_rad=alpha, d_m=d)})
        for link, (a, alpha, d) in zip(base.links, rows, strict=True)
    )
    return base.model_copy(update={"links": links, "name": f"wrist offset {kind}"})
