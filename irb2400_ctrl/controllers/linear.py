"""Arm and controllers, linearised: the same symbolic objects that are simulated and become C, as
`control` systems."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.codegen import Block, Field, compile_block, compile_function
from irb2400_ctrl.controllers.margins import Margins, frequencies, margins, response_of
from irb2400_ctrl.controllers.scaling import typical_inertia
from irb2400_ctrl.controllers.timing import Timing
from irb2400_ctrl.effects.transmission import wound_torque
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.given import finite
from irb2400_ctrl.model import Model
from irb2400_ctrl.model.elasticity import elastic_data, elastic_joints, links_only, twist
from irb2400_ctrl.model.friction import FrictionLaw
from irb2400_ctrl.robot import Robot

SLOW = 0.1
"""[rad/s] at which a friction has its slope whose slope is infinite at rest"""


def linearize(robot: Robot, q: Array, qd: Array | None = None, tau: Array | None = None) -> Any:
    """The arm around a state: u = tau, y = (q, qd) of the actuators, as `control.StateSpace`.

    x = (q, qd), with elastic joints x = (q, l, qd, ld), l their link angles. Dry friction has no
    slope and is left out; viscous friction and effects are in.

    Args:
        q: [rad], shape (n,).
        qd: [rad/s], default at rest. The links of elastic joints hang in their springs and move
            along.
        tau: [Nm], default the torque that gives no acceleration.

    Raises:
        InputError: one of them is not finite or has another shape, or the arm has no slope there.
    """
    import control

    n = robot.n
    soft = list(elastic_joints(robot))
    k = len(soft)
    q = finite("q", q, (n,), "rad")
    qd = np.zeros(n) if qd is None else finite("qd", qd, (n,), "rad/s")
    link, load = hanging(robot, q, qd)
    if tau is None:
        # no acceleration, viscous friction in balance
        tau = load + FrictionLaw.of(robot).viscous * qd
    tau = finite("tau", tau, (n,), "Nm")
    x = ca.SX.sym("x", 2 * (n + k))
    u = ca.SX.sym("u", n)
    rate = arm_rate(robot, x, u)
    slopes = ca.Function("slopes", [x, u], [ca.jacobian(rate, x), ca.jacobian(rate, u)])
    at = np.concatenate([q, link[soft], qd, qd[soft]])
    slow = at + SLOW * np.repeat([0.0, 1.0], n + k)
    A, B = _numbers(robot.name, slopes, [at, tau], [slow, tau])
    actuators = [*range(n), *range(n + k, 2 * n + k)]
    C = np.eye(2 * (n + k))[actuators]
    return control.ss(A, B, C, np.zeros((2 * n, n)))


def hanging(robot: Robot, q: Array, qd: Array) -> tuple[Array, Array]:
    """Link angles and torques without friction when nothing accelerates, motors at q, shapes
    (n,).

    Args:
        robot: the arm with its elastic joints.
        q: motor angles [rad], shape (n,).
        qd: motor speeds [rad/s], shape (n,).
    """
    links = Model(links_only(robot))
    soft = list(elastic_joints(robot))
    angles = np.array(q, dtype=float)
    load = links.inverse_dynamics(angles, qd, np.zeros(robot.n), friction=False)
    for _ in range(8 if soft else 0):
        # springs are stiff: a few rounds find the equilibrium
        angles[soft] = q[soft] - twist(load[soft], elastic_data(robot))
        load = links.inverse_dynamics(angles, qd, np.zeros(robot.n), friction=False)
    return angles, load


def arm_rate(robot: Robot, x: ca.SX, tau: ca.SX) -> ca.SX:
    """dx/dt of x = (q, l, qd, ld) without dry friction; l are the links of elastic joints.

    Args:
        robot: the arm with its elastic joints.
        x: state: angles [rad], then speeds [rad/s].
        tau: motor torques [Nm], shape (n,).
    """
    n = robot.n
    soft = list(elastic_joints(robot))
    k = len(soft)
    q, link, qd, link_rate = ca.vertsplit(x, [0, n, n + k, 2 * n + k, 2 * (n + k)])
    stiffness, damping, inertia, gap, bent = (ca.SX(column) for column in elastic_data(robot).T)
    angles = ca.SX(q)
    speeds = ca.SX(qd)
    drive = tau - ca.DM(FrictionLaw.of(robot).viscous) * qd
    # in contact: on which side of its gap a joint stands is decided by the pose, and the slope is
    # the same
    side = 0.5 * gap * ca.sign(q[soft, 0] - link)
    wound = wound_torque(q[soft, 0] - link - side, stiffness, bent)
    spring = wound + damping * (qd[soft, 0] - link_rate)
    motors = (drive[soft, 0] - spring) / inertia
    angles[soft, 0] = link
    speeds[soft, 0] = link_rate
    drive[soft, 0] = spring
    free = Model(links_only(robot)).function("forward_dynamics_without_friction")
    links = free(angles, speeds, drive, 0)
    actuators = ca.SX(links)
    actuators[soft, 0] = motors
    return ca.vertcat(qd, link_rate, actuators, links[soft, 0])


def viscous_dynamics(model: Model) -> ca.Function:
    """(q, qd, tau) -> qdd with viscous friction but no dry friction."""
    n = model.robot.n
    q, qd, tau = (ca.SX.sym(name, n) for name in ("q", "qd", "tau"))
    viscous = ca.DM(FrictionLaw.of(model.robot).viscous) * qd
    free = model.function("forward_dynamics_without_friction")
    return ca.Function(
        "viscous_dynamics",
        [q, qd, tau],
        [free(q, qd, tau - viscous, 0)],
        ["q", "qd", "tau"],
        ["qdd"],
    )


def linearize_block(block: Block, q: Array) -> Any:
    """A controller at rest at the pose q, reference there too: u = (q, qd), y = -tau, discrete
    `control.StateSpace`.

    The sign makes it the controller of a loop with negative feedback.

    Raises:
        InputError: no controller, or one with guards.
    """
    import control

    values = {f.name: f.start for f in (*block.states, *block.parameters)}
    if "deadband" in values:
        # inside its deadband an integral stands still; outside is where stability matters
        values["deadband"] = np.zeros_like(values["deadband"])
    rest = {f.name: (q if f.name in {"q", "q_ref"} else np.zeros(f.size)) for f in block.inputs}
    flat = block.flat()
    x, u, p = (ca.SX.sym(name, flat.numel_in(i)) for i, name in enumerate("xup"))
    after, y = flat(x, u, p)
    start = np.cumsum([0, *(f.size for f in block.inputs)])
    place = {f.name: slice(a, a + f.size) for f, a in zip(block.inputs, start, strict=False)}
    n = len(q)
    if "fresh" in place:
        raise InputError(
            f"block {block.name!r} has guards, which no linear loop shows; expected the controller "
            "without them: linearise it before `guarded`"
        )
    if "q" not in place or "qd" not in place or block.outputs[0].name != "tau":
        raise InputError(
            f"block {block.name!r} is no controller: expected inputs q, qd and the first output tau"
        )
    matrices = [
        ca.jacobian(after, x),
        _columns(after, u, place),
        ca.jacobian(y[:n], x),
        _columns(y[:n], u, place),
    ]
    slopes = ca.Function("slopes", [x, u, p], matrices)
    slow = rest | {name: np.full(n, SLOW) for name in ("qd", "qd_ref") if name in rest}
    ends = _stack(block.states, values), _stack(block.parameters, values)
    at = [[ends[0], _stack(block.inputs, given), ends[1]] for given in (rest, slow)]
    A, B, C, D = _numbers(block.name, slopes, *at)
    # states that stand still at rest (learned parameters) are constants of the linear loop
    moving = (np.abs(A - np.eye(len(A))).max(axis=1, initial=0.0) > 0) | (
        np.abs(B).max(axis=1, initial=0.0) > 0
    )
    return control.ss(A[np.ix_(moving, moving)], B[moving], -C[:, moving], -D, block.sample_time)


def _numbers(name: str, slopes: ca.Function, at: list[Array], slow: list[Array]) -> list[Array]:
    """Matrices of slopes at rest; in a slow motion where one is infinite at rest.

    Args:
        name: of whose they are.
        slopes: the matrices.
        at: its arguments at rest.
        slow: in a slow motion.

    Raises:
        InputError: they are no numbers there either.
    """
    for arguments in (at, slow):
        found = [np.asarray(ca.densify(m)) for m in slopes.call(arguments)]
        if all(np.isfinite(m).all() for m in found):
            return found
    raise InputError(
        f"{name}: no finite slope at rest, nor in a slow motion; look for a root or a division by "
        "zero in its law or in the robot's effects"
    )


def _columns(expression: ca.SX, u: ca.SX, place: dict[str, slice]) -> ca.SX:
    slope = ca.jacobian(expression, u)
    return ca.horzcat(slope[:, place["q"]], slope[:, place["qd"]])


def _stack(fields: Any, values: dict[str, Array]) -> Array:
    return np.concatenate([np.zeros(0), *(values[f.name] for f in fields)])


@dataclass(frozen=True, eq=False)
class LinearLoop:
    """Controller and arm at one pose, broken at the torque command; sampling, delay and speed
    filter inside."""

    robot: Robot
    block: Block
    q: Array
    timing: Timing

    @cached_property
    def open_loop(self) -> Any:
        """From torque command to the controller's answer (negative feedback), as their product."""
        controller, measured, actuator = self._chain
        return controller * measured * actuator

    @cached_property
    def _chain(self) -> tuple[Any, Any, Any]:
        """Controller, arm with its sensors, and actuators, each a discrete `control.StateSpace`."""
        import control

        n = self.robot.n
        timing = self.timing
        if abs(self.block.sample_time - timing.sample_time) > 1e-12:
            raise InputError(
                f"controller runs at {self.block.sample_time} s, the timing says "
                f"{timing.sample_time} s"
            )
        arm = control.sample_system(linearize(self.robot, self.q), timing.sample_time, method="zoh")
        actuator = control.append(*[control.tf2ss(timing.actuator())] * n)
        ones = [control.ss([], [], [], [[1.0]], timing.sample_time)] * n
        if timing.speed_filter_Hz > 0:
            # the speed is made from the angle, so the arm's own speed is not used
            only_q = control.ss(arm.A, arm.B, arm.C[:n], arm.D[:n], timing.sample_time)
            split = np.vstack([np.eye(n), np.eye(n)])
            sensors = control.append(*ones, *[control.tf2ss(timing.speed())] * n) * split
            measured = sensors * only_q
        else:
            measured = arm
        return linearize_block(self.block, self.q), measured, actuator

    @cached_property
    def poles(self) -> NDArray[np.complex128]:
        """Closed-loop poles in the z plane."""
        import control

        closed = control.feedback(
            self.open_loop, control.ss([], [], [], np.eye(self.robot.n), self.timing.sample_time)
        )
        return np.asarray(closed.poles())

    @property
    def stable(self) -> bool:
        """All closed-loop poles inside the unit circle."""
        return bool(np.abs(self.poles).max() < 1.0)

    @cached_property
    def omega(self) -> Array:
        """Frequencies of the analysis [rad/s]."""
        return frequencies(self.timing.sample_time, 1200)

    @cached_property
    def sensitivity(self) -> NDArray[np.complex128]:
        """S = (1 + L)^-1 at the torque command, in units of the torque limits, where one is
        unknown of what turns each joint at one acceleration, shape (k, n, n)."""
        z = np.exp(1j * self.omega * self.timing.sample_time)
        # part by part: a system of all their states takes ten times as long
        controller, measured, actuator = (response_of(part, z) for part in self._chain)
        unit = self.robot.tau_bound
        if not np.isfinite(unit).all():
            unit = typical_inertia(self.robot)
        scaled = controller @ measured @ actuator * unit / unit[:, None]
        return np.asarray(np.linalg.inv(np.eye(self.robot.n) + scaled))

    @property
    def coupled_peak(self) -> float:
        """Largest singular value of S over all frequencies: the sensitivity peak of the coupled
        loop.

        Torques are measured by their limits, because a singular value needs one unit for all
        joints.
        """
        return float(np.linalg.svd(self.sensitivity, compute_uv=False)[:, 0].max())

    def joint(self, j: int) -> Margins:
        """Margins of joint j (1 …) with the loops of all others closed."""
        return margins(self.omega, 1.0 / self.sensitivity[:, j - 1, j - 1] - 1.0)


