"""Arms of the second and third plant by seed and name, and what a diagnosis of their logs says."""

from __future__ import annotations

from typing import Any

from mujoco_plant.suites import suite
from third_plant.case import Case
from third_plant.suites import plan

import irb2400_ctrl as irb

ROBOT = irb.load_robot("irb2400")


def case_of(seed: int, name: str) -> Case:
    """The arm of the third plant that tables of a seed call by this name."""
    (arm,) = [one for one in plan(seed) if one.name == name]
    return Case(arm)


def diagnosed(case: Case) -> irb.Diagnosis:
    """What the first log of an arm of the third plant says."""
    return _diagnosis(case.identification())


def of_second_plant(seed: int, name: str) -> irb.Diagnosis:
    """What the log of the arm says that tables of a seed call by this name."""
    where, number = name.split("/")
    (case,) = suite(where, int(number), 1, seed)
    return _diagnosis(case.simulate())


def _diagnosis(seen: Any) -> irb.Diagnosis:
    log = irb.Log(seen.time, seen.q, seen.tau, qd=seen.qd, q_ref=seen.q_ref)
    return irb.diagnose(ROBOT, log)
