"""What a reference leaves unexplained itself has not changed."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from irb2400_ctrl.diagnosis import Number
from irb2400_ctrl.identification.another_day.reference_error import (
    has_changed,
    simplest,
    worse_joints,
)


def changed(place: str) -> Number:
    """A number that the reference has otherwise."""
    return Number("changed", place, "number", 1.0, 2.0, 0.1, 5.0)


def test_what_the_reference_leaves_itself_has_not_changed() -> None:
    floor = np.ones(6)
    error = np.array([2.0, 2.0, 1.0, 4.0, 1.0, 1.0])
    unseen = np.array([2.0, 1.2, 1.0, 2.0, 1.0, 1.0])
    before: Any = SimpleNamespace(least_floor=floor)
    worse = worse_joints(error, floor, before, unseen)
    assert worse.tolist() == [False, True, False, True, False, False]
    assert has_changed(changed("joint 4"), worse)
    assert not has_changed(changed("joint 1"), worse)
    assert has_changed(changed("link 1"), worse)


@pytest.mark.parametrize(("needed", "said"), [(0, 0), (1, 1), (2, 3), (3, 3)])
def test_the_fewest_changes_that_explain_the_log_are_taken(needed: int, said: int) -> None:
    """Two explanations less than `needed` leave more than the reference does.

    Of a TX40 whose readings of joint 1 were a quarter too large all that was found was left out:
    the floor had been read from what that left.
    """
    before = SimpleNamespace(least_floor=np.ones(6))
    unseen = np.full(6, 1.2)

    def few(count: int) -> Any:
        left = np.full(6, 1.1 if count >= needed else 3.0)
        compared = SimpleNamespace(error_after=SimpleNamespace(rmse=left))
        return Tried(count, compared)

    found: Any = few(said)
    found.least_floor = np.ones(6)
    taken: Any = simplest(found, few, cast(Any, before), unseen)
    assert len(taken.findings) == needed
    assert len(taken.weak) == (needed < said)


@dataclass
class Tried:
    """A diagnosis of so many explanations."""

    count: int
    identification: Any
    least_floor: Any = None
    unexplained: tuple[()] = ()
    weak: tuple[str, ...] = ()

    @property
    def noise_floor(self) -> Any:
        """All that is left passes for it."""
        return self.identification.error_after.rmse

    @property
    def findings(self) -> tuple[int, ...]:
        return tuple(range(self.count))
