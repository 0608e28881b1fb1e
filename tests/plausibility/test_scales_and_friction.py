"""Torques in another unit are not made up for by bodies, and a friction of the file is no column's
fault."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from importlib import resources

import numpy as np
import pytest
from sound_logs import Drawn, sound_log

from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.identification import identify
from irb2400_ctrl.identification.understood_logs import understood_logs
from irb2400_ctrl.measurement import Log, read_log
from irb2400_ctrl.plausibility import check_log, log_problem
from irb2400_ctrl.plausibility.log_check import examined
from irb2400_ctrl.robot import Identified, Robot, load_robot
from irb2400_ctrl.robot.joint import Friction

ROBOT = load_robot("irb2400")


@cache
def plain() -> Drawn:
    return sound_log(601, plain=True)


def with_torque(factors: float | np.ndarray) -> Log:
    log = plain().log
    return replace(log, tau=log.tau * factors)


@pytest.mark.parametrize("factor", [0.02, 0.1, 0.2, 0.3, 3.0, 5.0])
def test_a_factor_that_bodies_could_make_up_for_is_told(factor: float) -> None:
    """A tenth of the torques was sound, with a link of -431 times its inertia, and at a fiftieth
    with factors of 8 for 10: bodies far from the file's leave as little."""
    problem = log_problem(ROBOT, with_torque(factor))
    assert problem is not None
    assert problem.kind == "torque_scale"
    assert problem.fits["factor"] == pytest.approx(1.0 / factor, rel=0.15)
    # the masses may be what is wrong
    assert "or the masses of the robot file are off by as much" in problem.says


@pytest.mark.parametrize("factor", [0.1, 0.3])
def test_a_factor_is_told_where_as_little_is_left_without_it(factor: float) -> None:
    """Of the log that the package brings along bodies far off leave even less of some joints, and a
    factor sought by what is left alone came out as 8.3 for 10."""
    log = read_log(str(resources.files("irb2400_ctrl") / "data" / "arm" / "validation.csv.gz"))
    problem = log_problem(ROBOT, replace(log, tau=factor * log.tau))
    assert problem is not None
    assert problem.kind == "torque_scale"
    assert problem.fits["factor"] == pytest.approx(1.0 / factor, rel=0.1)


@pytest.mark.parametrize("joint", [1, 4])
def test_a_factor_is_sought_where_the_file_itself_is_off(joint: int) -> None:
    """Without its friction the model's torque is 1.9 to 2.2 times the recorded one, not three."""
    factors = np.ones(6)
    factors[joint - 1] = 1.0 / 3.0
    bare = ROBOT.with_unknown_friction(range(1, 7))
    problem = log_problem(bare, with_torque(factors))
    assert problem is not None
    assert problem.joints == (joint,)
    assert problem.fits["factor"] == pytest.approx(3.0, rel=0.1)


def test_of_one_joint_nothing_is_said_of_masses() -> None:
    factors = np.array([1.0, 1.0, 0.1, 1.0, 1.0, 1.0])
    problem = log_problem(ROBOT, with_torque(factors))
    assert problem is not None
    assert problem.joints == (3,)
    assert "masses" not in problem.says


def test_a_current_of_a_motor_that_turns_the_other_way_is_one_thing() -> None:
    """Small and turned over: neither alone explains anything."""
    factors = np.array([0.05, 0.1, -0.1, -0.05, 0.1, 0.1])
    problem = log_problem(ROBOT, with_torque(factors))
    assert problem is not None
    assert problem.kind == "torque_scale"
    np.testing.assert_allclose(problem.fits["factors"], 1.0 / factors, rtol=0.3)
    one = np.array([1.0, 1.0, -0.1, 1.0, 1.0, 1.0])
    problem = log_problem(ROBOT, with_torque(one))
    assert problem is not None
    assert problem.joints == (3,)
    assert problem.fits["factor"] == pytest.approx(-10.0, rel=0.15)


def test_small_torques_do_not_hide_below_what_an_identification_has_left() -> None:
    """Amperes under the name of Nm passed on an arm of which a third is not understood: all of them
    were less than that."""
    log = plain().log
    size = np.sqrt(np.mean(log.tau**2, axis=0))
    ways = log.time[:, None] * np.linspace(2.0, 5.0, 6) + np.arange(6)
    rough = log.tau + 0.3 * np.sqrt(2.0) * size * np.sin(ways)
    known = Identified.of(["coulomb_1"], np.eye(1), left_Nm=tuple(0.3 * size))
    robot = ROBOT.model_copy(update={"identified": known})
    assert log_problem(robot, replace(log, tau=rough)) is None
    problem = log_problem(robot, replace(log, tau=0.1 * rough))
    assert problem is not None
    assert problem.kind == "torque_scale"
    one = np.array([1.0, 1.0, 1.0, 0.1, 1.0, 1.0])
    problem = log_problem(robot, replace(log, tau=one * rough))
    assert problem is not None
    assert problem.joints == (4,)


