"""What an explanation is worth on rows that did not fit it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array, Mask, rms
from irb2400_ctrl.diagnosis.estimation.candidate import Candidate
from irb2400_ctrl.diagnosis.estimation.fit import Fit, Fitter
from irb2400_ctrl.diagnosis.estimation.through_chain import delayed, shown_of, slope_of_shown
from irb2400_ctrl.diagnosis.preparation.metrics import noise_floor
from irb2400_ctrl.diagnosis.regressors.predict import effect_torque
from irb2400_ctrl.effects import Effect
from irb2400_ctrl.effects.base import OPEN_END_S

FOLDS = 4
BLOCK = 2.0
"""[s] length of the stretches that are held out, at most"""
LEAST_BLOCKS = 3
"""stretches of each fold, at least"""
HELD = 0.5
"""share of what an effect that comes and goes shows, above which the stretch held out is not to be
predicted from the rest"""
NOISE = 1.3
"""times the noise floor up to which what is left is noise"""
FREE = 1e-2
"""precision of an effect's own numbers about the fitted ones: a fold has to find them itself"""


@dataclass(frozen=True)
class Worth:
    """Rms that is left of each joint's torque on unseen rows without and with an explanation.

    Args:
        before, after: shape (n,) [Nm]; rows: of each joint, shape (n,).
    """

    before: Array
    after: Array
    rows: Array

    @classmethod
    def of(cls, without: Array, left: Array, known: Mask) -> Worth:
        """From residuals (rows, n) [Nm]."""
        rows = known.sum(axis=0)
        rms = [
            np.sqrt(np.sum(np.where(known, r, 0.0) ** 2, axis=0) / np.maximum(rows, 1))
            for r in (without, left)
        ]
        return cls(rms[0], rms[1], rows)

    @property
    def gain(self) -> Array:
        """Per cent by which the rms falls, shape (n,); negative where it only rises."""
        return np.asarray(100.0 * (1.0 - self.after / np.maximum(self.before, 1e-6)))

    @property
    def nats(self) -> Array:
        """The same as log likelihood of the unseen rows, noise of each joint of a size of its own,
        shape (n,)."""
        ratio = np.maximum(self.before, 1e-6) / np.maximum(self.after, 1e-6)
        return np.asarray(self.rows * np.log(ratio))


