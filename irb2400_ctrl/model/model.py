"""`Model`: the equations of one robot, effects included, for numbers and for symbols."""

from __future__ import annotations

from functools import cached_property, lru_cache

import casadi as ca
import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.effects import Effect
from irb2400_ctrl.errors import InputError, UnreachableError
from irb2400_ctrl.given import finite, numbers
from irb2400_ctrl.model.branch_solver import BranchSolver, branch_solver
from irb2400_ctrl.model.functions import FUNCTIONS
from irb2400_ctrl.model.inverse_kinematics import Branches
from irb2400_ctrl.model.joint_box import JointBox, check_radians
from irb2400_ctrl.model.numeric import Value, evaluate
from irb2400_ctrl.model.symbolic_arm import SymbolicArm
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.typed import typed


@typed
class Model(SymbolicArm):
    """Kinematics and dynamics of one robot.

    Every method takes numpy arrays of shape (n,), or (m, n) for m states at once, and returns the
    same kind; given CasADi SX or MX columns it returns an expression. Angles in rad, torques in Nm
    on the actuators.
    """

    def __init__(self, robot: Robot) -> None:
        super().__init__(robot)
        self._built = _built_of(robot, tuple(map(type, robot.effects)))

    # ---- dynamics

    def inverse_dynamics(
        self,
        q: Value,
        qd: Value,
        qdd: Value,
        *,
        friction: bool = True,
        time: float = 0.0,
        wrench: Value | None = None,
    ) -> Value:
        """tau = M qdd + C qd + G + F + effects - J^T wrench (eqs. 53, 56) [Nm].

        Args:
            q, qd, qdd: [rad, rad/s, rad/s2], shape (n,) or (m, n).
            friction: False leaves the friction of eq. 55 out.
            time: since the start, for effects that depend on it [s].
            wrench: force and moment of the surroundings on the tool at the TCP, base frame [N, Nm],
                shape (6,) or (m, 6): what a force/torque sensor or a milling tool feels.

        Effects with memory stand in their steady state; load friction sees the arm's own load, not
        the wrench.
        """
        name = "inverse_dynamics" if friction else "inverse_dynamics_without_friction"
        tau = evaluate(self.function(name), q, qd, qdd, constants=(time,))
        return tau if wrench is None else tau - self.external_torque(q, wrench)

    def forward_dynamics(
        self,
        q: Value,
        qd: Value,
        tau: Value,
        *,
        friction: bool = True,
        time: float = 0.0,
        wrench: Value | None = None,
    ) -> Value:
        """qdd with tau = inverse_dynamics(q, qd, qdd) [rad/s2] (eq. 56); arguments as there.

        Args:
            q, qd: [rad], [rad/s]; tau: of the actuators [Nm]; shape (n,) or (m, n).
            friction, time, wrench: as in `inverse_dynamics`.
        """
        name = "forward_dynamics" if friction else "forward_dynamics_without_friction"
        if wrench is not None:
            pushed = self.external_torque(q, wrench)
            # a number alone would be added to every axis
            if isinstance(pushed, np.ndarray) and np.shape(numbers("tau", tau))[-1:] != (
                self.robot.n,
            ):
                raise InputError(
                    f"tau: found shape {np.shape(tau)}, expected ({self.robot.n},) or (m, n)"
                )
            tau = tau + pushed
        return evaluate(self.function(name), q, qd, tau, constants=(time,))

    def mass_matrix(self, q: Value) -> Value:
        """M(q), inertia of the effects included (eq. 50), shape (n, n) [kg m2]."""
        return evaluate(self.function("mass_matrix"), q, matrix=True)

    def coriolis(self, q: Value, qd: Value) -> Value:
        """C(q, qd) of the rigid arm from the Christoffel symbols (eq. 51), shape (n, n); Mdot - 2C
        is skew."""
        return evaluate(self.function("coriolis"), q, qd, matrix=True)

    def gravity(self, q: Value) -> Value:
        """G(q), the torque that holds the arm at rest without friction, effects included (eq. 52)
        [Nm]."""
        return evaluate(self.function("gravity"), q)

    def friction(self, qd: Value) -> Value:
        """F(qd) of eq. 55 [Nm]."""
        return evaluate(self.function("friction"), qd)

    def regressor(self, q: Value, qd: Value, qdd: Value) -> Value:
        """Y with tau_rigid = Y phi, phi the (m, mc, I_O) of all links, shape (n, 10 n).

        Args:
            q, qd, qdd: [rad], [rad/s], [rad/s2], shape (n,) or (m, n).
        """
        return evaluate(self.function("regressor"), q, qd, qdd, matrix=True)

    def body_torque(self, q: Value, qd: Value, qdd: Value, phi: Value) -> Value:
        """Y phi for any bodies phi, shape (10 n,): many times faster than Y itself [Nm].

        Args:
            q, qd, qdd: [rad], [rad/s], [rad/s2], shape (n,) or (m, n).
            phi: (m, mc, I_O) of all links [kg, kg m, kg m2].
        """
        return evaluate(self.function("body_torque"), q, qd, qdd, phi)

    def base_regressor(self, q: Value, qd: Value, qdd: Value) -> Value:
        """Y_b with tau_rigid = Y_b @ base_parameters.values, shape (n, number of base
        parameters).

        Args:
            q, qd, qdd: [rad], [rad/s], [rad/s2], shape (n,) or (m, n).
        """
        return evaluate(self.function("base_regressor"), q, qd, qdd, matrix=True)

    def external_torque(self, q: Value, wrench: Value) -> Value:
        """tau_ext = J^T (F, N): generalised force of a wrench on the tool at the TCP, base frame
        [N, Nm] -> [Nm].

        It helps the actuators: M qdd + ... = tau + tau_ext.
        """
        return evaluate(self.function("external_torque"), q, wrench)

    # ---- kinematics

    def tcp_pose(self, q: Value) -> Value:
        """X_BT, the TCP in the base (eqs. 14-26), shape (4, 4)."""
        return evaluate(self.function("tcp_pose"), q, matrix=True)

    def flange_pose(self, q: Value) -> Value:
        """X_BF, the flange (tool 0) in the base (eq. 13), shape (4, 4)."""
        return evaluate(self.function("flange_pose"), q, matrix=True)

    def tcp_jacobian(self, q: Value) -> Value:
        """J of the TCP (eq. 33), rows linear then angular, base frame, shape (6, n)."""
        return evaluate(self.function("tcp_jacobian"), q, matrix=True)

    def singularity_factors(self, q: Value) -> Value:
        """(wrist, shoulder, elbow) = (sin phi5, r, k) with |det J| = a2 |sin phi5 r k| (eqs.
        34-36), shape (3,) [-, m, m]; phi = q for the IRB 2400 (`ArmGeometry`).

        Raises:
            InputError: an arm of another family; see `smallest_singular_value`.
        """
        return evaluate(self.function("singularity_factors"), q)

    def smallest_singular_value(self, q: Array) -> Array:
        """How far any arm is from a singularity: the smallest singular value of the Jacobian, its
        linear rows over the arm's reach, shape () or (m,) [-]; zero in every singularity."""
        J = np.array(self.tcp_jacobian(numbers("q", q)))
        frames = [link.frame.matrix() for link in self.robot.links]
        reach = sum(float(np.linalg.norm(X[:3, 3])) for X in (*frames, self.robot.flange.matrix()))
        J[..., :3, :] /= max(reach, 1e-9)
        return np.asarray(np.linalg.svd(J, compute_uv=False)[..., -1])

    def inverse_kinematics(self, X_BT: Array, seed: Array | None = None) -> Array:
        """All actuator angles inside the joint box that reach the pose, shape (branches, 6) [rad].

        Closed form for arms with a spherical wrist or three parallel axes, roots of the
        characteristic polynomial for other arms of six axes. Whole turns that fit into the box are
        solutions of their own. With `seed` (6,) the nearest (largest joint difference smallest)
        comes first, and it decides an angle that a singularity leaves free.

        Raises:
            InputError: not a pose, the arm has not six axes, or a seed in degrees.
            UnreachableError: no branch reaches the pose inside the joint box; says by how much.
        """
        X = numbers("pose", X_BT)
        if seed is not None:
            seed = finite("seed", seed, (self.robot.n,), "rad")
            check_radians(self.robot, seed)
        if X.shape != (4, 4):
            raise _no_pose(X)
        q = self._branch_solver.inside(X, seed)
        if len(q) == 0:
            if not np.isfinite(X).all():
                raise _no_pose(X)
            raise UnreachableError(self._why_unreachable(X @ self._X_TF, seed))
        if seed is not None:
            q = q[np.argsort(np.abs(q - seed).max(axis=1), kind="stable")]
        return q

    def inverse_kinematics_branches(self, X_BT: Array, seed: Array | None = None) -> Branches:
        """The geometric branches of m poses (m, 4, 4), joint box not regarded, no whole turns:
        eight in a fixed order from a closed form.

        Raises:
            InputError: no poses.
        """
        X = numbers("poses", X_BT)
        if X.ndim != 3 or X.shape[1:] != (4, 4):
            raise InputError(f"poses: found an array of shape {X.shape}, expected (m, 4, 4)")
        q = None if seed is None else numbers("seed", seed)
        return self._branch_solver.many(X @ self._X_TF, q)

    @cached_property
    def _branch_solver(self) -> BranchSolver:
        return branch_solver(self.robot)

    @cached_property
    def _X_TF(self) -> Array:
        return np.asarray(np.linalg.inv(self.robot.X_FT))

    def _why_unreachable(self, X_BF: Array, seed: Array | None) -> str:
        q, overreach = self._branch_solver.one(X_BF, seed)
        if not np.isfinite(q).any():
            far = float(overreach.min())
            told = f"the wrist centre is {1e3 * far:.1f} mm out of reach of the arm"
            millimetres = "; poses are in metres, this one looks like millimetres"
            return told + millimetres * (far > 100.0)
        low = self.robot.q_min
        high = self.robot.q_max
        excess = np.maximum(np.maximum(low - q, q - high), 0.0)
        worst = excess.max(axis=1)
        best = int(np.nanargmin(worst))
        turned = JointBox(low, high).windings(q)
        if len(turned):
            return self._beyond_coupled_bound(turned)
        limits = np.degrees([low, high])
        axis = int(np.argmax(excess[best]))
        return (
            f"no branch inside the joint box: the nearest needs axis {axis + 1} at "
            f"{np.degrees(q[best, axis]):.1f} deg, range {limits[0, axis]:.0f} to "
            f"{limits[1, axis]:.0f} deg"
        )

    def _beyond_coupled_bound(self, q: Array) -> str:
        difference = np.degrees(q[:, 2] - q[:, 1])
        found = ", ".join(sorted({f"{value:.1f}" for value in difference}))
        low, high = self.robot.coupling.difference_deg or (0.0, 0.0)
        return (
            f"every branch inside the joint box breaks the coupled bound: q3 - q2 is {found} deg, "
            f"range {low:.0f} to {high:.0f} deg"
        )

    # ---- CasADi functions

    @typed
    def function(self, name: str) -> ca.Function:
        """The CasADi function (SX) behind a method, built once; for code generation and
        optimisation."""
        if name not in self._built:
            if name not in FUNCTIONS:
                raise InputError(
                    f"no model function {name!r}, expected one of {', '.join(sorted(FUNCTIONS))}"
                )
            self._built[name] = FUNCTIONS[name](self)
        return self._built[name]


@lru_cache(maxsize=64)
def _built_of(robot: Robot, effects: tuple[type[Effect], ...]) -> dict[str, ca.Function]:
    """Where the models of equal robots keep their functions: building them is most of what a design
    or a simulation waits for. `effects`: a user may have changed the law of a kind."""
    return {}


def _no_pose(X: Array) -> InputError:
    return InputError(
        f"inverse kinematics: found an array of shape {X.shape}, expected a finite (4, 4) pose"
    )
