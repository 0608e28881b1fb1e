"""What is said of an arm whose file is a little wrong, and what is not said of a sound one."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from independent_plant import Case
from independent_plant import suite as independent
from mujoco_plant.suites import suite

import irb2400_ctrl as irb
from irb2400_ctrl.diagnosis import Diagnosis, diagnose
from irb2400_ctrl.diagnosis.numbers import LOAD, off_bodies
from irb2400_ctrl.effects.wrist_coupling import FarWristCoupling, WristCoupling
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.planners import plan_path
from irb2400_ctrl.planners.toolpath import builders
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.simulation import simulate

ROBOT = irb.load_robot("irb2400")
Array = npt.NDArray[np.float64]


@cache
def sound() -> Log:
    """A log of an arm without any effect."""
    log = Case(31, duration=25.0, validation_duration=3.0).simulate()[0]
    return Log(log.time, log.q, log.tau, q_ref=log.q_ref)


def with_torque(joint: int, torque: Array) -> Log:
    """The sound log with more torque on one joint (from 1)."""
    tau = sound().tau.copy()
    tau[:, joint - 1] += torque
    return replace(sound(), tau=tau)


def speed(joint: int) -> Array:
    log = sound()
    assert log.q_ref is not None
    return np.gradient(log.q_ref[:, joint - 1], log.time)


def turned_over(joint: int, travel: float) -> Array:
    """The sign of a joint's speed, where it takes a travel [rad] to turn over."""
    rate = speed(joint)
    state = np.sign(rate)
    for k in range(1, len(rate)):
        sign = np.sign(rate[k])
        state[k] = sign + (state[k - 1] - sign) * np.exp(-abs(rate[k]) * 0.004 / travel)
    return state


def names(found: Diagnosis) -> list[tuple[str, int | None]]:
    return [(f.effect.kind, f.effect.joint) for f in found.findings]


def frictions(factor: float) -> Robot:
    joints = []
    for joint in ROBOT.joints:
        f = joint.friction
        scaled: dict[str, Any] = {
            name: factor * getattr(f, name)
            for name in ("static_Nm", "coulomb_Nm", "viscous_Nms_rad")
        }
        joints.append(joint.model_copy(update={"friction": f.model_copy(update=scaled)}))
    return ROBOT.model_copy(update={"joints": tuple(joints)})


@pytest.mark.parametrize(
    "radius", [0.05, *(pytest.param(r, marks=pytest.mark.slow) for r in (0.12, 0.15))]
)
def test_a_circle_of_the_model_itself_gets_no_name(radius: float) -> None:
    path = builders.circle((0.95, 0.0, 0.6), radius, feed=0.1)
    plan = plan_path(ROBOT, path, free_tool_rotation=False)
    found = diagnose(ROBOT, simulate(ROBOT, plan.trajectory, "computed_torque").log())
    assert found.verdict == "nothing_missing"


def test_a_vibration_above_the_filter_is_not_called_noise() -> None:
    time = sound().time
    found = diagnose(ROBOT, with_torque(4, 6.0 * np.sin(2 * np.pi * 10.0 * time)))
    assert 4 in found.beyond_noise
    assert found.verdict == "unexplained"
    # half as strong as the noise, whose size alone would not tell it
    assert found.noise is not None
    size = 0.7 * found.noise.floor[3]
    found = diagnose(ROBOT, with_torque(4, size * np.sin(2 * np.pi * 22.0 * time)))
    assert found.noise is not None
    assert found.noise.beyond == ()
    assert found.beyond_noise == (4,)
    assert found.verdict == "unexplained"
    assert any(said.startswith("a vibration of 22.0 Hz is left on joint 4") for said in found.weak)


def test_friction_of_a_cold_arm_is_recalibrated_and_is_no_effect() -> None:
    found = diagnose(frictions(1.0 / 1.3), sound())
    assert names(found) == []
    assert found.verdict == "nothing_missing"
    assert not off_bodies(found.numbers)
    ratio = found.robot.friction[:3, 1] / found.given.friction[:3, 1]
    np.testing.assert_allclose(ratio, 1.3, atol=0.15)
    # twelve numbers stood under "special": "other arms of this type do not have it"
    assert not [one for one in found.numbers if one.place.startswith("joint")]
    (said,) = [note for note in found.weak if note.startswith("friction of all joints together")]
    assert "dry +" in said
    own = diagnose(frictions(1.0), sound())
    assert not [note for note in own.weak if "friction of all joints" in note]


@pytest.mark.slow
def test_numbers_further_off_than_stated_are_no_effect() -> None:
    """All of them 2.5 times as far as the data sheet says: no single link is the one that is."""
    read = Case(609666504, spread=2.5).simulate()[0]
    found = diagnose(ROBOT, Log(read.time, read.q, read.tau, q_ref=read.q_ref))
    assert names(found) == []


@pytest.mark.slow
def test_what_is_too_small_for_a_name_is_not_unexplained_either() -> None:
    """A friction off by a hundredth of the torque: a function of the speed says it worse."""
    read = independent("clean", 2, 991217)[1].simulate()[0]
    found = diagnose(ROBOT, Log(read.time, read.q, read.tau, qd=read.qd, q_ref=read.q_ref))
    assert found.verdict == "nothing_missing"


