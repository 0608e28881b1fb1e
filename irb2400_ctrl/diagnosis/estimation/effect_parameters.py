"""The natural parameters of effects that a fit moves."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from pydantic import ValidationError

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.effects import Effect
from irb2400_ctrl.effects.base import COMMON


@dataclass(frozen=True)
class Parameter:
    """One natural parameter of one effect: place of the effect, field, element (None for a plain
    number)."""

    effect: int
    name: str
    element: int | None
    prior: tuple[float, float] | None


def parameters_of(effect: Effect, place: int, stated: Sequence[Effect] = ()) -> list[Parameter]:
    """The natural parameters of an effect that a fit may move.

    Args:
        effect: of the model; place: its number among them.
        stated: of `of_changing_strength`; what changes one of them keeps its shape.
    """
    found = []
    # those of effects with memory come from a search that also moves the record's beginning
    keeps = effect.states or changed_of(effect, stated) is not None
    held = type(effect).nonlinear_names(effect.joint) if keeps else ()
    for name, value in effect.parameters().items():
        if name in held:
            continue
        prior = effect.prior.fields.get(name)
        if isinstance(value, tuple | list):
            if name not in COMMON:
                found += [Parameter(place, name, k, prior) for k in range(len(value))]
        elif value == 0.0 and name in (*effect.prior.in_place_of_friction, *effect.prior.absent):
            continue
        elif isinstance(value, float) and name not in effect.prior.fixed:
            found.append(Parameter(place, name, None, prior))
    return found


def of_changing_strength(effects: Sequence[Effect]) -> tuple[Effect, ...]:
    """The effects of a file of which a log may show another strength at the same shape: torques
    whose shape is in their numbers, without memory, acting always. Those of one shape on one joint
    are one."""
    alike: dict[tuple[object, ...], list[Effect]] = {}
    for e in effects:
        if e.chain == "torque" and e.nonlinear and not e.states and not e.windows_s:
            alike.setdefault((e.kind, e.joint, *sorted(e.nonlinear.items())), []).append(e)
    found = []
    for e, *others in alike.values():
        whole = np.sum([one.coefficients() for one in (e, *others)], axis=0)
        if whole.any():
            found.append(type(e).from_coefficients(e.joint, whole.tolist(), e.nonlinear))
    return tuple(found)


def changed_of(effect: Effect, stated: Sequence[Effect]) -> Effect | None:
    """The one of `of_changing_strength` of which an effect is a change, if any is."""
    for one in stated:
        same = (one.kind, one.joint) == (effect.kind, effect.joint)
        if same and one.nonlinear == effect.nonlinear and not effect.windows_s:
            return one
    return None


def value_of(effect: Effect, parameter: Parameter) -> float:
    value = getattr(effect, parameter.name)
    return float(value if parameter.element is None else value[parameter.element])


def with_value(effect: Effect, parameter: Parameter, value: float) -> Effect:
    """A copy without validation (differences may step over a bound).

    Args:
        effect: with its other numbers.
        parameter: which one.
        value: in the unit of its field.
    """
    if parameter.element is None:
        return effect.model_copy(update={parameter.name: value})
    whole = list(getattr(effect, parameter.name))
    whole[parameter.element] = value
    return effect.model_copy(update={parameter.name: tuple(whole)})


def slope_of(
    effect: Effect, parameter: Parameter, step: float, shown: Callable[[Effect], Array]
) -> Array:
    """d shown / d parameter by central differences.

    Args:
        effect: about which; parameter: of it.
        step: to each side, in the unit of its field.
        shown: what an effect shows.
    """
    value = value_of(effect, parameter)
    up, down = (shown(with_value(effect, parameter, value + by)) for by in (step, -step))
    return np.asarray((up - down) / (2.0 * step))


def small_step(value: float) -> float:
    """Of a difference about a value."""
    return 1e-4 * max(abs(value), 1e-2)


def moved(
    effects: list[Effect], parameters: Sequence[Parameter], step: Array, longest: float
) -> list[Effect] | None:
    """The effects after a step, shortened until all bounds hold; None if no step is possible.

    Args:
        effects: as they are.
        parameters: that move.
        step: in the units of their fields, shape (p,).
        longest: time constant that the record can tell [s].
    """
    for shrink in (1.0, 0.5, 0.25, 0.1):
        there = list(effects)
        for parameter, change in zip(parameters, step * shrink, strict=True):
            effect = there[parameter.effect]
            value = value_of(effect, parameter) + float(change)
            if parameter.name in effect.prior.time_constants:
                value = min(value, longest)
            there[parameter.effect] = with_value(effect, parameter, value)
        try:
            valid = [type(e).model_validate(e.model_dump()) for e in there]
        except ValidationError:
            continue
        if not any(e.unlikely for e in valid):
            return valid
    return None


def alone(covariance: Array, parameters: Sequence[Parameter]) -> Array:
    """Standard errors with the other parameters of the same effect held."""
    found = np.zeros(len(parameters))
    owner = np.array([parameter.effect for parameter in parameters])
    for effect in set(owner):
        own = np.flatnonzero(owner == effect)
        found[own] = 1.0 / np.sqrt(np.diag(np.linalg.inv(covariance[np.ix_(own, own)])))
    return found
