"""The torque limit of the parameter table is the one that the law knows: what it remembers is what
was sent."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from irb2400_ctrl import load_robot
from irb2400_ctrl.codegen import Block, Field, HostController, Package
from irb2400_ctrl.controllers import controller, guarded
from irb2400_ctrl.controllers.parts import FASTEST, UNBOUNDED, UNKNOWN_SPEED
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.robot import Robot

ROBOT = load_robot("irb2400")
POSE = np.array([0.1, 0.2, 0.1, 0.2, 0.4, 0.3])


def at(fields: tuple[Field, ...], name: str) -> slice:
    """Where a field stands in the flat vector."""
    sizes = [f.size for f in fields]
    k = [f.name for f in fields].index(name)
    return slice(sum(sizes[:k]), sum(sizes[: k + 1]))


def with_limit(block: Block, share: float) -> HostController:
    """The C of a block whose table has this share of the robot's torque limits."""
    compiled = HostController(Package(block, "double"))
    table = compiled.parameters
    table[at(compiled.package.parameter_fields, "tau_limit")] = share * ROBOT.tau_max
    compiled.parameters = table
    compiled.reset()
    assert compiled.init_status == 0
    return compiled


def pushed(compiled: HostController, steps: int, error: float) -> tuple[np.ndarray, np.ndarray]:
    """Last torque and the state, after an error that no torque overcomes."""
    block = compiled.package.block
    given = {"q": POSE, "q_ref": POSE + error, "fresh": np.ones(1)}
    inputs = np.concatenate([given.get(f.name, np.zeros(f.size)) for f in block.inputs])
    for _ in range(steps):
        output, status = compiled.step(inputs)
        assert status == 0
    return output[at(block.outputs, "tau")], compiled.state


@pytest.mark.parametrize("share", [0.5, 1.5])
def test_an_integral_ends_where_the_torque_of_the_table_does(share: float) -> None:
    compiled = with_limit(controller("pid", ROBOT), share)
    tau, state = pushed(compiled, 5000, 0.02)
    np.testing.assert_allclose(tau, share * ROBOT.tau_max)
    integral = state[at(compiled.package.state_fields, "integral")]
    np.testing.assert_allclose(integral, share * ROBOT.tau_max, rtol=0.02)


@pytest.mark.parametrize("share", [0.5, 1.5])
def test_a_guard_remembers_the_torque_that_is_sent(share: float) -> None:
    block = guarded(controller("pid", ROBOT), ROBOT, consistency=False)
    compiled = with_limit(block, share)
    tau, state = pushed(compiled, 5000, 0.02)
    np.testing.assert_allclose(tau, share * ROBOT.tau_max)
    np.testing.assert_array_equal(state[at(compiled.package.state_fields, "tau_last")], tau)


def test_a_guard_remembers_no_more_than_is_sent_of_what_the_brake_held() -> None:
    """It takes over the weight that the brake has held, here far beyond the table's limit."""
    block = guarded(controller("pid", ROBOT), ROBOT, consistency=False)
    compiled = with_limit(block, 0.001)
    table = compiled.parameters
    table[at(compiled.package.parameter_fields, "hold")] = 0.5 * ROBOT.tau_max
    compiled.parameters = table
    compiled.reset()
    for _ in range(3):
        tau, state = pushed(compiled, 1, 0.0)
        np.testing.assert_allclose(tau, 0.001 * ROBOT.tau_max)
        np.testing.assert_array_equal(state[at(compiled.package.state_fields, "tau_last")], tau)


def test_an_adaptive_law_learns_nothing_at_the_limit_of_the_table() -> None:
    block = controller("adaptive", ROBOT)
    compiled = with_limit(block, 0.001)
    inputs = np.zeros(sum(f.size for f in block.inputs))
    for name, value in (("q", POSE), ("q_ref", POSE + 0.02), ("qd_ref", np.full(6, 0.1))):
        inputs[at(block.inputs, name)] = value
    compiled.step(inputs)
    learned = compiled.state[at(compiled.package.state_fields, "theta")]
    np.testing.assert_array_equal(learned, 0.0)


@pytest.mark.parametrize("name", ["pid", "computed_torque"])
def test_the_limit_stands_once_in_the_table_and_its_cut_once_in_the_code(name: str) -> None:
    block = controller(name, ROBOT)
    package = Package(block, "float")
    assert [f.name for f in package.parameter_fields].count("tau_limit") == 1
    sent = [line for line in package.source().splitlines() if "output->tau[0] = " in line]
    assert len(sent) == 2
    assert "own_limit(" in sent[0]
    if name == "computed_torque":
        assert "own_fmin(" not in package.source()


def test_another_parameter_of_that_name_is_still_refused() -> None:
    block = controller("gravity_pd", ROBOT)
    parameters = tuple(
        replace(f, unit="kNm") if f.name == "tau_limit" else f for f in block.parameters
    )
    with pytest.raises(InputError, match="two fields of one name"):
        Package(replace(block, parameters=parameters))


def with_unknown(joint: int, key: str) -> Robot:
    """The robot without one limit of a joint."""
    joints = list(ROBOT.joints)
    limits = joints[joint].limits.model_copy(update={key: None})
    joints[joint] = joints[joint].model_copy(update={"limits": limits})
    return ROBOT.model_copy(update={"joints": tuple(joints)})


@pytest.mark.parametrize("guard", [False, True])
def test_one_unknown_limit_leaves_those_of_the_others_in_the_table(guard: bool) -> None:
    arm = with_unknown(3, "torque_Nm")
    block = controller("pid", arm)
    block = guarded(block, arm, consistency=False) if guard else block
    compiled = HostController(Package(block, "double"))
    row = at(compiled.package.parameter_fields, "tau_limit")
    table = compiled.parameters
    known = np.delete(np.arange(6), 3)
    np.testing.assert_array_equal(table[row][known], ROBOT.tau_max[known])
    assert table[row][3] == UNBOUNDED
    table[row] *= 0.5
    compiled.parameters = table
    compiled.reset()
    assert compiled.init_status == 0
    tau, _ = pushed(compiled, 5000, 0.02)
    np.testing.assert_allclose(tau[known], 0.5 * ROBOT.tau_max[known])
    assert abs(tau[3]) > ROBOT.tau_max[3]


def test_a_released_brake_asks_no_joint_for_more_than_its_known_limit() -> None:
    arm = with_unknown(3, "torque_Nm")
    block = guarded(controller("gravity_pd", arm), arm, consistency=False)
    compiled = HostController(Package(block, "double"))
    table = compiled.parameters
    table[at(compiled.package.parameter_fields, "hold")] = 3.0 * ROBOT.tau_max
    compiled.parameters = table
    compiled.reset()
    tau, _ = pushed(compiled, 2, 0.0)
    assert (np.abs(tau) <= ROBOT.tau_max)[np.arange(6) != 3].all()


def test_one_unknown_speed_leaves_those_of_the_others_in_the_table() -> None:
    arm = with_unknown(2, "speed_deg_s")
    (qd,) = [f for f in controller("pid", arm).inputs if f.name == "qd"]
    expected = FASTEST * np.where(np.arange(6) == 2, UNKNOWN_SPEED, ROBOT.qd_max)
    np.testing.assert_allclose(qd.upper, expected)


def test_a_limit_that_is_not_known_is_written_as_one_that_nobody_reaches() -> None:
    """In Nm, as the header's words and `known` in the table's comment have it."""
    assert UNBOUNDED == 1e6