@pytest.mark.slow
def test_friction_of_one_joint_is_no_effect_where_all_numbers_are_further_off() -> None:
    """Of the second plant, 2.5 times: a viscous_change 5 and a link_inertia 2 before."""
    (case,) = suite("wrong_priors", 1, 1, 991217)
    read = case.simulate()
    found = diagnose(ROBOT, Log(read.time, read.q, read.tau, qd=read.qd, q_ref=read.q_ref))
    assert names(found) == []


def test_a_load_that_the_numbers_take_in_is_said_as_numbers_that_moved() -> None:
    """2 kg of 7.0 sigma: the tool's mass moved by 3.49 of its own standard deviations, eight others
    by one to two, and no word was said."""
    (case,) = suite("payload", 1, 1, 600213)
    read = case.simulate()
    found = diagnose(ROBOT, Log(read.time, read.q, read.tau, qd=read.qd, q_ref=read.q_ref))
    (load,) = [number for number in found.numbers if number.name == LOAD]
    assert load.sigmas > 3.0
    assert abs(load.after - 2.0) < 3.0 * load.standard_error
    assert "is the load declared?" in off_bodies(found.numbers)


@pytest.mark.slow
def test_dry_friction_that_builds_up_over_an_angle_is_a_hysteresis() -> None:
    found = diagnose(ROBOT, with_torque(2, 25.0 * (turned_over(2, 0.02) - np.sign(speed(2)))))
    assert names(found) == [("hysteresis", 2)]
    effect: Any = found.findings[0].effect
    assert effect.amplitude_Nm == pytest.approx(25.0, rel=0.25)
    assert effect.replaced_Nm == pytest.approx(effect.amplitude_Nm, rel=0.4)


@pytest.mark.slow
@pytest.mark.parametrize("travel", [1e-6, 0.02])
def test_a_wrist_coupling_of_one_direction_with_dry_friction_is_named(travel: float) -> None:
    found = diagnose(ROBOT, with_torque(5, 1.2 * turned_over(6, travel) + 0.3 * speed(6)))
    assert names(found) == [("wrist_coupling", 5)]
    effect: Any = found.findings[0].effect
    assert effect.dry_Nm == pytest.approx(1.2, rel=0.25)
    assert abs(effect.neighbour_dry_Nm) < 0.3


@pytest.mark.slow
def test_a_wrist_whose_first_axis_turns_the_motor_of_the_third_is_named() -> None:
    """The shaft of axis 6 runs through those of axes 4 and 5: on the arm of another maker axis 4
    was told to have something without a name that follows the speed of axis 6."""
    of_six = 1.2 * turned_over(6, 1e-6) + 0.3 * speed(6)
    alone = with_torque(4, of_six)
    tau = alone.tau.copy()
    tau[:, 4] += of_six
    found = diagnose(ROBOT, replace(alone, tau=tau))
    assert sorted(names(found)) == [("far_wrist_coupling", 4), ("wrist_coupling", 5)]
    for finding in found.findings:
        effect: Any = finding.effect
        assert isinstance(effect, FarWristCoupling if effect.joint == 4 else WristCoupling)
        assert effect.dry_Nm == pytest.approx(1.2, rel=0.25)
        assert abs(effect.neighbour_dry_Nm) < 0.3
    # a shaft through two axes drags both: what one feels alone is none
    assert ("far_wrist_coupling", 4) not in names(diagnose(ROBOT, alone))


@pytest.mark.slow
def test_a_motor_that_two_axes_turn_is_named_without_a_coupling_of_neighbours() -> None:
    """Two arms whose axes 4 and 6 turned one motor had two laws without a name, 1,043 nats of what
    was the speed of the other axis."""
    motor = speed(6) - 0.4 * speed(4)
    friction = 1.5 * motor + 0.5 * np.tanh(motor / 0.05)
    own = 1.5 * speed(6) + 0.5 * np.tanh(speed(6) / 0.05)
    log = with_torque(6, friction - own)
    tau = log.tau.copy()
    tau[:, 3] -= 0.4 * friction
    found = diagnose(ROBOT, replace(log, tau=tau))
    assert names(found) == [("far_wrist_coupling", 4)]
    assert found.verdict == "explained"


@pytest.mark.slow
def test_a_name_says_what_it_is_worth_on_unseen_stretches() -> None:
    found = diagnose(ROBOT, with_torque(4, 6.0 * np.sin(12.0 * sound().q[:, 3])))
    (finding,) = found.findings
    assert finding.effect.kind == "gear_ripple"
    assert finding.validation_gain is not None
    assert finding.validation_gain > 30.0
    assert finding.to_json()["validation_gain_percent"] == round(finding.validation_gain, 2)


@pytest.mark.slow
def test_a_contact_that_sticks_before_it_slides_is_no_effect() -> None:
    """Friction of bristles on every joint, and two kilograms that nobody declared: nothing else."""
    (case,) = suite("payload", 1, 1, 922905)
    read = case.simulate()
    found = diagnose(ROBOT, Log(read.time, read.q, read.tau, qd=read.qd, q_ref=read.q_ref))
    assert names(found) == [("payload", None)]


@pytest.mark.slow
def test_a_product_of_two_speeds_is_unexplained_over_both() -> None:
    """No law of the library holds it: not an offset from some moment on."""
    product = speed(5) * speed(4)
    found = diagnose(ROBOT, with_torque(5, 4.0 * product / np.std(product)))
    assert not found.findings
    assert found.verdict == "unexplained"
    (rest,) = found.unexplained
    assert rest.joint == 5
    assert set(rest.depends_on) == {"qd", "qd4"}
