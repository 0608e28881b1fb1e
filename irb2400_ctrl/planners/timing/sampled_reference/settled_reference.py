"""`settled_reference`: a timed path slowed until what the controller receives keeps the limits."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

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
    look = _Look(partial(_looked_at, dynamics, task, limits=limits, sampling=sampling))
    found = _slowed(look, law, dynamics, task, limits, sampling) if slow else look(law)
    # where the bounds lie told what to slow; of a long motion they are many MB
    return replace(found, bounds=found.bounds.largest)


def _slowed(
    look: _Look,
    law: TimeLaw,
    dynamics: PathDynamics,
    task: TaskPath,
    limits: MotionLimits,
    sampling: Sampling,
) -> Settled:
    """The rows of the law that keeps the limits, with the bounds of all cells."""
    asked = law
    bounded = look(law).bounded
    unslowed = look(law).worst(limits)
    swing = _Swing.of(look(law), limits)
    nearly = _slower_all_over(look, law, limits, _HARDLY)
    if look(nearly).worst(limits) <= 1:
        return look(nearly)
    if not (isinstance(law, PiecewiseConstantLaw) and bounded):
        return look(_slower_all_over(look, law, limits, _HOPELESS))
    for _ in range(_ROUNDS):
        if swing.by_effort >= _HOPELESS:
            break
        slower = _slower_where(dynamics, task, law, swing, limits, sampling)
        if slower.duration <= law.duration:
            break
        law = slower
        swing = _Swing.of(look(law), limits)
        nearly = _slower_all_over(look, law, limits, _HARDLY)
        if look(nearly).worst(limits) <= 1:
            law = nearly
            break
    if look(law).worst(limits) > unslowed:
        # axes too weak to come back so fast to their speed
        return look(_slower_all_over(look, asked, limits, _HOPELESS))
    # coming back to its speed the law itself may need more than its rows
    own = law.bounds(task.joints, limits, dynamics)
    effort = max(own.torque_ratio, own.acceleration_ratio)
    if effort > 1:
        law = law.slowed(1 + _BY_TORQUE * (effort - 1))
    last = _slower_all_over(look, law, limits, _HOPELESS)
    kept = last is law and effort <= 1
    return replace(look(last), own=own) if kept else look(last)


@dataclass
class _Look:
    """The rows of one law at a time: of a long motion they are tens of MB, and may be made
    again."""

    of: Callable[[TimeLaw], Settled]
    _law: TimeLaw | None = None
    _found: Settled | None = None

    def __call__(self, law: TimeLaw) -> Settled:
        if self._found is None or law is not self._law:
            self._law = self._found = None
            self._found = self.of(law)
            self._law = law
        return self._found


@dataclass(frozen=True)
class _Swing:
    """How far, and where, the rows of a law swing above the limits."""

    by_effort: float
    rows: Array
    """[s]"""
    wanted: Array
    """how many times slower each interval between them has to be"""

    @classmethod
    def of(cls, found: Settled, limits: MotionLimits) -> _Swing:
        rows = found.reference.rows.time
        return cls(found.by_effort(limits), rows, _wanted(found.bounds, found.feed, rows, limits))


def _slower_all_over(look: _Look, law: TimeLaw, limits: MotionLimits, most: float) -> TimeLaw:
    """The whole motion slowed, at most by that factor, until it keeps its limits."""
    factor = 1.0
    slowed = law
    for _ in range(_ROUNDS):
        worst = look(slowed).worst(limits)
        factor *= look(slowed).slower(limits) + _ROUNDING
        if not 1 < worst < _HOPELESS or factor > most:
            break
        slowed = law.slowed(factor)
    return slowed


def _slower_where(
    dynamics: PathDynamics,
    task: TaskPath,
    law: PiecewiseConstantLaw,
    swing: _Swing,
    limits: MotionLimits,
    sampling: Sampling,
) -> PiecewiseConstantLaw:
    """The law slowed around the rows that swing above a limit, until they do not, wherever between
    its own places a row may come to lie."""
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
        rows = np.arange(np.ceil(law.duration * sampling.rate) + 2) / sampling.rate
        wanted = np.ones(len(rows) - 1)
        for part in range(PHASES):
            read = Excerpt.of(law, task.joints, sampling, spans, part / PHASES)
            feed = read.feed(task, law)
            more = _wanted(read.bounds(dynamics, limits), feed, read.places.knots, limits)
            row = np.clip((read.start * sampling.rate).astype(int), 0, len(wanted) - 1)
            np.maximum.at(wanted, row, more)
        if wanted.max() <= 1:
            break
    return law


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


def _wanted(
    bounds: ReferenceBounds, feed: tuple[Array, Array] | None, rows: Array, limits: MotionLimits
) -> Array:
    """How many times slower each interval between rows has to be, at least 1, shape (rows - 1,)."""
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


def _looked_at(
    dynamics: PathDynamics, task: TaskPath, law: TimeLaw, limits: MotionLimits, sampling: Sampling
) -> Settled:
    """The rows of a law, and their bounds."""
    give_back_freed()
    reference = sampling.reference(law, task.joints).as_written(dynamics.lengths)
    bounds = reference.bounds(dynamics, limits)
    torque = bounds.torque.max(axis=0)
    if not np.isfinite(torque).all():
        torque = np.where(np.isfinite(torque), torque, _sampled_torque(dynamics, reference))
    return Settled(law, reference, bounds, torque, task.feed_ratios(law, reference.places))


def _sampled_torque(dynamics: PathDynamics, reference: SampledReference) -> Array:
    """Largest |tau| of each axis over 10,000 samples per second [Nm], shape (n,)."""
    end = reference.rows.time[-1]
    found = np.zeros(dynamics.n)
    for first in np.arange(0.0, end, _SPAN):
        t = np.arange(first, min(first + _SPAN, end), 1 / _RATE)
        tau = dynamics.torque(*reference.states(t), t)
        found = np.maximum(found, np.abs(tau).max(axis=0))
    return found
