"""What `verification.json` compares at: points at which the law is at work."""

from __future__ import annotations

import dataclasses

import casadi as ca
import numpy as np
import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.codegen import Block, Field
from irb2400_ctrl.codegen.checks import FARTHEST, compare_with_block, random_points, run_points
from irb2400_ctrl.codegen.controller import HostController
from irb2400_ctrl.codegen.package import Package
from irb2400_ctrl.controllers import controller, guarded
from irb2400_ctrl.controllers.registry import CONTROLLERS

from .blocks import pd_block, stateless_block

ROBOT = irb.load_robot("irb2400")


def guarded_arm(name: str, **design: float) -> Block:
    return guarded(controller(name, ROBOT, **design), ROBOT)


@pytest.mark.parametrize("name", CONTROLLERS)
def test_the_torque_of_a_guarded_controller_is_compared(name: str) -> None:
    """At each of 1024 states a guard had closed the brake: the torque was that before."""
    package = Package(guarded_arm(name), "double")
    states, inputs = random_points(package, 1024)
    _, outputs = run_points(HostController(package), states, inputs)
    last = states[:, _at(package, "tau_last")]
    tau = outputs[:, :6]
    free = np.sum((np.abs(tau - last) < 99.0) & (tau != last), axis=0)
    assert np.all(free >= 150), free
    # drawn numbers are hardly ever whole: only a run gets to the end of a start
    assert np.sum(states[:, _at(package, "blend")] == 1) >= 100
    running = states[:, _at(package, "running")] > 0
    assert np.sum(running[:, 0] & (outputs[:, 6] == 0)) >= 20


def _at(package: Package, name: str) -> slice:
    ends = np.cumsum([f.size for f in package.block.states])
    names = [f.name for f in package.block.states]
    k = names.index(name)
    return slice(ends[k] - package.block.states[k].size, ends[k])


def test_a_wrong_law_behind_a_guard_is_found() -> None:
    package = Package(guarded_arm("computed_torque"), "double")
    points = random_points(package, 256)
    other = HostController(Package(guarded_arm("computed_torque", bandwidth=60.6), "double"))
    by_field, _ = compare_with_block(package, *points, *run_points(other, *points))
    assert by_field["tau"] > 0.1


def test_inputs_are_within_their_bounds_and_half_of_the_states_are_reached() -> None:
    package = Package(pd_block(), "float")
    states, inputs = random_points(package, 64)
    q = inputs[:, :2]
    qd = inputs[:, 2:4]
    assert np.all((q >= [-3, -1]) & (q <= [3, 2]))
    assert np.all(np.abs(qd) <= 4)
    assert np.all(inputs[:, 6] <= 50)
    assert states.dtype == inputs.dtype == np.float32
    # z' = z + 0.01 e is bounded by 5 and goes where a drawn one, 0.5 and 1 around it, does not
    assert np.ptp(states[:, 0]) > 0
    again = random_points(package, 64)
    assert np.array_equal(states, again[0])
    assert np.array_equal(inputs, again[1])


def test_a_block_that_runs_away_keeps_drawn_states() -> None:
    x = ca.SX.sym("x")
    u = ca.SX.sym("u")
    step = ca.Function("step", [x, u], [10 * x + u, x], ["x", "u"], ["x_next", "y"])
    block = Block(
        name="apart", doc="", sample_time=0.1, states=(Field("x", 1, "-", "", (0.5,)),),
        inputs=(Field("u", 1, "-", ""),), outputs=(Field("y", 1, "-", ""),), parameters=(),
        step=step,
    )  # fmt: skip
    states, _ = random_points(Package(block, "double"), 512)
    assert np.all(np.abs(states) <= FARTHEST)
    assert np.max(np.abs(states)) > 10
    spoilt = dataclasses.replace(block, states=(Field("x", 1, "-", "", (1e300,)),))
    assert np.isfinite(random_points(Package(spoilt, "double"), 512)[0]).all()


def test_a_block_without_a_state_needs_no_run() -> None:
    states, inputs = random_points(Package(stateless_block(), "double"), 8)
    assert states.shape[0] == inputs.shape[0] == 8


def test_a_range_beside_zero_keeps_its_drawn_inputs_in_single_precision() -> None:
    x = ca.SX.sym("x", 2)
    away = Field("x", 2, "rad", "angles", lower=(0.3, -0.150001), upper=(0.300001, -0.15))
    step = ca.Function("away", [x], [x], ["x"], ["y"])
    block = Block(
        "away", "ranges beside zero", 0.001, (), (away,), (Field("y", 2, "", ""),), (), step
    )
    _, inputs = random_points(Package(block, "float"), 1024)
    assert (inputs >= np.array(away.lower, np.float32)).all()
    assert (inputs <= np.array(away.upper, np.float32)).all()
