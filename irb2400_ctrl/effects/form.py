"""An effect with symbols for its numbers: other numbers, the same code."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import casadi as ca

from irb2400_ctrl.effects.base import Effect
from irb2400_ctrl.effects.signals import Signals


@dataclass(frozen=True)
class EffectForm:
    """What of an effect is law, its numbers left open.

    Args:
        effect: of the same kind, its fields symbols: what is asked of it is an expression.
        coefficients, discrepancy: of the two bases, in their order.
    """

    effect: Effect
    coefficients: ca.SX | ca.DM
    discrepancy: ca.SX | ca.DM

    @classmethod
    def of(
        cls, effect: Effect, fields: Mapping[str, object], coefficients: ca.SX, discrepancy: ca.SX
    ) -> EffectForm:
        """The form of `effect` with symbols in place of its own fields; those that are no number,
        and are not given, stay as they are."""
        own = {n: getattr(effect, n) for n in type(effect).model_fields if n != "discrepancy"}
        # construct, not validate: the fields are symbols
        form = type(effect).model_construct(None, **{**own, **fields})
        return cls(form, coefficients, discrepancy)

    @classmethod
    def constant(cls, effect: Effect) -> EffectForm:
        """The effect with its own numbers."""
        numbers = (effect.coefficients(), effect.discrepancy)
        return cls(effect, *(ca.DM(list(some)).reshape((-1, 1)) for some in numbers))

    @property
    def states(self) -> int:
        """Number of internal states."""
        return len(self.effect.states)

    def torque(self, s: Signals) -> ca.SX:
        """As `Effect.torque`, shape (n,) [Nm]."""
        return self.effect.torque_of(s, self.coefficients, self.discrepancy)
