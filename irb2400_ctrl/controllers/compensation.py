"""The model inside a controller: inverse dynamics with friction along the *reference* motion and
effects with memory.

    tau = M(q) a + C(q, qd) qd + G(q) + effects(q, qd, a, t, z; s) + F_v qd_ref
        + (F_c + bell(qd / omega_st) qd_ref^2 / (qd_ref^2 + breakaway^2)) s
    s = qd_ref / sqrt(qd_ref^2 + eps^2),    bell(x) = (F_s - F_c) exp(-x^2) to a quarter of a per
    cent (`stribeck`)

Dry friction is compensated in the direction the arm is meant to move: the measured speed has noise
and stick in it, and its sign would make the torque chatter. The regularised sign s leaves a resting
reference without friction torque. How far the Stribeck curve has fallen is read from the measured
speed: a joint that still sticks while the reference has moved on needs its static friction, or it
stays behind until the feedback has found it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import casadi as ca

from irb2400_ctrl.codegen import Field
from irb2400_ctrl.controllers.arm_numbers import ArmNumbers, memory_fields
from irb2400_ctrl.controllers.parts import Clock
from irb2400_ctrl.controllers.stribeck import faded_bell
from irb2400_ctrl.effects import Effect
from irb2400_ctrl.robot import Robot

BREAKAWAY = 0.0045
"""reference speed [rad/s] at which half of the static friction above Coulomb's is compensated (0.9
at three times as much); with less, a joint that has just broken loose overshoots the reference and
sticks again, and its gear pays"""
LEAST_BREAKAWAY = 1e-6
"""[rad/s] by which nothing changes, and above the zero that at rest would be divided by"""
SIGN_WIDTH = 2e-3
"""eps of the regularised sign [rad/s]: a reference passes it in a millisecond or two, friction of
0.5 % is lost at ten times this speed"""


@dataclass(frozen=True)
class Compensation:
    """Torque that the model says a motion needs, as a piece of a discrete-time block.

    Args:
        robot: with its effects; those of the measuring chain are left alone.
        sample_time: of the controller [s], for effects with memory.
        tables: payload, friction and the numbers of the effects are parameters, not constants in
            the code.
    """

    robot: Robot
    sample_time: float
    tables: bool = False

    @cached_property
    def _numbers(self) -> ArmNumbers:
        return ArmNumbers(self.robot, self.tables)

    @cached_property
    def effects(self) -> tuple[Effect, ...]:
        """Effects that load the actuators as a force (those on the arm's parameters are in the
        model's mass data)."""
        return self._numbers.forces

    @cached_property
    def memories(self) -> tuple[tuple[Effect, Field], ...]:
        """The effects with internal states, and those states as fields of the block."""
        return memory_fields(self.effects)

    @cached_property
    def _core(self) -> ca.Function:
        """(q, qd, qdd, qd_ref, slip, time, memory, parameters) -> (tau, next memory)."""
        n = self.robot.n
        qd_ref, slip = (ca.SX.sym(name, n) for name in ("qd_ref", "slip"))
        given = {field.name: ca.SX.sym(field.name, field.size) for field in self.parameters}
        sign = qd_ref / ca.sqrt(qd_ref**2 + SIGN_WIDTH**2)
        s = replace(self._numbers.signals(given), sign=sign)
        law = self._numbers.friction(given)
        dry = law.coulomb + faded_bell(slip, law.stribeck, law.rise, qd_ref, given["breakaway"])
        # one product with the speed, which a small processor reads once
        tau = s.load + (law.viscous + dry / ca.sqrt(qd_ref**2 + SIGN_WIDTH**2)) * qd_ref
        # speeds of effects with memory come from the reference too, for the same reason as the
        # friction's
        tau, old, new = self._numbers.loaded(tau, given, s, qd_ref, self.sample_time)
        # the derivatives of the acceleration are not known to a controller; elastic joints count as
        # rigid here
        rest = ca.vertcat(s.qddd, s.qdddd)
        tau = ca.substitute(tau, rest, ca.SX.zeros(rest.numel()))
        memory = ca.vertcat(ca.SX(0, 1), *old)
        grown = ca.vertcat(ca.SX(0, 1), *new)
        steps = s.recursion.steps | {"dry": dry, "load": s.load}
        return ca.Function(
            "compensation",
            [s.q, s.qd, s.qdd, qd_ref, slip, s.time, memory, ca.vertcat(*given.values())],
            [ca.cse(ca.densify(tau)), grown, *(steps[field.name] for field in self.told)],
        )

    @cached_property
    def told(self) -> tuple[Field, ...]:
        """Steps on the way to the torque, by name."""
        s = self._numbers.signals({f.name: ca.SX.sym(f.name, f.size) for f in self.parameters})
        steps = [
            Field(name, x.numel(), *s.recursion.meaning(name))
            for name, x in s.recursion.steps.items()
        ]
        n = self.robot.n
        dry = Field("dry", n, "Nm", "Coulomb friction and what of static friction is above it")
        return (*steps, dry, Field("load", n, "Nm", "torque of the rigid arm (eq. 57)"))

    @cached_property
    def uses_time(self) -> bool:
        """Whether an effect depends on the time since the start."""
        return bool(self._core.jac_sparsity(0, 5).nnz())

    @property
    def states(self) -> tuple[Field, ...]:
        """What the block has to remember for this torque."""
        clock = self._clock.states if self.uses_time else ()
        return (*clock, *(field for _, field in self.memories))

    @property
    def parameters(self) -> tuple[Field, ...]:
        """What can be tuned without new code."""
        doc = "reference speed at which half of the static friction is compensated"
        n = self.robot.n
        least = (LEAST_BREAKAWAY,) * n
        breakaway = Field("breakaway", n, "rad/s", doc, (BREAKAWAY,) * n, lower=least)
        return (breakaway, *self._numbers.parameters)

    def torque(
        self,
        values: Mapping[str, ca.SX],
        motion: tuple[ca.SX, ca.SX, ca.SX],
        qd_ref: ca.SX,
        slip: ca.SX,
    ) -> tuple[ca.SX, dict[str, ca.SX]]:
        """tau, and by name the next values of `states` and what is `told`.

        Args:
            values: present values of `states` and `parameters` by name.
            motion: (q, qd, qdd) for inertia, Coriolis force, gravity and effects.
            qd_ref: speed that says where the arm is meant to go.
            slip: speed at which the Stribeck curve is read.
        """
        clock = self._clock.time(values) if self.uses_time else ca.SX(0)
        memory = [values[field.name] for _, field in self.memories]
        given = ca.vertcat(*(values[field.name] for field in self.parameters))
        tau, grown, *steps = self._core.call(
            [*motion, qd_ref, slip, clock, ca.vertcat(ca.SX(0, 1), *memory), given], True, False
        )
        ends = [0]
        for _, field in self.memories:
            ends.append(ends[-1] + field.size)
        after = {
            f.name: grown[a:b] for (_, f), (a, b) in zip(self.memories, pairwise(ends), strict=True)
        }
        after |= {field.name: x for field, x in zip(self.told, steps, strict=True)}
        return tau, after | (self._clock.later(values) if self.uses_time else {})

    @property
    def _clock(self) -> Clock:
        return Clock(self.sample_time)
