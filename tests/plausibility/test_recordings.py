"""No real recording is refused. Optional: the recordings are not part of the project."""

from __future__ import annotations

import importlib.util
import os
import sys
from pathlib import Path
from typing import Any

import pytest

from irb2400_ctrl.measurement import read_log
from irb2400_ctrl.plausibility import log_problem
from irb2400_ctrl.robot import Robot, load_robot

BESIDE = Path(__file__).parents[2] / ".." / "shared"
SHARED = Path(os.environ.get("IRB2400_SHARED", BESIDE))
FILES = sorted([*SHARED.glob("measured/*/*.csv.gz"), *SHARED.glob("measured/*/*.db3")])
ARMS = sorted(SHARED.glob("logs/arm_*/*.csv.gz"))
needs_files = pytest.mark.skipif(not FILES, reason="no recordings beside the project")


def real_robots() -> Any:
    """The benchmark's own module."""
    place = Path(__file__).parents[2] / "benchmarks" / "real_robots.py"
    spec = importlib.util.spec_from_file_location("real_robots", place)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # where its dataclasses look for themselves
    spec.loader.exec_module(module)
    return module


def robot_of(path: Path) -> Robot:
    """The robot of a recording, as the benchmark reads it."""
    found: Robot = real_robots().robot_of(path)
    return found


@needs_files
def test_no_recording_is_refused() -> None:
    refused = {}
    for path in FILES:
        file = path.parent / "robot.json"
        problem = log_problem(robot_of(file) if file.is_file() else None, read_log(path))
        if problem is not None:
            refused[path.name] = problem.says
    assert refused == {}


@needs_files
@pytest.mark.slow
@pytest.mark.parametrize("name", ["lwa4p", "panda", "ur10"])
def test_no_recording_is_refused_beside_guessed_bodies(name: str) -> None:
    """Three of the LWA 4P's were: gravity taken out, for a joint at rest that friction holds."""
    case = real_robots().CASES[name](SHARED / "measured")
    logs = [*case.logs, *case.others]
    assert [log.name for log in logs if log_problem(case.robot, log) is not None] == []


@needs_files
def test_a_recording_is_refused_for_another_robot() -> None:
    for path in FILES:
        if path.suffix == ".db3" or path.parent.name in ("kr300", "tx40"):
            problem = log_problem(load_robot("irb2400"), read_log(path))
            assert problem is not None, path


@pytest.mark.skipif(not ARMS, reason="no logs beside the project")
def test_no_log_of_the_arms_is_refused() -> None:
    robot = load_robot("irb2400")
    refused = [path for path in ARMS if log_problem(robot, read_log(path)) is not None]
    assert refused == []
