"""States of effects with memory along a motion."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from irb2400_ctrl.diagnosis.regressors.effect_states import Memory


def test_memory_is_exact_for_an_oscillator() -> None:
    """x'' + 2 zeta w x' + w^2 x = w^2 u with constant u, from rest: the textbook step response, at
    a coarse step."""
    u = ca.SX.sym("u")
    w = ca.SX.sym("w")
    state = ca.SX.sym("x", 2)
    zeta = 0.1
    rate = ca.vertcat(state[1], w**2 * (u - state[0]) - 2 * zeta * w * state[1])
    memory = Memory([u], state, [w], rate, ca.SX.zeros(2))
    step = 0.02
    m = 200
    frequency = np.array([[5.0, 40.0]])
    asked = ([np.ones((m, 1))], step, [frequency], (m, 2))
    (x, _), begun, _ = memory.states(*asked, 2)
    # of states that have no beginning of their own none is followed
    assert [len(memory.states(*asked, beginnings)) for beginnings in (0, 1)] == [1, 2]
    t = step * np.arange(m)[:, None]
    damped = np.sqrt(1 - zeta**2) * frequency
    envelope = np.exp(-zeta * frequency * t)
    swing = np.cos(damped * t) + zeta / np.sqrt(1 - zeta**2) * np.sin(damped * t)
    np.testing.assert_allclose(x, 1 - envelope * swing, atol=1e-9)
    np.testing.assert_allclose(begun[0] - x, envelope * swing, atol=1e-9)


@pytest.mark.parametrize("count", range(1, 18))
def test_states_of_a_grid_are_those_of_each_of_its_points(count: int) -> None:
    """Of eight points numpy 2.4.6 negated wrongly, and the columns of a hysteresis were noise."""
    u = ca.SX.sym("u")
    width = ca.SX.sym("w")
    state = ca.SX.sym("z")
    memory = Memory([u], state, [width], (u - ca.fabs(u) * state) / width, ca.sign(u))
    speed = np.sin(np.linspace(0.0, 20.0, 300))[:, None]
    widths = np.geomspace(0.01, 0.3, count)[None, :]
    ((found,),) = memory.states([speed], 0.01, [widths], (300, count), 0)
    for k in range(count):
        ((alone,),) = memory.states([speed], 0.01, [widths[:, [k]]], (300, 1), 0)
        np.testing.assert_array_equal(found[:, [k]], alone)