@pytest.mark.parametrize("share", [0.3, 1.2])
def test_what_was_left_of_a_worse_log_is_no_measure_of_this_one(share: float) -> None:
    """Torques were enlarged until they left as much as that: 21 to 32 for 10, and where one joint
    was in another unit all were."""
    size = np.sqrt(np.mean(plain().log.tau ** 2, axis=0))
    known = Identified.of(["coulomb_1"], np.eye(1), left_Nm=tuple(share * size))
    robot = ROBOT.model_copy(update={"identified": known})
    every = log_problem(robot, with_torque(0.1))
    assert every is not None
    assert every.fits["factor"] == pytest.approx(10.0, rel=0.15)
    one = log_problem(robot, with_torque(np.array([1.0, 1.0, 1.0, 0.1, 1.0, 1.0])))
    assert one is not None
    assert one.joints == (4,)
    assert one.fits["factor"] == pytest.approx(10.0, rel=0.05)


def with_friction(coulomb: float, viscous: float) -> Robot:
    joints = [
        joint.model_copy(update={"friction": Friction(coulomb_Nm=coulomb, viscous_Nms_rad=viscous)})
        for joint in ROBOT.joints
    ]
    return ROBOT.model_copy(update={"joints": tuple(joints)})


@pytest.mark.parametrize("value", [0.1, 1.0, 2.0])
def test_a_placeholder_of_friction_refuses_no_log(value: float) -> None:
    """Damping and friction of one on every joint, as URDFs have them for a simulator: a sound log
    was another robot's, of another arm "another unit on joint 1: x 0.166"."""
    check = check_log(with_friction(value, value), plain().log)
    assert check.sound
    assert any("the friction that the robot file states for joints 1" in r for r in check.remarks)
    # what no friction explains is still named
    problem = log_problem(with_friction(value, value), with_torque(0.02))
    assert problem is not None
    assert problem.kind == "torque_scale"


@pytest.mark.slow
def test_a_placeholder_bends_no_bodies() -> None:
    """An identification held to it left 60 % of a joint where plain least squares left 46, a
    diagnosis had inertial numbers of three links off."""
    robot = with_friction(1.0, 1.0)
    log = plain().log
    found = diagnose(robot, log)
    assert found.findings == ()
    assert {number.list for number in found.numbers} == {"lacks"}
    assert len(understood_logs(robot, [log]).other_friction) > 3
    assert understood_logs(ROBOT, [log]).other_friction == frozenset()
    # an identification's friction is no placeholder
    known = Identified.of(["coulomb_1"], np.eye(1), left_Nm=(1e-3,) * 6)
    assert examined(robot.model_copy(update={"identified": known}), log).other_friction == ()
    # an identification is that of a file that states none
    unknown = identify(ROBOT.with_unknown_friction(range(1, 7)), log)
    np.testing.assert_allclose(identify(robot, log).theta, unknown.theta, rtol=1e-6)
    # what it was before is that of the file
    assert found.given is robot


@pytest.mark.slow
@pytest.mark.parametrize("joint", [1, 3])
def test_one_joint_that_drags_keeps_the_friction_of_the_others(joint: int) -> None:
    """Its friction has changed, and has a name; that of the others is the file's."""
    joints = list(ROBOT.joints)
    drags = joints[joint - 1].friction
    tenth = {
        name: 0.1 * getattr(drags, name) for name in ("coulomb_Nm", "viscous_Nms_rad", "static_Nm")
    }
    joints[joint - 1] = joints[joint - 1].model_copy(
        update={"friction": drags.model_copy(update=tenth)}
    )
    robot = ROBOT.model_copy(update={"joints": tuple(joints)})
    assert set(examined(robot, plain().log).other_friction) <= {joint}
    found = diagnose(robot, plain().log)
    assert ("coulomb_change", joint) in {(f.effect.kind, f.effect.joint) for f in found.findings}


def test_a_friction_that_fits_is_not_remarked_on() -> None:
    assert not any("friction" in remark for remark in check_log(ROBOT, plain().log).remarks)
