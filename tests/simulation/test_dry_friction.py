"""Dry friction of one body against closed forms and an event-driven integrator."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from irb2400_ctrl.codegen import compile_function
from irb2400_ctrl.simulation.dry_friction import Bounds, dry_friction_step


def slider(
    static: float, coulomb: float, stribeck: float, h: float, mass: float = 1.0, sweeps: int = 2
):
    """A body on a rough floor: (x, force) -> (x+, friction), x = (position, speed, friction)."""
    x = ca.SX.sym("x", 3)
    force = ca.SX.sym("u")

    def bounds(v: ca.SX) -> Bounds:
        level = coulomb + (static - coulomb) * ca.exp(-((v / stribeck) ** 2))
        return Bounds(level, -level, ca.SX(static), ca.SX(-static))

    v, f = dry_friction_step(
        x[1], x[1] + h * force / mass, ca.SX(h / mass), bounds, (x[1], x[2]), sweeps
    )
    return compile_function(
        ca.Function("slider", [x, force], [ca.vertcat(x[0] + h / 2 * (x[1] + v), v, f), f])
    )


@pytest.mark.parametrize("h", [0.1, 0.037, 0.001])
def test_a_sliding_body_stops_where_it_should_and_stays(h: float) -> None:
    states, _ = slider(2.0, 2.0, 1.0, h).rollout([0.0, 1.0, 0.0], np.zeros((round(3 / h), 1)))
    # v^2 / (2 mu g): within the step of the stop the speed is taken as linear, an error of second
    # order
    assert states[-1, 0] == pytest.approx(0.25, abs=2 * h**2)
    assert (states[round(1 / h) :, 1] == 0.0).all()
    assert np.ptp(states[round(1 / h) :, 0]) == 0.0


def test_a_reversal_inside_a_step_has_the_right_impulse() -> None:
    h = 0.1
    force = -5.0
    level = 2.0
    v0 = 0.3
    states, _ = slider(level, level, 1.0, h).rollout([0.0, v0, 0.0], [[force]])
    stop = v0 / (level - force)
    assert states[1, 1] == pytest.approx((force + level) * (h - stop), rel=1e-12)


def test_below_the_static_bound_nothing_moves_and_friction_balances_the_load() -> None:
    load = np.linspace(0, 2.99, 50)[:, None]
    states, friction = slider(3.0, 1.0, 0.01, 0.01).rollout([0.7, 0.0, 0.0], load)
    assert (states[:, 0] == 0.7).all()
    np.testing.assert_allclose(friction, load, rtol=1e-14)


def test_no_chatter_at_rest() -> None:
    states, _ = slider(3.0, 1.0, 0.01, 0.001).rollout([0.0, 0.4, 0.0], np.full((3000, 1), 0.5))
    signs = np.sign(states[:, 1])
    assert np.count_nonzero(np.diff(signs)) == 1  # it stops once and never moves again


def event_driven(
    static: float, coulomb: float, stribeck: float, times: np.ndarray, force
) -> np.ndarray:
    """Positions by an adaptive integrator with events at standstill and at break-away."""

    def level(v: float) -> float:
        return coulomb + (static - coulomb) * np.exp(-((v / stribeck) ** 2))

    t = 0.0
    x = 0.0
    v = 0.0
    direction = 0
    positions = np.zeros(len(times))
    while t < times[-1]:
        if direction == 0:
            later = np.linspace(t, times[-1], 200001)
            over = np.abs(force(later)) > static
            if not over.any():
                positions[times >= t] = x
                break
            from scipy.optimize import brentq

            k = int(np.argmax(over))
            start = (
                later[k]
                if k == 0
                else brentq(lambda s: abs(force(s)) - static, later[k - 1], later[k], xtol=1e-13)
            )
            positions[(times >= t) & (times < start)] = x
            t = start + 1e-12
            direction = int(np.sign(force(start + 1e-9)))

        def standstill(s, y, d=direction, begun=t):
            return y[1] * d + (1.0 if s < begun + 1e-9 else 0.0)

        standstill.terminal = True
        standstill.direction = -1
        run = solve_ivp(
            lambda s, y, d=direction: [y[1], force(s) - d * level(y[1])],
            (t, times[-1]),
            [x, v + direction * 1e-9],
            events=standstill,
            rtol=1e-10,
            atol=1e-13,
            dense_output=True,
            max_step=0.01,
        )
        inside = (times >= t) & (times <= run.t[-1])
        positions[inside] = run.sol(times[inside])[0]
        t = run.t[-1]
        (x, v) = run.y[:, -1]
        load = force(t)
        direction = 0 if abs(load) <= static else int(np.sign(load))
        v = 0.0
    return positions


def test_converges_to_the_event_driven_solution_with_second_order() -> None:
    static = 1.5
    coulomb = 1.0
    stribeck = 0.05

    def force(t):
        return 2.5 * np.sin(3.0 * t + 0.4) * (1 + 0.2 * np.asarray(t))

    errors = []
    times = np.linspace(0, 6, 121)
    truth = event_driven(static, coulomb, stribeck, times, force)
    for n in (1200, 2400, 4800):
        h = 6 / n
        middle = (np.arange(n) + 0.5) * h
        states, _ = slider(static, coulomb, stribeck, h).rollout(
            [0.0, 0.0, 0.0], force(middle)[:, None]
        )
        errors.append(np.abs(states[:: n // 120, 0] - truth).max())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert errors[-1] < 2e-5
    assert (orders > 1.6).all(), (errors, orders)
