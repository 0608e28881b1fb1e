"""Numbers of the effects' symbolic bases along a motion, all samples and all nonlinear parameters
at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.diagnosis.regressors.effect_states import Memory
from irb2400_ctrl.diagnosis.regressors.given_signals import DerivedSignals, GivenSignals
from irb2400_ctrl.effects import LIBRARY, Effect
from irb2400_ctrl.effects.base import within
from irb2400_ctrl.effects.checked_basis import basis_of
from irb2400_ctrl.effects.registry import in_library
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.model import Model
from irb2400_ctrl.robot import Robot
from irb2400_ctrl.symbolic.vectorised import Vectorised

CHUNK = 400_000
"""numbers per array while a grid is evaluated: bounds the memory, and each is small enough to be
made of what the last one left (`system.give_back_large_arrays`)"""
REMEMBERED = 40_000
"""the same of effects with memory, of which many arrays are at hand: they stay in the processor's
cache"""


@dataclass(frozen=True)
class RegressorColumns:
    """Torque per unit of coefficient: values (m, len(joints), k) on the zero-based joints; zero on
    all others."""

    joints: tuple[int, ...]
    values: Array

    def torque(self, coefficients: Array, n: int) -> Array:
        """values @ coefficients on all n joints, shape (m, n)."""
        tau = np.zeros((len(self.values), n))
        tau[:, list(self.joints)] = self.values @ coefficients
        return tau

    def part(self, columns: slice) -> RegressorColumns:
        """Some of the columns."""
        return RegressorColumns(self.joints, np.ascontiguousarray(self.values[:, :, columns]))


class Bases:
    """Evaluates effects of one robot; builds each expression once."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.model = Model(robot)
        self._laws: dict[tuple[type[Effect], int | None, bool, tuple[str, ...], bool], _Law] = {}

    @cached_property
    def signals(self) -> DerivedSignals:
        return DerivedSignals(self.model.signals())

    def columns(
        self,
        kind: str,
        joint: int | None,
        motion: PreparedLog,
        grid: Sequence[dict[str, float]] = ({},),
        *,
        discrepancy: bool = False,
        filtered: bool = True,
        windows: Sequence[tuple[float, float]] = (),
    ) -> list[RegressorColumns]:
        """The basis of one effect along the motion, one entry per set of nonlinear parameters.

        Args:
            discrepancy: the columns of `Effect.discrepancy_basis` instead of the basis.
            windows: times between which the effect acts [s]; empty: always.
            filtered: through the motion's common filter (rows), or sample by sample.
        """
        if not grid:
            return []
        law = self._law(kind, joint, discrepancy, tuple(grid[0]))
        return law(
            motion,
            [tuple(entry[key] for key in grid[0]) for entry in grid],
            filtered,
            within(windows, motion.time),
        )

    def of(
        self,
        effect: Effect,
        motion: PreparedLog,
        *,
        discrepancy: bool = False,
        filtered: bool = True,
    ) -> RegressorColumns:
        """`columns` of an effect with its own nonlinear parameters, in its windows.

        Args:
            effect: of the arm; motion: the log, prepared.
            discrepancy, filtered: as of `columns`.
        """
        (found,) = self.columns(
            effect.kind,
            effect.joint,
            motion,
            [effect.nonlinear],
            discrepancy=discrepancy,
            filtered=filtered,
            windows=effect.windows_s,
        )
        return found

    def with_beginnings(
        self,
        kind: str,
        joint: int | None,
        motion: PreparedLog,
        grid: Sequence[dict[str, float]],
        *,
        own: bool = False,
    ) -> tuple[list[RegressorColumns], list[RegressorColumns]]:
        """Filtered columns of basis and discrepancy of an effect with memory, from one pass over
        its states; `own`: on its own joint alone (the first of a whole arm).

        What would take the place of dry friction that the file does not state is left out of the
        basis: that friction is the robot's to find, and the two would share it at will."""
        if not grid:
            return [], []
        law = self._law(kind, joint, True, tuple(grid[0]), own)
        points = [tuple(entry[key] for key in grid[0]) for entry in grid]
        always = within((), motion.time)
        both = law(motion, points, True, always, law_too=True)
        split = law.k + law.free
        basis = [c.part(slice(split, self._end(kind, joint))) for c in both]
        departures = [c.part(slice(split)) for c in both]
        return basis, departures

    def _end(self, kind: str, joint: int | None) -> int | None:
        """Where the columns end that a law has on this robot, counted from the last."""
        instead = len(LIBRARY[kind].prior.in_place_of_friction)
        stated = joint is None or self.robot.friction_stated[joint - 1, 1]
        return None if stated or not instead else -instead

    def _law(
        self,
        kind: str,
        joint: int | None,
        discrepancy: bool,
        keys: tuple[str, ...],
        own: bool = False,
    ) -> _Law:
        """The effect's expression, built once; `own`: on its own joint alone."""
        effect = LIBRARY[kind]
        name = (effect, joint, discrepancy, keys, own)
        if name not in self._laws:
            self._laws[name] = _Law(self.signals, effect, joint, discrepancy, keys, own)
        return self._laws[name]


