"""The CasADi functions (SX) behind the methods of `Model`, by name; for code generation and
optimisation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import casadi as ca

from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import euler_lagrange, geometry, kinematics, newton_euler
from irb2400_ctrl.model.acceleration import Acceleration
from irb2400_ctrl.model.friction import FrictionLaw
from irb2400_ctrl.model.inverse_kinematics import closed_form
from irb2400_ctrl.model.regressor import regressor
from irb2400_ctrl.model.symbolic_arm import SymbolicArm


def function(name: str, inputs: dict[str, ca.SX], outputs: dict[str, ca.SX]) -> ca.Function:
    """One CasADi function with shared subexpressions computed once, its outputs dense.

    Args:
        name: of the CasADi function.
        inputs: symbols by name, in the order of the arguments.
        outputs: expressions by name, in the order of the results.
    """
    shared = ca.cse([ca.densify(expression) for expression in outputs.values()])
    return ca.Function(name, list(inputs.values()), shared, list(inputs), list(outputs))


def inverse_dynamics(
    arm: SymbolicArm, name: str, with_friction: bool = True, with_wrench: bool = False
) -> ca.Function:
    """(q, qd, qdd, [wrench], time) -> tau.

    Args:
        arm: parameters, signals and effects.
        name: of the CasADi function.
        with_friction: whether friction is part of the torque.
        with_wrench: whether force [N] and moment [Nm] at the tool are one more input, shape (6,).
    """
    s = arm.signals()
    wrench = ca.SX.sym("wrench", 6)
    inputs = {"q": s.q, "qd": s.qd, "qdd": s.qdd}
    tau = s.load + arm.effect_torque(s)
    if with_friction:
        tau += FrictionLaw.of(arm.robot).torque(s.qd)
    if with_wrench:
        tau -= s.tcp_jacobian.T @ wrench
        inputs["wrench"] = wrench
    return function(name, {**inputs, "time": s.time}, {"tau": tau})


def inverse_dynamics_carried(arm: SymbolicArm, name: str) -> ca.Function:
    """(q, qd, qdd, base_acceleration, time) -> tau of an arm on a carriage that accelerates."""
    base = ca.SX.sym("base_acceleration", 3)
    s = replace(arm.signals(), carried=base)
    tau = s.load + arm.effect_torque(s) + FrictionLaw.of(arm.robot).torque(s.qd)
    inputs = {"q": s.q, "qd": s.qd, "qdd": s.qdd, "base_acceleration": base, "time": s.time}
    return function(name, inputs, {"tau": tau})


def forward_dynamics(
    arm: SymbolicArm, name: str, with_friction: bool = True, with_wrench: bool = False
) -> ca.Function:
    """(q, qd, tau, [wrench], time) -> qdd.

    Args:
        arm: parameters, signals and effects.
        name: of the CasADi function.
        with_friction: whether friction acts.
        with_wrench: whether force [N] and moment [Nm] at the tool are one more input, shape (6,).
    """
    s = arm.signals()
    tau = ca.SX.sym("tau", arm.robot.n)
    wrench = ca.SX.sym("wrench", 6)
    inputs = {"q": s.q, "qd": s.qd, "tau": tau}
    driving = tau
    if with_wrench:
        driving = tau + s.tcp_jacobian.T @ wrench
        inputs["wrench"] = wrench
    qdd = Acceleration.of(arm, s, driving, with_friction).qdd
    return function(name, {**inputs, "time": s.time}, {"qdd": qdd})


def forward_dynamics_derivatives(
    arm: SymbolicArm, name: str, with_friction: bool = True
) -> ca.Function:
    """(q, qd, tau, time) -> (qdd, dqdd_dq, dqdd_dqd, dqdd_dtau).

    Args:
        arm: parameters, signals and effects.
        name: of the CasADi function.
        with_friction: whether friction acts.
    """
    s = arm.signals()
    tau = ca.SX.sym("tau", arm.robot.n)
    solution = Acceleration.of(arm, s, tau, with_friction)
    return function(
        name, {"q": s.q, "qd": s.qd, "tau": tau, "time": s.time}, solution.derivatives()
    )


def mass_matrix(arm: SymbolicArm, name: str) -> ca.Function:
    """q -> M, with the inertia of the effects at rest."""
    s = arm.signals()
    zero = ca.SX.zeros(arm.robot.n)
    slope = ca.substitute(
        ca.jacobian(arm.effect_torque(s), s.qdd), ca.vertcat(s.qd, s.qdd), ca.vertcat(zero, zero)
    )
    return function(name, {"q": s.q}, {"M": s.mass_matrix + ca.substitute(slope, s.time, 0)})


def gravity(arm: SymbolicArm, name: str) -> ca.Function:
    """q -> G, effects at rest included."""
    s = arm.signals()
    zero = ca.SX.zeros(arm.robot.n)
    tau = ca.substitute(
        arm.effect_torque(s), ca.vertcat(s.qd, s.qdd, s.time), ca.vertcat(zero, zero, 0)
    )
    tau += newton_euler.inverse_dynamics(arm.robot, s.q, zero, zero, arm.phi)
    return function(name, {"q": s.q}, {"G": tau})


def external_torque(arm: SymbolicArm, name: str) -> ca.Function:
    """(q, wrench) -> J^T wrench."""
    s = arm.signals()
    wrench = ca.SX.sym("wrench", 6)
    return function(name, {"q": s.q, "wrench": wrench}, {"tau_ext": s.tcp_jacobian.T @ wrench})


def coriolis(arm: SymbolicArm, name: str) -> ca.Function:
    """(q, qd) -> C."""
    s = arm.signals()
    return function(
        name, {"q": s.q, "qd": s.qd}, {"C": euler_lagrange.coriolis(arm.robot, s.q, s.qd)}
    )


def torque_regressor(arm: SymbolicArm, name: str, base: bool = False) -> ca.Function:
    """(q, qd, qdd) -> Y, in all inertial parameters or in the base parameters.

    Args:
        arm: parameters, signals and effects.
        name: of the CasADi function.
        base: in base parameters, which a motion can tell apart, instead of all.
    """
    s = arm.signals()
    Y = regressor(arm.robot, s.q, s.qd, s.qdd)
    if base:
        Y = Y[:, list(arm.base_parameters.kept)]
    return function(name, {"q": s.q, "qd": s.qd, "qdd": s.qdd}, {"Y": Y})


def body_torque(arm: SymbolicArm, name: str) -> ca.Function:
    """(q, qd, qdd, phi) -> Y phi, for any bodies."""
    s = arm.signals()
    phi = ca.SX.sym("phi", 10 * arm.robot.n)
    tau = ca.mtimes(regressor(arm.robot, s.q, s.qd, s.qdd), phi)
    return function(name, {"q": s.q, "qd": s.qd, "qdd": s.qdd, "phi": phi}, {"tau": tau})


def friction_torque(arm: SymbolicArm, name: str) -> ca.Function:
    """qd -> F."""
    qd = ca.SX.sym("qd", arm.robot.n)
    return function(name, {"qd": qd}, {"F": FrictionLaw.of(arm.robot).torque(qd)})


def of_q(
    name: str, arm: SymbolicArm, output: str, expression: Callable[[ca.SX], ca.SX]
) -> ca.Function:
    """q -> a kinematic quantity.

    Args:
        name: of the CasADi function.
        arm: whose angles are the input [rad], shape (n,).
        output: name of the result.
        expression: from the angles to it.
    """
    q = ca.SX.sym("q", arm.robot.n)
    return function(name, {"q": q}, {output: expression(q)})


def _exact_geometry(arm: SymbolicArm) -> geometry.ArmGeometry:
    found = arm.arm_geometry
    if not found.exact:
        raise InputError(
            f"{arm.robot.name}: its axes only come near those of a {found.family} arm "
            "(calibrated?), so a closed form would miss the pose; use Model.inverse_kinematics, "
            "which ends with Newton's method on the arm itself"
        )
    return found


FUNCTIONS: dict[str, Callable[[SymbolicArm], ca.Function]] = {
    "inverse_dynamics": lambda m: inverse_dynamics(m, "inverse_dynamics"),
    "inverse_dynamics_without_friction": lambda m: inverse_dynamics(
        m, "inverse_dynamics", with_friction=False
    ),
    "inverse_dynamics_with_wrench": lambda m: inverse_dynamics(
        m, "inverse_dynamics", with_wrench=True
    ),
    "forward_dynamics": lambda m: forward_dynamics(m, "forward_dynamics"),
    "forward_dynamics_without_friction": lambda m: forward_dynamics(
        m, "forward_dynamics", with_friction=False
    ),
    "forward_dynamics_with_wrench": lambda m: forward_dynamics(
        m, "forward_dynamics", with_wrench=True
    ),
    "forward_dynamics_derivatives": lambda m: forward_dynamics_derivatives(
        m, "forward_dynamics_derivatives"
    ),
    "forward_dynamics_derivatives_without_friction": lambda m: forward_dynamics_derivatives(
        m, "forward_dynamics_derivatives", with_friction=False
    ),
    "inverse_dynamics_carried": lambda m: inverse_dynamics_carried(m, "inverse_dynamics_carried"),
    "mass_matrix": lambda m: mass_matrix(m, "mass_matrix"),
    "gravity": lambda m: gravity(m, "gravity"),
    "external_torque": lambda m: external_torque(m, "external_torque"),
    "coriolis": lambda m: coriolis(m, "coriolis"),
    "regressor": lambda m: torque_regressor(m, "regressor"),
    "base_regressor": lambda m: torque_regressor(m, "base_regressor", base=True),
    "body_torque": lambda m: body_torque(m, "body_torque"),
    "friction": lambda m: friction_torque(m, "friction"),
    "tcp_pose": lambda m: of_q("tcp_pose", m, "X_BT", lambda q: kinematics.tcp_pose(m.robot, q)),
    "flange_pose": lambda m: of_q(
        "flange_pose", m, "X_BF", lambda q: kinematics.flange_pose(m.robot, q)
    ),
    "tcp_jacobian": lambda m: of_q(
        "tcp_jacobian", m, "J", lambda q: kinematics.tcp_jacobian(m.robot, q)
    ),
    "inverse_kinematics": lambda m: closed_form(_exact_geometry(m)),
    "singularity_factors": lambda m: of_q(
        "singularity_factors",
        m,
        "factors",
        lambda q: ca.vertcat(*geometry.singularity_factors(m.arm_geometry, q)),
    ),
}
