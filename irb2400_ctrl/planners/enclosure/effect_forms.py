"""Which form an effect's torque has along a path, and with it how it is bounded.

    regular   a(s) u + b(s) x + e(s) sqrt(x) + c(s)              enclosed like the arm itself
    timed     the same times factors of the time alone, or of    each factor between its bounds over
              the speeds of other joints (a neighbour's dry      all times, or all speeds
              friction)
    law       f(qd_j), f(qd_j, memory) or f(|load_j|), own       a straight line above, one below
    (`ScalarLaw`)  friction counted as load or not
    open      anything else (elastic_joint)                      no bound

Time counts from an instant that the timing does not know: the bounds hold whenever the motion
starts.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import casadi as ca
import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.effects import Effect
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.model.signals import ArmSignals
from irb2400_ctrl.planners.enclosure.complex_disc import disc_function
from irb2400_ctrl.planners.enclosure.interval import Interval, interval_function
from irb2400_ctrl.planners.enclosure.time_factors import lifted

Memory = Callable[[Array], tuple[Array, Array]]
"""bounds (m,) of the internal state for a joint that has turned forwards by (m,) [rad]"""


@dataclass(frozen=True, eq=False)
class ScalarLaw:
    """Torque on one joint as a function of one scalar w of its motion, for one direction of
    motion."""

    joint: int
    """zero-based"""
    of: Literal["speed", "load"]
    """w: qd^2 [rad2/s2] or |load| [Nm]"""
    values: ca.Function
    """(w, direction, state, factors…) -> f, df/dw, d2f/dw2"""
    low: Array
    high: Array
    """bounds of the factors"""
    memory: Memory | None
    curved: bool
    """whether f is anything but a straight line over w"""
    own_friction: float = 0.0
    """share of the joint's own friction that counts as load"""

    def bounds(self, w: Interval, direction: Interval, state: Interval) -> list[Interval]:
        """Bounds of f, df/dw and d2f/dw2 over m boxes."""
        ends = [(np.array([a]), np.array([b])) for a, b in zip(self.low, self.high, strict=True)]
        return self._bounds([w, direction, state, *ends])

    @cached_property
    def _bounds(self) -> Callable[[list[Interval]], list[Interval]]:
        return interval_function(self.values)


@dataclass(frozen=True, eq=False)
class Forms:
    """The force effects of a robot, sorted."""

    regular: tuple[Effect, ...]
    """of the regular form, up to factors of the time"""
    laws: tuple[ScalarLaw, ...]
    open: tuple[Effect, ...]

    @classmethod
    def of(cls, model: Model) -> Forms:
        """Sort the effects of a robot."""
        regular: list[Effect] = []
        laws: list[ScalarLaw] = []
        left: list[Effect] = []
        for effect in model.robot.effects:
            if effect.role != "force":
                continue
            if is_regular(model, effect):
                regular.append(effect)
                continue
            law = _law(model, effect)
            if law is not None:
                laws.append(law)
            elif is_regular(model, effect, others=True):
                regular.append(effect)
            else:
                left.append(effect)
        return cls(tuple(regular), tuple(laws), tuple(left))


Carried = tuple[ca.SX, ca.SX]
"""first and second derivative of the place of the base along the path, each (3,)"""


def expand(
    tau: ca.SX, s: ArmSignals, dq: ca.SX, ddq: ca.SX, carried: Carried | None = None
) -> list[ca.SX]:
    """a, b, e and c (backwards, at rest, forwards) of a torque of the regular form, as expressions
    of (q, q', q'') and, where the base is carried, of the derivatives of its place."""
    n = s.q.numel()
    v = ca.SX.sym("v")
    u = ca.SX.sym("u")
    zero = ca.SX.zeros(n)
    if s.carried is not None:
        first, second = carried or (ca.SX.zeros(3), ca.SX.zeros(3))
        tau = ca.substitute(tau, s.carried, second * v**2 + first * u)
    tau = ca.substitute(
        tau,
        ca.vertcat(s.qd, s.qdd, s.qddd, s.qdddd, s.time),
        ca.vertcat(dq * v, ddq * v**2 + dq * u, ca.SX.zeros(2 * n + 1)),
    )
    rest = ca.vertcat(v, u, s.sign)
    at_rest = ca.vertcat(0, 0, zero)
    slope_v = ca.jacobian(tau, v)
    a = ca.substitute(ca.jacobian(tau, u), rest, at_rest)
    e = ca.substitute(slope_v, rest, at_rest)
    b = ca.substitute(ca.jacobian(slope_v, v), rest, at_rest) / 2
    c = [ca.substitute(tau, rest, ca.vertcat(0, 0, ca.DM([level] * n))) for level in (-1, 0, 1)]
    return [ca.densify(ca.simplify(o)) for o in (a, b, e, *c)]


