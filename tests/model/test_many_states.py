"""Many states at once: the same numbers as one by one, however many there are."""

from __future__ import annotations

import gc

import casadi as ca
import numpy as np
import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.model import numeric
from irb2400_ctrl.model.model import _built_of


@pytest.mark.parametrize("count", [0, 1, 3, 1023, 1024, 1025, 2500])
def test_every_state_is_evaluated_once(count: int) -> None:
    model = irb.Model(irb.load_robot("irb2400"))
    rng = np.random.default_rng(count)
    q, qd, qdd = rng.uniform(-1.0, 1.0, (3, count, 6))
    Y = model.regressor(q, qd, qdd)
    assert Y.shape == (count, 6, 60)
    for k in {0, count // 3, 1023, 1024, count - 1} & set(range(count)):
        assert np.array_equal(Y[k], model.regressor(q[k], qd[k], qdd[k]))


def test_parts_cover_every_row_once() -> None:
    for count in (0, 1, 7, 1024, 1025, 5000):
        rows = [row for first, many in numeric._parts(count) for row in range(first, first + many)]
        assert rows == list(range(count))


def test_maps_go_with_their_function() -> None:
    gc.collect()
    before = len(numeric._MAPS)
    q = ca.SX.sym("q", 6)
    function = ca.Function("cosines", [q], [ca.cos(q)])
    numeric.evaluate(function, np.zeros((5, 6)))
    assert len(numeric._MAPS) > before
    del function
    gc.collect()
    assert len(numeric._MAPS) == before


def test_both_ways_give_the_same_numbers() -> None:
    """Few states go through CasADi, many through numpy, but for what numpy lacks."""
    q = ca.SX.sym("q", 2)
    states = np.random.default_rng(1).uniform(-1.0, 1.0, (3 * numeric._FEW, 2))
    known = ca.vertcat(ca.horzcat(ca.exp(q[0]), 2.0), ca.horzcat(0.0, ca.fmin(q[0], 1 / q[1])))
    for expression in (ca.sparsify(known), ca.erf(q)):
        function = ca.Function("f", [q], [expression])
        many = numeric.evaluate(function, states, matrix=True)
        few = [numeric.evaluate(function, part, matrix=True) for part in np.array_split(states, 6)]
        np.testing.assert_allclose(many, np.concatenate(few), rtol=1e-14)
    assert numeric._walk(function) is None


def test_equal_robots_share_their_functions() -> None:
    """Built once, unless another law bears the name of the effect."""
    robot = irb.load_robot("irb2400")
    offset = LIBRARY["torque_offset"].of(2, offset_Nm=3.0)
    model = irb.Model(robot.with_effects(offset))
    again = irb.Model(irb.load_robot("irb2400").with_effects(offset))
    assert again.function("gravity") is model.function("gravity")
    other = robot.with_effects(LIBRARY["torque_offset"].of(2, offset_Nm=4.0))
    assert irb.Model(other).function("gravity") is not model.function("gravity")
    assert _built_of(robot, (type(offset),)) is not _built_of(robot, (LIBRARY["payload"],))
