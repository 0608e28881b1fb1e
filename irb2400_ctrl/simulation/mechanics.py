"""The arm's equations of motion, taken apart the way the time step needs them.

    M(q) qdd + bias(q, qd, t, z) + f = tau + J^T w,      f_j in [lower_j, upper_j] (dry friction,
    set-valued at rest)

Everything that carries the sign of the motion (Coulomb and Stribeck friction of eq. 55, and the
effects that act through it) is dry friction; the rest, viscous friction and the effects' smooth
part included, is bias.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from irb2400_ctrl.effects import Effect
from irb2400_ctrl.effects.form import EffectForm
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model, mass_matrix, newton_euler
from irb2400_ctrl.model.elasticity import links_only
from irb2400_ctrl.model.friction import FrictionLaw
from irb2400_ctrl.model.signals import ArmSignals
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.simulation.dry_friction import Bounds
from irb2400_ctrl.simulation.effect_data import data_of, effect_data, form_of


@dataclass(frozen=True)
class Mechanics:
    """Symbolic mechanics of a robot whose mass, friction and effect data are symbols themselves.

    Args:
        robot: geometry and kinds of effects; its numbers for `phi`, `table` and `data` are not
            used.
        phi: inertial parameters of the links, shape (n, 10).
        table: friction parameters, shape (n, 4).
        data: numbers of the effects (`effect_data`), shape (k,).
    """

    robot: Robot
    phi: ca.SX
    table: ca.SX
    data: ca.SX

    @property
    def law(self) -> FrictionLaw:
        """Friction of eq. 55 with the numbers of `table`."""
        return FrictionLaw.of_table(self.table)

    @property
    def effects(self) -> tuple[Effect, ...]:
        """The effects that act as a force; elasticity is a state of its own, parameter effects are
        in `phi`."""
        return force_effects(self.robot)

    @property
    def memory_size(self) -> int:
        """Number of internal states of the effects."""
        return sum(len(e.states) for e in self.effects)

    def equations(
        self, q: ca.SX, qd: ca.SX, qdd: ca.SX, time: ca.SX, memory: ca.SX
    ) -> tuple[ca.SX, ca.SX, tuple[ca.SX, ca.SX], ca.SX]:
        """M (n, n), bias (n,), the effects' share in upper and lower bound of the dry friction,
        rate of their memory.

        Args:
            qdd: an estimate of the acceleration, for effects that depend on the load: shape (n,)
                [rad/s2].
        """
        n = self.robot.n
        s = ArmSignals.symbols(self.robot, self.phi)
        sign = ca.SX.sym("sign", n)
        z = ca.SX.sym("z", self.memory_size)
        s = replace(s, sign=sign)
        torque, rates = self._effects(s, z)
        torque = self._expand(torque, s, sign)
        zero = ca.SX.zeros(n)
        smooth = ca.substitute(torque, sign, zero)
        slope = ca.jacobian(smooth, s.qdd)
        bent = bool(ca.jacobian(slope, s.qdd).nnz())
        if bent:
            slope = ca.SX(n, n)
        else:
            smooth = ca.substitute(smooth, s.qdd, zero)
        M = mass_matrix.mass_matrix(self.robot, s.q, self.phi) + slope
        bias = newton_euler.inverse_dynamics(self.robot, s.q, s.qd, zero, self.phi) + smooth
        bias += self.law.viscous * s.qd
        share = torque - ca.substitute(torque, sign, zero)
        upper, lower = (ca.substitute(share, sign, d * ca.SX.ones(n)) for d in (1, -1))
        arguments = [s.q, s.qd, s.qdd, s.time, z]
        numbers = [self.phi, self.table, self.data]
        f = ca.Function("mechanics", [*arguments, *numbers], [M, bias, upper, lower, rates])
        M, bias, upper, lower, rate = f.call([q, qd, qdd, time, memory, *numbers], True, False)
        return M, bias, (upper, lower), rate

    def bounds(self, qd: ca.SX, effects: tuple[ca.SX, ca.SX]) -> Bounds:
        """Bounds of the dry friction at the speeds qd, the effects' share given."""
        moving = self.law.level(qd)
        static = self.law.static
        up, low = effects
        limits = (up + moving, low - moving, up + static, low - static)
        return Bounds(
            *(pick(value, 0) for pick, value in zip((ca.fmax, ca.fmin) * 2, limits, strict=True))
        )

    def _effects(self, s: ArmSignals, z: ca.SX) -> tuple[ca.SX, ca.SX]:
        torque = ca.SX.zeros(self.robot.n)
        rates = [ca.SX(0, 1)]
        used = 0
        for form in self._forms():
            own = s.with_state(z[used : used + form.states])
            used += form.states
            torque += form.torque(own)
            rates.append(form.effect.state_rate(own))
        return torque, ca.vertcat(*rates)

    def _forms(self) -> list[EffectForm]:
        ends = np.cumsum([0, *(len(effect_data(e)) for e in self.effects)]).tolist()
        parts = zip(self.effects, ends, ends[1:], strict=False)
        return [form_of(effect, self.data[start:end]) for effect, start, end in parts]

    def balance(self) -> ca.Function:
        """(q, qd, qdd, phi, friction, effects) -> torque of that motion [Nm], memory of the effects
        in steady state."""
        s = ArmSignals.symbols(self.robot, self.phi)
        torque = s.load + self.law.torque(s.qd, s.sign)
        for form in self._forms():
            torque += form.torque(s.with_state(form.effect.steady_state(s)))
        torque = self._expand(torque, s, ca.SX.sym("none", self.robot.n))
        torque = ca.substitute(torque, s.time, 0)
        return ca.Function(
            "balance", [s.q, s.qd, s.qdd, self.phi, self.table, self.data], [ca.densify(torque)]
        )

    def _expand(self, torque: ca.SX, s: ArmSignals, sign: ca.SX) -> ca.SX:
        """Check the form that the friction step relies on: each torque carries its own joint's sign
        only."""
        rows, columns = ca.jacobian_sparsity(torque, sign).get_triplet()
        if any(row != column for row, column in zip(rows, columns, strict=True)):
            raise InputError(
                "an effect puts the sign of one joint's motion into another joint's torque: no "
                "such plant"
            )
        rest = ca.vertcat(s.qddd, s.qdddd)
        return ca.substitute(torque, rest, ca.SX.zeros(rest.numel()))


def symbolic_mechanics(robot: Robot) -> Mechanics:
    """The mechanics with fresh symbols for all numbers."""
    n = robot.n
    k = len(data_of(force_effects(robot)))
    return Mechanics(
        robot, ca.SX.sym("phi", n, 10), ca.SX.sym("friction", n, 4), ca.SX.sym("effects", k)
    )


def force_effects(robot: Robot) -> tuple[Effect, ...]:
    """The effects that act as a force; elasticity is a state of its own, parameter effects are in
    `phi`."""
    return tuple(e for e in links_only(robot).effects if e.role == "force")


def mass_data(robot: Robot) -> ca.DM:
    """Numbers for `phi`, effects on the arm's parameters folded in, shape (n, 10)."""
    return Model(robot).phi
