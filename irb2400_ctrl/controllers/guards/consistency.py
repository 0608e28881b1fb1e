"""Whether motion and torque agree, or an encoder lies: what a momentum observer leaves must lie
within what a load and a friction that nobody told can do at this pose and this speed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca
import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.codegen import Field
from irb2400_ctrl.controllers.guards.sample_check import all_of
from irb2400_ctrl.controllers.momentum import (
    Momentum,
    followed,
    observer_bandwidth,
    observer_states,
    observer_told,
)
from irb2400_ctrl.controllers.parts import Values, gain, strongest
from irb2400_ctrl.controllers.scaling import largest_inertia
from irb2400_ctrl.model import kinematics

LOAD_AT = 0.15
"""[m] from the flange along its axis: where a load that nobody told is taken to be"""
UNKNOWN_LOAD = 12.5
"""[kg] at that place: what may hang there and nobody told"""
UNKNOWN_FRICTION = 0.45
"""share of friction by which it may differ from the model's"""
STILL = 0.04
"""[rad/s] below which a joint may be sticking: its friction then is anything up to static"""
RESTART = (0.0012, 0.011)
"""[s] times torque limit and static friction: momentum that a speed still wrong after an angle was,
from a drive that forms speeds from angles, may seem to have as the observers begin"""
SPEED_LAG = 0.00076
"""[s] by which a speed is late that a drive forms from angles (half a millisecond) and filters at
250 Hz: a torque that changes by 50 limits a second is 4 % of its limit ahead of what it shows"""
SPEED_STEP = 0.0035
"""[rad/s] by which a speed is off that a drive forms a thousand times a second from angles of 5e-6
rad: momentum that comes and goes with each sample"""
STATIC = 0.1
"""share of static friction in the limits of both bands"""


@dataclass(frozen=True)
class Band:
    """An observer of its own bandwidth.

    Args:
        suffix: of the names of its states and parameters.
        bandwidth: [rad/s].
        share: of the torque limit that is left unexplained beside load and friction.
    """

    suffix: str
    bandwidth: float
    share: float


# a jump of the speed shows in the first within 10 ms; the second is quieter and shows what stays
BANDS = (Band("", 100.0, 0.035), Band("_slow", 10.0, 0.015))


