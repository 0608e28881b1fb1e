"""The numbers of a plant's effects as inputs of its compiled code: other numbers, the same machine
code.

An effect is `basis(nonlinear fields) @ coefficients + departures @ shape`. Its data are, one after
the other, the coefficients, the fields, the shape; all three become symbols, so nothing of the
effect but its form is compiled in.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca

from irb2400_ctrl.effects import Effect
from irb2400_ctrl.model.signals import ArmSignals


@dataclass(frozen=True)
class EffectForm:
    """An effect with symbols for its numbers."""

    effect: Effect
    coefficients: ca.SX
    shape: ca.SX

    @classmethod
    def of(cls, effect: Effect, data: ca.SX) -> EffectForm:
        """The form of `effect`, its numbers taken from `data`, shape
        (len(effect_data(effect)),)."""
        own = _fields(effect)
        k = len(effect.coefficients())
        # construct, not validate: the fields are symbols
        symbols: dict[str, Any] = {name: data[k + i] for i, name in enumerate(own)}
        symbols |= {"kind": effect.kind, "joint": effect.joint, "windows_s": effect.windows_s}
        form = type(effect).model_construct(None, **symbols)
        return cls(form, data[:k], data[k + len(own) :])

    @property
    def states(self) -> int:
        """Number of internal states."""
        return len(self.effect.states)

    def torque(self, s: ArmSignals) -> ca.SX:
        """As `Effect.torque`, shape (n,) [Nm]."""
        tau = self.effect.basis(s) @ self.coefficients
        if self.shape.numel():
            tau += self.effect.departures(s) @ self.shape
        return self.effect.switched(tau, s)


def effect_data(effect: Effect) -> tuple[float, ...]:
    """The numbers of one effect: coefficients, fields, shape."""
    return (*effect.coefficients(), *_fields(effect).values(), *effect.shape)


def data_of(effects: Sequence[Effect]) -> tuple[float, ...]:
    """The numbers of several effects, one after the other."""
    return tuple(float(value) for effect in effects for value in effect_data(effect))


def structure(effects: Sequence[Effect]) -> tuple[tuple[object, ...], ...]:
    """What of the effects is compiled in: their kinds, joints, number of shape coefficients and
    windows of time."""
    return tuple((e.kind, e.joint, len(e.shape), e.windows_s) for e in effects)


def _fields(effect: Effect) -> dict[str, float]:
    return {
        name: value
        for name, value in effect.parameters().items()
        if name not in {"shape", "windows_s"}
    }
