"""The numbers of a plant's effects as inputs of its compiled code: other numbers, the same machine
code.

An effect is `basis(nonlinear fields) @ coefficients + discrepancy_basis @ discrepancy`. Its data
are, one after the other, the coefficients, the fields, the discrepancy; all three become symbols,
so nothing of the effect but its form is compiled in.
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from irb2400_ctrl.effects import Effect
from irb2400_ctrl.effects.base import COMMON
from irb2400_ctrl.effects.form import EffectForm


def form_of(effect: Effect, data: ca.SX) -> EffectForm:
    """The form of `effect`, its numbers taken from `data`, shape (len(effect_data(effect)),)."""
    own = _fields(effect)
    k = len(effect.coefficients())
    symbols = {name: data[k + i] for i, name in enumerate(own)}
    return EffectForm.of(effect, symbols, data[:k], data[k + len(own) :])


def effect_data(effect: Effect) -> tuple[float, ...]:
    """The numbers of one effect: coefficients, fields, discrepancy."""
    return (*effect.coefficients(), *_fields(effect).values(), *effect.discrepancy)


def data_of(effects: Sequence[Effect]) -> tuple[float, ...]:
    """The numbers of several effects, one after the other."""
    return tuple(float(value) for effect in effects for value in effect_data(effect))


def structure(effects: Sequence[Effect]) -> tuple[tuple[object, ...], ...]:
    """What of the effects is compiled in: their kinds, joints, number of discrepancy coefficients
    and windows of time."""
    return tuple((e.kind, e.joint, len(e.discrepancy), e.windows_s) for e in effects)


def _fields(effect: Effect) -> dict[str, float]:
    return {name: value for name, value in effect.parameters().items() if name not in COMMON}
