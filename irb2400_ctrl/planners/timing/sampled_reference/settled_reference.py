"""`settled_reference`: a timed path slowed until what the controller receives keeps the limits."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.planners.enclosure.path_dynamics import PathDynamics
from irb2400_ctrl.planners.timing.motion_bounds import Checked
from irb2400_ctrl.planners.timing.motion_limits import MotionLimits
from irb2400_ctrl.planners.timing.piecewise_constant_law import PiecewiseConstantLaw
from irb2400_ctrl.planners.timing.sampled_reference.excerpt import Excerpt
from irb2400_ctrl.planners.timing.sampled_reference.local_slowing import slowing
from irb2400_ctrl.planners.timing.sampled_reference.reference_bounds import ReferenceBounds
from irb2400_ctrl.planners.timing.sampled_reference.sampled_reference import SampledReference
from irb2400_ctrl.planners.timing.sampled_reference.sampling import PHASES, Sampling
from irb2400_ctrl.planners.timing.task_path import TaskPath
from irb2400_ctrl.planners.timing.time_law import TimeLaw
from irb2400_ctrl.system import give_back_freed

_ROUNDS = 20
# a ratio to a limit that slowing down is not tried on
_HOPELESS = 3.0
# how many times slower a motion is made around a row at once
_AT_ONCE = 1.5
_ROUNDING = 1e-7
# a factor by which a whole motion is slowed without a thought: its feed still counts as held
_HARDLY = 1.008
# around a row it costs nothing to slow a little more than that: later rows swing otherwise
_MORE = 1.2
_SPARE = 5e-4
# change of the speed along a path by a jump of its acceleration between rows that is looked at, as
# a part of the speed
_BEND = 5e-3
# of what a torque is above its limit, how much slower it has to be
_BY_TORQUE = 0.7
# samples per second of a torque that has no bound, and seconds that are sampled at once
_RATE = 1e4
_SPAN = 10.0


@dataclass(frozen=True)
class Settled:
    """A time law, the rows of its file, and what is sure of them over all times."""

    law: TimeLaw
    reference: SampledReference
    """with the digits of the file"""
    bounds: ReferenceBounds
    """of each cell while the law is being slowed, then of the whole motion as one"""
    torque: Array
    """largest |tau| of each axis [Nm], shape (n,); of samples where there is no bound"""
    feed: tuple[Array, Array] | None
    """ends of cells of time [s], and the TCP's speed over the feed in each; None without a feed"""
    own: Checked | None = None
    """what is sure of the law itself; None where it was not looked at"""

    @property
    def bounded(self) -> bool:
        """Whether the torque has a bound."""
        return bool(np.isfinite(self.bounds.torque).all())

    @property
    def feed_ratio(self) -> float | None:
        """The largest speed of the TCP over the feed; None without a feed."""
        return None if self.feed is None else float(self.feed[1].max())

    def by_torque(self, limits: MotionLimits) -> float:
        """The largest part of a torque limit."""
        return float((self.torque / limits.tau_max).max())

    def by_effort(self, limits: MotionLimits) -> float:
        """The largest part of a limit of torque or acceleration."""
        return max(self.by_torque(limits), self.bounds.acceleration_ratio(limits.qdd_max))

    def worst(self, limits: MotionLimits) -> float:
        """The largest part of a limit, feed included."""
        return max(self.by_effort(limits), self._by_speed(limits))

    def slower(self, limits: MotionLimits) -> float:
        """About how many times slower the motion has to be: below 1 where it keeps its limits."""
        return max(1 + _BY_TORQUE * (self.by_effort(limits) - 1), self._by_speed(limits))

    def _by_speed(self, limits: MotionLimits) -> float:
        return max(self.bounds.velocity_ratio(limits.qd_max), self.feed_ratio or 0.0)