class HeldOut:
    """Errors on stretches of a log that everything is fitted without, in turn.

    Stretches of different folds lie between each other, so that what grows with time is
    interpolated and an event of some seconds is seen by all folds.

    Two errors are asked for. `left` is that of the fit: through the common filter, with flexible
    laws and all that may move beside the robot. `told` is that of names and numbers alone, as a
    robot's file can hold them, sample by sample. A name that only a flexible law beside it, or a
    friction below nothing, makes bearable, or that says something above the filter's band, is seen
    by the second.
    """

    def __init__(self, fitter: Fitter, chosen: Sequence[Candidate], fit: Fit) -> None:
        self.fitter = fitter
        self.chosen = chosen
        self.fit = fit
        self.fold = folds(fitter.motion.row_time)
        self._known = fitter.motion.at_rows(fitter.motion.known.astype(float)) > 0.5
        for j, one in enumerate(fit.noise):
            # how a hysteresis stood before the first row that is fitted is anybody's guess
            self._known[: one.kept[0] if len(one.kept) else 0, j] = False
        self._found = self._solved(fit)

    def worth(self, place: int) -> Worth:
        """Of one of `chosen` for the fit's error."""
        other = self._without(place)
        before = self._left(other, self._solved(other))
        return Worth.of(before, self._left(self.fit, self._found), self.fitter.motion.row_known)

    def told(self, place: int) -> Worth:
        """Of one of `chosen`, a named one, for the error of what the robot's file will say."""
        other = self._without(place)
        before = self._told(other, self._solved(other))
        return Worth.of(before, self._told(self.fit, self._found), self._known)

    def over_given(self, effects: Sequence[int]) -> Worth:
        """Of effects of the fit (their places) and the numbers fitted beside them, over the robot's
        numbers as they were given beside the other effects."""
        fitter = self.fitter
        motion = fitter.motion
        others = [e for k, e in enumerate(self.fit.effects) if k not in effects]
        given = motion.at_rows(motion.tau - fitter.predicted(others))
        return Worth.of(given, self._told(self.fit, self._found), self._known)

    def of_the_fit(self, place: int) -> bool:
        """Whether a law without a name (its place among `chosen`) makes up for what the fit has
        made of the robot's numbers: as they were given they leave noise on its joint, and less of
        it than the law is."""
        joint = self.chosen[place].joint
        if joint is None:
            return False
        own = [joint - 1]
        laws = sum(not c.known for c in self.chosen[:place])
        law = self.fit.non_parametric[laws][:, own]
        motion = self.fitter.motion
        samples = (motion.tau - self.fitter.predicted(self.fit.effects))[:, own]
        (floor,) = noise_floor(samples, motion.known[:, own], motion.step)
        counts = self._known[:, own].ravel()
        (left,) = rms(motion.at_rows(samples)[counts])
        (size,) = rms(law[counts])
        return bool(left < min(NOISE * floor, size))

    def told_of(self, effects: Sequence[int]) -> Worth:
        """The same for effects of the fit (their places) that other numbers of the robot could take
        in, were they not held where they are."""
        motion = self.fitter.motion
        left = self._told(self.fit, self._found)
        before = left.copy()
        for k in effects:
            torque = effect_torque(self.fitter.bases, self.fit.effects[k], motion)
            before += motion.recorded_rows(torque)
        return Worth.of(before, left, self._known)

    def _without(self, place: int) -> Fit:
        return self.fitter.fit([c for k, c in enumerate(self.chosen) if k != place])

    def _solved(self, fit: Fit) -> list[Array]:
        """Coefficients of the fit's columns by ridge regression on the rows of all folds but one,
        for each.

        How a swing or a hysteresis stood when the record began shows in its first seconds alone and
        is no property of the robot: it is as all rows together say. A fold without those seconds
        would find any, as it would any force that acts in the stretch held out alone.
        """
        precision = np.ones(fit.Z.shape[2])
        start = int(np.sum(fit.owner < 0))
        precision[start : start + len(fit.parameters)] = FREE
        grams = np.zeros((FOLDS, len(precision), len(precision)))
        rights = np.zeros((FOLDS, len(precision)))
        for j, one in enumerate(self.fit.noise):
            X = one.whiten(fit.Z[:, j, :])
            v = one.whiten(fit.y[:, j])
            for k in range(FOLDS):
                rows = self.fold[one.kept] == k
                grams[k] += X[rows].T @ X[rows]
                rights[k] += X[rows].T @ v[rows]
        lasting = ~self._of_beginnings(fit)
        passing = self._of_moments(fit)
        shares = np.diagonal(grams, axis1=1, axis2=2)
        shares = shares / np.maximum(shares.sum(axis=0), 1e-300)
        whole = np.linalg.solve(grams.sum(axis=0) + np.diag(precision), rights.sum(axis=0))
        found = []
        for k in range(FOLDS):
            free = lasting & ~(passing & (shares[k] > HELD))
            A = np.delete(grams, k, axis=0).sum(axis=0) + np.diag(precision)
            right = np.delete(rights, k, axis=0).sum(axis=0) - A[:, ~free] @ whole[~free]
            b = whole.copy()
            b[free] = np.linalg.solve(A[np.ix_(free, free)], right[free])
            found.append(b)
        return found

    @staticmethod
    def _of_beginnings(fit: Fit) -> Mask:
        """Columns of the states that effects had when the record began, shape (k,)."""
        found = np.zeros(fit.Z.shape[2], dtype=bool)
        stop = int(np.sum(fit.owner < 0)) + len(fit.parameters)
        for effect, unit in zip(fit.effects, fit.units, strict=True):
            stop += len(unit)
            found[stop - min(effect.beginnings(), len(unit)) : stop] = True
        return found

    @staticmethod
    def _of_moments(fit: Fit) -> Mask:
        """Columns of effects that come and go, shape (k,)."""
        passing = [
            k
            for k, e in enumerate(fit.effects)
            if any(stop < OPEN_END_S for _, stop in e.windows_s)
        ]
        return np.isin(fit.owner, passing)

    def _left(self, fit: Fit, found: Sequence[Array]) -> Array:
        """What everything together leaves, shape (rows, n)."""
        left = np.zeros_like(fit.y)
        for k, b in enumerate(found):
            rows = self.fold == k
            left[rows] = fit.y[rows] - fit.Z[rows] @ b
        return left

    def _told(self, fit: Fit, found: Sequence[Array]) -> Array:
        """What the robot's numbers and the named effects leave, not filtered, shape (rows, n)."""
        fitter = self.fitter
        motion = fitter.motion
        plain = fitter.plain
        assert plain is not None
        bare = [e.model_copy(update={"discrepancy": ()}) for e in fit.effects]
        left = motion.at_rows(motion.tau - fitter.predicted(bare))
        columns, places = self._of_names(fit, bare)
        late = [e for e in bare if e.chain == "clock"]
        shown = shown_of(bare, motion)
        slopes = [slope_of_shown(bare[p.effect], p, motion) for p in fit.parameters]
        own = int(np.sum(fit.owner < 0)) + np.arange(len(slopes))
        for k, b in enumerate(found):
            rows = self.fold == k
            z = b[: fitter.own] * fitter.widened
            numbers = plain.torque(z, rows)
            if late:
                later = delayed(late, plain.samples @ z, motion)
                numbers += motion.recorded_rows(later)[rows]
            # a gain multiplies numbers that moved as well
            more = zip(slopes, b[own] * fit.scales, strict=True)
            growth = shown[rows] + sum(slope[rows] * value for slope, value in more)
            left[rows] -= growth * numbers
            left[rows] -= columns[rows] @ b[places]
        return left

    def _of_names(self, fit: Fit, bare: Sequence[Effect]) -> tuple[Array, npt.NDArray[np.intp]]:
        """Columns of the named effects' own numbers and of their discrepancy, not filtered, and
        their places among those of the fit."""
        fitter = self.fitter
        base = int(np.sum(fit.owner < 0))
        place = base + len(fit.parameters)
        blocks = [np.zeros((*fit.y.shape, 0))]
        places = [np.arange(base, place)]
        for parameter, scale in zip(fit.parameters, fit.scales, strict=True):
            slope = fitter.slope(bare[parameter.effect], parameter, filtered=False)
            blocks.append(slope[:, :, None] * scale)
        for effect, unit in zip(bare, fit.units, strict=True):
            blocks.append(fitter.departures(effect, filtered=False) * unit)
        places.append(np.arange(place, place + sum(map(len, fit.units))))
        return np.concatenate(blocks, axis=2), np.concatenate(places)


def folds(time: Array) -> npt.NDArray[np.intp]:
    """Fold of each row, shape (rows,)."""
    elapsed = time - time[0]
    block = min(BLOCK, float(elapsed[-1]) / (FOLDS * LEAST_BLOCKS))
    return np.asarray((elapsed / block).astype(np.intp) % FOLDS)