def with_sign(model: Model, carried: bool = False) -> ArmSignals:
    """Signals whose direction of motion is a symbol of its own, and so is the acceleration of a
    base that is carried."""
    base = ca.SX.sym("base", 3) if carried else None
    return replace(model.signals(), sign=ca.SX.sym("sign", model.robot.n), carried=base)


Parts = tuple[list[ca.SX], Array, Array]
"""a torque as parts[0] + sum_k factor_k parts[k], and the factors' bounds"""


def regular_parts(model: Model, tau: ca.SX, s: ArmSignals) -> Parts:
    """A torque of the regular form, taken apart.

    Raises:
        ValueError: it is not of that form.
    """
    for others in (False, True):
        parts = _split(tau, s, others)
        if parts is not None and all(_fits(model, part, s) for part in parts[0]):
            return parts
    raise ValueError("not of the regular form")


def _split(tau: ca.SX, s: ArmSignals, others: bool) -> Parts | None:
    """None if it is not of that form.

    The product of two factors (a window around a force that has its own times) counts as a third
    one.
    """
    found = lifted(tau, s, others)
    g = found.factors
    count = found.factors.numel()
    if not count:
        return [tau], found.low, found.high
    low = list(found.low)
    high = list(found.high)
    zero = ca.SX.zeros(count)
    slope = ca.jacobian(found.tau, g)
    parts = [ca.substitute(found.tau, g, zero), *ca.horzsplit(ca.substitute(slope, g, zero))]
    for k in range(count):
        bend = ca.jacobian(slope[:, k], g)
        if ca.depends_on(bend, g) or not bend[:, k].is_zero():
            return None
        for i in range(k):
            if not bend[:, i].is_zero():
                ends = [
                    a * b
                    for a in (found.low[k], found.high[k])
                    for b in (found.low[i], found.high[i])
                ]
                parts.append(bend[:, i])
                low.append(min(ends))
                high.append(max(ends))
    return parts, np.array(low), np.array(high)


def is_regular(model: Model, effect: Effect, others: bool = False) -> bool:
    """Whether the torque has the regular form, up to factors of the time (and, with `others`, of
    the speeds of other joints): compared with its own expansion."""
    s = with_sign(model)
    if effect.states:
        return False
    try:
        parts = _split(effect.torque(s), s, others)
    except InputError:
        if not others:
            raise
        return False
    return parts is not None and all(_fits(model, part, s) for part in parts[0])


def _fits(model: Model, tau: ca.SX, s: ArmSignals) -> bool:
    """Compare with the expansion at random states; its coefficients must be analytic. A base that
    stands will do: torque is linear in its acceleration as in that of the joints."""
    n = model.robot.n
    if s.carried is not None:
        tau = ca.substitute(tau, s.carried, ca.SX.zeros(3))
    if ca.depends_on(tau, ca.vertcat(s.time, s.qddd, s.qdddd)):
        return False
    dq = ca.SX.sym("dq", n)
    ddq = ca.SX.sym("ddq", n)
    truth = ca.Function("t", [s.q, s.qd, s.qdd, s.sign], [tau])
    form = ca.Function("form", [s.q, dq, ddq], expand(tau, s, dq, ddq))
    try:
        disc_function(form)
    except InputError:
        return False
    rng = np.random.default_rng(0)
    for _ in range(6):
        q = rng.uniform(model.robot.q_min, model.robot.q_max)
        d = rng.normal(size=n)
        dd = rng.normal(size=n)
        v = rng.uniform(0.3, 3.0)
        u = rng.normal() * 3
        a, b, e, c_minus, _, c_plus = (np.asarray(x).ravel() for x in form(q, d, dd))
        expected = a * u + b * v**2 + e * v + np.where(d > 0, c_plus, c_minus)
        found = np.asarray(truth(q, d * v, dd * v**2 + d * u, np.sign(d))).ravel()
        if not np.abs(found - expected).max() <= 1e-9 * (1 + np.abs(found).max()):
            return False
    return True


