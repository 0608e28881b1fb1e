"""What a log looks like is said as one thing, the likeliest first."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from sound_logs import Drawn, sound_log

import irb2400_ctrl as irb
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.identification.understood_logs import understood_logs
from irb2400_ctrl.plausibility import check_log, log_problem
from irb2400_ctrl.plausibility.criteria import behind
from irb2400_ctrl.plausibility.evidence import Fit
from irb2400_ctrl.plausibility.reading import Reading
from irb2400_ctrl.robot import Body, load_robot

ROBOT = load_robot("irb2400")


@cache
def plain() -> Drawn:
    return sound_log(601, plain=True)


def test_a_small_factor_may_be_that_of_a_current() -> None:
    """Efforts of an arm's driver are currents, of 7 to 13 Nm/A: "motor side" sent to its gears."""
    log = plain().log
    problem = log_problem(ROBOT, replace(log, tau=log.tau / 9.5))
    assert problem is not None
    assert problem.kind == "torque_scale"
    assert "motor side, or currents: times " in problem.says


def test_degrees_are_said_first_where_the_torques_want_them() -> None:
    """Of an arm that is far from its file they were "the motor's", with gears to be given."""
    log = plain().log
    tau = log.tau + 0.5 * log.tau.std(axis=0) * np.sin(2.3 * log.time)[:, None]
    problem = log_problem(ROBOT, replace(log, q=np.degrees(log.q), tau=tau, qd=None, q_ref=None))
    assert problem is not None
    assert problem.kind == "angle_unit"
    assert problem.says.startswith("angles look like degrees under the name of radians: as written")
    assert "its range is 360 deg" in problem.says


def test_an_order_of_several_exchanges_is_said_as_one() -> None:
    """As joint states of a bag come: it was three exchanges, one beside the other."""
    log = plain().log
    problem = log_problem(ROBOT, replace(log, tau=log.tau[:, [1, 2, 3, 0, 4, 5]]))
    assert problem is not None
    assert problem.kind == "torque_order"
    assert problem.says == (
        "torque columns look exchanged: joints 1 to 6 are columns 4, 1, 2, 3, 5, 6"
    )
    assert problem.fits == {"columns": [4, 1, 2, 3, 5, 6]}
    assert problem.joints == (1, 2, 3, 4)


@pytest.mark.parametrize(
    ("mass", "says"), [(0.0, "no link has a mass"), (1.0, "the same mass data, placeholders")]
)
def test_a_robot_file_without_bodies_tells_nothing_of_a_log(mass: float, says: str) -> None:
    """As files of ROS-Industrial are: a sound log of the arm was "another robot"."""
    size = (mass, mass, mass, 0.0, 0.0, 0.0)
    same = Body(mass_kg=mass, com_m=(0.0, 0.0, 0.0), inertia_kgm2=size)
    links = tuple(link.model_copy(update={"body": same}) for link in ROBOT.links)
    bare = ROBOT.model_copy(update={"links": links, "tool": None})
    log = plain().log
    found = check_log(bare, log)
    assert found.sound
    assert found.left is None
    assert found.made_by_angles is None
    assert says in found.remarks[0]
    assert "irb2400 identify" in found.remarks[0]
    assert log_problem(bare, log) is None
    # nor does identify call its numbers far off
    assert [seen.problem for _, seen in understood_logs(bare, [log]).taken] == [None]
    # what the columns show of themselves, and the ranges, count as before
    far = log_problem(bare, replace(log, q=120.0 * log.q, qd=None, q_ref=None))
    assert far is not None
    assert far.kind == "angle_scale"
    with pytest.raises(InputError, match=rf"{says}, expected a model.*irb2400 identify"):
        irb.diagnose(bare, log)


def test_a_zero_that_explains_its_own_joint_worse_is_none() -> None:
    """A recording of an arm was refused for a zero of joint 6, of which it left more."""
    none = np.eye(3)
    zero = Reading("angle_zero", "", none, np.zeros(3), none, joints=(2,))
    labelled = Fit(90.0, 60.0, np.array([0.3, 0.2, 0.3]))
    worse = Fit(50.0, 30.0, np.array([0.1, 0.25, 0.1]))
    assert behind(zero, worse, labelled)
    assert not behind(zero, replace(worse, left=np.array([0.1, 0.15, 0.1])), labelled)
    assert not behind(replace(zero, kind="angle_sign"), worse, labelled)