@dataclass(frozen=True)
class Consistency:
    """The test of the guard, once for each band.

        -d - [-m A]+  <=  r  <=  d + [m A]+,    A = J^T (g - a),    d = limit + doubt

    r: what the observer leaves; m: load nobody told, a its acceleration, J its Jacobian; [x]+: x
    where it is positive, else 0. doubt: u (F_c + F_v |qd|) + (1 + u) F_s stick(qd), low-passed as
    r is; stick falls from 1 at rest within `STILL`, u is the share of friction that is not known.
    As the observers begin, doubt is K times what `RESTART` says, and fades as r does.

    Args:
        core: momentum and its rate, with a memory of its own: a controller that knows no effect has
            none.
        sample_time: [s].
    """

    core: Momentum
    sample_time: float

    @property
    def states(self) -> tuple[Field, ...]:
        """What both observers remember."""
        n = self.core.arm.robot.n
        explained, running = observer_states(n)
        fields = [running, Field("tau_seen", n, "Nm", "torque as late as the speed shows it")]
        for band in BANDS:
            fields += [
                replace(explained, name=f"explained{band.suffix}"),
                Field(
                    f"load_speed{band.suffix}", 3, "m/s", "speed of the flange's load, low-passed"
                ),
                Field(f"doubt{band.suffix}", n, "Nm", "friction that is not known, low-passed"),
            ]
        return (*fields, *self.core.states)

    @property
    def parameters(self) -> tuple[Field, ...]:
        """What can be tuned without new code."""
        robot = self.core.arm.robot
        doc = "load at the flange that nobody told, at most"
        u = "share of friction that is not known"
        late = "by how much the measured speed is late"
        fields = [
            Field("unknown_load", 1, "kg", doc, (UNKNOWN_LOAD,), lower=(0.0,)),
            gain(robot, "unknown_friction", "-", u, UNKNOWN_FRICTION),
            Field("speed_lag", 1, "s", late, (SPEED_LAG,), lower=(0.0,)),
        ]
        for band in BANDS:
            steps = band.bandwidth * SPEED_STEP * largest_inertia(robot)
            limit = np.maximum(band.share * self._strongest, steps)
            limit = limit + STATIC * robot.friction[:, 0]
            end = band.suffix
            doc = "largest torque that is not explained"
            fields += [
                observer_bandwidth(robot, f"observer{end}", band.bandwidth, self.sample_time),
                gain(robot, f"unexplained_limit{end}", "Nm", doc, limit),
            ]
        return tuple(fields)

    @property
    def told(self) -> tuple[Field, ...]:
        """Steps of the fast observer, by name."""
        return observer_told(self.core.arm.robot.n)

    def judged(self, v: Values, q: ca.SX, qd: ca.SX) -> tuple[ca.SX, Values]:
        """1 where motion and torque agree; by name the next states and what is told.

        Args:
            v: present values by name; `tau_last` is the torque that acts in the coming period.
            q, qd: angles and speeds that are believed [rad, rad/s], shape (n,).
        """
        T = self.sample_time
        p, beta, remembered = self.core.of(v, q, qd)
        J = self._load_jacobian(q)
        speed = J @ qd
        doubt = self._doubt(v, qd)
        gravity = ca.DM(self.core.arm.robot.gravity)
        tau = self._seen(v)
        after: Values = {"running": ca.SX(1), "p": p, "beta": beta, "tau_seen": tau}
        after |= remembered
        conditions = []
        for band in BANDS:
            of = {name: f"{name}{band.suffix}" for name in ("explained", "load_speed", "doubt")}
            K = v[f"observer{band.suffix}"]
            now = {"explained": p, "load_speed": speed, "doubt": K * self._restart}
            # at the first sample nothing has been observed yet: the present counts as explained
            old = {name: ca.if_else(v["running"] > 0, v[of[name]], now[name]) for name in of}
            left, explained = followed(K, p, old["explained"], tau + beta, T)
            # the load is one body: its acceleration is low-passed with the first joint's bandwidth
            a, load_speed = followed(K[0], speed, old["load_speed"], ca.SX.zeros(3), T)
            load = v["unknown_load"] * (J.T @ (gravity - a))
            most = v[f"unexplained_limit{band.suffix}"] + old["doubt"]
            conditions += ca.vertsplit(left - ca.fmax(load, 0) <= most)
            conditions += ca.vertsplit(ca.fmin(load, 0) - left <= most)
            after |= {
                of["explained"]: explained,
                of["load_speed"]: load_speed,
                of["doubt"]: old["doubt"] + T * K * (doubt - old["doubt"]),
            }
            after.setdefault("unexplained", left)
        return all_of(conditions), after

    @property
    def _strongest(self) -> Array:
        """Torque limits [Nm], shape (n,)."""
        return strongest(self.core.arm.robot)

    @property
    def _restart(self) -> ca.DM:
        """Momentum that is in doubt as the observers begin [kg m2/s], shape (n,)."""
        by_torque, by_friction = RESTART
        static = self.core.arm.robot.friction[:, 0]
        return ca.DM(by_torque * self._strongest + by_friction * static)

    def _seen(self, v: Values) -> ca.SX:
        """The torque that acts, as late as the speed [Nm], shape (n,)."""
        last = ca.if_else(v["running"] > 0, v["tau_seen"], v["tau_last"])
        share = self.sample_time / (self.sample_time + v["speed_lag"])
        return ca.SX(last + share * (v["tau_last"] - last))

    def _doubt(self, v: Values, qd: ca.SX) -> ca.SX:
        """Friction that may differ from the model's [Nm], shape (n,)."""
        law = self.core.arm.friction(v)
        u = v["unknown_friction"]
        stick = 1 / (1 + (qd / STILL) ** 2) ** 2
        moving = law.viscous * ca.fabs(qd) + law.coulomb
        return ca.SX(u * moving + (1 + u) * law.static * stick)

    @cached_property
    def _load_jacobian(self) -> ca.Function:
        """q -> J of the load's place in the base frame, shape (3, n)."""
        robot = self.core.arm.robot
        q = ca.SX.sym("q", robot.n)
        place = kinematics.flange_pose(robot, q) @ ca.DM([0, 0, LOAD_AT, 1])
        return ca.Function("load_jacobian", [q], [ca.cse(ca.jacobian(place[:3], q))])
