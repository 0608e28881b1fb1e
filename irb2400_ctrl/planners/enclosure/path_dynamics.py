"""The arm's torque along a path: tau = a(s) u + b(s) x + e(s) sqrt(x) + c(s) with x = sdot^2, u =
sddot.

With q = q(s), qd = q' sqrt(x), qdd = q'' x + q' u the rigid-body torque and every effect that is at
most quadratic in the speeds and linear in the accelerations have this form exactly (a = M q', b = M
q'' + C(q, q') q', c = G). The dry friction of eq. 55 stands apart, because its sign and Stribeck
curve need their own treatment; so do effects of other forms (`effect_forms`, `effect_bounds`).

A path may move further axes that carry the part (`cell/external_axes.py`). Their columns follow
those of the arm; for them "torque" is the acceleration e'' x + e' u [rad/s2], which has a limit as
the arm's torque has. Where the first of them is a rail, the arm stands on a base that accelerates
by d (e'' x + e' u): for the arm, which turns in no other way, gravity less that.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import casadi as ca
import numpy as np

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.cell.external_axes import axis_names
from irb2400_ctrl.codegen import CompiledFunction, compile_function
from irb2400_ctrl.effects import Effect
from irb2400_ctrl.model import Model
from irb2400_ctrl.model.friction import FrictionLaw
from irb2400_ctrl.model.numeric import evaluate
from irb2400_ctrl.planners.enclosure.complex_disc import disc_function
from irb2400_ctrl.planners.enclosure.effect_forms import (
    Forms,
    expand,
    regular_parts,
    with_sign,
)
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.typed import typed

Way = tuple[float, float, float]
"""where the base of the arm goes per metre of the first further axis"""

OUTPUTS = ("a", "b", "e", "c_minus", "c_zero", "c_plus")


@dataclass(frozen=True, eq=False)
class PathDynamics:
    """Coefficients of one robot's torque along paths, as machine code."""

    model: Model
    external: int = 0
    """number of axes beside the arm"""
    carriage: Way | None = None
    """where the first of them is a rail that carries the arm"""

    @property
    def _moved(self) -> int:
        """Columns that the arm's torque depends on."""
        return self.model.robot.n + (self.carriage is not None)

    @property
    def lengths(self) -> tuple[int, ...]:
        """Columns that are lengths, not angles."""
        return () if self.carriage is None else (self.model.robot.n,)

    @property
    def n(self) -> int:
        """Columns of a path: joints of the arm, then further axes."""
        return self.model.robot.n + self.external

    def axis(self, j: int) -> str:
        """What column j of a path is called in messages."""
        n = self.model.robot.n
        if j < n:
            return f"axis {j + 1}"
        return f"external axis {axis_names(self.external, len(self.lengths))[j - n]}"

    @cached_property
    def friction(self) -> Array:
        """Table of eq. 54, shape (n, 4); further axes have none."""
        own = self.model.robot.friction
        none = np.tile([0.0, 0.0, 0.0, 1.0], (self.external, 1))
        return np.vstack([own, none])

    @cached_property
    def forms(self) -> Forms:
        """The robot's effects, sorted by how they are bounded."""
        return Forms.of(self.model)

    @property
    def irregular(self) -> tuple[Effect, ...]:
        """Effects without a bound: their torque is sampled, and nothing is guaranteed."""
        return self.forms.open

    @property
    def needs_load(self) -> bool:
        """Whether a law depends on the load of a transmission."""
        return any(law.of == "load" for law in self.forms.laws)

    @cached_property
    def _built(self) -> tuple[ca.Function, Array, Array]:
        return coefficient_function(self.model, self.forms.regular, self.needs_load, self.carriage)

    @property
    def symbolic(self) -> ca.Function:
        """(q, q', q'') -> a, b, e and c for motion backwards, at rest, forwards; then what
        `effect_bounds` needs."""
        return self._built[0]

    @property
    def factors(self) -> tuple[Array, Array]:
        """Bounds of the effects' factors of the time, over all times."""
        return self._built[1:]

    @property
    def local(self) -> bool:
        """Whether what is needed at a place does not depend on the way to it, or on the time."""
        return not (self.forms.laws or self.factors[0].size)

    @cached_property
    def _compiled(self) -> CompiledFunction:
        return compile_function(self.symbolic, fused=True)

    @cached_property
    def _discs(self) -> CompiledFunction:
        return compile_function(disc_function(self.symbolic), fused=True)

    def coefficients(self, q: Array, dq: Array, ddq: Array) -> tuple[Array, ...]:
        """The outputs of `symbolic` at m points, each (m, n)."""
        n = self._moved
        found = self._compiled.map(*(v[:, :n] for v in (q, dq, ddq)))
        return self._with_external(found, dq, ddq)

    def radii(
        self, q: Array, dq: Array, ddq: Array, r: Array, dr: Array, ddr: Array
    ) -> tuple[Array, ...]:
        """By how much the coefficients differ at most from those at (q, q', q'') within complex
        discs, each (m, n)."""
        n = self._moved
        found = self._discs.map(*(v[:, :n] for v in (q, dq, ddq, r, dr, ddr)))
        return self._with_external(found, dr, ddr)

    def _with_external(
        self, found: tuple[Array, ...], first: Array, second: Array
    ) -> tuple[Array, ...]:
        """Outputs with the columns of further axes: a is the first derivative, b the second one,
        the rest is zero."""
        if not self.external:
            return found
        own = {"a": first[:, -self.external :], "b": second[:, -self.external :]}
        nothing = np.zeros_like(own["a"])
        names = self.symbolic.name_out()
        return tuple(
            np.hstack([f, own.get(name, nothing)]) for name, f in zip(names, found, strict=True)
        )

    @cached_property
    def _irregular_torque(self) -> ca.Function:
        base = ca.SX.sym("base", 3)
        s = replace(self.model.signals(), carried=base)
        tau = ca.SX.zeros(self.model.robot.n)
        for effect in self.irregular:
            tau += effect.torque(s.with_state(effect.steady_state(s)))
        zero = ca.SX.zeros(2 * self.model.robot.n)
        tau = ca.substitute(tau, ca.vertcat(s.qddd, s.qdddd), zero)
        return ca.Function("irregular", [s.q, s.qd, s.qdd, base, s.time], [ca.densify(tau)])

    def torque(self, q: Array, qd: Array, qdd: Array, time: Array) -> Array:
        """The model's torque at the times (m,) of a motion that starts at time zero, shape (m, n)
        [Nm]; of further axes the acceleration [rad/s2, m/s2 of a rail]."""
        n = self.model.robot.n
        columns = [v[:, :n] for v in (q, qd, qdd)]
        name = "inverse_dynamics"
        if self.carriage is not None:
            columns.append(self._base_acceleration(qdd))
            name = "inverse_dynamics_carried"
        tau = evaluate(self.model.function(name), *columns, time[:, None])
        return np.hstack([tau, qdd[:, n:]]) if self.external else tau

    def _base_acceleration(self, qdd: Array) -> Array:
        """Of the arm's base, shape (m, 3) [m/s2]."""
        if self.carriage is None:
            return np.zeros((len(qdd), 3))
        return np.outer(qdd[:, self.model.robot.n], self.carriage)

    def irregular_torque(self, q: Array, qd: Array, qdd: Array, time: Array) -> Array:
        """Torque of the irregular effects, shape (m, n) [Nm]."""
        if not self.irregular:
            return np.zeros_like(q)
        n = self.model.robot.n
        columns = [v[:, :n] for v in (q, qd, qdd)]
        columns += [self._base_acceleration(qdd), time[:, None]]
        tau = evaluate(self._irregular_torque, *columns)
        return np.hstack([tau, np.zeros_like(q[:, n:])])


