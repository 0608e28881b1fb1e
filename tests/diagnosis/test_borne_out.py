"""What bears a name out: other joints that its effect moves, and the numbers as they were given."""

from __future__ import annotations

from types import SimpleNamespace

from diagnosis.test_acceptance import fitted, judged

from irb2400_ctrl.effects import LIBRARY

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
