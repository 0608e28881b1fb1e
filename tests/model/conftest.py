"""What the model tests share: the arm, the reference states, random states inside the joint box."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from model.states import States, random_states

import irb2400_ctrl as irb

DATA = Path(__file__).parents[1] / "data"
Array = npt.NDArray[np.float64]


@pytest.fixture(scope="session")
def robot() -> irb.Robot:
    return irb.load_robot("irb2400")


@pytest.fixture(scope="session")
def model(robot: irb.Robot) -> irb.Model:
    return irb.Model(robot)


@pytest.fixture(scope="session")
def states(robot: irb.Robot) -> States:
    return random_states(robot, 200)


@pytest.fixture(scope="session")
def reference() -> dict[str, Array]:
    """40 states of an independent rigid-body engine, stacked: name -> (40, ...)."""
    rows = json.loads((DATA / "irb2400_states.json").read_text())["states"]
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}
