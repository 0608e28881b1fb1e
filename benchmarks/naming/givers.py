"""Who gives names to a log: the library's diagnosis, and the afternoon's baseline beside it."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from benchmarks.baseline_names import names as baseline_names
from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.robot import Robot

Said = dict[str, Any]
TOLD = ("kind", "joint", "confidence", "alternatives", "parameters", "standard_errors")
TOLD += ("log_evidence", "margin")
"""of each effect"""
TRIM = 0.9
"""share of the differences that counts for the floor: reversals and lost samples are the rest"""
TRIMMED_RMS = 0.789
"""rms of the inner 90 % of a normal distribution"""


def difference_floor(log: Log) -> np.ndarray:
    """Torque noise from sample-to-sample differences of second order, (n,) [Nm]."""
    second = np.abs(np.diff(log.tau, n=2, axis=0))
    inner = np.sort(second, axis=0)[: int(TRIM * len(second))]
    return np.asarray(np.sqrt((inner**2).mean(axis=0) / 6.0) / TRIMMED_RMS)


def diagnosis(robot: Robot, log: Log) -> Said:
    """`diagnose` with its defaults."""
    start = time.process_time()
    try:
        found = diagnose(robot, log)
    except InputError as error:
        return {"refused": str(error), "cpu": time.process_time() - start}
    cpu = time.process_time() - start
    said = found.to_json()
    compared = found.identification
    left = np.where(compared.known, compared.measured - compared.after, np.nan)
    return {
        "verdict": said["verdict"],
        "names": [{k: e[k] for k in TOLD} for e in said["effects"]],
        "unexplained": said["unexplained"],
        "recalibrated": sorted(said["recalibrated"]),
        "said": {k: v for k, v in said.items() if k not in ("effects", "error")},
        "left": np.sqrt(np.nanmean(left**2, axis=0)).tolist(),
        "cpu": cpu,
    }


def baseline(robot: Robot, log: Log) -> Said:
    """Forward selection over columns."""
    start = time.process_time()
    found = baseline_names(robot, log)
    return {
        "verdict": "explained" if found else "nothing_missing",
        "names": [
            {"kind": n.kind, "joint": n.joint, "confidence": None, "alternatives": []}
            for n in found
        ],
        "unexplained": [],
        "recalibrated": [],
        "cpu": time.process_time() - start,
    }


GIVERS: dict[str, Callable[[Robot, Log], Said]] = {"diagnosis": diagnosis, "baseline": baseline}
