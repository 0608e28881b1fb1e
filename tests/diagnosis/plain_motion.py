"""A motion of the plain arm, shared by the tests of the parts of the diagnosis."""

from __future__ import annotations

from functools import cache

from independent_plant import Case

from irb2400_ctrl.diagnosis.regressors.bases import Bases
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.measurement.prepared_log import PreparedLog, prepare
from irb2400_ctrl.robot import load_robot

ROBOT = load_robot("irb2400")
BASES = Bases(ROBOT)


@cache
def motion() -> PreparedLog:
    recorded = Case(5, duration=8.0, validation_duration=3.0).simulate()[0]
    return prepare(Log(recorded.time, recorded.q, recorded.tau, q_ref=recorded.q_ref))
