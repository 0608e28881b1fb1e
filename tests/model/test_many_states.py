"""Many states at once: the same numbers as one by one, however many there are."""

from __future__ import annotations

import gc

import numpy as np
import pytest

import irb2400_ctrl as irb
from irb2400_ctrl.model import numeric


@pytest.mark.parametrize("count", [0, 1, 3, 1023, 1024, 1025, 2500])
def test_every_state_is_evaluated_once(count: int) -> None:
    model = irb.Model(irb.load_robot("irb2400"))
    rng = np.random.default_rng(count)
    q, qd, qdd = rng.uniform(-1.0, 1.0, (3, count, 6))
    Y = model.regressor(q, qd, qdd)
    assert Y.shape == (count, 6, 60)
    for k in {0, count // 3, 1023, 1024, count - 1} & set(range(count)):
        assert np.array_equal(Y[k], model.regressor(q[k], qd[k], qdd[k]))


def test_parts_cover_every_row_once() -> None:
    for count in (0, 1, 7, 1024, 1025, 5000):
        rows = [row for first, many in numeric._parts(count) for row in range(first, first + many)]
        assert rows == list(range(count))


def test_maps_go_with_their_function() -> None:
    gc.collect()
    before = len(numeric._MAPS)
    model = irb.Model(irb.load_robot("puma560"))
    model.gravity(np.zeros((5, 6)))
    assert len(numeric._MAPS) > before
    del model
    gc.collect()
    assert len(numeric._MAPS) == before