def _law(model: Model, effect: Effect) -> ScalarLaw | None:
    """The effect as a law of one scalar of one joint; None if it is not one."""
    n = model.robot.n
    memory = _memory(effect)
    if effect.joint is None or len(effect.states) > 1 or (effect.states and memory is None):
        return None
    j = effect.index
    s = replace(with_sign(model), state=ca.SX.sym("state", len(effect.states)))
    load = ca.SX.sym("load", n)
    friction = ca.SX.sym("friction", n)
    # the rigid-body torque as a symbol, in place of its long expression, and friction beside it
    vars(s).update(load=load, tau=load + friction)
    parts = lifted(effect.torque(s), s)
    others = [k for k in range(n) if k != j]
    elsewhere = parts.tau[others]
    w = ca.SX.sym("w")
    direction = ca.SX.sym("direction")
    state = ca.SX.sym("x")
    f = ca.substitute(parts.tau[j], s.sign[j], direction)
    f = ca.substitute(f, s.state, state) if effect.states else f
    by_load = bool(ca.depends_on(f, load[j]))
    own = _own_friction(f, load[j], friction[j]) if by_load else 0.0
    f = ca.substitute(f, friction, 0) if by_load else f
    f = (
        ca.substitute(f, load[j], w)
        if by_load
        else ca.substitute(f, s.qd[j], direction * ca.sqrt(w))
    )
    arguments = (
        [w, direction, state, *ca.vertsplit(parts.factors)]
        if parts.factors.numel()
        else [w, direction, state]
    )
    if not elsewhere.is_zero() or {v.element_hash() for v in ca.symvar(f)} - {
        v.element_hash() for v in arguments
    }:
        return None
    slope = ca.jacobian(f, w)
    bend = ca.jacobian(slope, w)
    values = ca.Function("law", arguments, [ca.densify(x) for x in (f, slope, bend)])
    try:
        interval_function(values)([(np.ones(1), np.ones(1))] * values.n_in())
    except InputError:
        return None
    if own is None or (by_load and not _even(values)):
        return None
    of: Literal["speed", "load"] = "load" if by_load else "speed"
    return ScalarLaw(j, of, values, parts.low, parts.high, memory, not bend.is_zero(), own)


def _own_friction(f: ca.SX, load: ca.SX, friction: ca.SX) -> float | None:
    """The share k of a law that depends on load + k friction, from its slopes at random places;
    None: it is not one."""
    if not ca.depends_on(f, friction):
        return 0.0
    symbols = ca.symvar(f)
    slopes = ca.Function("slopes", symbols, [ca.gradient(f, load), ca.gradient(f, friction)])
    rng = np.random.default_rng(0)
    places = rng.uniform(0.5, 90.0, (8, len(symbols))) * rng.choice([-1.0, 1.0], (8, len(symbols)))
    found = np.array([[float(slope) for slope in slopes(*place)] for place in places])
    share = found[0, 1] / found[0, 0]
    same = np.allclose(found[:, 1], share * found[:, 0], rtol=1e-9, atol=0)
    return float(share) if same and 0 <= share <= 1 else None


def _even(values: ca.Function) -> bool:
    """Whether a law of the load depends on its size only."""
    rest = [0.7] * (values.n_in() - 1)
    pairs = [(float(values(w, *rest)[0]), float(values(-w, *rest)[0])) for w in (3.0, 70.0, 900.0)]
    return all(np.isclose(one, other, atol=1e-12) for one, other in pairs)


def _memory(effect: Effect) -> Memory | None:
    turned = ca.SX.sym("turned")
    ends = effect.settled(turned)
    if ends is None or len(effect.states) != 1:
        return None
    function = ca.Function("settled", [turned], [ca.densify(end) for end in ends])

    def bounds(angle: Array) -> tuple[Array, Array]:
        low, high = function(ca.DM(angle[None, :]))
        return np.asarray(low).ravel(), np.asarray(high).ravel()

    return bounds
