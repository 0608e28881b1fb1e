"""The symbolic signals that effects are written in, computed from the rigid-body model."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca

from irb2400_ctrl.model import kinematics, mass_matrix, newton_euler
from irb2400_ctrl.model.friction import FrictionLaw
from irb2400_ctrl.model.regressor import regressor, transport
from irb2400_ctrl.robot import Robot


@dataclass(frozen=True)
class ArmSignals:
    """State of the arm, and on demand what follows from it (implements `effects.Signals`).

    `phi` are the link parameters with the parameter effects folded in, shape (n, 10).
    """

    robot: Robot
    phi: ca.DM | ca.SX
    q: ca.SX
    qd: ca.SX
    qdd: ca.SX
    time: ca.SX
    sign: ca.SX
    state: ca.SX
    qddd: ca.SX
    qdddd: ca.SX
    added: ca.SX | None = None
    """(m, mc, I_O) of a body more on each link, in its frame, shape (n, 10)"""
    carried: ca.SX | None = None
    """acceleration of the base, which turns with nothing, in its own frame [m/s2], shape (3,); None
    where the base stands"""

    @classmethod
    def symbols(cls, robot: Robot, phi: ca.DM | ca.SX) -> ArmSignals:
        """Fresh symbols for everything."""
        q, qd, qdd, qddd, qdddd = (
            ca.SX.sym(name, robot.n) for name in ("q", "qd", "qdd", "qddd", "qdddd")
        )
        return cls(robot, phi, q, qd, qdd, ca.SX.sym("time"), ca.sign(qd), ca.SX(0, 1), qddd, qdddd)

    def with_state(self, state: ca.SX) -> ArmSignals:
        """The same signals for an effect with the given internal state."""
        moved = replace(self, state=state)
        # nothing that follows from the motion depends on the state: what effects with memory ask
        # for is derived once, for all of them
        for name in ("load", "mass_matrix", "tau_jacobian"):
            getattr(self, name)
        known = {
            name: value
            for name, value in self.__dict__.items()
            if name not in self.__dataclass_fields__
        }
        moved.__dict__.update(known)
        return moved

    @property
    def felt_gravity(self) -> ca.DM | ca.SX:
        """Gravity less the acceleration of the base: what stands on it cannot tell them apart,
        shape (3,) [m/s2]."""
        g = ca.DM(self.robot.gravity)
        return g if self.carried is None else g - self.carried

    @cached_property
    def load(self) -> ca.SX:
        """Rigid-body torque, shape (n,) [Nm]."""
        return self.recursion.tau

    @cached_property
    def recursion(self) -> newton_euler.Recursion:
        """`load` with the steps that lead to it."""
        return newton_euler.recursion(
            self.robot, self.q, self.qd, self.qdd, self.phi, self.felt_gravity, self.added
        )

    @cached_property
    def gravity_map(self) -> ca.SX:
        """d tau / d g, shape (n, 3)."""
        g = ca.SX.sym("g", 3)
        zero = ca.SX.zeros(self.robot.n)
        return ca.jacobian(
            newton_euler.inverse_dynamics(self.robot, self.q, zero, zero, self.phi, g, self.added),
            g,
        )

    @cached_property
    def tcp_jacobian(self) -> ca.SX:
        """TCP Jacobian, shape (6, n)."""
        return kinematics.tcp_jacobian(self.robot, self.q)

    @cached_property
    def tool_axes(self) -> ca.SX:
        """Axes of the tool as columns, base frame, shape (3, 3)."""
        return kinematics.tcp_pose(self.robot, self.q)[:3, :3]

    @cached_property
    def whole_regressor(self) -> ca.SX:
        """d tau / d phi of all links, shape (n, 10 n)."""
        return regressor(self.robot, self.q, self.qd, self.qdd, self.felt_gravity)

    def regressor(self, link: int) -> ca.SX:
        """d tau / d phi of link 1…n, or n + 1 for the flange frame, shape (n, 10)."""
        return self.link_columns(self.whole_regressor, link)

    def link_columns(self, whole: ca.SX, link: int) -> ca.SX:
        """What belongs to link 1…n, or n + 1, of the regressor of all links, shape (n, 10)."""
        n = self.robot.n
        if link == n + 1:
            return whole[:, -10:] @ transport(ca.DM(self.robot.flange.matrix()))
        return whole[:, 10 * (link - 1) : 10 * link]

    @cached_property
    def mass_matrix(self) -> ca.SX:
        """M(q), shape (n, n) [kg m2]."""
        return mass_matrix.mass_matrix(self.robot, self.q, self.phi, self.added)

    @cached_property
    def tau(self) -> ca.SX:
        """Rigid-body torque and friction [Nm]; the effects' own part is second order here and left
        out."""
        torque: ca.SX = self.load + FrictionLaw.of(self.robot).torque(self.qd, self.sign)
        return torque

    @cached_property
    def tau_rate(self) -> ca.SX:
        """d tau / dt [Nm/s] along the motion; the jump of dry friction at a reversal is spread over
        about 10 ms."""
        smooth, dry = self._friction_apart
        rate: ca.SX = self._rate(smooth) + dry
        return rate

    @cached_property
    def tau_rates(self) -> ca.SX:
        """`tau_rate` by the motion of one joint alone, one column each, shape (n, n) [Nm/s]."""
        smooth, dry = self._friction_apart
        state = ca.vertcat(self.q, self.qd, self.qdd)
        along = ca.vertcat(ca.diag(self.qd), ca.diag(self.qdd), ca.diag(self.qddd))
        rates: ca.SX = ca.jtimes(smooth, state, along) + ca.diag(dry)
        return rates

    @property
    def _friction_apart(self) -> tuple[ca.SX, ca.SX]:
        """`tau` without dry friction [Nm], and the rate of that [Nm/s]."""
        law = FrictionLaw.of(self.robot)
        return self.load + ca.DM(law.viscous) * self.qd, law.reversal_rate(self.qd, self.qdd)

    @cached_property
    def tau_jacobian(self) -> ca.SX:
        """d tau / d q, shape (n, n) [Nm/rad]."""
        return ca.jacobian(self.load, self.q)

    def _rate(self, signal: ca.SX) -> ca.SX:
        """Time derivative of a function of (q, qd, qdd, qddd) by the chain rule."""
        state = ca.vertcat(self.q, self.qd, self.qdd, self.qddd)
        return ca.jtimes(signal, state, ca.vertcat(self.qd, self.qdd, self.qddd, self.qdddd))