class _Law:
    """One effect on one joint as a function of the scalars it depends on."""

    def __init__(
        self,
        signals: DerivedSignals,
        effect: type[Effect],
        joint: int | None,
        discrepancy: bool,
        keys: tuple[str, ...],
        own: bool,
    ) -> None:
        theta = [ca.SX.sym(key) for key in keys]
        prototype = effect.prototype(joint, dict(zip(keys, theta, strict=True)))  # type: ignore[arg-type]
        state = ca.SX.sym("x", len(effect.states))
        # the user's own may differentiate a signal: it has to be written out
        s = GivenSignals(signals, state) if in_library(effect) else signals.arm.with_state(state)
        law = basis_of(prototype, s)
        basis = prototype.discrepancy_basis(s) if discrepancy else law
        # it lives on the joints of the law, so that both can stand side by side
        rows = sorted(set(law.sparsity().row()))
        if own:
            rows = [row for row in rows if row == int(joint or 1) - 1]
        self.joints = tuple(rows)
        self.k = basis.shape[1]
        rate = prototype.state_rate(s)
        steady = prototype.steady_state(s)
        self.signals = signals
        self.asked = s.asked if isinstance(s, GivenSignals) else []
        scalars = signals.symbols(self.asked)
        self.memory = Memory(scalars, state, theta, rate, steady) if effect.states else None
        # the record may begin in any state: what a different beginning adds is a departure too
        self.moved = self.memory.beginnings(effect.beginnings()) if self.memory else []
        self.moved = self.moved if discrepancy else []
        self.free = len(self.moved)
        shown = [basis]
        elsewhere: list[ca.SX] = []
        for block in self.moved:
            other = ca.SX(state)
            for i in block:
                other[i] = ca.SX.sym("x")
                elsewhere.append(other[i])
            # of a law of several columns the first stands for the beginning
            shown.append(ca.substitute(law[:, 0], state, other) - law[:, 0])
        shown += [law] if self.free else []
        # in one expression: most of what the law asks for is the same from any beginning
        inputs = [*scalars, *ca.vertsplit(state), *elsewhere, *theta]
        whole = ca.horzcat(*shown)
        self.width = whole.shape[1]
        self.law = Vectorised(inputs, _flat(whole, rows))

    def __call__(
        self,
        motion: PreparedLog,
        grid: list[tuple[float, ...]],
        filtered: bool,
        active: Mask,
        law_too: bool = False,
    ) -> list[RegressorColumns]:
        """`law_too`: the basis after the discrepancy."""
        m = len(motion.time)
        rows = motion.rows if filtered else m
        columns = self.width if law_too else self.k + self.free
        values = np.empty((len(grid), rows, len(self.joints), columns))
        if values.size == 0:
            return [RegressorColumns(self.joints, v) for v in values]
        inputs = [signal[:, None] for signal in self.signals.numbers(self.asked, motion)]
        always = bool(active.all())
        numbers = CHUNK if self.memory is None else REMEMBERED
        chunk = max(1, numbers // m)
        for start in range(0, len(grid), chunk):
            points = grid[start : start + chunk]
            part = np.array(points, dtype=float).reshape(len(points), len(grid[0]))
            place = slice(start, start + len(part))
            for index, flat in enumerate(self._flat_columns(motion, inputs, part)):
                joint, column = divmod(index, self.width)
                if column >= columns:
                    continue
                whole = np.broadcast_to(flat, (m, len(part)))
                whole = whole if always else whole * active[:, None]
                shown = motion.filtered(whole) if filtered else whole
                values[place, :, joint, column] = shown.T
        return [RegressorColumns(self.joints, v) for v in values]

    def _flat_columns(self, motion: PreparedLog, inputs: list[Array], part: Array) -> list[Array]:
        """Numbers over samples and grid points of every column, joint by joint.

        Args:
            part: nonlinear parameters, one row per grid point.
        """
        theta = [part[None, :, i] for i in range(part.shape[1])]
        trajectories = self._state_trajectories(motion, inputs, theta, len(part))
        states = trajectories[0] if trajectories else []
        begun = zip(self.moved, trajectories[1:], strict=True)
        elsewhere = [other[i] for block, other in begun for i in block]
        return self.law(*inputs, *states, *elsewhere, *theta)

    def _state_trajectories(
        self, motion: PreparedLog, inputs: list[Array], theta: list[Array], points: int
    ) -> list[list[Array]]:
        """The states along the motion, then those of other beginnings; none without memory."""
        if self.memory is None:
            return []
        found = []
        for part in motion.parts:  # every log begins anew
            own = [signal[part] for signal in inputs]
            shape = (part.stop - part.start, points)
            found.append(self.memory.states(own, motion.step, theta, shape, self.free))
        if len(found) == 1:
            return found[0]
        return [
            [np.concatenate([log[k][i] for log in found]) for i in range(len(found[0][k]))]
            for k in range(len(found[0]))
        ]


def _flat(basis: ca.SX, rows: list[int]) -> ca.SX:
    """The rows of a basis one after another as a column."""
    return (
        ca.vertcat(*[ca.densify(basis[row, :]).T for row in rows])
        if rows and basis.shape[1]
        else ca.SX(0, 1)
    )
