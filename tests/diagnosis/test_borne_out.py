"""What bears a name out: other joints that its effect moves, and the numbers as they were given."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from diagnosis.test_acceptance import fitted, judged

from irb2400_ctrl.diagnosis.comparison import possible
from irb2400_ctrl.diagnosis.comparison.possible import in_time
from irb2400_ctrl.diagnosis.estimation.candidate import most_of
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.robot import load_robot

NAMED = {"known": True, "everywhere": False, "devices": frozenset(), "joint": 2}


def test_a_name_says_more_than_the_numbers_as_they_were_given() -> None:
    """The fit had made them worse: on the first day after its reference, on another motion, an
    unchanged arm had "friction that does not grow with speed"."""
    offset = LIBRARY["torque_offset"].of(2, offset_Nm=3.0)
    name = SimpleNamespace(**NAMED, effects=(offset,))
    assert judged(name, [0.0, 5.0, -1.0], over_given=0.1)
    assert not judged(name, [0.0, 5.0, -1.0], over_given=-0.1)


def test_a_wrong_zero_is_judged_on_all_joints() -> None:
    """Of axis 2, 50 standard deviations beside a ripple of that axis, it was refused for a nat
    there, where the other joints gained 146."""
    effect = LIBRARY["encoder_zero"].of(2, zero_rad=0.04)
    zero = SimpleNamespace(**NAMED, effects=(effect,))
    shown = fitted(effect, 0.001)
    assert judged(zero, [68.0, -1.0, 36.0], fit=shown)
    assert not judged(zero, [0.5, -1.0, 0.4], fit=shown)


@pytest.mark.parametrize(("delay", "borne"), [(-0.028, False), (-0.0114, True), (0.004, True)])
def test_no_torque_of_one_joint_is_told_before_it_was_there(delay: float, borne: bool) -> None:
    """Two were, 28 and 33 ms, on sound arms; where the file states 12 ms, they may have gone."""
    stated = LIBRARY["time_delay"].of(5, delay_s=0.012)
    robot = load_robot("irb2400").with_effects(stated)
    assert in_time(robot, LIBRARY["time_delay"].of(5, delay_s=delay)) == borne
    bare = load_robot("irb2400")
    assert in_time(bare, LIBRARY["time_delay"].of(5, delay_s=delay)) == (delay > 0.0)
    assert in_time(bare, LIBRARY["time_delay"].of(None, delay_s=delay))


def test_what_was_told_before_it_was_there_is_not_borne_out(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    offset = LIBRARY["torque_offset"].of(2, offset_Nm=3.0)
    name: Any = SimpleNamespace(effects=(offset,), **NAMED)
    for sound in (True, False):
        monkeypatch.setattr(possible, "in_time", lambda robot, effect, sound=sound: sound)
        assert judged(name, [0.0, 5.0, 0.0]) == sound


def test_of_joints_that_rest_nothing_is_asked() -> None:
    """Three of seven joints moved, and each rotor had to come by itself."""
    known = np.ones((50, 7), dtype=bool)
    motion: Any = SimpleNamespace(row_known=known)
    assert most_of(motion) == 4
    known[:, 2:6] = False
    assert most_of(motion) == 2


def test_beside_a_swing_the_numbers_as_given_are_no_rival() -> None:
    """A ripple of 730 nats fell beside an elastic joint of 24, whose swing no file tells: a delay
    of 36 ms came in its place."""
    spring = LIBRARY["elastic_joint"].of(2, stiffness_Nm_rad=400.0, damping_ratio=0.05)
    offset = LIBRARY["torque_offset"].of(2, offset_Nm=3.0)

    def candidate(effect: Any, *devices: Any) -> Any:
        return SimpleNamespace(
            known=True,
            everywhere=False,
            devices=frozenset(devices),
            effects=(effect,),
            joint=effect.joint,
        )

    own = candidate(offset)
    assert not judged(own, [0.0, 5.0, 0.0], over_given=-1.0)
    swings = candidate(spring, ("transmission", 2))
    assert judged(own, [0.0, 5.0, 0.0], over_given=-1.0, beside=swings)
    elsewhere = candidate(spring.model_copy(update={"joint": 3}), ("transmission", 3))
    assert not judged(own, [0.0, 5.0, 0.0], over_given=-1.0, beside=elsewhere)


@pytest.mark.parametrize(
    ("told", "worth", "borne"),
    # of two true springs, and of an arm on the day after its reference
    [(200.0, 428.0, True), (-133.0, 1326.0, True), (-297.0, 356.0, False), (-177.0, 356.0, True)],
)
def test_a_spring_is_right_sample_by_sample(told: float, worth: float, borne: bool) -> None:
    """An unchanged arm had a spring in joint 2, with which its error grew by an eighth."""
    spring = LIBRARY["elastic_joint"].of(2, stiffness_Nm_rad=400.0, damping_ratio=0.05)
    swings = SimpleNamespace(
        known=True,
        everywhere=False,
        devices=frozenset({("transmission", 2)}),
        effects=(spring,),
        joint=2,
        rattles=False,
    )
    assert judged(swings, [0.0, told, 0.0], worth=worth, fit=fitted(spring, 1.0)) == borne