def to_control(block: Block) -> Any:
    """Any block (controller, plant, closed loop) as a discrete non-linear
    `control.NonlinearIOSystem`.

    Inputs, outputs and states bear the names of the fields with the number of the element:
    `q_ref[0]` … . Parameters stand at their defaults. It runs in generated C.
    """
    import control

    compiled = compile_block(block)

    def step(x: Array, u: Array) -> tuple[Array, Array]:
        return compiled.step(np.asarray(x, dtype=float), np.asarray(u, dtype=float))

    return control.nlsys(
        lambda t, x, u, params: step(x, u)[0],
        lambda t, x, u, params: step(x, u)[1],
        inputs=_labels(block.inputs),
        outputs=_labels(block.outputs),
        states=_labels(block.states),
        dt=block.sample_time,
        name=block.name,
    )


def arm_to_control(robot: Robot) -> Any:
    """The arm without dry friction as a continuous `control.NonlinearIOSystem`: x = (q, qd) = y, u
    = tau."""
    import control

    n = robot.n
    dynamics = compile_function(viscous_dynamics(Model(robot)))

    def rate(t: float, x: Array, u: Array, params: dict[str, Any]) -> Array:
        return np.concatenate([x[n:], dynamics.call(x[:n], x[n:], u)[0]])

    state = [f"{name}[{j}]" for name in ("q", "qd") for j in range(n)]
    inputs = [f"tau[{j}]" for j in range(n)]
    return control.nlsys(
        rate, None, inputs=inputs, outputs=state, states=state, name=robot.name.replace(" ", "_")
    )


def _labels(fields: tuple[Field, ...]) -> list[str]:
    return [f"{f.name}[{i}]" for f in fields for i in range(f.size)]
