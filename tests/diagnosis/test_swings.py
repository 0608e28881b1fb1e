"""A transmission that swings is held against the samples, as far as these can tell."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from diagnosis.test_acceptance import judged

from irb2400_ctrl.effects import LIBRARY


def test_a_swing_that_is_more_wrong_sample_by_sample_than_right_below_it_is_none() -> None:
    """Play of a wrist (652 sigma) was a spring: 612 nats in what is compared, and 7,955 against it
    sample by sample; of true springs it is 255 to 2,700 for it, 2,370 against 2,550 at worst."""
    offset = LIBRARY["torque_offset"].of(2, offset_Nm=3.0)

    def swings(rattles: bool = False) -> Any:
        return SimpleNamespace(
            known=True, devices=frozenset({"spring"}), effects=(offset,), joint=2, rattles=rattles
        )

    assert judged(swings(), [-9e3, 4e3, 0.0], worth=5100.0)
    assert not judged(swings(), [-9e3, 4e3, 0.0], worth=4900.0)
    assert judged(swings(), [0.0, 9.0, 0.0], worth=-8.0)
    assert not judged(swings(), [0.0, 5.0, 0.0], worth=-8.0)
    # of play nothing else is asked
    assert judged(swings(rattles=True), [-9.0, -9.0, -9.0], worth=-9.0)
