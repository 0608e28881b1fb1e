"""The acceleration that given torques cause, and its derivatives (forward dynamics, eq. 56 solved
for qdd)."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import linear_solve, newton_euler
from irb2400_ctrl.model.friction import FrictionLaw
from irb2400_ctrl.model.signals import ArmSignals
from irb2400_ctrl.model.symbolic_arm import SymbolicArm

NEWTON_STEPS = 4
"""for effects that bend the law in the acceleration (load friction); from a start of zero four
reach rounding"""


@dataclass(frozen=True)
class Acceleration:
    """qdd with tau = inverse dynamics(q, qd, qdd)."""

    signals: ArmSignals
    required: ca.SX
    """inverse dynamics as an expression in the signals, shape (n,) [Nm]"""
    slope: ca.SX
    """d required / d qdd at the solution, shape (n, n)"""
    symmetric: bool
    qdd: ca.SX

    @classmethod
    def of(cls, arm: SymbolicArm, s: ArmSignals, tau: ca.SX, with_friction: bool) -> Acceleration:
        """M qdd = tau - rest: the mass matrix by composite bodies, the rest by one recursion at qdd
        = 0.

        Raises:
            InputError: an axis without any inertia about itself; its acceleration is not
            determined.
        """
        zero = ca.SX.zeros(arm.robot.n)
        effects = arm.effect_torque(s)
        rest = newton_euler.inverse_dynamics(arm.robot, s.q, s.qd, zero, arm.phi)
        dry = FrictionLaw.of(arm.robot).torque(s.qd) if with_friction else zero
        slope = s.mass_matrix + ca.jacobian(effects, s.qdd)
        for i in range(arm.robot.n):
            if slope[i, i].is_zero():
                raise InputError(
                    f"forward dynamics: axis {i + 1} has no inertia about itself, so no torque "
                    "determines its "
                    "acceleration; give link or tool an inertia, or the robot a rotor_inertia "
                    "effect on that axis"
                )
        bent = any(ca.which_depends(effects, s.qdd, 2))
        # the slope of a load-dependent law is not symmetric
        symmetric = not bent
        qdd = zero
        for _ in range(NEWTON_STEPS if bent else 1):
            residual = tau - rest - dry - s.mass_matrix @ qdd - ca.substitute(effects, s.qdd, qdd)
            qdd = qdd + _solve(ca.substitute(slope, s.qdd, qdd), residual, symmetric)
        return cls(s, s.load + dry + effects, ca.substitute(slope, s.qdd, qdd), symmetric, qdd)

    def derivatives(self) -> dict[str, ca.SX]:
        """By the implicit function theorem: dqdd/dx = -slope^-1 d required/dx, dqdd/dtau =
        slope^-1.

        Half as many operations as differentiating the solve.
        """
        s = self.signals
        n = self.qdd.numel()
        mobility = _solve(self.slope, ca.SX.eye(n), self.symmetric)
        rows = [
            ca.jtimes(self.required, ca.vertcat(s.q, s.qd), unit, True).T
            for unit in ca.horzsplit(ca.DM.eye(n))
        ]
        by_state = -mobility @ ca.substitute(ca.vertcat(*rows), s.qdd, self.qdd)
        return {
            "qdd": self.qdd,
            "dqdd_dq": by_state[:, :n],
            "dqdd_dqd": by_state[:, n:],
            "dqdd_dtau": mobility,
        }


def _solve(A: ca.SX, b: ca.SX, symmetric: bool) -> ca.SX:
    return linear_solve.solve_ldl(A, b) if symmetric else ca.solve(A, b)
