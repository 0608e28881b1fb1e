"""Generalised-momentum observer: the torque that the model cannot explain, without accelerations.

    p = M(q) qd,    dp/dt = tau + beta(q, qd) + tau_ext,    beta = d(qd^T M qd / 2)/dq - G(q) -
    F(qd) - effects
    r = K (p - integral of (tau + beta + r) dt)            =>  r follows tau_ext with the time
    constant 1 / K

(De Luca and Mattone 2003.) tau_ext helps the actuators: a push at the tool shows up as J^T w. Dry
friction is taken in the measured direction, regularised; a joint that stands can hide any torque
below its static friction from it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca
from numpy.typing import ArrayLike

from irb2400_ctrl.codegen import Block, Field
from irb2400_ctrl.controllers.arm_numbers import ArmNumbers, memory_fields
from irb2400_ctrl.controllers.origin import arm_notes, origin_of
from irb2400_ctrl.controllers.parts import (
    Clock,
    Values,
    assemble,
    check_masses,
    gain,
    signals_in,
)
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.model import Model
from irb2400_ctrl.model.linear_solve import factorise
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.typed import typed

SIGN_WIDTH = 0.02
"""speed [rad/s] over which the measured direction is regularised: a few times the noise of the
measured speed"""
DAMPING = 0.03
"""damping d of the Jacobian's inverse, so that a singular pose gives a small wrench and not an
infinite one: of a direction with the singular value s the part s^2 / (s^2 + d^2) is seen. No less,
for single precision: with 1e-3 J J^T + d^2 cost the float code thousands of newtons there"""


@dataclass(frozen=True)
class Momentum:
    """p and beta of an arm, effects included: those with memory remember, along the measured speed;
    those that change with the time know it.

    Args:
        arm: constants of the code, or parameters of the block.
        sample_time: of the block [s].
        prefix: of the names of its states.
    """

    arm: ArmNumbers
    sample_time: float
    prefix: str = ""

    @property
    def states(self) -> tuple[Field, ...]:
        """What the effects have to remember."""
        return (*(self._clock.states if self._uses_time else ()), *self._memories)

    def of(self, values: Values, q: ca.SX, qd: ca.SX) -> tuple[ca.SX, ca.SX, Values]:
        """p, beta, and by name the next values of `states`.

        Args:
            values: present values of the states and of the arm's parameters by name.
            q, qd: angles and speeds [rad, rad/s], shape (n,).
        """
        given = [values[field.name] for field in self.arm.parameters]
        time = self._clock.time(values) if self._uses_time else ca.SX(0)
        memory = [values[field.name] for field in self._memories]
        p, beta, *grown = self._core.call([q, qd, time, *memory, *given], True, False)
        after = dict(zip((field.name for field in self._memories), grown, strict=True))
        return p, beta, after | (self._clock.later(values) if self._uses_time else {})

    @property
    def _clock(self) -> Clock:
        return Clock(self.sample_time, f"{self.prefix}clock")

    @cached_property
    def _memories(self) -> tuple[Field, ...]:
        """The internal states of each effect that has some."""
        fields = memory_fields(self.arm.forces)
        return tuple(replace(field, name=f"{self.prefix}{field.name}") for _, field in fields)

    @cached_property
    def _uses_time(self) -> bool:
        """Whether an effect depends on the time since the start."""
        return any(self._core.jac_sparsity(k, 2).nnz() for k in range(self._core.n_out()))

    @cached_property
    def _core(self) -> ca.Function:
        """(q, qd, time, memories..., parameters...) -> (p, beta, next memories...)."""
        given = {field.name: ca.SX.sym(field.name, field.size) for field in self.arm.parameters}
        s = self.arm.signals(given)
        s = replace(s, sign=s.qd / ca.sqrt(s.qd**2 + SIGN_WIDTH**2))
        zero = ca.SX.zeros(self.arm.robot.n)
        others, old, new = self.arm.loaded(zero, given, s, s.qd, self.sample_time)
        unknown = (s.qdd, s.qddd, s.qdddd)
        added = _without(ca.jacobian(others, s.qdd), s.qd, *unknown)
        others = _without(others, *unknown)
        # shared before it is differentiated
        M = ca.cse(ca.densify(s.mass_matrix + added))
        weight = ca.cse(ca.densify(replace(s, qd=zero, qdd=zero).load))
        kinetic = 0.5 * s.qd.T @ M @ s.qd
        friction = self.arm.friction(given).torque(s.qd, s.sign)
        beta = ca.gradient(kinetic, s.q) - weight - friction - others
        taken = [s.q, s.qd, s.time, *old, *given.values()]
        grown = [_without(x, *unknown) for x in new]
        return ca.Function("momentum", taken, [M @ s.qd, ca.cse(beta), *grown])


def _without(expression: ca.SX, *symbols: ca.SX) -> ca.SX:
    """The expression where these symbols are zero."""
    gone = ca.vertcat(*symbols)
    return ca.substitute(expression, gone, ca.SX.zeros(gone.numel()))


@typed
def momentum_observer(
    robot: Robot, sample_time: float = 0.001, *, bandwidth: float = 60.0
) -> Block:
    """Estimates the external torque, and the wrench at the TCP that would explain it.

    Inputs: `q`, `qd` as measured, `tau` the torque that acts in the coming period. Outputs:
    `tau_ext` (n,) [Nm] and `wrench` (6,): force and moment on the tool in the base frame [N, Nm],
    from J^T wrench = tau_ext (damped).

    Args:
        robot: the arm it knows; sample_time: period [s].
        bandwidth: K [rad/s].
    """
    check_masses(robot)
    n = robot.n
    core = Momentum(ArmNumbers(robot), sample_time)
    jacobian = Model(robot).function("tcp_jacobian")
    inputs = (
        *signals_in(robot)[:2],
        Field("tau", n, "Nm", "torque that acts in the coming period"),
    )
    outputs = (
        Field("tau_ext", n, "Nm", "torque from outside"),
        Field("wrench", 6, "N, Nm", "force and moment on the tool at the TCP, base frame"),
    )

    def law(v: Values) -> Values:
        p, beta, remembered = core.of(v, v["q"], v["qd"])
        tau_ext, after = residual(v, p, beta, sample_time)
        J = jacobian(v["q"])
        wrench = factorise(J @ J.T + DAMPING**2 * ca.SX.eye(6)).solve(J @ tau_ext)
        return {"tau_ext": tau_ext, "wrench": wrench, **after, **remembered}

    block = assemble(
        "momentum_observer",
        "external torque from the generalised momentum",
        sample_time,
        law,
        states=(*observer_states(n), *core.states),
        inputs=inputs,
        outputs=outputs,
        parameters=(observer_bandwidth(robot, "observer", bandwidth, sample_time),),
        told=observer_told(n),
    )
    origin = origin_of(robot, block.name, {"bandwidth": bandwidth})
    return replace(block, origin=origin, notes=arm_notes(robot))


def observer_bandwidth(robot: Robot, name: str, value: ArrayLike, sample_time: float) -> Field:
    """K of each joint as a parameter; the sampled observer loses the factor 1 - K T of its error
    with each sample, so that K is held below 1 / T.

    Args:
        robot: whose joints it is of.
        name: of the parameter.
        value: [rad/s], one number or shape (n,).
        sample_time: T [s].

    Raises:
        InputError: a negative K, or one above 1 / T.
    """
    field = gain(robot, name, "rad/s", "bandwidth of the observer", value)
    most = 1.0 / sample_time
    if max(field.default) > most:
        raise InputError(
            f"the momentum observer has {max(field.default):g} rad/s and a sample every "
            f"{sample_time:g} s; expected at most {most:g} rad/s (from twice that on its estimate "
            "grows without end); sample more often, ask for less, or leave a guard's observers "
            "out (consistency=False; codegen --bare has no guard)"
        )
    return replace(field, upper=(most,) * field.size)


def observer_states(n: int) -> tuple[Field, ...]:
    """What the observer remembers."""
    return (
        Field("explained", n, "kg m2/s", "momentum that the model explains"),
        Field("running", 1, "-", "0 before the first sample, 1 after"),
    )


def residual(v: Values, p: ca.SX, beta: ca.SX, sample_time: float) -> tuple[ca.SX, Values]:
    """The estimate at this sample; by name the observer's next states and what is told.

    Args:
        v: present values by name.
        p, beta: momentum and what changes it beside the torque, shape (n,).
        sample_time: [s].
    """
    # at the first sample nothing has been observed yet: the arm's present momentum counts as
    # explained
    explained = ca.if_else(v["running"] > 0, v["explained"], p)
    tau_ext, after = followed(v["observer"], p, explained, v["tau"] + beta, sample_time)
    return tau_ext, {
        "explained": after,
        "running": ca.SX(1),
        "p": p,
        "beta": beta,
        "unexplained": tau_ext,
    }


def followed(
    bandwidth: ca.SX, now: ca.SX, explained: ca.SX, rate: ca.SX, sample_time: float
) -> tuple[ca.SX, ca.SX]:
    """r = K (now - explained): what changes `now` beside `rate`, low-passed; next `explained`.

    Args:
        bandwidth: K [rad/s], shape (n,) or one.
        now: what is observed, shape (n,); explained: what of it the model explains.
        rate: the model's derivative of it, per second.
        sample_time: [s].
    """
    left = bandwidth * (now - explained)
    return left, explained + sample_time * (rate + left)


def observer_told(n: int) -> tuple[Field, ...]:
    """Steps of the observer, by name."""
    return (
        Field("p", n, "kg m2/s", "generalised momentum M(q) qd"),
        Field("beta", n, "Nm", "what changes it besides the torque"),
        Field("unexplained", n, "Nm", "torque that motion and command do not explain"),
    )
