"""Bodies that the robot carries without the model knowing: a payload, a mass on a link."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Annotated, Any, ClassVar, Literal, Self

import casadi as ca
import numpy as np
from pydantic import Field

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.effects.ambiguity import MASS, Ambiguity
from irb2400_ctrl.effects.base import Acts, Effect
from irb2400_ctrl.effects.prior import EXACT, Nested, Prior
from irb2400_ctrl.effects.signals import Signals

Vector3 = Annotated[
    tuple[float, float, float], Field(description="in the frame of the body that carries it")
]


REACH = 0.8
"""[m] no body of an arm sits further from its link frame"""
SHARE_OF_MASS = 0.1
"""spread of an added mass over the mass that the arm moves"""
SHARE_OF_REACH = 0.1
"""spread of its place over the arm's reach"""
USUAL_REACH = 0.35
"""[m] where it is taken to sit when the data do not tell"""


class AddedBody(Effect):
    """A point mass m at c, fixed to a link frame: phi = (m, m c, m (|c|^2 1 - c c^T)), tau = Y(q,
    qd, qdd) phi."""

    acts: ClassVar[Acts] = "parameters"
    prior: ClassVar[Prior] = Prior(
        coefficients=((0.0, 10.0), *[(0.0, 3.0)] * 3, *[(0.0, 1.0)] * 6),
        fields={"com_m": (0.0, 0.25), "mass_kg": (0.0, 10.0)},
        discrepancy_share=EXACT,
    )

    mass_kg: float = Field(description="mass m, negative for one that is missing [kg]")
    com_m: Vector3 = Field(default=(0.0, 0.0, 0.0), description="its place c [m]")

    @classmethod
    def nested(cls, mass: float, reach: float, axis: Array) -> Sequence[Nested]:
        """A mass on the last axis, at a place, or a whole body.

        Args:
            mass: that the arm moves [kg]; reach: of its flange [m]; axis: of its last joint.
        """
        m = SHARE_OF_MASS * mass
        place = SHARE_OF_REACH * reach
        spreads = [m, *[m * place] * 3, *[m * place**2] * 6]
        whole = tuple((0.0, float(s)) for s in spreads)
        forms = [Nested(np.eye(10)[:, :k], whole[:k]) for k in (4, 10)]
        if not cls.whole_arm:
            return forms
        # on the last joint's axis, where a tool usually sits
        on_axis = cls.of(None, mass_kg=1.0, com_m=tuple(place * axis)).coefficients()
        return [Nested(np.array(on_axis)[:, None], whole[:1]), *forms]

    @abstractmethod
    def carrier(self, n: int) -> int:
        """Number of the carrying link, n + 1 for the flange frame."""

    def body(self, n: int) -> tuple[int, Array]:
        return self.carrier(n), np.array(self.coefficients())

    def basis(self, s: Signals) -> ca.SX:
        return s.regressor(self.carrier(s.q.numel()))

    def coefficients(self) -> tuple[float, ...]:
        m = self.mass_kg
        x, y, z = self.com_m
        second = (y * y + z * z, -x * y, -x * z, x * x + z * z, -y * z, x * x + y * y)
        return (m, m * x, m * y, m * z, *(m * s for s in second))

    def sizes(self) -> tuple[float, ...]:
        return self.mass_kg, math.hypot(*(self.mass_kg * c for c in self.com_m))

    @classmethod
    def from_coefficients(
        cls, joint: int | None, coefficients: Sequence[float], nonlinear: dict[str, float]
    ) -> Self:
        m, *moment = (float(c) for c in coefficients[:4])
        # a mass whose weight another link carries (the parallelogram) shows in its first moment
        # only
        if math.hypot(*moment) > REACH * abs(m):
            m = math.hypot(*moment) / USUAL_REACH
        return cls.of(joint, mass_kg=m, com_m=tuple(c / m for c in moment))


class Payload(AddedBody):
    """tau = Y phi(m, c) of a mass at the flange that the tool data do not contain (frame: flange,
    eq. 9)."""

    sentence: ClassVar[str] = (
        "the robot carries more (or less) at its flange than its tool data say"
    )
    whole_arm: ClassVar[bool] = True
    example: ClassVar[Mapping[str, Any]] = {"mass_kg": 5.0, "com_m": (0.03, 0.02, 0.1)}
    ambiguity: ClassVar[Ambiguity] = replace(MASS, change_of=("tool",))

    kind: Literal["payload"] = "payload"

    @classmethod
    def about(cls, form: Nested, numbers: Array) -> Nested | None:
        """Of a mass and its place: with its moments of second order about its link's frame, which
        are m c_i c_j = (m c_i) (m c_j) / m, to first order about this mass and place."""
        if form.columns.shape[1] != 4 or not abs(numbers[0]) > 0.0:
            return None
        c = numbers[1:] / numbers[0]
        if np.hypot.reduce(c) > REACH:
            return None
        columns = np.zeros((10, 4))
        columns[:4] = np.eye(4)
        pairs = [(i, j) for i in range(3) for j in range(i, 3)]
        for row, (i, j) in enumerate(pairs, start=4):
            # I = m (|c|^2 1 - c c^T)
            columns[row, 0] += c[i] * c[j] - (c @ c if i == j else 0.0)
            columns[row, 1 + i] -= c[j]
            columns[row, 1 + j] -= c[i]
            if i == j:
                columns[row, 1:] += 2.0 * c
        return Nested(columns, form.coefficients)

    def carrier(self, n: int) -> int:
        return n + 1


class LinkInertia(AddedBody):
    """tau = Y phi(m, c) of a mass on a link that the link data do not contain (frame: that
    link)."""

    sentence: ClassVar[str] = "a link of the robot is heavier or lighter than its data say"
    example: ClassVar[Mapping[str, Any]] = {"mass_kg": 5.0, "com_m": (0.15, 0.05, 0.1)}
    ambiguity: ClassVar[Ambiguity] = replace(MASS, change_of=("link",))

    # from one day to another it is the tool that is changed, a thousand times to one
    prior: ClassVar[Prior] = replace(AddedBody.prior, steady=7.0)

    kind: Literal["link_inertia"] = "link_inertia"

    def carrier(self, n: int) -> int:
        return self.index + 1

    @classmethod
    def joints(cls, n: int) -> Sequence[int | None]:
        # a mass on the last link is a payload; of link 1 only the inertia about its axis is ever
        # seen
        return range(2, n)