def settled_reference(
    dynamics: PathDynamics,
    task: TaskPath,
    law: TimeLaw,
    limits: MotionLimits,
    sampling: Sampling,
    slow: bool,
) -> Settled:
    """The rows of a timed path, bounded; the law slowed first, where allowed, until they keep
    torque, acceleration, speed and feed: all over if hardly anything is missing, or if its torque
    may not jump (such a law was made for its rows, see `Sampling.ratios`); else where they swing
    above a limit, and all over by the little that is left then, or if that does not settle.

    Args:
        dynamics: the arm's torque along the path.
        task: the path.
        law: when it is where.
        limits: to keep.
        sampling: which rows the file has of a law.
        slow: whether the law may be slowed.
    """
    look = _Look(dynamics, task, limits, sampling)
    found = look.slowed(law) if slow else look(law)
    # where the bounds lie told what to slow; of a long motion they are many MB
    return replace(found, bounds=found.bounds.largest)


@dataclass(frozen=True)
class _Swing:
    """How far, and where, the rows of a law swing above the limits."""

    by_effort: float
    rows: Array
    """[s]"""
    wanted: Array
    """how many times slower each interval between them has to be"""


@dataclass
class _Look:
    """The rows of one law of a path at a time: of a long motion they are tens of MB, and may be
    made again."""

    dynamics: PathDynamics
    task: TaskPath
    limits: MotionLimits
    sampling: Sampling
    _law: TimeLaw | None = None
    _found: Settled | None = None

    def __call__(self, law: TimeLaw) -> Settled:
        """The rows of a law, and their bounds."""
        if self._found is None or law is not self._law:
            self._law = self._found = None
            self._found = self._made(law)
            self._law = law
        return self._found

    def _made(self, law: TimeLaw) -> Settled:
        dynamics = self.dynamics
        give_back_freed()
        reference = self.sampling.reference(law, self.task.joints).as_written(dynamics.lengths)
        bounds = reference.bounds(dynamics, self.limits)
        torque = bounds.torque.max(axis=0)
        if not np.isfinite(torque).all():
            torque = np.where(np.isfinite(torque), torque, _sampled_torque(dynamics, reference))
        return Settled(law, reference, bounds, torque, self.task.feed_ratios(law, reference.places))

    def slowed(self, law: TimeLaw) -> Settled:
        """The rows of the law that keeps the limits, with the bounds of all cells."""
        limits = self.limits
        asked = law
        bounded = self(law).bounded
        unslowed = self(law).worst(limits)
        swing = self.swing(law)
        nearly = self.slower_all_over(law, _HARDLY)
        if self(nearly).worst(limits) <= 1:
            return self(nearly)
        if not (isinstance(law, PiecewiseConstantLaw) and bounded):
            return self(self.slower_all_over(law, _HOPELESS))
        for _ in range(_ROUNDS):
            if swing.by_effort >= _HOPELESS:
                break
            slower = self.slower_where(law, swing)
            if slower.duration <= law.duration:
                break
            law = slower
            swing = self.swing(law)
            nearly = self.slower_all_over(law, _HARDLY)
            if self(nearly).worst(limits) <= 1:
                law = nearly
                break
        if self(law).worst(limits) > unslowed:
            # axes too weak to come back so fast to their speed
            return self(self.slower_all_over(asked, _HOPELESS))
        # coming back to its speed the law itself may need more than its rows
        own = law.bounds(self.task.joints, limits, self.dynamics)
        effort = max(own.torque_ratio, own.acceleration_ratio)
        if effort > 1:
            law = law.slowed(1 + _BY_TORQUE * (effort - 1))
        last = self.slower_all_over(law, _HOPELESS)
        kept = last is law and effort <= 1
        return replace(self(last), own=own) if kept else self(last)

    def swing(self, law: TimeLaw) -> _Swing:
        """How far, and where, the rows of a law swing above the limits."""
        found = self(law)
        rows = found.reference.rows.time
        wanted = self._wanted(found.bounds, found.feed, rows)
        return _Swing(found.by_effort(self.limits), rows, wanted)

    def slower_all_over(self, law: TimeLaw, most: float) -> TimeLaw:
        """The whole motion slowed, at most by that factor, until it keeps its limits."""
        factor = 1.0
        slowed = law
        for _ in range(_ROUNDS):
            worst = self(slowed).worst(self.limits)
            factor *= self(slowed).slower(self.limits) + _ROUNDING
            if not 1 < worst < _HOPELESS or factor > most:
                break
            slowed = law.slowed(factor)
        return slowed

    def slower_where(self, law: PiecewiseConstantLaw, swing: _Swing) -> PiecewiseConstantLaw:
        """The law slowed around the rows that swing above a limit, until they do not, wherever
        between its own places a row may come to lie."""
        rate = self.sampling.rate
        rows = swing.rows
        wanted = swing.wanted
        places = law.at(_spans(rows, np.maximum(wanted, 1.0 + _abrupt(law, rows))))[0]
        for _ in range(_ROUNDS):
            factors = slowing(wanted)
            before = law.at(rows)[0]
            law = law.slowed_at(rows, factors)
            # what nobody slowed is as it was
            places = places[_touches(places, before[factors > 1])]
            spans = np.interp(places, law.s, law.time)
            rows = np.arange(np.ceil(law.duration * rate) + 2) / rate
            wanted = np.ones(len(rows) - 1)
            for part in range(PHASES):
                read = Excerpt.of(law, self.task.joints, self.sampling, spans, part / PHASES)
                feed = read.feed(self.task, law)
                bounds = read.bounds(self.dynamics, self.limits)
                more = self._wanted(bounds, feed, read.places.knots)
                row = np.clip((read.start * rate).astype(int), 0, len(wanted) - 1)
                np.maximum.at(wanted, row, more)
            if wanted.max() <= 1:
                break
        return law

    def _wanted(
        self, bounds: ReferenceBounds, feed: tuple[Array, Array] | None, rows: Array
    ) -> Array:
        """How many times slower each interval between rows has to be, at least 1, (rows - 1,)."""
        limits = self.limits
        # both fall with the square of the speed, torque but for gravity and friction
        torque = (bounds.torque / limits.tau_max).max(axis=1)
        effort = np.maximum(torque, (bounds.acceleration / limits.qdd_max).max(axis=1))
        speed = (bounds.speed / limits.qd_max).max(axis=1)
        parts = [(bounds.time, np.maximum(1 + _MORE * _BY_TORQUE * (effort - 1), speed))]
        if feed is not None:
            parts.append(feed)
        found = np.ones(len(rows) - 1)
        for ends, ratio in parts:
            row = np.searchsorted(rows, (ends[:-1] + ends[1:]) / 2) - 1
            np.maximum.at(found, np.clip(row, 0, len(found) - 1), ratio)
        # what swings from a rapid move into a slow cut is settled by far less than its ratio
        return np.where(found > 1, np.minimum(found, _AT_ONCE) + _SPARE, 1.0)


