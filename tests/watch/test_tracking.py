"""Friction that grows is followed inside its band; what does not grow, or is not shown, stays."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from independent_plant import Case
from independent_plant.drift import drifting, grown_part

import irb2400_ctrl as irb
from irb2400_ctrl.arrays import Array
from irb2400_ctrl.identification import identify
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.watch import Baseline, Tracked, Tracker, Usual, Watch
from irb2400_ctrl.watch.baseline import White
from irb2400_ctrl.watch.watch import between

JOINT = 3
GROWN = 0.3
LEARN = 60.0
EVERY = 5
"""blocks after which tracked and true values are compared"""


def log_of(raw: object) -> Log:
    return Log(raw.time, raw.q, raw.tau)  # type: ignore[attr-defined]


@cache
def arm() -> tuple[irb.Robot, Log, Array, Array]:
    """The file of its own identification, five minutes of its work, the true numbers before and
    after."""
    case = Case(31, duration=40.0, validation_duration=300.0)
    raw, (start, end) = drifting(case, JOINT, GROWN, quiet=LEARN)
    robot = identify(irb.load_robot("irb2400"), [log_of(case.recorded(0))]).robot
    return robot, log_of(raw), start, end


@cache
def tracked() -> tuple[Array, list[Tracked]]:
    """Of every fifth second: the true numbers, and those that were tracked."""
    robot, log, start, end = arm()
    watch = Watch(robot, LEARN)
    for begin in np.arange(log.time[0], log.time[-1], 60.0):
        list(watch.feed(between(log, begin, begin + 60.0)))
    seen = watch.seen[EVERY::EVERY]
    time = np.array([log.time[0], *(one.time for one in seen), log.time[-1]])
    grown = grown_part(time, LEARN)[1:-1, None]
    return start + grown * (end - start), [one.tracked for one in seen]


def stacked(name: str) -> Array:
    return np.array([getattr(one, name) for one in tracked()[1]])


OWN = [JOINT - 1, 6 + JOINT - 1]


def test_friction_that_grows_is_followed_inside_its_band() -> None:
    true, (*_, last) = tracked()
    inside = np.abs(stacked("values") - true) < stacked("bands")
    assert inside[:, OWN].mean() > 0.9
    # and the band says something: a few per cent, after a growth of thirty
    assert (last.bands[OWN] < 0.07 * true[-1, OWN]).all()
    assert (last.changes[OWN] > 3 * last.change_bands[OWN]).all()


def test_the_others_stay() -> None:
    others = [k for k in range(13) if k not in OWN]
    true = tracked()[0]
    inside = np.abs(stacked("values") - true) < stacked("bands")
    assert inside[:, others].mean() > 0.85
    changes = stacked("changes")[:, others]
    bands = stacked("change_bands")[:, others]
    assert (np.abs(changes) < bands).mean() > 0.85
    assert (np.abs(changes) < 2 * bands).all()
    # in per cent of the friction: nothing wanders
    assert np.abs(stacked("changes")[:, others[:-1]] / true[0, others[:-1]]).max() < 0.08


@pytest.fixture(scope="module")
def begun() -> tuple[Baseline, list[White]]:
    """What was learned, and the joints' rows of the minute after."""
    robot, log, _, _ = arm()
    middle = float(np.ceil(log.time[0] + LEARN))
    baseline = Baseline.of(robot, between(log, -np.inf, middle))
    return baseline, baseline.judged(between(log, middle, middle + 60.0))[1]


def fed(baseline: Baseline, joints: list[White], still: int | None = None) -> list[Tracked]:
    """A minute, in which a joint may stand."""
    tracker = Tracker(baseline, Usual.of(baseline.learned))
    found = [tracker.tracked]
    for time in np.arange(np.ceil(joints[0].time[0]) + 0.5, joints[0].time[-1] - 1.0):
        rows = [white.block(time) for white in joints]
        if still is not None:
            none = slice(0, 0)
            one = rows[still]
            rows[still] = White(one.time[none], one.left[none], one.columns[none], one.drifts[none])
        found.append(tracker.add(rows))
    return found


def test_what_the_motion_does_not_show_stays_with_its_band(
    begun: tuple[Baseline, list[White]],
) -> None:
    still = 3
    first, *_, last = fed(*begun, still)
    own = [still, 6 + still]
    assert last.changes[own] == pytest.approx(0.0, abs=1e-12)
    assert last.change_bands[own] == pytest.approx(0.0, abs=1e-12)
    # it is only told what the others say of the numbers that they have in common
    assert (np.abs(last.values - first.values)[own] < 0.5 * first.bands[own]).all()
    assert (last.bands[own] <= first.bands[own] * 1.001).all()
    moved = [k for k in range(12) if k not in own]
    assert (last.change_bands[moved] > 0.0).all()


def test_it_begins_with_what_was_learned(begun: tuple[Baseline, list[White]]) -> None:
    """The band is that of the numbers' own covariance; nothing has drifted yet."""
    baseline, joints = begun
    first = fed(baseline, joints)[0]
    assert not first.changes.any()
    assert not first.change_bands.any()
    true = arm()[2]
    assert (np.abs(first.values - true)[:12] < 1.5 * first.bands[:12]).all()
