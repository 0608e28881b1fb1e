"""A torque taken apart into what depends on the time alone, and the rest.

Time counts from an instant that the timing does not know: the factors are bounded over all times.
What the speeds of other joints do to one, within bounds whatever they are (a neighbour's dry
friction, that of a motor which both turn), may be taken apart in the same way.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import casadi as ca
import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.model.signals import ArmSignals
from irb2400_ctrl.planners.enclosure.interval import INTERVALS, Interval
from irb2400_ctrl.symbolic import Algebra, NoRule, walk

# all times from zero to 28 years (a force without an end acts until 1e9 s), in steps small against
# any time constant
_TIMES = np.concatenate([[0.0], np.geomspace(1e-3, 9e8, 2000)])


@dataclass(frozen=True)
class Lifted:
    """An effect's torque with every part that depends on time alone, and has bounds, replaced by a
    symbol."""

    tau: ca.SX
    factors: ca.SX
    """the symbols, shape (k, 1)"""
    low: Array
    high: Array
    """bounds of the factors over all times, shape (k,)"""


_ANY: Interval = (np.array([-np.inf]), np.array([np.inf]))

Timed = tuple[ca.SX, Interval | None]
"""an expression, and its bounds at all times if it depends on time alone"""


class _TimedParts(Algebra[Timed]):
    """Numbers are expressions; one that depends on time alone becomes a factor where it meets the
    rest, or what has no bounds."""

    expected = "a force that depends on the time must be bounded over all times"

    def __init__(self, others: ca.SX | None = None) -> None:
        self.others = ca.SX(0, 1) if others is None else others
        self.factors: list[ca.SX] = []
        self.low: list[float] = []
        self.high: list[float] = []
        # with the expressions: the hash of one that is gone may be given to another
        self._known: dict[int, tuple[ca.SX, ca.SX]] = {}

    def constant(self, value: float) -> Timed:
        return ca.SX(value), INTERVALS.constant(value)

    def rule(self, op: int) -> Callable[..., Timed]:
        bounds = INTERVALS.rule(op)

        def apply(*operands: Timed) -> Timed:
            ranges = [r for _, r in operands if r is not None]
            if len(ranges) < len(operands):
                if op == ca.OP_SIGN and ca.depends_on(operands[0][0], self.others):
                    return ca.sign(operands[0][0]), (np.array([-1.0]), np.array([1.0]))
                return _operation(op, [self.apart(o) for o in operands]), None
            if bounds is None:
                raise NoRule(op)
            with np.errstate(all="ignore"):
                result = bounds(*ranges)
            bounded = [e for e, r in operands if _finite(r) and not e.is_constant()]
            if bounded and not _finite(result):
                return _operation(op, [self.apart(o) for o in operands]), None
            return _operation(op, [e for e, _ in operands]), result

        return apply

    def apart(self, x: Timed) -> ca.SX:
        """The expression itself, or the factor that stands for it."""
        expression, range_ = x
        if range_ is None or not _finite(range_) or expression.is_constant():
            return expression
        key = expression.element_hash()
        if key not in self._known:
            self._known[key] = expression, ca.SX.sym(f"factor{len(self._known)}")
            self.factors.append(self._known[key][1])
            self.low.append(float(np.min(range_[0])))
            self.high.append(float(np.max(range_[1])))
        return self._known[key][1]


def lifted(tau: ca.SX, s: ArmSignals, others: bool = False) -> Lifted:
    """Separate the time from the rest, operation by operation; no factors where time does not
    enter.

    Args:
        others: separate what the speeds of other joints do to each one, too.
    """
    if not others and not ca.depends_on(tau, s.time):
        return Lifted(tau, ca.SX(0, 1), np.empty(0), np.empty(0))
    inputs = list(ca.vertsplit(ca.vertcat(*ca.symvar(tau))))
    parts = _TimedParts(s.qd if others else None)
    rows = []
    clock = {s.time.element_hash(): (_TIMES[:-1], _TIMES[1:])}
    for j, torque in enumerate(ca.vertsplit(tau) if others else [tau]):
        speeds = [v for k, v in enumerate(ca.vertsplit(s.qd)) if others and k != j]
        free = clock | {v.element_hash(): _ANY for v in speeds}
        known = [(v, free.get(v.element_hash())) for v in inputs]
        function = ca.Function("torque", inputs, [ca.densify(torque)])
        (column,) = walk(function, parts, partial(_input, known))
        rows += [parts.apart(x) for x in column]
    factors = ca.vertcat(*parts.factors) if parts.factors else ca.SX(0, 1)
    return Lifted(ca.vertcat(*rows), factors, np.array(parts.low), np.array(parts.high))


def _input(known: list[Timed], number: int, _: int) -> Timed:
    return known[number]


def _finite(range_: Interval | None) -> bool:
    """Whether there are bounds."""
    return range_ is not None and bool(
        np.isfinite(range_[0]).all() and np.isfinite(range_[1]).all()
    )


def _operation(op: int, operands: list[ca.SX]) -> ca.SX:
    return ca.SX.unary(op, *operands) if len(operands) == 1 else ca.SX.binary(op, *operands)