def _touches(places: Array, slowed: Array) -> npt.NDArray[np.bool_]:
    """Which stretches (k, 2) of a path hold one of the increasing lengths (m,) [m]."""
    first = np.searchsorted(slowed, places[:, 0] - _ROUNDING)
    last = np.searchsorted(slowed, places[:, 1] + _ROUNDING, side="right")
    return np.asarray(last > first)


def _spans(rows: Array, wanted: Array) -> Array:
    """First and last time of each stretch of rows around those that have to be slower, shape (k,
    2) [s]."""
    slow = np.flatnonzero(slowing(wanted) > 1)
    ends = np.flatnonzero(np.diff(slow) > 1)
    first = slow[np.insert(ends + 1, 0, 0)]
    last = slow[np.append(ends, len(slow) - 1)]
    return np.stack([rows[first], rows[last]], axis=1)


def _abrupt(law: TimeLaw, rows: Array) -> Array:
    """Whether the speed along the path bends between two rows so that a cubic may swing, shape
    (rows - 1,): what these rows happen to meet well, others will not."""
    _, speed, acceleration = law.at(rows)
    bend = np.abs(np.diff(acceleration)) * np.diff(rows)
    return np.asarray(bend > _BEND * np.maximum(speed[:-1], speed[1:]))


def _sampled_torque(dynamics: PathDynamics, reference: SampledReference) -> Array:
    """Largest |tau| of each axis over 10,000 samples per second [Nm], shape (n,)."""
    end = reference.rows.time[-1]
    found = np.zeros(dynamics.n)
    for first in np.arange(0.0, end, _SPAN):
        t = np.arange(first, min(first + _SPAN, end), 1 / _RATE)
        tau = dynamics.torque(*reference.states(t), t)
        found = np.maximum(found, np.abs(tau).max(axis=0))
    return found
