"""The numbers of the arm that a controller computes with: constants of its code, or parameters of a
running one: one image for many tools and arms."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca

from irb2400_ctrl.codegen import Field
from irb2400_ctrl.controllers.effect_tables import EffectTable, effect_tables
from irb2400_ctrl.effects import Effect
from irb2400_ctrl.effects.form import EffectForm
from irb2400_ctrl.effects.memory import next_memory
from irb2400_ctrl.model import Model
from irb2400_ctrl.model.friction import FrictionLaw
from irb2400_ctrl.model.regressor import transport
from irb2400_ctrl.model.signals import ArmSignals
from irb2400_ctrl.robot import Robot

SLOWEST = 1e-4
"""smallest Stribeck speed that is taken [rad/s]: the law divides by it"""
Given = Mapping[str, ca.SX]
"""values of `ArmNumbers.parameters` by name"""


@dataclass(frozen=True)
class ArmNumbers:
    """Payload, friction and effects of an arm, for equations.

    Args:
        robot: with its effects.
        tables: whether those numbers are parameters of the block.
    """

    robot: Robot
    tables: bool = False

    @cached_property
    def parameters(self) -> tuple[Field, ...]:
        """What of the arm can be set while a block runs."""
        if not self.tables:
            return ()
        rows = (row for table in self._effects.values() for row in table.fields())
        return (*payload_fields(), *friction_fields(self.robot), *rows)

    @cached_property
    def _effects(self) -> dict[int, EffectTable]:
        return effect_tables(self.robot) if self.tables else {}

    @property
    def forces(self) -> tuple[Effect, ...]:
        """The effects that load the actuators as a force, in the order of the robot's.

        An elastic joint counts as rigid: its spring would need the derivatives of the acceleration.
        """
        return tuple(e for e in self.robot.effects if _is_force(e))

    def forms(self, given: Given) -> list[EffectForm]:
        """`forces` with the present values of the parameters."""
        every = enumerate(self.robot.effects)
        return [self._form(place, given) for place, effect in every if _is_force(effect)]

    def loaded(
        self, tau: ca.SX, given: Given, s: ArmSignals, qd: ca.SX, step: float
    ) -> tuple[ca.SX, list[ca.SX], list[ca.SX]]:
        """A torque with that of `forces` on top, symbols of their memories, and these one sample
        later.

        Args:
            tau: without them [Nm], shape (n,).
            given: present values of the parameters.
            s: of the arm.
            qd: speed along which they remember [rad/s], shape (n,).
            step: sample time [s].
        """
        along = replace(s, qd=qd)
        old = []
        new = []
        for form in self.forms(given):
            x = ca.SX.sym("memory", form.states)
            tau += form.torque(s.with_state(x))
            if form.states:
                old.append(x)
                new.append(next_memory(form.effect.state_rate(along.with_state(x)), x, step))
        return tau, old, new

    def _form(self, place: int, given: Given) -> EffectForm:
        if place in self._effects:
            return self._effects[place].form(given)
        return EffectForm.constant(self.robot.effects[place])

    def friction(self, given: Given) -> FrictionLaw:
        """The law of dry and viscous friction."""
        return friction_of(given) if self.tables else FrictionLaw.of(self.robot)

    def signals(self, given: Given) -> ArmSignals:
        """Fresh symbols of the arm's state, and what follows from them with these bodies."""
        if not self.tables:
            return Model(self.robot).signals()
        forces = tuple(e for e in self.robot.effects if e.role != "parameters")
        bare = self.robot.model_copy(update={"effects": forces})
        return replace(Model(bare).signals(), added=self._bodies(given))

    def _bodies(self, given: Given) -> ca.SX:
        """(m, m c, I_O) that each link carries beside its own, shape (n, 10)."""
        n = self.robot.n
        added = ca.SX(n, 10)
        added[n - 1, :] = payload_of(self.robot, given).T
        on_flange = transport(ca.DM(self.robot.flange.matrix()))
        for place, effect in enumerate(self.robot.effects):
            if effect.role == "parameters":
                carrier, _ = effect.body(n)
                body = self._form(place, given).coefficients
                link = min(carrier, n) - 1
                added[link, :] += (on_flange @ body if carrier > n else body).T
        return added


def _is_force(effect: Effect) -> bool:
    return effect.role == "force" and effect.acts != "transmission"


def memory_fields(effects: Sequence[Effect]) -> tuple[tuple[Effect, Field], ...]:
    """The effects with internal states, and those states as fields of a block."""
    return tuple(
        (
            effect,
            Field(
                f"{effect.kind}_{effect.joint or 'arm'}_{place}",
                len(effect.states),
                "-",
                f"memory {', '.join(effect.states)} of {effect.kind}",
            ),
        )
        for place, effect in enumerate(effects)
        if effect.states
    )


def payload_fields() -> tuple[Field, ...]:
    """A body on the flange beside what the robot file has there; none by default."""
    zero = (0.0,)
    return (
        Field("payload_mass", 1, "kg", "mass of a body beside the file's tool", zero, zero),
        Field("payload_com", 3, "m", "its centre of mass, in the flange's frame"),
        Field(
            "payload_moments", 3, "kg m2", "its Ixx, Iyy, Izz about its centre, axes of the flange",
            (0.0,) * 3, (0.0,) * 3,
        ),
        Field("payload_products", 3, "kg m2", "its Ixy, Ixz, Iyz about its centre"),
    )  # fmt: skip


def friction_fields(robot: Robot) -> tuple[Field, ...]:
    """The four numbers of eq. 55 of each joint, those of the robot file by default."""
    law = FrictionLaw.of(robot)
    zero = (0.0,) * robot.n

    def field(name: str, unit: str, doc: str, values: object, least: tuple[float, ...]) -> Field:
        numbers = tuple(float(v) for v in values)  # type: ignore[attr-defined]
        return Field(name, robot.n, unit, doc, numbers, lower=least)

    return (
        field("friction_static", "Nm", "F_s of eq. 55", law.static, zero),
        field("friction_coulomb", "Nm", "F_c of eq. 55", law.coulomb, zero),
        field("friction_viscous", "Nm s/rad", "F_v of eq. 55", law.viscous, zero),
        field(
            "friction_stribeck", "rad/s", "omega_st of eq. 55", law.stribeck, (SLOWEST,) * robot.n
        ),
    )


def payload_of(robot: Robot, values: Mapping[str, ca.SX]) -> ca.SX:
    """(m, m c, I_O) of the payload in the last link's frame, shape (10,)."""
    m = values["payload_mass"]
    c = values["payload_com"]
    moments = values["payload_moments"]
    products = values["payload_products"]
    x, y, z = (c[k] for k in range(3))
    own = ca.vertcat(
        moments[0] + m * (y * y + z * z),
        products[0] - m * x * y,
        products[1] - m * x * z,
        moments[1] + m * (x * x + z * z),
        products[2] - m * y * z,
        moments[2] + m * (x * x + y * y),
    )
    return transport(ca.DM(robot.flange.matrix())) @ ca.vertcat(m, m * c, own)


def friction_of(values: Mapping[str, ca.SX]) -> FrictionLaw:
    """The law of the parameters' present values."""
    names = ("static", "coulomb", "viscous", "stribeck")
    return FrictionLaw(*(values[f"friction_{name}"] for name in names))
