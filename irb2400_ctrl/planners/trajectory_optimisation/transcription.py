"""`Transcription`: a motion through way-points with free geometry as a sparse nonlinear program.

Between two way-points the time is cut into equal intervals; on each the acceleration is linear in
time, so that q(t) is a cubic spline with unknown knots q_i, qd_i, qdd_i and one unknown interval
length dt_k per segment:

    q_{i+1}  = q_i + dt qd_i + dt^2 (2 qdd_i + qdd_{i+1}) / 6
    qd_{i+1} = qd_i + dt (qdd_i + qdd_{i+1}) / 2

Torque, power and singularity factors are demanded at the knots. What they do between knots is not
checked here: the certified timing takes the geometry afterwards. Joint box and speed limits hold
everywhere (Bernstein coefficients). The derivatives of the dynamics are made once for a single knot
and mapped over all of them, as machine code where there is a compiler; what couples knots is
bilinear and cheap.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from functools import cached_property

import casadi as ca
import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.model import Model
from irb2400_ctrl.model.friction import FrictionLaw
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.trajectory_optimisation.knot_coupling import KnotCoupling, Objective
from irb2400_ctrl.planners.trajectory_optimisation.knots import Knots, Solved
from irb2400_ctrl.planners.trajectory_optimisation.sparse_program import (
    machine_code,
    sparse_program,
)

# width of a change of direction in the smoothed friction, as a part of what a joint can gain in
# speed in one interval of the guess (whose intervals are 1.6 times those of the motion found):
# knots cannot step over static friction
_REVERSAL = 1.25
# but no more than this part of the speed limit
_WIDEST = 0.5
# the same for power, as a part of the speed limit: narrow, because friction that is smoothed away
# costs nothing
_POWER = 0.04


ITERATIONS = 400
"""of the solver, over all programs of one request"""


@dataclass(frozen=True, eq=False)
class Transcription:
    """One problem: build once, solve from any guess."""

    model: Model
    limits: MotionLimits
    waypoints: Array
    """[rad], shape (k + 1, n)"""
    intervals: tuple[int, ...]
    """number of intervals of each of the k segments; even where `paired`"""
    objective: Objective = "time"
    duration: float = np.inf
    """upper bound [s]"""
    margins: tuple[tuple[int, float], ...] = ()
    """(number of the singularity factor, signed bound): sign(b) factor >= |b| with b in the
    factor's unit"""
    torque_rate: Array | None = None
    """limit of the change of torque without dry friction [Nm/s], for each axis, shape (n,), or for
    each interval, too, shape (m, n)"""
    reserve: float = 0.0
    """part of every torque limit left for what happens between knots [-]"""
    compiled: bool = field(default=True)
    """whether the mapped derivatives run as machine code"""

    @property
    def paired(self) -> bool:
        """Whether every second knot only samples, its acceleration the mean of its neighbours'.

        Otherwise energy and torque rate go zigzag between the knots that they are counted at. A
        motion of least duration gains more by the freedom than it loses when it is timed again.
        """
        return self.objective == "energy" or self.torque_rate is not None

    # ---- one knot

    @cached_property
    def _accelerations(self) -> Array:
        """Unit of the acceleration variables: what the torque limit gives to each axis alone
        [rad/s2]."""
        inertia = np.diagonal(self.model.mass_matrix(self.waypoints), axis1=1, axis2=2).max(axis=0)
        return np.asarray(self.limits.tau_max / inertia)

    def _parameters(self, dt: float) -> Array:
        """Width of a change of direction, never below that of the friction itself, and unit of qdd;
        shape (2 n,)."""
        gained = np.minimum(_REVERSAL * self._accelerations * dt, _WIDEST * self.limits.qd_max)
        return np.concatenate(
            [np.maximum(gained, FrictionLaw.of(self.model.robot).stribeck), self._accelerations]
        )

    @cached_property
    def _knot(self) -> ca.Function:
        """(q, qd, qdd in units of the variables; width of a reversal [rad/s], unit of qdd [rad/s2])
        -> rows at a knot.

        What differs from problem to problem is a parameter, so that a robot's machine code serves
        all of them.

        The torque must stay within its limits for either direction that the joint may have within
        about one interval: U(qd) is dry friction at its worst upwards, -U(-qd) downwards.
        """
        robot = self.model.robot
        n = self.model.robot.n
        y = ca.SX.sym("y", 3 * n)
        p = ca.SX.sym("p", 2 * n)
        width = p[:n]
        unit = p[n:]
        q = y[:n]
        qd = y[n : 2 * n] * ca.DM(self.limits.qd_max)
        qdd = y[2 * n :] * unit
        bare = self.model.function("inverse_dynamics_without_friction")(q, qd, qdd, 0)
        law = FrictionLaw.of(robot)
        smooth = bare + ca.DM(law.viscous) * qd
        tau_max = ca.DM(self.limits.tau_max)
        rows = [
            (smooth + law.worst(qd, width)) / tau_max,
            (smooth - law.worst(-qd, width)) / tau_max,
        ]
        if self.objective == "energy":
            speed = ca.DM(self.limits.qd_max)
            rows.append((smooth + law.smoothed(qd, _POWER * speed)) * qd / (tau_max * speed))
        if self.torque_rate is not None:
            rows.append(smooth / tau_max)
        if self.margins:
            factors = self.model.function("singularity_factors")(q)
            rows.append(ca.vertcat(*(np.sign(b) * factors[k] for k, b in self.margins)))
        return ca.Function(
            "knot", [y, p], [ca.cse(ca.densify(ca.vertcat(*rows)))], ["y", "p"], ["rows"]
        )

    @cached_property
    def _knot_derivatives(self) -> ca.Function:
        """(y, parameters, multipliers) -> rows, their Jacobian, upper triangle of the Hessian of
        their weighted sum."""
        y = ca.SX.sym("y", 3 * self.model.robot.n)
        p = ca.SX.sym("p", 2 * self.model.robot.n)
        rows = self._knot(y, p)
        weights = ca.SX.sym("w", rows.numel())
        hessian, _ = ca.hessian(ca.dot(weights, rows), y)
        outputs = ca.cse([rows, ca.jacobian(rows, y), ca.triu(hessian)])
        inputs = [y, p, weights]
        names = ["y", "p", "w"]
        function = ca.Function("knot_d", inputs, outputs, names, ["rows", "jacobian", "hessian"])
        return machine_code(function) if self.compiled else function

    # ---- the program

    @cached_property
    def _sizes(self) -> tuple[int, int, int]:
        """Knots, variables per knot (3 n), variables in all."""
        n = self.model.robot.n
        knots = sum(self.intervals) + 1
        return knots, 3 * n, knots * (3 * n + self._extra) + len(self.intervals)

    @property
    def _extra(self) -> int:
        """Further variables of a knot: power and torque, where they are needed."""
        n = self.model.robot.n
        return n * (self.objective == "energy") + n * (self.torque_rate is not None)

    def _coupling(self, step: Array) -> tuple[ca.Function, Array, Array]:
        """x -> (objective, rows that couple knots), and the bounds of these rows; `step` is the
        unit of dt [s]."""
        return KnotCoupling(
            robot=self.model.robot,
            limits=self.limits,
            accelerations=self._accelerations,
            intervals=self.intervals,
            step=step,
            objective=self.objective,
            duration=self.duration,
            torque_rate=self.torque_rate,
            paired=self.paired,
            extra=self._extra,
        ).function()

    def _knot_rows(self) -> tuple[ca.DM, Array, Array]:
        """Constant matrix C of the rows at all knots, rows(w) + C x, and their bounds."""
        knots, width, size = self._sizes
        n = self.model.robot.n
        count = self._knot.numel_out(0)
        C = ca.DM(count * knots, size)
        low = np.full((knots, count), -np.inf)
        high = np.full((knots, count), np.inf)
        high[:, :n] = 1 - self.reserve
        low[:, n : 2 * n] = -(1 - self.reserve)
        row = 2 * n
        column = 0
        for needed, upper in (
            (self.objective == "energy", 0.0),
            (self.torque_rate is not None, 0.0),
        ):
            if not needed:
                continue
            for i in range(knots):
                for j in range(n):
                    C[i * count + row + j, knots * width + i * self._extra + column + j] = -1
            # power variables lie above the power, torque variables on the torque
            high[:, row : row + n] = upper
            low[:, row : row + n] = -np.inf if column == 0 and self.objective == "energy" else 0.0
            row = row + n
            column = column + n
        for k, (_, bound) in enumerate(self.margins):
            low[:, row + k] = abs(bound)
            # a way-point stays where it is, and a bound that was tightened must not exclude it
            low[np.concatenate([[0], np.cumsum(self.intervals)]), row + k] = -np.inf
        return C, low.ravel(), high.ravel()

    def solve(self, guess: Knots, iterations: int = ITERATIONS) -> Solved:
        """Minimise from a guess whose knots belong to `intervals`; the geometry found goes through
        all way-points."""
        knots, width, size = self._sizes
        n = self.model.robot.n
        at = np.concatenate([[0], np.cumsum(self.intervals)])
        step = np.diff(guess.time[at]) / self.intervals
        coupling, low_c, high_c = self._coupling(step)
        C, low_k, high_k = self._knot_rows()
        parameters = np.tile(self._parameters(guess.time[-1] / (knots - 1)), (knots, 1)).T
        solver = sparse_program(self._knot_derivatives, parameters, coupling, C, size, iterations)
        low, high = self._bounds(at)
        scale = np.concatenate([np.ones(n), self.limits.qd_max, self._accelerations])
        w = np.hstack([guess.q, guess.qd, guess.qdd]) / scale
        extra = []
        if self._extra:
            rows = np.asarray(self._knot.map(knots)(ca.DM(w.T), ca.DM(parameters)))[
                2 * n : 2 * n + self._extra
            ].T
            if self.objective == "energy":
                rows[:, :n] = np.maximum(rows[:, :n], 0.0) + 0.01
            extra = [rows.ravel()]
        x0 = np.concatenate([w.ravel(), *extra, np.ones(len(self.intervals))])
        started = time.perf_counter()
        found = solver(
            x0=x0, lbx=low, ubx=high, lbg=np.append(low_c, low_k), ubg=np.append(high_c, high_k)
        )
        elapsed = time.perf_counter() - started
        statistics = solver.stats()
        x = np.asarray(found["x"]).ravel()
        w = x[: knots * width].reshape(knots, width) * scale
        dt = np.repeat(x[-len(self.intervals) :] * step, self.intervals)
        q = w[:, :n]
        q[at] = self.waypoints
        return Solved(
            Knots(np.concatenate([[0.0], np.cumsum(dt)]), q, w[:, n : 2 * n], w[:, 2 * n :]),
            bool(statistics["success"]),
            str(statistics["return_status"]),
            int(statistics["iter_count"]),
            elapsed,
        )

    def _bounds(self, at: npt.NDArray[np.int64]) -> tuple[Array, Array]:
        """Bounds of all variables: box, speed, rest at the ends, way-points."""
        knots, _, _ = self._sizes
        n = self.model.robot.n
        robot = self.model.robot
        reach = np.where(
            np.isfinite(self.limits.qdd_max), self.limits.qdd_max / self._accelerations, 20.0
        )
        high = np.tile(np.concatenate([robot.q_max, np.ones(n), reach]), (knots, 1))
        low = np.tile(np.concatenate([robot.q_min, -np.ones(n), -reach]), (knots, 1))
        for bound in (low, high):
            bound[at, :n] = self.waypoints
            # rest at both ends; with a limited torque rate the torque starts from what holds the
            # arm
            bound[[0, -1], n : (3 if self.torque_rate is not None else 2) * n] = 0.0
        free = np.full(knots * self._extra, np.inf)
        power = np.tile(np.arange(self._extra) < n * (self.objective == "energy"), knots)
        lowest = np.where(power, 0.0, -np.inf)
        k = len(self.intervals)
        # the interval lengths may change fifty times over
        lower = np.concatenate([low.ravel(), lowest, np.full(k, 0.02)])
        return lower, np.concatenate([high.ravel(), free, np.full(k, 50.0)])
