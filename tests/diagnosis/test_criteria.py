"""Each criterion at its edge, on candidates whose sizes are plain numbers."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from irb2400_ctrl.diagnosis.comparison.comparison import Alternative
from irb2400_ctrl.diagnosis.comparison.criteria import Criteria, Threshold
from irb2400_ctrl.diagnosis.comparison.step import of_one_moment
from irb2400_ctrl.effects.base import OPEN_END_S

BASE = 1000.0
"""log evidence without any explanation"""
ROWS = np.array([1.0, -1.0, 1.0, -1.0])
"""a torque of rms one"""


def candidate(size: Any = (0.0, 5.0, 0.0), **given: Any) -> Any:
    """An offset on joint 2 of three with these rms torques [Nm]."""
    gain = given.pop("gain", 100.0)
    stops = given.pop("stops", ())
    effect = SimpleNamespace(
        windows_s=[(0.0, stop) for stop in stops],
        chain=given.pop("chain", "torque"),
        search=SimpleNamespace(repeats=given.pop("repeats", False)),
    )
    usual: dict[str, Any] = {
        "kind": "torque_offset", "joint": 2, "known": True, "devices": frozenset(), "begins": (),
        "expected": (), "discrepancy_share": 0.5, "effects": (effect,), "rattles": False,
        "has_own_shape": False, "freer": "",
        "score": SimpleNamespace(gain=gain), "torque": lambda n: ROWS[:, None] * np.array(size),
        "acts_on": lambda n: np.array(size) != 0.0,
    }  # fmt: skip
    return SimpleNamespace(**(usual | given))


def alternative(
    of: Any, gain: float = 100.0, by_law: float = 100.0, rattles: bool = False
) -> Alternative:
    return Alternative(of, BASE + gain, by_law, rattles)


def comparison(**given: Any) -> Any:
    usual: dict[str, Any] = {
        "gain": lambda one: one.evidence - BASE,
        "energy": np.full(3, 80.0),  # the twentieth of it is 2 Nm squared
        "share_beyond_base": lambda one: 1.0,
        "elsewhere": lambda one: 1.0,
        "added": lambda one: np.array([0.0, 5.0, 0.0]),
        "by_joint": lambda gain, torque: gain * np.array([0.25, 0.5, 0.25]),
        "explained": lambda one: one.torque(3),
        "known_rms": lambda torque: np.sqrt(np.mean(torque**2, axis=0)),
        "sampled_rms": lambda one: np.zeros(3),
        "leftover": lambda one: None,
        "relieves_base": lambda one: False,
        "with_its_leftover": lambda one: one.evidence,
        "scan": SimpleNamespace(laws={("time_delay", None): ((), (SimpleNamespace(values=0.0),))}),
        "gain_beside": lambda one, columns: 100.0,
        "chosen": (),
    }
    return SimpleNamespace(**(usual | given))


def threshold(measured: float = 20.0, predicted: float = 10.0, **changed: float) -> Threshold:
    motion: Any = SimpleNamespace(
        n=3, tau=measured * ROWS[:, None] * np.ones(3), filtered_reading=lambda values: values
    )
    return Threshold(Criteria(**changed), motion, [predicted * ROWS[:, None] * np.ones(3)])  # type: ignore[arg-type]


def constant(value: Any) -> Any:
    return lambda one: value


def accepts(of: Any, *chosen: Any, **given: Any) -> bool:
    stated = {name: given.pop(name) for name in ("gain", "by_law", "rattles") if name in given}
    judge = given.pop("judge", None) or threshold()
    return judge.accepts(comparison(chosen=chosen, **given), alternative(of, **stated))


@pytest.mark.parametrize(("measured", "predicted"), [(20.0, 10.0), (10.0, 20.0)])
def test_a_torque_that_another_one_must_cancel_is_refused(
    measured: float, predicted: float
) -> None:
    """Above one and a half times the larger of measured and predicted, on any joint."""
    judge = threshold(measured, predicted)
    np.testing.assert_allclose(judge.rms, measured)
    np.testing.assert_allclose(judge.largest, 30.0)
    assert accepts(candidate((0.0, 29.9, 0.0)), judge=judge)
    assert not accepts(candidate((0.0, 30.1, 0.0)), judge=judge)
    assert not accepts(candidate((30.1, 5.0, 0.0)), judge=judge)


def test_a_law_is_told_on_the_joint_of_whose_torque_it_is_the_most() -> None:
    unlike: Any = SimpleNamespace(
        n=3, tau=ROWS[:, None] * np.array([90.0, 20.0, 6.0]), filtered_reading=lambda values: values
    )
    told = Threshold(Criteria(), unlike, [0.0 * ROWS[:, None] * np.ones(3)])  # type: ignore[arg-type]
    assert told.most_on(candidate((9.0, 5.0, 1.0))) == 2
    assert told.most_on(candidate((9.0, 1.0, 1.0))) == 3


def test_beside_flexible_columns_of_what_an_earlier_law_leaves_evidence_alone_speaks() -> None:
    # may leave 1,125 nats of any shape
    earlier = candidate((0.0, 8.0, 0.0), gain=9000.0, kind="balancer")

    def beside(gain: float, left: float, known: Any = "angle") -> bool:
        return accepts(
            candidate(gain=gain),
            earlier,
            added=lambda one: np.zeros(3),
            leftover=lambda one: known,
            gain_beside=lambda one, columns: left if columns == "angle" else np.nan,
        )

    assert beside(200.0, 22.1)
    assert not beside(200.0, 21.9)
    assert not beside(200.0, 100.0, known=None)
    assert not beside(22.0, 100.0)  # what hardly counts by itself is not asked


def test_an_effect_is_large_against_what_is_left_and_against_the_joint() -> None:
    assert accepts(candidate((0.0, 2.01, 0.0)))
    assert not accepts(candidate((0.0, 1.99, 0.0)))
    heavy = threshold(measured=300.0)  # one hundredth of it is 3 Nm, two are 6
    assert accepts(candidate((0.0, 3.01, 0.0)), judge=heavy)
    assert not accepts(candidate((0.0, 2.99, 0.0)), judge=heavy)
    # one joint is enough
    assert accepts(candidate((0.1, 0.1, 3.01)), judge=heavy)
    # by departures from its law, not by the law itself: twice the size
    beside = {"judge": heavy, "by_law": 25.0}
    assert accepts(candidate((0.0, 6.01, 0.0)), **beside)
    assert not accepts(candidate((0.0, 5.99, 0.0)), **beside)
    assert accepts(candidate((0.0, 3.01, 0.0)), judge=heavy, by_law=25.1)
    # play is mostly quicker than what is compared: against what is left alone
    assert accepts(candidate((0.0, 2.01, 0.0), rattles=True), judge=heavy)
    assert not accepts(candidate((0.0, 1.99, 0.0), rattles=True), judge=heavy)
    # and so is what comes late where friction turns over: half the size
    heavier = threshold(measured=900.0)
    assert accepts(candidate((0.0, 4.51, 0.0), chain="clock"), judge=heavier)
    assert not accepts(candidate((0.0, 4.49, 0.0), chain="clock"), judge=heavier)
    # a spring of axis 4 with 970 nats, 2.9 % of its torque, has 0.8 % below 10 Hz; one of axis 6
    # with 1,157 nats, 2.4 % of its torque, 0.4 %: its samples count
    for size, sampled, large in ((4.51, 0.0, 1), (4.49, 0.0, 0), (4.4, 9.01, 1), (4.4, 8.99, 0)):
        spring = candidate((0.0, size, 0.0), devices=frozenset({"transmission"}))
        given = {"judge": heavier, "sampled_rms": constant(np.array([0.0, sampled, 0.0]))}
        assert accepts(spring, **given) == large
        assert not accepts(candidate((0.0, size, 0.0)), **given)


def test_what_an_identification_of_the_arm_leaves_is_no_news() -> None:
    """Of 16 runs of an unchanged arm, of which the model misses half the torque of three axes,
    eleven got a name."""
    judge = threshold()
    judge.usual = np.array([0.0, 5.0, 9.0])
    assert not accepts(candidate((0.0, 5.0, 0.0)), judge=judge)
    assert accepts(candidate((0.0, 5.1, 0.0)), judge=judge)
    # on one joint that it acts on it has to be more
    assert accepts(candidate((4.0, 4.0, 4.0)), judge=judge)


def test_a_second_that_says_it_nearly_alone_is_no_law() -> None:
    def with_share(elsewhere: float, beyond: float = 1.0, **given: Any) -> bool:
        return accepts(
            candidate(**given),
            elsewhere=lambda one: elsewhere,
            share_beyond_base=lambda one: beyond,
        )

    assert with_share(0.4)
    assert not with_share(0.39)
    # a force that comes and goes, a swing, and what the base could take as well
    assert with_share(0.0, stops=(3.0,))
    assert not with_share(0.0, stops=(OPEN_END_S,))
    assert with_share(0.0, devices=frozenset({"spring"}))
    assert with_share(0.0, beyond=0.0099)
    assert not with_share(0.0, beyond=0.01)


def test_what_an_earlier_law_of_another_shape_leaves_is_nothing_new() -> None:
    """It takes half the earlier torque off, or gains a quarter of what the earlier one gained on
    that joint, under the same noise."""
    earlier = candidate((0.0, 8.0, 0.0), gain=900.0, kind="balancer")

    def beside(added: float, gain: float = 100.0, before: Any = earlier, **given: Any) -> bool:
        return accepts(
            candidate(gain=gain, **given), before, added=lambda one: np.array([0.0, added, 0.0])
        )

    assert beside(4.01)
    assert not beside(4.0)
    # half of 900 is on joint 2
    assert beside(0.0, gain=112.6)
    assert not beside(0.0, gain=112.4)
    assert not accepts(candidate(gain=112.4), earlier, gain=1e4, added=lambda one: np.zeros(3))
    # the same effect once more: all of its share, unless a joint may have several
    twice = candidate((0.0, 8.0, 0.0), gain=900.0)
    assert not beside(9.0, gain=449.9, before=twice)
    assert beside(0.0, gain=450.1, before=twice)
    assert beside(4.01, before=twice, repeats=True)
    # the swing of one transmission: only the evidence speaks, and half of all of it
    swing = frozenset({"spring"})
    springs = candidate((0.0, 8.0, 0.0), gain=900.0, devices=swing)
    assert not beside(9.0, gain=449.9, before=springs, devices=swing)
    assert beside(0.0, gain=450.1, before=springs, devices=swing)


def test_what_the_base_need_not_hide_any_longer_is_as_large_as_its_own_torque() -> None:
    """Grease of axis 1 that had doubled was told as a number, viscous friction moved by 26 standard
    deviations, because a springy axis 5 that shakes axis 1 might have left as much evidence."""
    earlier = candidate((0.0, 8.0, 0.0), gain=900.0, kind="elastic_joint")

    def beside(size: float, relieved: bool, added: float = 0.0, **given: Any) -> bool:
        return accepts(
            candidate((0.0, size, 0.0), **given),
            earlier,
            added=lambda one: np.array([0.0, added, 0.0]),
            relieves_base=lambda one: relieved,
        )

    assert beside(4.1, True)
    assert not beside(4.1, False)
    assert not beside(3.9, True)
    # flexible laws have taken in whatever the base could hide
    assert not beside(4.1, True, added=3.9, known=False)
    assert beside(4.1, True, added=4.1, known=False)


def test_a_law_without_a_name_is_new_by_its_size_alone() -> None:
    unnamed = candidate(known=False)
    earlier = candidate((0.0, 2.0, 0.0), gain=0.0)

    def beside(added: float, before: Any) -> bool:
        return accepts(unnamed, before, gain=1e4, added=lambda one: np.array([0.0, added, 0.0]))

    assert beside(2.01, earlier)
    assert not beside(1.99, earlier)
    assert not beside(3.99, candidate((0.0, 8.0, 0.0), gain=0.0))
    # a flexible law has taken in whatever the base could hide: beside it evidence says nothing
    assert not accepts(candidate(), candidate((0.0, 20.0, 0.0), gain=0.0, known=False), gain=1e4)
    # all earlier ones count
    assert not accepts(
        unnamed, earlier, candidate((0.0, 20.0, 0.0)), added=lambda one: np.array([0.0, 9.9, 0.0])
    )


def test_a_moment_has_one_cause() -> None:
    first = candidate(gain=900.0, begins=(12.0,), kind="balancer")
    assert not accepts(candidate(gain=60.0, begins=(12.999,)), first)
    assert accepts(candidate(gain=60.0, begins=(13.0,)), first)
    assert of_one_moment(candidate(gain=60.0, begins=(11.001,)), [first])
    assert not of_one_moment(candidate(gain=900.0, begins=(12.5,)), [first])


def test_how_much_evidence_each_kind_of_explanation_needs() -> None:
    judge = threshold()

    def least(of: Any, *chosen: Any, beyond: float = 1.0, **given: Any) -> float:
        beside = comparison(share_beyond_base=lambda one: beyond, chosen=chosen)
        return judge.least_gain(beside, alternative(of, **given))

    one = candidate()
    assert least(one) == 22.0
    assert least(candidate(known=False)) == 25.0
    assert least(one, beyond=0.01) == 11.0
    # a law of a shape of its own is no number of the robot: it must count by that shape
    shaped = candidate(has_own_shape=True)
    assert least(shaped, beyond=0.01, by_law=21.9) == 22.0
    assert least(shaped, beyond=0.01, by_law=22.1) == 11.0
    assert least(one, beyond=0.01, by_law=0.0) == 11.0
    assert least(one, beyond=0.0101) == 22.0
    assert least(candidate(expected=((0.0, 1.0),)), beyond=0.01) == 8.0
    # another day's friction; not another load, whose spread nobody states
    for kind, bar in (("coulomb_change", 6.0), ("viscous_change", 6.0), ("link_inertia", 11.0)):
        assert least(candidate(kind=kind), beyond=0.01) == bar
        assert least(candidate(kind=kind)) == 22.0
    # beside an earlier law the base is bent by a quarter of what that has gained on the joint
    assert least(one, candidate(gain=40.0), beyond=0.01) == 11.0 + 0.25 * 20.0
    assert least(one, candidate(gain=40.0), candidate(gain=8.0), beyond=0.01) == 16.0
    assert least(one, candidate(gain=400.0), beyond=0.01) == 22.0
    assert least(candidate((0.0, 0.0, 5.0)), candidate(gain=40.0), beyond=0.01) == 11.0 + 2.5
    # play that the neighbours feel, whatever the base could say of it
    assert least(one, candidate(gain=400.0), rattles=True) == 4.0


def test_play_that_the_neighbours_feel_may_be_small() -> None:
    """What of it is quick stands in no column; a torque that must be cancelled is refused all the
    same, and so is a second cause of one moment."""
    small = candidate((0.0, 0.1, 0.0))
    assert accepts(small, rattles=True)
    assert not accepts(small)
    assert not accepts(candidate((0.0, 30.1, 0.0)), rattles=True)
    at_once = candidate((0.0, 0.1, 0.0), gain=60.0, begins=(12.5,))
    assert not accepts(at_once, candidate(gain=900.0, begins=(12.0,)), rattles=True)
