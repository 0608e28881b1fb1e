"""Numbers of the robot further off than stated, as a rival of the best name."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from diagnosis.test_selection_steps import bare

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.comparison import selection as module


@pytest.mark.parametrize(
    ("more", "step", "wider"),
    # what several effects say together is twice the best of them, and it pays as a name does, 8
    # nats; without a step what any needs: 22 nats
    [
        ((68.1, 0.0), 30.0, 2.0),
        ((67.9, 0.0), 30.0, None),
        ((22.1, 0.0), None, 2.0),
        ((21.9, 0.0), None, None),
        # bodies that are another arm's: the better of both
        ((60.0, 70.0), 30.0, 4.0),
        ((70.0, 60.0), 30.0, 2.0),
    ],
)
def test_wider_numbers_of_the_robot_must_say_more_than_two_best_steps(
    more: tuple[float, float],
    step: float | None,
    wider: float | None,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    gains = {1.0: 0.0, 2.0: more[0], 4.0: more[1]}

    def compared(scan: Any, reversal: Any, y: Any, Z: Array) -> Any:
        # the robot's own numbers alone; what is fitted stays as it is
        times = float(Z[0, 0, 0])
        np.testing.assert_array_equal(Z, [[[times, times, 1.0]]])
        return SimpleNamespace(base=SimpleNamespace(log_evidence=gains[times]))

    monkeypatch.setattr(module, "Comparison", compared)
    selection = bare(scan=None, fitter=SimpleNamespace(own=2, noise=None))
    stated = SimpleNamespace(log_evidence=gains[1.0])
    beside: Any = SimpleNamespace(y=None, Z=np.ones((1, 1, 3)), base=stated)
    best: Any = None if step is None else SimpleNamespace(gain=step)
    assert selection._rather_wider(best, beside) == wider
    np.testing.assert_array_equal(beside.Z, np.ones((1, 1, 3)))
