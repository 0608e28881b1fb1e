"""Laws that another one passes for are held beside it, plausible by themselves or not."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from diagnosis.plain_motion import BASES, motion
from diagnosis.test_criteria import accepts, candidate

from irb2400_ctrl.diagnosis.comparison import ground as module
from irb2400_ctrl.diagnosis.comparison.confidence import alternatives, confidence
from irb2400_ctrl.diagnosis.comparison.ground import Ground
from irb2400_ctrl.diagnosis.comparison.passing import of_the_clock, springs
from irb2400_ctrl.diagnosis.comparison.scan import Scan
from irb2400_ctrl.diagnosis.comparison.step import Step
from irb2400_ctrl.diagnosis.estimation.evidence import Problem
from irb2400_ctrl.diagnosis.preparation.contacts import Contacts
from irb2400_ctrl.diagnosis.preparation.noise import NoiseModel
from irb2400_ctrl.effects import LIBRARY


def test_springs_are_told_though_they_swing_the_wrong_way() -> None:
    m = motion()
    real = Scan(BASES, m, np.sin(3.0 * m.time)[:, None] * np.ones((1, 6)), Contacts())
    grid, _ = real.laws["elastic_joint", 2]
    law = real.member("elastic_joint", 2, grid[len(grid) // 2])[0]
    rows = law.torque(np.array([-1.0, 0.2]), 6)
    rows += 1e-3 * np.random.default_rng(4).normal(size=rows.shape)
    noise = NoiseModel(m.row_known, ~m.row_known, np.zeros(6), 0.04, least=0.1).white(rows)
    problem = Problem(rows, np.full((*rows.shape, 1), 1e-3), noise)
    found = springs(real, problem, 2)
    assert len(found) == len({tuple(c.effects[0].nonlinear.values()) for c in found}) > 1
    assert {(c.kind, c.joint) for c in found} == {("elastic_joint", 2)}
    assert any(c.effects[0].unlikely for c in found)
    assert springs(SimpleNamespace(laws={}), problem, 2) == []  # type: ignore[arg-type]


@pytest.mark.parametrize(("early", "soft"), [(4e-3, 0.0), (0.0, 1.0), (4e-3, 1.0)])
def test_torques_told_a_part_of_a_sample_early_are_no_spring(early: float, soft: float) -> None:
    """On a simulated arm without one, in a quick motion, a spring of axis 1 was told at 0.75 with
    61 nats: all torques were told half a millisecond early."""
    m = motion()
    real = Scan(BASES, m, np.sin(3.0 * m.time)[:, None] * np.ones((1, 6)), Contacts())
    skew = real.laws["time_delay", None][1][0].values
    grid, _ = real.laws["elastic_joint", 1]
    law = real.member("elastic_joint", 1, grid[len(grid) // 2])[0]
    rows = -early * skew[:, :, 0] + soft * law.torque(np.array([0.5, 0.1]), 6)
    rows += 0.02 * np.random.default_rng(4).normal(size=rows.shape)
    noise = NoiseModel(m.row_known, ~m.row_known, np.zeros(6), 0.04, least=0.02).white(rows)
    base = np.full((*rows.shape, 1), 1e-3)
    score = Problem(rows, base, noise).score(law)
    spring: Any = SimpleNamespace(devices=frozenset({"spring"}))

    def gain_beside(one: Any, columns: np.ndarray) -> float:
        return Problem(rows, np.concatenate([base, columns], axis=2), noise).score(law).gain

    beside: Any = SimpleNamespace(scan=real, gain_beside=gain_beside)
    assert score.gain > 100.0
    assert of_the_clock(beside, spring, 22.0) == (not soft)
    assert not of_the_clock(beside, SimpleNamespace(devices=frozenset()), 22.0)  # type: ignore[arg-type]


def test_a_spring_that_the_clock_says_is_not_accepted() -> None:
    swing = candidate((0.0, 8.0, 0.0), devices=frozenset({"spring"}))
    assert accepts(swing, gain_beside=lambda one, columns: 22.0)
    assert not accepts(swing, gain_beside=lambda one, columns: 21.9)


def test_an_axis_too_light_for_any_stiffness_of_the_grid_has_no_spring_beside_its_play() -> None:
    """Play on the last axis of an arm of 200 kg ended in an IndexError."""
    light: Any = SimpleNamespace(laws={("elastic_joint", 6): ([], [])})
    light.promising = lambda problem, *asked: Scan.promising(light, problem, *asked)
    nothing: Any = None
    assert springs(light, nothing, 6) == []


@pytest.mark.parametrize(
    ("law", "beside"),
    [
        ({"kind": "transmission_backlash", "joint": 1, "rattles": True}, [9.0]),
        ({"kind": "cable_spring", "joint": 1, "rattles": False}, [4.0]),
        ({"kind": "torque_gain", "joint": 1, "rattles": False}, []),
        ({"kind": "payload", "joint": None, "rattles": False}, []),
    ],
)
def test_the_best_of_them_stands_beside_a_law(
    monkeypatch: pytest.MonkeyPatch, law: dict[str, Any], beside: list[float]
) -> None:
    monkeypatch.setattr(module, "springs", lambda scan, problem, joint: [3.0, 9.0, 5.0])
    monkeypatch.setattr(module, "slow_ripple", lambda scan, problem, joint: 4.0)
    ground: Any = Ground.__new__(Ground)
    ground.comparison = SimpleNamespace(scan=None, start=None, gain=lambda one: one)
    ground._told = lambda candidate: candidate
    assert ground.passing(SimpleNamespace(**law)) == beside


@pytest.mark.parametrize(("spring", "sure"), [(278.0, 0.48), (20.0, 0.92)])
def test_play_that_a_spring_says_more_than_is_not_sure(spring: float, sure: float) -> None:
    """Stiff springs of axis 1 were its play at 0.93: their swing was none by itself, and said 2.7
    times as much."""
    play: Any = SimpleNamespace(
        kind="transmission_backlash",
        joint=1,
        known=True,
        effects=(LIBRARY["transmission_backlash"].of(1, gap_rad=1e-3),),
    )
    other: Any = SimpleNamespace(kind="elastic_joint", joint=1, known=True, effects=())
    own: Any = SimpleNamespace(candidate=play, evidence=102.0)
    step = Step(play, 102.0, (own, SimpleNamespace(candidate=other, evidence=spring)))  # type: ignore[arg-type]
    assert confidence(step) == pytest.approx(sure, abs=0.01)
    assert ("elastic_joint" in alternatives(step)) == (spring > 100.0)
