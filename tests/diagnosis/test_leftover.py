"""What an earlier law may leave: flexible functions of its own signal, as large as its share."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from irb2400_ctrl.diagnosis.comparison.comparison import StepComparison
from irb2400_ctrl.diagnosis.estimation.candidate import Candidate
from irb2400_ctrl.diagnosis.estimation.evidence import Score
from irb2400_ctrl.diagnosis.preparation.noise import NoiseModel
from irb2400_ctrl.diagnosis.regressors.bases import RegressorColumns


def leftover(names: tuple[str, ...], known: dict[str, np.ndarray], **given: Any) -> Any:
    """Of a law of rms 2 Nm on joint 2 of two, a fifth of which it may leave."""
    comparison: Any = StepComparison.__new__(StepComparison)
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


@pytest.mark.parametrize(("beside", "more"), [(0.15, True), (0.0, False)])
def test_a_name_with_what_its_law_may_leave_says_more_where_it_left_something(
    beside: float, more: bool
) -> None:
    """A law of the angle of rms 0.7 Nm, and 0.15 of its bend beside it."""
    rng = np.random.default_rng(4)
    angle = np.sin(np.arange(600) / 23.0)
    bend = 4 * angle**3 - 3 * angle
    y = (angle + beside * bend + rng.normal(0, 0.02, 600))[:, None]
    law = RegressorColumns((0,), angle[:, None, None])
    prior = SimpleNamespace(leftover=("angle",), discrepancy_share=0.22)
    effect = SimpleNamespace(prior=prior, windows_s=(), states=())
    candidate = Candidate(
        "cable_spring", 1, "", (), (effect,), law, None,  # type: ignore[arg-type]
        Score(0.0, np.ones(1), np.zeros(0)),
    )  # fmt: skip
    scan: Any = SimpleNamespace(
        motion=SimpleNamespace(n=1),
        non_parametric={0: [SimpleNamespace(name="angle", columns=bend[:, None])]},
    )
    every = np.ones((600, 1), dtype=bool)
    noise = NoiseModel(every, ~every, np.zeros(1), 0.04)
    comparison = StepComparison(scan, noise, y, np.full((600, 1, 1), 0.1))
    alone = comparison.compared(candidate)
    gained = comparison.with_its_leftover(alone) - alone.evidence
    assert (gained > 50.0) if more else (-10.0 < gained < 1.0)
    # of a law of which nothing is known it is what it says alone
    effect.prior.leftover = ()
    assert comparison.with_its_leftover(alone) == alone.evidence
