"""Payload and friction as parameters: set in the running block they equal a block that is made for
the arm that carries the payload and has that friction."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from numpy.typing import ArrayLike

from irb2400_ctrl import Robot, load_robot
from irb2400_ctrl.arrays import Array
from irb2400_ctrl.codegen import Block
from irb2400_ctrl.controllers import controller
from irb2400_ctrl.robot import Body
from irb2400_ctrl.robot.link import Tool, Transform

NAMES = ("computed_torque", "feedforward_pid")
COM = (0.03, -0.02, 0.11)
INERTIA = (0.09, 0.08, 0.05, 0.004, -0.006, 0.003)
"""xx, yy, zz, xy, xz, yz about the centre of mass, axes of the flange"""
PAYLOAD = {
    "payload_mass": 4.2,
    "payload_com": COM,
    "payload_moments": INERTIA[:3],
    "payload_products": INERTIA[3:],
}
ARMS = {name: load_robot(name) for name in ("irb2400", "ur10e")}


def signals(robot: Robot, count: int) -> Array:
    """Drawn inputs of a controller, near what an arm does, shape (count, 5 n)."""
    rng = np.random.default_rng(7)
    q = rng.uniform(robot.q_min, robot.q_max, (count, robot.n))
    qd = rng.uniform(-0.5, 0.5, (count, robot.n))
    near = [q + 1e-4 * rng.normal(size=q.shape), qd + 1e-3 * rng.normal(size=q.shape)]
    return np.hstack([q, qd, *near, rng.uniform(-1.0, 1.0, (count, robot.n))])


@cache
def with_tables(name: str, arm: str) -> Block:
    """The controller of that name with payload and friction as parameters."""
    return controller(name, ARMS[arm], tables=True)


def torque(block: Block, robot: Robot, **parameters: ArrayLike) -> Array:
    """One step from the start at each of the drawn inputs, shape (count, n) [Nm]."""
    assert set(parameters) <= {field.name for field in block.parameters}
    x = [field.start for field in block.states]
    p = [np.ravel(parameters.get(field.name, field.start)) for field in block.parameters]
    place = block.step.name_out().index("tau")
    steps = (block.step.call([*x, *np.split(u, 5), *p])[place] for u in signals(robot, 40))
    return np.array([np.asarray(step).ravel() for step in steps])


def carrying(robot: Robot) -> Robot:
    """The arm whose tool is what it has and the payload in one body."""
    none = Body(mass_kg=0.0, com_m=(0.0, 0.0, 0.0), inertia_kgm2=(0.0,) * 6)
    own = none if robot.tool is None else robot.tool.body
    load = Body(mass_kg=4.2, com_m=COM, inertia_kgm2=INERTIA)
    parts = [(b.mass_kg, np.array(b.com_m), b.tensor()) for b in (own, load)]
    mass = sum(m for m, _, _ in parts)
    centre = sum(m * c for m, c, _ in parts) / mass
    inertia = np.zeros((3, 3))
    for m, c, about in parts:
        away = c - centre
        inertia += about + m * (away @ away * np.eye(3) - np.outer(away, away))
    six = (*np.diag(inertia), inertia[0, 1], inertia[0, 2], inertia[1, 2])
    body = Body(mass_kg=mass, com_m=tuple(centre), inertia_kgm2=six)
    place = Transform(transform=tuple(tuple(row) for row in np.eye(4)))
    tool = Tool(name="both", tcp=place, body=body, source="of this test")
    return robot.model_copy(update={"tool": tool})


@pytest.mark.parametrize("name", NAMES)
def test_without_a_payload_nothing_changes(name: str) -> None:
    robot = ARMS["irb2400"]
    plain = controller(name, robot)
    tables = with_tables(name, "irb2400")
    expected = torque(plain, robot)
    np.testing.assert_allclose(torque(tables, robot), expected, rtol=1e-9, atol=1e-8)


@pytest.mark.parametrize("arm", ARMS)
def test_a_payload_is_a_tool_with_its_mass_data(arm: str) -> None:
    robot = ARMS[arm]
    tables = with_tables("computed_torque", arm)
    made_for = controller("computed_torque", carrying(robot))
    found = torque(tables, robot, **PAYLOAD)
    np.testing.assert_allclose(found, torque(made_for, robot), rtol=1e-9, atol=1e-8)
    # and it is felt
    assert np.abs(found - torque(tables, robot)).max() > 1.0


def test_friction_is_that_of_the_table() -> None:
    robot = ARMS["irb2400"]
    tables = with_tables("feedforward_pid", "irb2400")
    table = robot.friction * [1.4, 1.1, 0.7, 1.3]
    keys = ("static_Nm", "coulomb_Nm", "viscous_Nms_rad", "stribeck_rad_s")
    joints = tuple(
        joint.model_copy(
            update={"friction": joint.friction.model_copy(update=dict(zip(keys, row, strict=True)))}
        )
        for joint, row in zip(robot.joints, table.tolist(), strict=True)
    )
    other = robot.model_copy(update={"joints": joints})
    np.testing.assert_allclose(other.friction, table)
    names = ("static", "coulomb", "viscous", "stribeck")
    given = {f"friction_{name}": table[:, k] for k, name in enumerate(names)}
    expected = torque(controller("feedforward_pid", other), robot)
    np.testing.assert_allclose(torque(tables, robot, **given), expected, rtol=1e-9, atol=1e-8)
