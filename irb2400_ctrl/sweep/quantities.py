"""Uncertain numbers of a study: fixed, or drawn from a range; and the effects and payloads made of
them."""

from __future__ import annotations

from typing import Annotated, Any, Self

import numpy as np
from pydantic import (
    AfterValidator,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
    ValidationError,
    model_validator,
)

from irb2400_ctrl.effects import LIBRARY, Effect, effect_class
from irb2400_ctrl.effects.added_body import Payload
from irb2400_ctrl.effects.base import COMMON
from irb2400_ctrl.effects.registry import joints_in_words
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.table import Table


def _form(value: object) -> str:
    length = len(value) if isinstance(value, list | tuple) else 0
    return {0: "number", 3: "vector"}.get(length, "range")


def _ordered(value: tuple[float, float]) -> tuple[float, float]:
    if value[0] > value[1]:
        raise ValueError(f"a range has its lower end first, found [{value[0]}, {value[1]}]")
    return value


def _spread(value: float | tuple[float, float]) -> float | tuple[float, float]:
    least = value[0] if isinstance(value, tuple) else value
    if least < 0:
        raise ValueError(f"a standard deviation is not below zero, found {least}")
    return value


FORMS = ("number", "range", "vector")
"""words that pydantic puts into the path of a problem"""
_Number = Annotated[float, Tag("number")]
_Range = Annotated[tuple[float, float], AfterValidator(_ordered), Tag("range")]
Quantity = Annotated[_Number | _Range, Discriminator(_form)]
"""a number, or [low, high] of a uniform distribution"""
Spread = Annotated[Quantity, AfterValidator(_spread)]
"""a standard deviation"""
Vector = tuple[Quantity, Quantity, Quantity]
AnyQuantity = Annotated[_Number | _Range | Annotated[Vector, Tag("vector")], Discriminator(_form)]


def draw(quantity: Quantity, rng: np.random.Generator) -> float:
    """One value; a fixed number uses up a random one too, so that fixing one leaves the others as
    they were."""
    share = float(rng.random())
    if isinstance(quantity, tuple):
        low, high = quantity
        return low + (high - low) * share
    return quantity


def _farthest(quantity: Quantity) -> float:
    """The end of a range that is farther from zero."""
    return max(quantity, key=abs) if isinstance(quantity, tuple) else quantity


class Deviations(Table):
    """Relative standard deviations of the plant's data around the robot's, cut at two
    (`perturbed_robot`)."""

    mass: float = Field(default=0.0, ge=0, lt=0.5)
    com_m: float = Field(default=0.0, ge=0, le=0.1)
    """of each coordinate of the centres of mass [m]"""
    inertia: float = Field(default=0.0, ge=0, lt=0.5)
    friction: float = Field(default=0.0, ge=0, lt=0.5)


class PayloadSpread(Table):
    """A mass at the flange that no controller knows."""

    mass_kg: Quantity
    com_m: Vector = (0.0, 0.0, 0.0)

    @property
    def largest(self) -> Payload:
        """The one that asks most of the arm."""
        mass, *com = (_farthest(value) for value in (self.mass_kg, *self.com_m))
        return Payload.of(None, mass_kg=mass, com_m=tuple(com))


class EffectDraw(Table):
    """An effect of the plant: its kind, where it may sit, the ranges of its parameters (all other
    keys)."""

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[str, AnyQuantity]

    kind: str
    joint: int | tuple[int, ...] | None = None
    """one joint, or a list to draw from; absent for an effect of the whole arm"""
    probability: float = Field(default=1.0, ge=0, le=1)
    """share of the plants that have it"""

    @model_validator(mode="after")
    def _is_an_effect(self) -> Self:
        try:
            effect_class(self.kind)
        except InputError as error:
            raise ValueError(str(error)) from error
        problems = []
        for joint in self.joints:
            # every corner that a draw may come near has to be a valid effect
            for end in (0, 1):
                try:
                    corner = {name: _corner(value, end) for name, value in self.ranges.items()}
                    LIBRARY[self.kind].model_validate({"joint": joint, **corner})
                except ValidationError as error:
                    problems += [_problem(self.kind, item) for item in error.errors()]
        if problems:
            raise ValueError("\n".join(dict.fromkeys(problems)))
        return self

    @property
    def joints(self) -> tuple[int | None, ...]:
        """Joints to draw from."""
        return self.joint if isinstance(self.joint, tuple) else (self.joint,)

    @property
    def ranges(self) -> dict[str, AnyQuantity]:
        """Parameters of the effect."""
        return dict(self.__pydantic_extra__)

    def problems(self, axes: int) -> list[str]:
        """What does not fit an arm of that many axes."""
        allowed = LIBRARY[self.kind].joints(axes)
        wrong = [joint for joint in self.joints if joint not in allowed]
        names = joints_in_words(self.kind, axes)
        return [f"{self.kind} on joint {joint}, expected {names}" for joint in wrong]

    def draw(self, rng: np.random.Generator) -> tuple[Effect | None, list[Effect]]:
        """The effect of one plant, None where it has none; and the same of size zero wherever it
        could have been.

        With these all plants have the same equations, and one compiled loop serves them; a kind
        that cannot be zero is left out where it is absent, which costs a compilation.
        """
        present = bool(rng.random() < self.probability)
        joint = self.joints[int(rng.integers(len(self.joints)))]
        values = {name: _drawn(value, rng) for name, value in self.ranges.items()}
        drawn = self._make(joint, values)
        if drawn.role != "force":
            return (drawn, []) if present else (None, [])
        others = [
            self._make(j, values) for j in dict.fromkeys(self.joints) if not present or j != joint
        ]
        return drawn if present else None, [
            zero for zero in map(without_size, others) if zero is not None
        ]

    def _make(self, joint: int | None, values: dict[str, Any]) -> Effect:
        return LIBRARY[self.kind].of(joint, **values)


def without_size(effect: Effect) -> Effect | None:
    """The effect with coefficients of zero, None if its kind has no such member."""
    if effect.acts == "transmission":
        # in the plant a link with a state of its own, whatever the coefficient in the regressor
        return None
    bent = effect.nonlinear_names(effect.joint)
    values = {name: value if name in bent else 0.0 for name, value in effect.parameters().items()}
    try:
        zero = type(effect).of(effect.joint, **values)
        return zero if not any(zero.coefficients()) else None
    except (InputError, ZeroDivisionError):
        return None


def _problem(kind: str, item: Any) -> str:
    name = ".".join(str(part) for part in item["loc"])
    if item["type"] == "extra_forbidden":
        known = [f for f in LIBRARY[kind].model_fields if f not in COMMON]
        return f"{kind} has no {name}; expected some of {', '.join(known)}"
    return f"{name}: {item['msg']}"


def _corner(value: AnyQuantity, end: int) -> Any:
    if isinstance(value, tuple):
        return value[end] if len(value) == 2 else tuple(_corner(part, end) for part in value)
    return value


def _drawn(value: AnyQuantity, rng: np.random.Generator) -> Any:
    if isinstance(value, tuple) and len(value) == 3:
        return tuple(draw(part, rng) for part in value)
    return draw(value, rng)
