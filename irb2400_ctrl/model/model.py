"""`Model`: the equations of one robot, effects included, for numbers and for symbols."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any, TypeVar, cast

import casadi as ca
import numpy as np
import numpy.typing as npt

from irb2400_ctrl.effects.added_body import AddedBody
from irb2400_ctrl.errors import InputError, UnreachableError
from irb2400_ctrl.model import euler_lagrange, geometry, kinematics, mass_matrix, newton_euler
from irb2400_ctrl.model import friction as friction_law
from irb2400_ctrl.model import inverse_kinematics as closed_form
from irb2400_ctrl.model.regressor import regressor, transport
from irb2400_ctrl.model.signals import ArmSignals
from irb2400_ctrl.robot import Robot

Array = npt.NDArray[np.float64]
# numpy in, numpy out; SX or MX in, the same out
Value = TypeVar("Value", npt.NDArray[np.float64], ca.SX, ca.MX)


class Model:
    """Kinematics and dynamics of one robot.

    Every method takes numpy arrays of shape (n,), or (m, n) for m states at once, and returns the same kind; given
    CasADi SX or MX columns it returns an expression. Angles in rad, torques in Nm on the actuators.
    """

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self._built: dict[str, ca.Function] = {}

    # ---- dynamics

    def inverse_dynamics(self, q: Value, qd: Value, qdd: Value, *, friction: bool = True, time: float = 0.0) -> Value:
        """tau = M qdd + C qd + G + F + effects (eq. 56) [Nm].

        `friction=False` leaves the friction of eq. 55 out. Effects with memory stand in their steady state.
        """
        name = "inverse_dynamics" if friction else "inverse_dynamics_without_friction"
        return self._call(name, q, qd, qdd, constants=(time,))

    def forward_dynamics(self, q: Value, qd: Value, tau: Value, *, friction: bool = True, time: float = 0.0) -> Value:
        """qdd with tau = inverse_dynamics(q, qd, qdd) [rad/s2] (eq. 56)."""
        name = "forward_dynamics" if friction else "forward_dynamics_without_friction"
        return self._call(name, q, qd, tau, constants=(time,))

    def mass_matrix(self, q: Value) -> Value:
        """M(q), inertia of the effects included (eq. 50), shape (n, n) [kg m2]."""
        return self._call("mass_matrix", q, matrix=True)

    def coriolis(self, q: Value, qd: Value) -> Value:
        """C(q, qd) of the rigid arm from the Christoffel symbols (eq. 51), shape (n, n); Mdot - 2C is skew."""
        return self._call("coriolis", q, qd, matrix=True)

    def gravity(self, q: Value) -> Value:
        """G(q), the torque that holds the arm at rest without friction, effects included (eq. 52) [Nm]."""
        return self._call("gravity", q)

    def friction(self, qd: Value) -> Value:
        """F(qd) of eq. 55 [Nm]."""
        return self._call("friction", qd)

    def regressor(self, q: Value, qd: Value, qdd: Value) -> Value:
        """Y with tau_rigid = Y phi, phi the (m, mc, I_O) of all links, shape (n, 10 n)."""
        return self._call("regressor", q, qd, qdd, matrix=True)

    def external_torque(self, q: Value, wrench: Value) -> Value:
        """tau_ext = J^T (F, N): generalised force of a wrench on the tool at the TCP, base frame [N, Nm] -> [Nm].

        It helps the actuators: M qdd + ... = tau + tau_ext.
        """
        return self._call("external_torque", q, wrench)

    # ---- kinematics

    def tcp_pose(self, q: Value) -> Value:
        """X_BT, the TCP in the base (eqs. 14-26), shape (4, 4)."""
        return self._call("tcp_pose", q, matrix=True)

    def flange_pose(self, q: Value) -> Value:
        """X_BF, the flange (tool 0) in the base (eq. 13), shape (4, 4)."""
        return self._call("flange_pose", q, matrix=True)

    def tcp_jacobian(self, q: Value) -> Value:
        """J of the TCP (eq. 33), rows linear then angular, base frame, shape (6, n)."""
        return self._call("tcp_jacobian", q, matrix=True)

    def singularity_factors(self, q: Value) -> Value:
        """(wrist, shoulder, elbow) = (sin q5, r, k) with det J = -a2 sin q5 r k (eqs. 34-36), shape (3,) [-, m, m]."""
        return self._call("singularity_factors", q)

    def inverse_kinematics(self, X_BT: Array, seed: Array | None = None) -> Array:
        """All actuator angles inside the joint box that reach the pose, shape (branches, 6) [rad].

        Whole turns of axes 4 and 6 that fit into the box are solutions of their own. With `seed` (6,) the nearest
        (largest joint difference smallest) comes first, and it decides an angle that a singularity leaves free.

        Raises:
            InputError: not a pose, or the arm is not of this family.
            UnreachableError: no branch reaches the pose inside the joint box; says by how much.
        """
        X = np.asarray(X_BT, dtype=float)
        if X.shape != (4, 4) or not np.isfinite(X).all():
            raise InputError(f"inverse kinematics: found an array of shape {X.shape}, expected a finite (4, 4) pose")
        if np.abs(X[:3, :3] @ X[:3, :3].T - np.eye(3)).max() > 1e-6 or np.linalg.det(X[:3, :3]) < 0:
            raise InputError("inverse kinematics: the upper left (3, 3) block of the pose is not a rotation")
        branches = self.inverse_kinematics_branches(X[None], seed)
        q = closed_form.windings(branches.q[0], self.robot.q_min, self.robot.q_max)
        if len(q) == 0:
            raise UnreachableError(self._why_unreachable(branches))
        if seed is not None:
            q = q[np.argsort(np.abs(q - np.asarray(seed, dtype=float)).max(axis=1), kind="stable")]
        return q

    def inverse_kinematics_branches(self, X_BT: Array, seed: Array | None = None) -> closed_form.Branches:
        """The eight geometric branches of m poses (m, 4, 4), joint box not regarded, no whole turns."""
        X_TF = np.linalg.inv(self.robot.X_FT)
        return closed_form.solve(self.arm_geometry, np.asarray(X_BT, dtype=float) @ X_TF, seed)

    @cached_property
    def arm_geometry(self) -> geometry.ArmGeometry:
        """Constants of Tab. 2; raises InputError for an arm of another family."""
        return geometry.arm_geometry(self.robot)

    def _why_unreachable(self, branches: closed_form.Branches) -> str:
        q = branches.q[0]
        if not np.isfinite(q).any():
            return f"the wrist centre is {1e3 * branches.overreach[0].min():.1f} mm out of reach of the arm"
        low, high = self.robot.q_min, self.robot.q_max
        excess = np.maximum(np.maximum(low - q, q - high), 0.0)
        worst = excess.max(axis=1)
        best = int(np.nanargmin(worst))
        limits = np.degrees([low, high])
        axis = int(np.argmax(excess[best]))
        return (
            f"no branch inside the joint box: the nearest needs axis {axis + 1} at "
            f"{np.degrees(q[best, axis]):.1f} deg, range {limits[0, axis]:.0f} to {limits[1, axis]:.0f} deg"
        )

    # ---- symbolic core

    def function(self, name: str) -> ca.Function:
        """The CasADi function (SX) behind a method, built once; for code generation and optimisation."""
        if name not in self._built:
            if name not in _BUILDERS:
                raise InputError(f"no model function {name!r}, expected one of {', '.join(sorted(_BUILDERS))}")
            self._built[name] = _BUILDERS[name](self)
        return self._built[name]

    @cached_property
    def phi(self) -> ca.DM:
        """Inertial parameters of the links with tool and parameter effects folded in, shape (n, 10)."""
        phi = self.robot.inertial_parameters.copy()
        n = self.robot.n
        for effect in self.robot.effects:
            if isinstance(effect, AddedBody):
                carrier, added = effect.carrier(n), np.array(effect.coefficients())
                if carrier == n + 1:
                    carrier, added = n, np.asarray(transport(ca.DM(self.robot.flange.matrix()))) @ added
                phi[carrier - 1] += added
        return ca.DM(phi)

    def signals(self) -> ArmSignals:
        """Fresh symbols of the arm's state and what follows from them: the language effects are written in."""
        return ArmSignals.symbols(self.robot, self.phi)

    def effect_torque(self, s: ArmSignals) -> ca.SX:
        """Sum of the force effects, memory in its steady state, shape (n,) [Nm]."""
        tau = ca.SX.zeros(self.robot.n)
        for effect in self.robot.effects:
            # parameter effects are folded into phi; the measuring chain does not load the actuators
            if effect.acts == "force":
                tau += effect.torque(s.with_state(effect.steady_state(s)))
        # derivatives of the acceleration are not inputs of the dynamics: elasticity is a state of the simulated plant
        zero = ca.SX.zeros(self.robot.n)
        return ca.substitute(tau, ca.vertcat(s.qddd, s.qdddd), ca.vertcat(zero, zero))

    def _inverse_dynamics(self, with_friction: bool) -> ca.Function:
        s = self.signals()
        tau = s.load + self.effect_torque(s)
        if with_friction:
            tau += friction_law.friction(self.robot, s.qd)
        return self._function("inverse_dynamics", [s.q, s.qd, s.qdd, s.time], tau, ["q", "qd", "qdd", "time"], "tau")

    def _forward_dynamics(self, with_friction: bool) -> ca.Function:
        """Solve for qdd with M; effects that bend the law (load friction) cost further Newton steps."""
        n = self.robot.n
        s, tau = self.signals(), ca.SX.sym("tau", n)
        zero = ca.SX.zeros(n)
        effects = self.effect_torque(s)
        rest = newton_euler.inverse_dynamics(self.robot, s.q, s.qd, zero, self.phi)
        if with_friction:
            rest += friction_law.friction(self.robot, s.qd)
        M = mass_matrix.mass_matrix(self.robot, s.q, self.phi)
        slope = ca.jacobian(effects, s.qdd)
        if slope.nnz() == 0:
            qdd = mass_matrix.solve_ldl(M, tau - rest - effects)
        else:
            bent = any(ca.which_depends(effects, s.qdd, 2))
            qdd = zero
            for _ in range(4 if bent else 1):
                residual = tau - rest - M @ qdd - ca.substitute(effects, s.qdd, qdd)
                total = M + ca.substitute(slope, s.qdd, qdd)
                # the slope of a load-dependent law is not symmetric: a general solve
                step = ca.solve(total, residual) if bent else mass_matrix.solve_ldl(total, residual)
                qdd = qdd + step
        return self._function("forward_dynamics", [s.q, s.qd, tau, s.time], qdd, ["q", "qd", "tau", "time"], "qdd")

    def _mass_matrix(self) -> ca.Function:
        s = self.signals()
        zero = ca.SX.zeros(self.robot.n)
        slope = ca.substitute(
            ca.jacobian(self.effect_torque(s), s.qdd), ca.vertcat(s.qd, s.qdd), ca.vertcat(zero, zero)
        )
        return self._function("mass_matrix", [s.q], s.mass_matrix + ca.substitute(slope, s.time, 0), ["q"], "M")

    def _gravity(self) -> ca.Function:
        s = self.signals()
        zero = ca.SX.zeros(self.robot.n)
        tau = ca.substitute(self.effect_torque(s), ca.vertcat(s.qd, s.qdd, s.time), ca.vertcat(zero, zero, 0))
        tau += newton_euler.inverse_dynamics(self.robot, s.q, zero, zero, self.phi)
        return self._function("gravity", [s.q], tau, ["q"], "G")

    def _friction(self) -> ca.Function:
        qd = ca.SX.sym("qd", self.robot.n)
        return self._function("friction", [qd], friction_law.friction(self.robot, qd), ["qd"], "F")

    def _external_torque(self) -> ca.Function:
        s, wrench = self.signals(), ca.SX.sym("wrench", 6)
        return self._function("external_torque", [s.q, wrench], s.tcp_jacobian.T @ wrench, ["q", "wrench"], "tau_ext")

    def _of_q(self, name: str, expression: Callable[[ca.SX], ca.SX], output: str) -> ca.Function:
        q = ca.SX.sym("q", self.robot.n)
        return self._function(name, [q], expression(q), ["q"], output)

    def _of_motion(
        self, name: str, build: Callable[[ArmSignals], tuple[list[ca.SX], ca.SX]], output: str
    ) -> ca.Function:
        inputs, expression = build(self.signals())
        return self._function(name, inputs, expression, ["q", "qd", "qdd"][: len(inputs)], output)

    @staticmethod
    def _function(name: str, inputs: list[ca.SX], expression: ca.SX, names: list[str], output: str) -> ca.Function:
        return ca.Function(name, inputs, [ca.densify(ca.cse(expression))], names, [output])

    # ---- numbers and symbols through one door

    def _call(self, name: str, *inputs: Value, constants: tuple[float, ...] = (), matrix: bool = False) -> Value:
        function = self.function(name)
        if any(isinstance(value, ca.SX | ca.MX) for value in inputs):
            symbolic: Any = function(*inputs, *constants)
            return cast(Value, symbolic)
        arrays = [np.asarray(value, dtype=float) for value in inputs]
        many = max(array.ndim for array in arrays) == 2
        count = max((len(array) for array in arrays if array.ndim == 2), default=1)
        columns = []
        for position, array in enumerate(arrays):
            width = function.size1_in(position)
            if array.shape not in {(width,), (count, width)}:
                expected = f"({width},) or ({count if many else 'm'}, {width})"
                raise InputError(f"{name}, argument {position + 1}: found shape {array.shape}, expected {expected}")
            columns.append(np.broadcast_to(array, (count, width)).T)
        columns += [np.full((1, count), value) for value in constants]
        rows, width = function.size1_out(0), function.size2_out(0)
        # a function called with m columns is mapped over them by CasADi, without a Python loop
        flat = np.asarray(function(*[ca.DM(column) for column in columns]))
        result: Any = flat.reshape(rows, count, width).transpose(1, 0, 2) if matrix else flat.T
        numbers: Any = np.ascontiguousarray(result if many else result[0])
        return cast(Value, numbers)


