"""A law of the whole arm is as large on each joint as on the others, or it is not that law."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from diagnosis.test_names import ROBOT, names, sound
from third_plant.case import Case
from third_plant.suites import plan

from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.measurement import Log


def late(delays_ms: npt.ArrayLike) -> Log:
    """The sound log with each joint's torque as late as that."""
    log = sound()
    delays = np.asarray(delays_ms) * 1e-3
    pairs = zip(delays, log.tau.T, strict=True)
    tau = [np.interp(log.time - delay, log.time, one) for delay, one in pairs]
    return replace(log, tau=np.column_stack(tau))


def test_torques_that_are_late_alike_are_a_delay_of_all_joints() -> None:
    (finding,) = diagnose(ROBOT, late([6.0] * 6)).findings
    assert (finding.effect.kind, finding.effect.joint) == ("time_delay", None)


def test_torques_that_are_late_each_in_its_own_way_are_no_delay_of_all_joints() -> None:
    found = names(diagnose(ROBOT, late([6.0, 12.0, 2.0, 12.0, 2.0, 12.0])))
    assert ("time_delay", None) not in found


@pytest.mark.parametrize(
    ("seed", "number"), [(20261721, 14), pytest.param(20261601, 4, marks=pytest.mark.slow)]
)
def test_a_liquid_at_the_tool_is_no_delay_of_all_joints(seed: int, number: int) -> None:
    """It was one of 1 ms at 0.91 and 0.96: 1.2 ± 0.2 ms on axis 1, 0.2 ± 0.2 on axis 2."""
    (arm,) = (one for one in plan(seed) if (one.suite, one.number) == ("outside", number))
    case = Case(arm)
    assert [t.kind for t in case.truth] == ["sloshing_tool"]
    seen = case.identification()
    found = diagnose(ROBOT, Log(seen.time, seen.q, seen.tau, qd=seen.qd, q_ref=seen.q_ref))
    assert names(found) == []
    assert found.verdict == "unexplained"