@typed
@lru_cache(maxsize=8)
def path_dynamics(robot: Robot, external: int = 0, carriage: Way | None = None) -> PathDynamics:
    """The coefficients of a robot, and of further axes, built once.

    Args:
        robot: whose dynamics they are.
        external: number of further axes, behind the joints.
        carriage: where the base goes per metre of the first of them, shape (3,), if it carries it.
    """
    return PathDynamics(Model(robot), external, carriage)


def coefficient_function(
    model: Model,
    effects: tuple[Effect, ...],
    with_load: bool = False,
    carriage: Way | None = None,
) -> tuple[ca.Function, Array, Array]:
    """The coefficients as an SX function of (q, q', q''), and the bounds of the effects' factors of
    the time; with a carriage its place follows the angles.

    Outputs: a, b, e, c_minus, c_zero, c_plus of the arm with its effects; the same six for every
    factor of the time; and with the load a_load, b_load, c_load of the rigid-body torque.
    """
    n = model.robot.n
    s = with_sign(model, carriage is not None)
    tau = s.load
    timed = list[ca.SX]()
    low = list[Array]()
    high = list[Array]()
    for effect in effects:
        parts = regular_parts(model, effect.torque(s.with_state(effect.steady_state(s))), s)
        tau += parts[0][0]
        timed += parts[0][1:]
        low.append(parts[1])
        high.append(parts[2])
    moved = n if carriage is None else n + 1
    q, dq, ddq = (ca.SX.sym(name, moved) for name in ("q", "dq", "ddq"))
    way = ca.DM.zeros(3) if carriage is None else ca.DM(carriage)
    along = (dq[:n], ddq[:n], (way * dq[-1], way * ddq[-1]))
    arm = expand(tau, s, *along)
    arm[2] += ca.DM(FrictionLaw.of(model.robot).viscous) * dq[:n]
    names = list(OUTPUTS)
    outputs = arm
    for k, part in enumerate(timed):
        names += [f"{name}_{k}" for name in OUTPUTS]
        outputs += expand(part, s, *along)
    if with_load:
        names += ["a_load", "b_load", "c_load"]
        load = expand(s.load, s, *along)
        outputs += [load[0], load[1], load[4]]
    outputs = ca.substitute(outputs, [s.q], [q[:n]])
    shared = ca.Function("coefficients", [q, dq, ddq], outputs, ["q", "dq", "ddq"], names)
    together = ca.cse(ca.vertcat(*shared.call([q, dq, ddq], True, False)))
    parts_ = ca.vertsplit(together, n)
    function = ca.Function("coefficients", [q, dq, ddq], parts_, ["q", "dq", "ddq"], names)
    return function, np.concatenate([*low, np.empty(0)]), np.concatenate([*high, np.empty(0)])
