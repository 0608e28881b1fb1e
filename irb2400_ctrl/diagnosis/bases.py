"""Numbers of the effects' symbolic bases along a motion, all samples and all nonlinear parameters at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np
import numpy.typing as npt

from irb2400_ctrl.diagnosis.motion import Motion
from irb2400_ctrl.diagnosis.vectorised import Vectorised
from irb2400_ctrl.effects import LIBRARY, Effect
from irb2400_ctrl.model import Model
from irb2400_ctrl.model.signals import ArmSignals
from irb2400_ctrl.robot import Robot

Array = npt.NDArray[np.float64]

CHUNK = 4_000_000
"""numbers per array while a grid is evaluated: bounds the memory"""


@dataclass(frozen=True)
class Columns:
    """Torque per unit of coefficient: values (m, len(joints), k) on the zero-based joints; zero on all others."""

    joints: tuple[int, ...]
    values: Array

    def torque(self, coefficients: Array, n: int) -> Array:
        """values @ coefficients on all n joints, shape (m, n)."""
        tau = np.zeros((len(self.values), n))
        tau[:, list(self.joints)] = self.values @ coefficients
        return tau


def inputs_of(motion: Motion) -> list[Array]:
    """The 5 n + 1 scalars effects may depend on, each (m,): q, qd, qdd, qddd, qdddd, time."""
    parts = (motion.q, motion.qd, motion.qdd, motion.qddd, motion.qdddd)
    return [np.ascontiguousarray(part[:, j]) for part in parts for j in range(motion.n)] + [motion.time]


class Bases:
    """Evaluates effects of one robot; builds each expression once."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.model = Model(robot)
        self._laws: dict[tuple[str, int | None, bool, tuple[str, ...]], _Law] = {}

    @cached_property
    def signals(self) -> ArmSignals:
        return self.model.signals()

    def columns(
        self,
        kind: str,
        joint: int | None,
        motion: Motion,
        grid: Sequence[dict[str, float]] = ({},),
        *,
        departures: bool = False,
        filtered: bool = True,
    ) -> list[Columns]:
        """The basis of one effect along the motion, one entry per set of nonlinear parameters.

        Args:
            departures: the columns of `Effect.departures` instead of the basis.
            filtered: through the motion's common filter (rows), or sample by sample.
        """
        keys = tuple(grid[0])
        name = (kind, joint, departures, keys)
        if name not in self._laws:
            self._laws[name] = _Law(self.signals, LIBRARY[kind], joint, departures, keys)
        return self._laws[name](motion, [tuple(entry[key] for key in keys) for entry in grid], filtered)


class _Law:
    """One effect on one joint as a function of the scalars it depends on."""

    def __init__(
        self, s: ArmSignals, effect: type[Effect], joint: int | None, departures: bool, keys: tuple[str, ...]
    ) -> None:
        theta = [ca.SX.sym(key) for key in keys]
        prototype = effect.prototype(joint, dict(zip(keys, theta, strict=True)))  # type: ignore[arg-type]
        state = ca.SX.sym("x", len(effect.states))
        s = s.with_state(state)
        basis = prototype.departures(s) if departures else prototype.basis(s)
        # departures live on the joints of the law, so that both can stand side by side
        rows = sorted(set(prototype.basis(s).sparsity().row()))
        self.joints, self.k = tuple(rows), basis.shape[1]
        flat = ca.vertcat(*[ca.densify(basis[row, :]).T for row in rows]) if rows and self.k else ca.SX(0, 1)
        scalars = [*ca.vertsplit(ca.vertcat(s.q, s.qd, s.qdd, s.qddd, s.qdddd, s.time))]
        self.law = Vectorised([*scalars, *ca.vertsplit(state), *theta], flat)
        self.states = len(effect.states)
        if self.states:
            self.rate = _exponential_step([*scalars], state, theta, prototype.state_rate(s))

    def __call__(self, motion: Motion, grid: list[tuple[float, ...]], filtered: bool) -> list[Columns]:
        m = len(motion.time)
        inputs = inputs_of(motion)
        count = motion.rows if filtered else m
        values = np.empty((len(grid), count, len(self.joints), self.k))
        if values.size == 0:
            return [Columns(self.joints, v) for v in values]
        chunk = max(1, CHUNK // m)
        for start in range(0, len(grid), chunk):
            piece = grid[start : start + chunk]
            part = np.array(piece, dtype=float).reshape(len(piece), len(grid[0]))
            theta = [part[:, i : i + 1] for i in range(part.shape[1])]
            states = self._states(inputs, motion.step, theta, len(part)) if self.states else []
            for place, flat in enumerate(self.law(*inputs, *states, *theta)):
                i, c = divmod(place, self.k)
                whole = np.broadcast_to(flat, (len(part), m)).T
                values[start : start + len(part), :, i, c] = (motion.filtered(whole) if filtered else whole).T
        return [Columns(self.joints, v) for v in values]

    def _states(self, inputs: list[Array], step: float, theta: list[Array], count: int) -> list[Array]:
        """States of all grid points, each (count, m), from zero."""
        decay, gain = self.rate(inputs, theta, step)
        m = len(inputs[0])
        found = []
        for a, b in zip(decay, gain, strict=True):
            a, b = np.broadcast_to(a, (count, m)).T, np.broadcast_to(b, (count, m)).T
            x = np.zeros((m, count))
            for k in range(1, m):
                x[k] = a[k] * x[k - 1] + b[k]
            found.append(x.T)
        return found


class _exponential_step:
    """x+ = exp(a h) x + (exp(a h) - 1) / a * b for states with dx/dt = a x + b: exact for constant a, b over a step."""

    def __init__(self, scalars: list[ca.SX], state: ca.SX, theta: list[ca.SX], rate: ca.SX) -> None:
        a = ca.diag(ca.jacobian(rate, state))
        b = ca.substitute(rate, state, ca.SX.zeros(state.numel()))
        self._evaluate = Vectorised([*scalars, *theta], ca.vertcat(a, b))
        self._n = state.numel()

    def __call__(self, inputs: list[Array], theta: list[Array], step: float) -> tuple[list[Array], list[Array]]:
        """Factors of x and additions per sample, for every state."""
        values = self._evaluate(*inputs, *theta)
        decay, gain = [], []
        for a, b in zip(values[: self._n], values[self._n :], strict=True):
            factor = np.exp(np.minimum(a * step, 0.0))
            small = np.abs(a * step) < 1e-9
            growth = np.where(small, step, (factor - 1.0) / np.where(small, 1.0, a))
            decay.append(factor)
            gain.append(growth * b)
        return decay, gain


__all__ = ["Bases", "Columns", "inputs_of"]