_BUILDERS: dict[str, Callable[[Model], ca.Function]] = {
    "inverse_dynamics": lambda m: m._inverse_dynamics(True),
    "inverse_dynamics_without_friction": lambda m: m._inverse_dynamics(False),
    "forward_dynamics": lambda m: m._forward_dynamics(True),
    "forward_dynamics_without_friction": lambda m: m._forward_dynamics(False),
    "mass_matrix": lambda m: m._mass_matrix(),
    "gravity": lambda m: m._gravity(),
    "external_torque": lambda m: m._external_torque(),
    "coriolis": lambda m: m._of_motion(
        "coriolis", lambda s: ([s.q, s.qd], euler_lagrange.coriolis(m.robot, s.q, s.qd)), "C"
    ),
    "regressor": lambda m: m._of_motion(
        "regressor", lambda s: ([s.q, s.qd, s.qdd], regressor(m.robot, s.q, s.qd, s.qdd)), "Y"
    ),
    "friction": lambda m: m._friction(),
    "tcp_pose": lambda m: m._of_q("tcp_pose", lambda q: kinematics.tcp_pose(m.robot, q), "X_BT"),
    "flange_pose": lambda m: m._of_q("flange_pose", lambda q: kinematics.flange_pose(m.robot, q), "X_BF"),
    "tcp_jacobian": lambda m: m._of_q("tcp_jacobian", lambda q: kinematics.tcp_jacobian(m.robot, q), "J"),
    "singularity_factors": lambda m: m._of_q(
        "singularity_factors", lambda q: ca.vertcat(*geometry.singularity_factors(m.arm_geometry, q)), "factors"
    ),
}
