"""All parameters of the chosen effects at once, with the uncertain base: Gauss-Newton on the exact
prediction."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from operator import is_

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array, Mask
from irb2400_ctrl.diagnosis.estimation.candidate import Candidate
from irb2400_ctrl.diagnosis.estimation.effect_parameters import (
    Parameter,
    alone,
    moved,
    of_changing_strength,
    parameters_of,
    slope_of,
    small_step,
    value_of,
)
from irb2400_ctrl.diagnosis.estimation.evidence import discrepancy_shares, discrepancy_unit
from irb2400_ctrl.diagnosis.estimation.linearised import Linearised
from irb2400_ctrl.diagnosis.estimation.through_chain import MovedBase, shown_of
from irb2400_ctrl.diagnosis.preparation.noise import Noise, NoiseModel
from irb2400_ctrl.diagnosis.preparation.plain_numbers import PlainNumbers
from irb2400_ctrl.diagnosis.regressors.bases import Bases, RegressorColumns
from irb2400_ctrl.diagnosis.regressors.predict import predicted_torque
from irb2400_ctrl.effects import Effect
from irb2400_ctrl.measurement.prepared_log import PreparedLog
from irb2400_ctrl.robot import Robot

ITERATIONS = 5
KEPT_BYTES = 100_000_000
"""of the columns of the last fits, which are kept"""


@dataclass(frozen=True)
class Fit:
    """The chosen explanations fitted together with the uncertain base.

    Args:
        effects: fitted, with their discrepancy; parameters, sigma: their natural parameters and
            standard errors; alone: those with the other parameters of the same effect held, for
            what two of them can share is there all the same.
        z: deviations of the robot's numbers in prior standard deviations; z_covariance: of them.
        y: what the effects (without discrepancy) leave of the filtered torque, shape (rows, n).
        Z: base and everything else that may still move, unit priors, shape (rows, n, k).
        residual: what everything together leaves; noise: of it, per joint.
        non_parametric: filtered torque of the non-parametric laws, one (rows, n) per law.
        owner: whose column of Z each is: -1 the base, then the effects from 0, then the laws.
        scales: of the columns of the parameters, in natural units; units: of those of each
            effect's discrepancy.
    """

    effects: tuple[Effect, ...]
    parameters: tuple[Parameter, ...]
    sigma: Array
    alone: Array
    z: Array
    z_covariance: Array
    y: Array
    Z: Array
    residual: Array
    noise: tuple[Noise, ...]
    non_parametric: tuple[Array, ...] = field(default=())
    owner: npt.NDArray[np.intp] = field(default_factory=lambda: np.zeros(0, dtype=np.intp))
    scales: Array = field(default_factory=lambda: np.zeros(0))
    units: tuple[Array, ...] = ()


class Fitter:
    """Fits sets of candidates to one log."""

    def __init__(
        self,
        robot: Robot,
        bases: Bases,
        motion: PreparedLog,
        Z: Array,
        reversal: Mask,
        own: int | None = None,
        plain: PlainNumbers | None = None,
        holds: Array | None = None,
    ) -> None:
        """Fits with base columns Z (rows, n, k).

        Args:
            own: how many, the first, are numbers of the robot (others tell nothing of it).
            plain: these at the instants of the rows, not filtered; only `HeldOut` needs them.
            holds: what dry friction holds of a joint that rests, shape (n,) [Nm].
        """
        self.robot = robot
        self.bases = bases
        self.motion = motion
        self.Z = Z
        self.noise = NoiseModel.of(motion, reversal, robot.usually_left, holds)
        self.own = Z.shape[2] if own is None else own
        self.plain = plain
        self.stated = of_changing_strength(robot.effects)
        self.widened = np.ones(self.own)  # times further off than stated that each may be
        self._cache: dict[tuple[object, ...], Array] = {}
        self._fits: list[tuple[tuple[Candidate, ...], Fit]] = []

    def fit(self, chosen: Sequence[Candidate]) -> Fit:
        """Gauss-Newton from the candidates' own estimates; the last ones are kept."""
        for k, (candidates, fit) in enumerate(self._fits):
            if len(candidates) == len(chosen) and all(map(is_, candidates, chosen)):
                self._fits.append(self._fits.pop(k))
                return fit
        fit = self._fitted(chosen)
        self._fits.append((tuple(chosen), fit))
        while sum(one.Z.nbytes for _, one in self._fits) > KEPT_BYTES and len(self._fits) > 1:
            self._fits.pop(0)
        return fit

    @property
    def friction(self) -> int:
        """How many of the robot's numbers, the last, are those of friction alone; an identification
        knows it together with the bodies."""
        apart = self.plain is not None and self.robot.identified is None
        return 3 * self.robot.n if apart else 0

    def widen(self, factor: Array) -> None:
        """Let the robot's numbers be so many times further off than so far, shape (own,)."""
        self.Z = self.Z.copy()
        self.Z[:, :, : self.own] *= factor
        self.widened = self.widened * factor
        self._fits.clear()

    def as_stated(self, fit: Fit) -> Fit:
        """A fit with its deviations in stated standard deviations again."""
        wide = self.widened
        Z = np.concatenate([fit.Z[:, :, : self.own] / wide, fit.Z[:, :, self.own :]], axis=2)
        return replace(
            fit, Z=Z, z=fit.z * wide, z_covariance=fit.z_covariance * np.outer(wide, wide)
        )

    def _fitted(self, chosen: Sequence[Candidate]) -> Fit:
        effects = [e for c in chosen for e in c.effects]
        non_parametric = [c for c in chosen if not c.known]
        G = [self._non_parametric_columns(c) for c in non_parametric]
        z: Array | None = None
        state = self._linearised(effects, G)
        noise = self.noise.white(state.y)
        for _ in range(ITERATIONS if effects else 0):
            noise = self.noise.coloured(state.left(noise))
            if any(e.chain in ("reading", "clock") for e in effects):
                # of the base, which a gain multiplies and a clock delays as well
                z = state.under(noise).mean[: state.base]
                state = self._linearised(effects, G, z)
            found = state.under(noise)
            step = found.mean[state.own] * state.sizes
            if not len(step):
                break
            better = self._descended(effects, G, z, step, state, noise)
            if better is None:
                break
            scale = np.sqrt(np.diag(found.covariance))[state.own] * state.sizes
            effects, state, shrink = better
            if (np.abs(shrink * step) < 0.05 * scale).all():
                break
        return self._finished(effects, state, noise, [g.shape[2] for g in G])

    def _descended(
        self,
        effects: list[Effect],
        G: list[Array],
        z: Array | None,
        step: Array,
        state: Linearised,
        noise: tuple[Noise, ...],
    ) -> tuple[list[Effect], Linearised, float] | None:
        """Effects and state after the longest fraction of the step that does not fit worse."""
        before = state.misfit(noise)
        for shrink in (1.0, 0.4, 0.15):
            further = moved(effects, state.parameters, shrink * step, self.motion.duration)
            if further is not None:
                there = self._linearised(further, G, z)
                if there.misfit(noise) < before + 0.1:
                    return further, there, shrink
        return None

    def _finished(
        self,
        effects: list[Effect],
        state: Linearised,
        noise: tuple[Noise, ...],
        widths: Sequence[int],
    ) -> Fit:
        """`widths`: number of columns of each non-parametric law, the last ones."""
        noise = self.noise.coloured(state.left(noise))
        found = state.under(noise)
        covariance = found.covariance
        y = state.y
        columns = state.columns
        shapes = state.shapes
        own = state.own
        # all else beside the parameters as they are, not as a further step would move them
        b = found.mean
        b = b - covariance[:, own] @ np.linalg.solve(covariance[own, own], b[own])
        sigma = np.sqrt(np.diag(covariance))
        shaped = []
        place = own.stop
        for effect, unit in zip(effects, shapes, strict=True):
            # how the record began is no property of the robot
            kept = effect.prior.kept(len(unit) - effect.beginnings())
            values = (b[place : place + len(unit)] * unit)[:kept]
            place += len(unit)
            shaped.append(
                effect.model_copy(update={"discrepancy": tuple(float(v) for v in values)})
                if kept
                else effect
            )
        owner = np.full(columns.shape[2], -1, dtype=np.intp)
        owner[own] = [parameter.effect for parameter in state.parameters]
        owner[own.stop : place] = np.repeat(np.arange(len(effects)), [len(unit) for unit in shapes])
        non_parametric = []
        edges = place + np.cumsum([0, *widths])
        for law, (start, stop) in enumerate(pairwise(edges)):
            part = slice(start, stop)
            owner[part] = len(effects) + law
            non_parametric.append(columns[:, :, part] @ b[part])
        return Fit(
            effects=tuple(shaped),
            parameters=tuple(state.parameters),
            sigma=sigma[own] * state.sizes,
            alone=alone(covariance[own, own], state.parameters) * state.sizes,
            z=b[: self.own],
            z_covariance=covariance[: self.own, : self.own],
            y=y,
            Z=columns,
            residual=y - columns @ b,
            noise=noise,
            non_parametric=tuple(non_parametric),
            owner=owner,
            scales=state.sizes,
            units=tuple(shapes),
        )

    def _linearised(
        self, effects: list[Effect], G: list[Array], z: Array | None = None
    ) -> Linearised:
        """`z`: deviations of the base, where a gain multiplies or a clock delays these as well."""
        bare = [e.model_copy(update={"discrepancy": ()}) for e in effects]
        y = self._left_by(bare)
        moved_base = None if z is None else self._moved(z)
        if moved_base is not None:
            y = y - moved_base.later(bare)
        blocks = [self.Z * shown_of(bare, self.motion)[:, :, None]]
        parameters = []
        sizes = []
        shapes = []
        for place, effect in enumerate(bare):
            torque = self._torque(effect)
            size = max(float(np.sqrt(np.mean(torque**2))), 1e-9)
            for parameter in parameters_of(effect, place, self.stated):
                slope = self.slope(effect, parameter)
                if moved_base is not None:
                    slope += moved_base.slope(effect, parameter)
                scale = 3.0 * size / max(float(np.sqrt(np.mean(slope**2))), 1e-12)
                if parameter.prior is not None:
                    scale = min(scale, parameter.prior[1])
                blocks.append(slope[:, :, None] * scale)
                parameters.append(parameter)
                sizes.append(scale)
        for effect in bare:
            columns, unit = self._discrepancy(effect)
            blocks.append(columns * unit)
            shapes.append(unit)
        columns = np.concatenate([*blocks, *G], axis=2)
        base = self.Z.shape[2]
        return Linearised(y, columns, base, parameters, np.array(sizes), shapes)

    def _moved(self, z: Array) -> MovedBase:
        """The base where its deviations are."""
        own = z[: self.own] * self.widened
        samples = None if self.plain is None else self.plain.samples @ own
        return MovedBase(self.motion, self.Z @ z, samples)

    def _left_by(self, effects: list[Effect]) -> Array:
        """What the robot with these effects leaves of the filtered torque, shape (rows, n) [Nm]."""
        if all(e.chain == "torque" for e in (*self.robot.effects, *effects)):
            return np.asarray(self._left_by_none - sum(self._torque(e) for e in effects))
        return self.motion.filtered_reading(self.motion.tau_smooth - self.predicted(effects))

    @cached_property
    def _left_by_none(self) -> Array:
        return self.motion.filtered_reading(self.motion.tau_smooth - self.predicted())

    def predicted(self, effects: Sequence[Effect] = ()) -> Array:
        """What the log should show of the robot with these effects as well, shape (m, n) [Nm]."""
        return predicted_torque(self.robot.with_effects(*effects), self.motion, self.bases)

    def _torque(self, effect: Effect, filtered: bool = True) -> Array:
        return np.asarray(self.placed(effect, filtered=filtered) @ np.array(effect.coefficients()))

    def placed(self, effect: Effect, *, discrepancy: bool = False, filtered: bool = True) -> Array:
        """Columns of an effect's basis or discrepancy, shape (rows, n, k)."""
        nonlinear = tuple(sorted(effect.nonlinear.items()))
        key = (effect.kind, effect.joint, effect.windows_s, discrepancy, filtered, nonlinear)
        if key not in self._cache:
            found = self.bases.of(effect, self.motion, discrepancy=discrepancy, filtered=filtered)
            values = found.values if filtered else self.motion.recorded_rows(found.values)
            self._cache[key] = self._on_all_joints(found.joints, values)
        return self._cache[key]

    def _on_all_joints(self, joints: Sequence[int], values: Array) -> Array:
        placed = np.zeros((self.motion.rows, self.motion.n, values.shape[2]))
        placed[:, list(joints)] = values
        return placed

    def slope(self, effect: Effect, parameter: Parameter, *, filtered: bool = True) -> Array:
        """d torque / d parameter by central differences, shape (rows, n)."""
        step = small_step(value_of(effect, parameter))
        return slope_of(effect, parameter, step, lambda one: self._torque(one, filtered))

    def departures(self, effect: Effect, *, filtered: bool = True) -> Array:
        """Columns of an effect's discrepancy, shape (rows, n, k): of what no file keeps that which
        the law cannot give, or the law alone would be another one."""
        placed = self.placed(effect, discrepancy=True, filtered=filtered)
        if effect.prior.lasting is None:
            return placed
        lost = slice(effect.prior.lasting, placed.shape[2] - effect.beginnings())
        law = self.placed(effect)
        more = self.placed(effect, discrepancy=True)[:, :, lost]
        same = np.linalg.lstsq(law.reshape(-1, law.shape[2]), more.reshape(-1, more.shape[2]))[0]
        placed = placed.copy()
        placed[:, :, lost] -= self.placed(effect, filtered=filtered) @ same
        return placed

    def _discrepancy(self, effect: Effect) -> tuple[Array, Array]:
        placed = self.departures(effect)
        shares = discrepancy_shares(effect.kind, placed.shape[2])
        joints = tuple(range(self.motion.n))
        law, departures = (RegressorColumns(joints, one) for one in (self.placed(effect), placed))
        # wider than in the competition, so that they do not come out too small
        sizes = discrepancy_unit(law, np.array(effect.coefficients()), departures, shares)
        return placed, 1.5 * sizes

    def _non_parametric_columns(self, candidate: Candidate) -> Array:
        b = candidate.score.coefficients
        values = candidate.law.values * (3.0 * np.sqrt(np.mean(b**2)))
        return self._on_all_joints(candidate.law.joints, values)
