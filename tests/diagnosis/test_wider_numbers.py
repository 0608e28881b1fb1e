"""Numbers of the robot further off than stated, as a rival of the best name."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis.comparison import wider_numbers as module
from irb2400_ctrl.diagnosis.comparison.criteria import Criteria
from irb2400_ctrl.diagnosis.comparison.wider_numbers import but_for_a_joint, rather_wider, ways_of
from irb2400_ctrl.diagnosis.estimation.fit import Fitter


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

    monkeypatch.setattr(module, "StepComparison", compared)
    fitter: Any = SimpleNamespace(own=2, friction=0, noise=None)
    stated = SimpleNamespace(log_evidence=gains[1.0])
    beside: Any = SimpleNamespace(y=None, Z=np.ones((1, 1, 3)), base=stated)
    best: Any = None if step is None else SimpleNamespace(gain=step)
    scan: Any = None
    found = rather_wider(scan, fitter, beside, best, Criteria())
    assert (found is None) == (wider is None)
    assert found is None or found.tolist() == [wider, wider]
    np.testing.assert_array_equal(beside.Z, np.ones((1, 1, 3)))


@pytest.mark.parametrize("known", [False, True])
def test_friction_alone_may_be_further_off(known: bool) -> None:
    """Of an arm with friction a fifth off a load of 2.5 kg was lost: all numbers were said to be
    four times as far off, and impossible inertias of the last links took it in. What an
    identification knows of friction it knows together with the bodies."""
    fitter: Any = Fitter.__new__(Fitter)
    fitter.own = 5
    fitter.plain = "numbers"
    fitter.robot = SimpleNamespace(n=1, identified="covariance" if known else None)
    ways = [way.tolist() for way in ways_of(fitter, (2.0, 4.0))]
    assert ways[:2] == [[2.0] * 5, [4.0] * 5]
    assert ways[2:] == ([] if known else [[1.0, 1.0, w, w, w] for w in (2.0, 4.0)])


@pytest.mark.parametrize(
    ("z", "wider"),
    [
        # friction of three joints, dry, viscous and static, behind two numbers of bodies
        ((0.5, -0.8, 5.0, -5.0, 4.0, 0.3, 0.2, 0.1, 0.4, -0.6, 0.3), "friction"),
        ((5.0, -6.0, 0.4, -0.2, 0.3, 0.3, 0.2, 0.1, 0.4, -0.6, 0.3), "all"),
        # one joint's alone is a name, or hides what has none
        ((0.5, -0.8, 9.0, -0.2, 0.3, 0.3, 0.2, 0.1, 0.4, -0.6, 0.3), None),
    ],
)
def test_that_which_explains_most_is_taken(
    z: tuple[float, ...], wider: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    rng = np.random.default_rng(3)
    Z = rng.normal(size=(400, 1, 11))
    y = Z @ np.array(z) + 0.1 * rng.normal(size=(400, 1))

    class OfSomeBase:
        def __init__(self, scan: Any, noise: Any, y: Any, Z: Any) -> None:
            covariance = 0.01 * np.eye(400) + Z[:, 0] @ Z[:, 0].T
            sign, size = np.linalg.slogdet(covariance)
            assert sign > 0
            nats = -0.5 * (size + y[:, 0] @ np.linalg.solve(covariance, y[:, 0]))
            self.base = SimpleNamespace(log_evidence=nats)

    fitter: Any = SimpleNamespace(own=11, friction=9, noise=None)
    monkeypatch.setattr(module, "StepComparison", OfSomeBase)
    beside: Any = OfSomeBase(None, None, y, Z)
    beside.y = y
    beside.Z = Z
    scan: Any = None
    found = rather_wider(scan, fitter, beside, None, Criteria(wider=(2.0, 4.0), gain=2.0))
    told = None if found is None else {1.0: "friction"}.get(found[0], "all")
    assert told == wider
    assert found is None or found[-1] > 1.0


def test_without_the_friction_of_a_joint() -> None:
    fitter: Any = SimpleNamespace(own=8, friction=6)
    friction = np.array([1.0, 1.0, *[4.0] * 6])
    bodies = np.full(8, 4.0)
    assert [one.tolist() for one in but_for_a_joint(fitter, friction)] == [
        [1.0, 1.0, 1.0, 4.0, 1.0, 4.0, 1.0, 4.0],
        [1.0, 1.0, 4.0, 1.0, 4.0, 1.0, 4.0, 1.0],
    ]
    assert but_for_a_joint(fitter, bodies) == []
    fitter.friction = 0
    assert but_for_a_joint(fitter, friction) == []
