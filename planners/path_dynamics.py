"""The arm's torque along a path: tau = a(s) u + b(s) x + e(s) sqrt(x) + c(s) with x = sdot^2, u = sddot.

With q = q(s), qd = q' sqrt(x), qdd = q'' x + q' u the rigid-body torque and every effect that is at most quadratic in
the speeds and linear in the accelerations have this form exactly (a = M q', b = M q'' + C(q, q') q', c = G). The dry
friction of eq. 55 stands apart, because its sign and Stribeck curve need their own treatment.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import casadi as ca
import numpy as np
import numpy.typing as npt

from irb2400_ctrl.codegen import CompiledFunction, compile_function
from irb2400_ctrl.effects import Effect
from irb2400_ctrl.model import Model
from irb2400_ctrl.model.signals import ArmSignals
from irb2400_ctrl.planners.ball import ball_function
from irb2400_ctrl.robot import Robot

Array = npt.NDArray[np.float64]

OUTPUTS = ("a", "b", "e", "c_minus", "c_zero", "c_plus")


@dataclass(frozen=True, eq=False)
class PathDynamics:
    """Coefficients of one robot's torque along paths, as machine code."""

    model: Model

    @cached_property
    def regular(self) -> tuple[Effect, ...]:
        """Effects that fit the form above."""
        return tuple(e for e in self.model.robot.effects if e.acts == "force" and _fits(self.model, e))

    @cached_property
    def irregular(self) -> tuple[Effect, ...]:
        """Effects on the arm that do not: their torque is bounded by looking, and nothing is guaranteed."""
        return tuple(e for e in self.model.robot.effects if e.acts == "force" and e not in self.regular)

    @cached_property
    def symbolic(self) -> ca.Function:
        """(q, q', q'') -> a, b, e and c for motion backwards, at rest, forwards."""
        return coefficient_function(self.model, self.regular)

    @cached_property
    def _compiled(self) -> CompiledFunction:
        return compile_function(self.symbolic, fused=True)

    @cached_property
    def _ball(self) -> CompiledFunction:
        return compile_function(ball_function(self.symbolic), fused=True)

    def coefficients(self, q: Array, dq: Array, ddq: Array) -> tuple[Array, ...]:
        """a, b, e, c_minus, c_zero, c_plus at m points, each (m, n)."""
        return self._compiled.map(q, dq, ddq)

    def radii(self, q: Array, dq: Array, ddq: Array, r: Array, dr: Array, ddr: Array) -> tuple[Array, ...]:
        """By how much the coefficients differ at most from those at (q, q', q'') within complex balls, each (m, n)."""
        return self._ball.map(q, dq, ddq, r, dr, ddr)

    @cached_property
    def _irregular_torque(self) -> ca.Function:
        s = self.model.signals()
        tau = ca.SX.zeros(self.model.robot.n)
        for effect in self.irregular:
            tau += effect.torque(s.with_state(effect.steady_state(s)))
        zero = ca.SX.zeros(2 * self.model.robot.n)
        tau = ca.substitute(tau, ca.vertcat(s.qddd, s.qdddd), zero)
        return ca.Function("irregular", [s.q, s.qd, s.qdd, s.time], [ca.densify(tau)])

    def irregular_torque(self, q: Array, qd: Array, qdd: Array, time: Array) -> Array:
        """Torque of the irregular effects, shape (m, n) [Nm]."""
        if not self.irregular:
            return np.zeros_like(q)
        columns = [ca.DM(v.T) for v in (q, qd, qdd)] + [ca.DM(time[None, :])]
        return np.asarray(self._irregular_torque(*columns)).T


@lru_cache(maxsize=8)
def path_dynamics(robot: Robot) -> PathDynamics:
    """The coefficients of a robot, built once."""
    return PathDynamics(Model(robot))


def coefficient_function(model: Model, effects: tuple[Effect, ...]) -> ca.Function:
    """The coefficients as an SX function of (q, q', q'')."""
    n = model.robot.n
    sign = ca.SX.sym("sign", n)
    s = replace(model.signals(), sign=sign)
    tau = s.load + _effects_torque(effects, s)
    dq, ddq, v, u = ca.SX.sym("dq", n), ca.SX.sym("ddq", n), ca.SX.sym("v"), ca.SX.sym("u")
    tau = ca.substitute(
        tau,
        ca.vertcat(s.qd, s.qdd, s.qddd, s.qdddd, s.time),
        ca.vertcat(dq * v, ddq * v**2 + dq * u, ca.SX.zeros(2 * n + 1)),
    )
    zero = ca.SX.zeros(n)
    rest = ca.vertcat(v, u, sign)
    slope_v = ca.jacobian(tau, v)
    at_rest = ca.vertcat(0, 0, zero)
    a = ca.substitute(ca.jacobian(tau, u), rest, at_rest)
    e = ca.substitute(slope_v, rest, at_rest)
    b = ca.substitute(ca.jacobian(slope_v, v), rest, at_rest) / 2
    c = [ca.substitute(tau, rest, ca.vertcat(0, 0, ca.DM([level] * n))) for level in (-1, 0, 1)]
    viscous = ca.DM(model.robot.friction[:, 2])
    outputs = [ca.densify(ca.simplify(o)) for o in (a, b, e + viscous * dq, *c)]
    shared = ca.Function("coefficients", [s.q, dq, ddq], outputs, ["q", "dq", "ddq"], list(OUTPUTS))
    together = ca.cse(ca.vertcat(*shared.call([s.q, dq, ddq], True, False)))
    parts = ca.vertsplit(together, n)
    return ca.Function("coefficients", [s.q, dq, ddq], parts, ["q", "dq", "ddq"], list(OUTPUTS))


def _effects_torque(effects: tuple[Effect, ...], s: ArmSignals) -> ca.SX:
    tau = ca.SX.zeros(s.q.numel())
    for effect in effects:
        tau += effect.torque(s.with_state(effect.steady_state(s)))
    return tau


def _fits(model: Model, effect: Effect) -> bool:
    """Whether the effect's torque has the form above: compared with its own expansion at random states."""
    n = model.robot.n
    signals = model.signals()
    bare = effect.torque(signals.with_state(effect.steady_state(signals)))
    if ca.depends_on(bare, ca.vertcat(signals.time, signals.qddd, signals.qdddd)):
        return False
    rng = np.random.default_rng(0)
    truth = ca.Function("t", [signals.q, signals.qd, signals.qdd], [bare])
    full = coefficient_function(model, (effect,))
    alone = coefficient_function(model, ())
    for _ in range(6):
        q = rng.uniform(model.robot.q_min, model.robot.q_max)
        dq, ddq = rng.normal(size=n), rng.normal(size=n)
        v, u = rng.uniform(0.3, 3.0), rng.normal() * 3
        a, b, e, c_minus, _, c_plus = (
            np.asarray(x - y).ravel() for x, y in zip(full(q, dq, ddq), alone(q, dq, ddq), strict=True)
        )
        c = np.where(dq > 0, c_plus, c_minus)
        expected = a * u + b * v**2 + e * v + c
        found = np.asarray(truth(q, dq * v, ddq * v**2 + dq * u)).ravel()
        if np.abs(found - expected).max() > 1e-9 * (1 + np.abs(found).max()):
            return False
    return True
