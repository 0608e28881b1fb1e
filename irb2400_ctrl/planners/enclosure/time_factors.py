"""A torque taken apart into what depends on the time alone, and the rest.

Time counts from an instant that the timing does not know: the factors are bounded over all times.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

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
    """An effect's torque with every part that depends on time alone replaced by a symbol."""

    tau: ca.SX
    factors: ca.SX
    """the symbols, shape (k, 1)"""
    low: Array
    high: Array
    """bounds of the factors over all times, shape (k,)"""


Timed = tuple[ca.SX, Interval | None]
"""an expression, and its bounds at all times if it depends on time alone"""


class _TimedParts(Algebra[Timed]):
    """Numbers are expressions; one that depends on time alone becomes a factor where it meets the
    rest."""

    expected = "a force that depends on the time must be bounded over all times"

    def __init__(self) -> None:
        self.factors: list[ca.SX] = []
        self.low: list[float] = []
        self.high: list[float] = []
        self._known: dict[int, ca.SX] = {}

    def constant(self, value: float) -> Timed:
        return ca.SX(value), INTERVALS.constant(value)

    def rule(self, op: int) -> Callable[..., Timed]:
        bounds = INTERVALS.rule(op)

        def apply(*operands: Timed) -> Timed:
            ranges = [r for _, r in operands if r is not None]
            if len(ranges) < len(operands):
                return _operation(op, [self.apart(o) for o in operands]), None
            if bounds is None:
                raise NoRule(op)
            with np.errstate(all="ignore"):
                return _operation(op, [e for e, _ in operands]), bounds(*ranges)

        return apply

    def apart(self, x: Timed) -> ca.SX:
        """The expression itself, or the factor that stands for it."""
        expression, range_ = x
        if range_ is None or expression.is_constant():
            return expression
        key = expression.element_hash()
        if key not in self._known:
            self._known[key] = ca.SX.sym(f"factor{len(self._known)}")
            self.factors.append(self._known[key])
            self.low.append(float(np.min(range_[0])))
            self.high.append(float(np.max(range_[1])))
        return self._known[key]


def lifted(tau: ca.SX, s: ArmSignals) -> Lifted:
    """Separate the time from the rest, operation by operation; no factors where time does not
    enter."""
    if not ca.depends_on(tau, s.time):
        return Lifted(tau, ca.SX(0, 1), np.empty(0), np.empty(0))
    inputs = list(ca.vertsplit(ca.vertcat(*ca.symvar(tau))))
    function = ca.Function("torque", inputs, [ca.densify(tau)])
    clock = next(i for i, v in enumerate(inputs) if v.element_hash() == s.time.element_hash())
    parts = _TimedParts()
    times = _TIMES[:-1], _TIMES[1:]
    (column,) = walk(function, parts, lambda k, _: (inputs[k], times if k == clock else None))
    result = ca.vertcat(*(parts.apart(x) for x in column))
    factors = ca.vertcat(*parts.factors) if parts.factors else ca.SX(0, 1)
    return Lifted(result, factors, np.array(parts.low), np.array(parts.high))


def _operation(op: int, operands: list[ca.SX]) -> ca.SX:
    return ca.SX.unary(op, *operands) if len(operands) == 1 else ca.SX.binary(op, *operands)
