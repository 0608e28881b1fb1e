"""A log of an arm that cuts, or leans against something, is that arm's log."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from independent_plant import Case

from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.model import Model
from irb2400_ctrl.plausibility.evidence import Nominal
from irb2400_ctrl.plausibility.log_check import check_log, log_problem
from irb2400_ctrl.plausibility.pushed import pushed
from irb2400_ctrl.plausibility.rows import rows_of
from irb2400_ctrl.plausibility.search import LOST_PRICE, understand
from irb2400_ctrl.robot import load_robot

ROBOT = load_robot("irb2400")
TIMES = {
    "always": ((-1.0, 99.0),),
    "half": ((5.0, 17.0),),
    "cuts": ((3.0, 6.0), (8.0, 11.0), (13.0, 16.0), (18.0, 21.0)),
}


@cache
def sound(in_tool_frame: bool = False) -> tuple[Log, np.ndarray]:
    """A sound arm's log, and the torque of one newton at the tool, shape (m, n) [Nm]."""
    log = Case(77, duration=25.0, validation_duration=3.0).simulate()[0]
    force = LIBRARY["process_force"].of(
        None, force_x_N=0.6, force_z_N=0.8, in_tool_frame=in_tool_frame
    )
    still = 0.0 * log.q
    pair = [
        Model(r).inverse_dynamics(log.q, still, still) for r in (ROBOT.with_effects(force), ROBOT)
    ]
    return Log(log.time, log.q, log.tau, qd=log.qd, q_ref=log.q_ref), pair[0] - pair[1]


def log(times: str, size: float, in_tool_frame: bool = False) -> Log:
    """With a force at the tool [N] at these times."""
    free, one = sound(in_tool_frame)
    acts = sum((free.time >= start) & (free.time < stop) for start, stop in TIMES[times])
    return Log(
        free.time, free.q, free.tau + size * acts[:, None] * one, qd=free.qd, q_ref=free.q_ref
    )


@pytest.mark.parametrize("times", TIMES)
@pytest.mark.parametrize(
    ("size", "in_tool_frame"),
    [(150.0, False), pytest.param(300.0, False, marks=pytest.mark.slow), (300.0, True)],
)
def test_a_force_at_the_tool_makes_no_other_robot_of_an_arm(
    times: str, size: float, in_tool_frame: bool
) -> None:
    """From 100 N on, a log of an IRB 2400 that cuts was told to be another robot's."""
    found = understand(ROBOT, log(times, size, in_tool_frame))
    assert found is not None
    assert found.labelled.price > LOST_PRICE
    assert found.problem is None
    assert not found.reading.kind


def test_a_cut_of_half_a_slow_motion_is_found_too() -> None:
    """Of a milling program that cuts from 5 to 21 s of 29 the search began with a force that always
    acts, and ended there: "another robot"."""
    time = np.arange(0.0, 29.0, 0.01)
    drawn = np.random.default_rng(0)
    rates = 2.0 * np.pi * drawn.uniform(0.03, 0.2, 6)
    sizes = np.radians(drawn.uniform(5.0, 25.0, 6))
    phase = rates * time[:, None] + drawn.uniform(0.0, 6.0, 6)
    q = np.radians([0.0, 20.0, 20.0, -60.0, 80.0, -100.0]) + sizes * np.sin(phase)
    qd = sizes * rates * np.cos(phase)
    force = LIBRARY["process_force"].of(None, force_x_N=-60.0, force_y_N=75.0, force_z_N=-105.0)
    acts = (time >= 5.0) & (time < 21.0)
    free, cut = (
        Model(robot).inverse_dynamics(q, qd, -sizes * rates**2 * np.sin(phase))
        for robot in (ROBOT, ROBOT.with_effects(force))
    )
    noise = np.random.default_rng(1).normal(size=q.shape) * [1.0, 1.0, 0.6, 0.1, 0.15, 0.06]
    found = understand(ROBOT, Log(time, q, np.where(acts[:, None], cut, free) + noise))
    assert found is not None
    assert found.labelled.price > LOST_PRICE
    assert found.problem is None


def test_it_is_said() -> None:
    when, what = check_log(ROBOT, log("half", 200.0)).remarks
    assert "does not go with the rest of the log" in when
    assert "force at the tool" in what


def test_it_is_named() -> None:
    (found,) = diagnose(ROBOT, log("cuts", 200.0)).findings
    assert found.effect.kind == "process_force"
    assert found.effect.sizes()[0] == pytest.approx(200.0, rel=0.1)


def test_no_force_makes_a_robot_of_other_columns() -> None:
    """Joints in another order, torques of another motion, degrees for radians."""
    free = sound()[0]
    others = {
        "order": Log(free.time, free.q[:, [1, 0, 2, 3, 4, 5]], free.tau),
        "torques": Log(free.time, free.q, free.tau[::-1]),
        "degrees": Log(free.time, np.radians(free.q), free.tau),
    }
    nominal = Nominal(ROBOT)
    for name, other in others.items():
        rows = rows_of(other)
        assert rows is not None
        assert not pushed(nominal, rows, nominal.columns(rows)), name
        assert log_problem(ROBOT, other) is not None, name
