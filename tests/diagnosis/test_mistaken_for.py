"""What is in no library and passes for an effect of certain numbers."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from independent_plant import Case

from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.diagnosis.comparison.comparison import Alternative
from irb2400_ctrl.diagnosis.comparison.confidence import LOOKALIKE_CAP, confidence
from irb2400_ctrl.diagnosis.comparison.step import Step
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import load_robot

ROBOT = load_robot("irb2400")
PUSHES = {
    # of a liquid, of a loose load: named at 0.92 and 0.86
    ((9.07, 9.82), (30.07, 30.51), (36.07, 36.26), (37.38, 37.63)): True,
    ((2.0, 2.8), (10.1, 10.6), (21.7, 21.9)): True,
    # cuts of one length, the last as long as the record lasts; contacts
    ((1.0, 1.9), (3.0, 3.9), (5.0, 5.9), (7.0, 7.5)): False,
    ((1.0, 3.3), (4.5, 6.9), (8.5, 8.9)): True,
    ((1.0, 2.2), (4.5, 9.9), (12.0, 14.0)): False,
    ((15.1, 15.3), (17.1, 18.4)): False,
    ((20.1, 20.4),): False,
    # torques that stood still: named at 0.96 and 0.98
    ((23.91, 23.98),): True,
    ((9.94, 10.06), (14.35, 14.44)): True,
    (): False,
}


@pytest.mark.parametrize("windows", PUSHES)
def test_short_pushes_may_be_a_load_that_swings_or_torques_that_stood_still(windows: Any) -> None:
    force = LIBRARY["process_force"].of(None, force_x_N=30.0, windows_s=windows)
    assert bool(force.mistaken_for) == PUSHES[windows]
    candidate: Any = SimpleNamespace(
        kind="process_force", joint=None, known=True, effects=(force,), name="force"
    )
    step = Step(candidate, 1e3, (Alternative(candidate, 1e3, 1e3),))
    assert (confidence(step) > LOOKALIKE_CAP) == (not PUSHES[windows])


@pytest.mark.parametrize(
    ("here", "there", "gyroscopic"),
    [
        (0.49, -0.42, True),
        (0.27, -0.58, False),
        (-0.34, 0.58, True),
        (0.5, 0.4, False),
        (0.0, 0.8, False),
        (-0.13, 0.01, False),
        (0.0, 0.0, False),
    ],
)
def test_a_coupling_that_takes_no_work_may_be_a_spindle_that_turns(
    here: float, there: float, gyroscopic: bool
) -> None:
    """The moment of one was a coupling of axes 4 and 5, at 0.94."""
    numbers = {"viscous_Nms_rad": here, "neighbour_viscous_Nms_rad": there}
    coupling = LIBRARY["wrist_coupling"].of(4, **numbers)
    assert coupling.mistaken_for.startswith("joint 4: what this axis and joint 5 do") == gyroscopic


def test_a_coupling_that_begins_in_the_middle_may_be_a_spindle_that_is_switched_on() -> None:
    """One was two couplings, from 9.4 and from 10.5 s on, at 0.94."""
    numbers = {"viscous_Nms_rad": 0.1, "neighbour_viscous_Nms_rad": 0.4}
    later = LIBRARY["wrist_coupling"].of(5, **numbers, windows_s=((9.37, 1e9),))
    assert "joint 6 do to each other begins at 9.4 s" in later.mistaken_for
    assert not LIBRARY["wrist_coupling"].of(5, **numbers).mistaken_for


@pytest.mark.slow
def test_such_a_force_says_what_else_it_may_be() -> None:
    log = Case(77, duration=25.0, validation_duration=3.0).simulate()[0]
    force = LIBRARY["process_force"].of(None, force_x_N=24.0, force_z_N=32.0)
    pushed = np.zeros(len(log.time))
    for start, stop in ((4.0, 4.8), (9.0, 11.5), (15.0, 15.9), (19.0, 21.0)):
        pushed[(log.time >= start) & (log.time < stop)] = 1.0
    qd = np.gradient(log.q, log.time, axis=0)
    torques = [
        Model(robot).inverse_dynamics(log.q, qd, 0.0 * qd)
        for robot in (ROBOT.with_effects(force), ROBOT)
    ]
    tau = log.tau + pushed[:, None] * (torques[0] - torques[1])
    found = diagnose(ROBOT, Log(log.time, log.q, tau, qd=log.qd, q_ref=log.q_ref))
    (name,) = found.findings
    assert name.effect.kind == "process_force"
    assert name.confidence <= LOOKALIKE_CAP
    (said,) = (line for line in found.weak if line.startswith("process_force"))
    assert "4 pushes" in said
