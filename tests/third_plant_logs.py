"""Arms of the third plant by seed and name, and what a diagnosis of their logs says."""

from __future__ import annotations

from third_plant.case import Case
from third_plant.suites import plan

import irb2400_ctrl as irb

ROBOT = irb.load_robot("irb2400")


def case_of(seed: int, name: str) -> Case:
    """The arm of a seed that tables call by this name."""
    (arm,) = [one for one in plan(seed) if one.name == name]
    return Case(arm)


def diagnosed(case: Case) -> irb.Diagnosis:
    """What the first log of an arm says."""
    seen = case.identification()
    log = irb.Log(seen.time, seen.q, seen.tau, qd=seen.qd, q_ref=seen.q_ref)
    return irb.diagnose(ROBOT, log)
