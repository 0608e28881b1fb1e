"""Small studies, and work for workers that misbehave in a known way."""

from __future__ import annotations

import os
import signal
import tempfile
import time
from pathlib import Path

from irb2400_ctrl.sweep import Study, load_study
from irb2400_ctrl.sweep.cases import CaseOutcome, identity, run_case

SMALL = """
name = "small"
robot = "irb2400"
draws = 4
seed = 7

[plant]
mass = 0.02
com_m = 0.005
inertia = 0.05
friction = 0.1

[payload]
mass_kg = [0.0, 5.0]
com_m = [0.0, 0.0, [0.0, 0.1]]

[noise]
torque_Nm = [0.1, 1.0]

[[effects]]
kind = "coulomb_change"
joint = [1, 2]
probability = 0.7
coulomb_Nm = [2.0, 20.0]

[[controllers]]
controller = "feedforward_pid"

[[controllers]]
name = "soft"
controller = "computed_torque"
design = { bandwidth = 30.0 }

[[motions]]
name = "nod"
poses_deg = [[0, 0, 0, 0, 30, 0], [5, 5, 5, 5, 35, 5]]
speeds = [0.5, 1.0]

[[motions]]
name = "anywhere"
random = { share = 0.05 }
"""
CASES = 24
TRACE = "IRB2400_SWEEP_TEST_TRACE"
"""folder in which the work below leaves a file per attempt at a case"""


def write_study(folder: Path, text: str = SMALL) -> Path:
    """The study as a file."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "wanted.toml"
    path.write_text(text)
    return path


def small(folder: Path, text: str = SMALL) -> Study:
    """The study, read."""
    return load_study(write_study(folder, text))


def attempts(folder: Path) -> dict[int, int]:
    """How often each case was begun."""
    names = [int(path.name.split("-")[0]) for path in folder.iterdir()]
    return {case: names.count(case) for case in sorted(set(names))}


def traced(study: Study, index: int) -> CaseOutcome:
    """A case that leaves a mark and takes its time, without simulating anything."""
    mark(index)
    time.sleep(0.01)
    return quick(study, index)


def dies_once(study: Study, index: int) -> CaseOutcome:
    """Case 5 takes its worker down the first time."""
    if mark(index) == 1 and index == 5:
        time.sleep(0.5)  # what this worker has finished is told by then, on a busy machine as well
        os.kill(os.getpid(), getattr(signal, "SIGKILL", signal.SIGTERM))
    time.sleep(0.02)
    return quick(study, index)


def dies_always(study: Study, index: int) -> CaseOutcome:
    """Case 5 takes its worker down each time."""
    mark(index)
    if index == 5:
        os._exit(17)
    return quick(study, index)


def dies_twice(study: Study, index: int) -> CaseOutcome:
    """Case 7 takes its worker down twice; it is marked as 107, which no other work is."""
    if index == 7 and mark(100 + index) <= 2:
        os._exit(17)
    return quick(study, index)


def holds_a_folder(study: Study, index: int) -> CaseOutcome:
    """Every case but the first holds a temporary folder beside the marks."""
    if index:
        with tempfile.TemporaryDirectory(dir=os.environ[TRACE]):
            time.sleep(60.0)
    while not any(Path(os.environ[TRACE]).iterdir()):
        time.sleep(0.01)
    return quick(study, index)


def dies_at_once(study: Study, index: int) -> CaseOutcome:
    """No case is ever finished."""
    os._exit(1)


def broken(study: Study, index: int) -> CaseOutcome:
    """Case 3 meets an error of the program."""
    if index == 3:
        raise ZeroDivisionError("a mistake of ours")
    return quick(study, index)


def slow(study: Study, index: int) -> CaseOutcome:
    """A real case that leaves a mark and takes at least a tenth of a second."""
    mark(index)
    time.sleep(0.1)
    return run_case(study, index)


def quick(study: Study, index: int) -> CaseOutcome:
    """A row without a simulation."""
    figures = {"tcp_error_rms_mm": float(index), "joint1_saturated_share": 0.0}
    return CaseOutcome({**identity(study, index), **figures, "wall_time_s": 0.0})


def mark(index: int) -> int:
    """Leave a mark; returns how many there are for that case."""
    folder = Path(os.environ[TRACE])
    (folder / f"{index}-{os.getpid()}-{time.monotonic_ns()}").touch()
    return attempts(folder)[index]
