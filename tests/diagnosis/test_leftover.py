"""What an earlier law may leave: flexible functions of its own signal, as large as its share."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from irb2400_ctrl.diagnosis.comparison.comparison import Comparison


def leftover(names: tuple[str, ...], known: dict[str, np.ndarray], **given: Any) -> Any:
    """Of a law of rms 2 Nm on joint 2 of two, a fifth of which it may leave."""
    comparison: Any = Comparison.__new__(Comparison)
    comparison.n = 2
    comparison.y = np.zeros((4, 2))
    laws = [SimpleNamespace(name=name, columns=columns) for name, columns in known.items()]
    comparison.scan = SimpleNamespace(non_parametric={1: laws})
    effect = SimpleNamespace(prior=SimpleNamespace(leftover=names))
    usual = {"effects": (effect,), "joint": 2, "begins": (), "discrepancy_share": 0.2}
    torque = np.array([[0.0, 2.0], [0.0, -2.0], [0.0, 2.0], [0.0, -2.0]])
    earlier = SimpleNamespace(**(usual | given), torque=lambda n: torque)
    return comparison.leftover(earlier)


def test_it_is_as_large_as_the_share_on_its_joint_alone() -> None:
    angle = np.array([[1.0, 0.0], [0.0, 3.0], [1.0, 0.0], [0.0, 3.0]])
    found = leftover(("angle",), {"angle": angle, "speed": np.ones((4, 3))})
    assert found.shape == (4, 2, 2)
    np.testing.assert_array_equal(found[:, 0], 0.0)
    assert np.sqrt(np.mean(found[:, 1] ** 2, axis=0).sum()) == pytest.approx(0.2 * 2.0)


def test_where_nothing_is_known_there_is_none() -> None:
    known = {"angle": np.ones((4, 2))}
    assert leftover((), known) is None
    assert leftover(("angle",), known, joint=None) is None
    assert leftover(("angle",), known, begins=(3.0,)) is None
    # a joint that rests has no law of its angle
    assert leftover(("angle",), {"load": np.ones((4, 2))}) is None
