"""A link with play bounces as its load changes sides: its neighbours at the wrist feel it, quicker
than any column of a law."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from diagnosis.test_names import ROBOT, names
from mujoco_plant.suites import suite

import irb2400_ctrl as irb
from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.diagnosis.comparison.at_load_changes import LEAST, AtLoadChanges
from irb2400_ctrl.diagnosis.comparison.comparison import Alternative
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.measurement import Log

STEP = 0.004
TIME = np.arange(0.0, 20.0, STEP)
MODEL = irb.Model(ROBOT)
RATES = np.array([0.9, 1.1, 1.3, 3.1, 3.7, 4.3])
PHASE = np.arange(6.0)
Q = np.array([0.1, 0.2, -0.1, 0.0, 0.8, -0.2]) + 0.3 * np.sin(RATES * TIME[:, None] + PHASE)
QD = 0.3 * RATES * np.cos(RATES * TIME[:, None] + PHASE)
QDD = -0.3 * RATES**2 * np.sin(RATES * TIME[:, None] + PHASE)
LOAD = np.asarray(MODEL.inverse_dynamics(Q, QD, QDD, friction=False))
NOISE = np.random.default_rng(8).normal(scale=0.3, size=Q.shape)


def changes(joint: int) -> np.ndarray:
    """Samples at which the torque of the rigid arm on a joint (from 0) changes its sign."""
    return np.flatnonzero(np.diff(np.sign(LOAD[:, joint])) != 0) + 1


def bounces(joint: int, moments: Any, size: float = 25.0) -> np.ndarray:
    """What a link that swings out at 30 Hz in these moments asks of the motors [Nm]."""
    acceleration = np.zeros(len(TIME))
    for k in moments:
        t = TIME[k:] - TIME[k]
        acceleration[k:] += size * np.exp(-t / 0.025) * np.cos(2 * np.pi * 30.0 * t)
    coupled = np.array([MODEL.mass_matrix(q)[:, joint] for q in Q])
    return coupled * acceleration[:, None]


def heard(left: np.ndarray, **changed: Any) -> AtLoadChanges:
    given: dict[str, Any] = {
        "q": Q, "qd": QD, "qdd": QDD, "time": TIME, "step": STEP, "n": 6, "recorders": (None,),
        "known": np.ones(Q.shape, bool), "parts": [slice(0, len(TIME))],
    }  # fmt: skip
    motion: Any = SimpleNamespace(**(given | changed))
    return AtLoadChanges(motion, left, LOAD, MODEL)


def candidate(kind: str, joint: int | None, count: int = 1) -> Any:
    effect = LIBRARY[kind].of(joint, **LIBRARY[kind].example)
    devices = frozenset({effect.search.device} - {""})
    return SimpleNamespace(kind=kind, joint=joint, effects=(effect,) * count, devices=devices)


@pytest.mark.parametrize("joint", [3, 5])
def test_a_link_that_bounces_is_heard_by_its_neighbours(joint: int) -> None:
    seen = heard(NOISE + bounces(joint, changes(joint))).seen
    assert list(seen) == [joint + 1]
    assert seen[joint + 1] > 2 * LEAST


def test_nothing_is_heard_where_nothing_bounces() -> None:
    assert heard(NOISE).seen == {}
    # one moment of twenty, a bounce of no load, one that only its own motor feels
    moments = changes(5)
    assert heard(NOISE + bounces(5, moments[3:4], 100.0)).seen == {}
    elsewhere = np.setdiff1d(np.arange(200, 4800, 190), (moments[:, None] + range(-60, 60)).ravel())
    assert heard(NOISE + bounces(5, elsewhere)).seen == {}
    own = NOISE.copy()
    own[:, 5] += bounces(5, moments)[:, 5]
    assert heard(own).seen == {}
    # what is slow is other effects'
    assert heard(NOISE + 5.0 * np.sin(3.0 * TIME)[:, None]).seen == {}


def test_what_has_not_been_recorded_is_not_asked() -> None:
    left = NOISE + bounces(5, changes(5))
    assert heard(left, recorders=("low-pass",)).seen == {}
    assert heard(left, step=0.03).seen == {}
    standing = QD.copy()
    standing[:, 3:5] = 0.0
    assert heard(left, qd=standing).seen == {}
    unknown = np.ones(Q.shape, bool)
    unknown[:, 3:5] = False
    assert heard(left, known=unknown).seen == {}


def test_a_bounce_is_looked_for_right_behind_its_moment() -> None:
    moments = changes(5)
    asked = heard(NOISE)._bounces(5)
    rows = np.flatnonzero(asked.moment >= 0)
    behind = TIME[rows] - TIME[moments[asked.moment[rows]]]
    assert asked.count == len(moments)
    assert (behind.min() > -0.015) & (behind.min() < 0) & (0.06 < behind.max() < 0.08)
    assert set(asked.moment[moments]) == set(range(len(moments)))
    # by the coupling entry of the mass matrix, and less and less of it
    k = moments[3]
    coupled = np.abs(MODEL.mass_matrix(Q[k])[:, 5])
    np.testing.assert_allclose(asked.torque[k], coupled)
    np.testing.assert_allclose(asked.torque[k + 10], coupled * np.exp(-0.04 / 0.035))
    assert not asked.torque[asked.moment < 0].any()


def test_between_two_logs_a_load_changes_its_sign_and_nothing_bounces() -> None:
    moments = changes(5)
    join = int(moments[4])
    parts = [slice(0, join), slice(join, len(TIME))]
    asked = heard(NOISE, parts=parts)._bounces(5)
    assert asked.count == len(moments) - 1
    left = NOISE + bounces(5, moments)
    assert heard(left, parts=parts).seen[6] == pytest.approx(heard(left).seen[6], rel=0.2)


def test_the_name_of_the_joint_alone_is_told() -> None:
    bouncing = heard(NOISE + bounces(5, changes(5)))
    play = candidate("transmission_backlash", 6)
    told = bouncing.told(Alternative(play, 10.0, 5.0))
    assert told.evidence == pytest.approx(10.0 + bouncing.seen[6])
    assert told.rattles
    for other in (
        candidate("transmission_backlash", 5),
        candidate("elastic_joint", 6),
        candidate("payload", None),
        candidate("transmission_backlash", 6, count=2),
    ):
        alternative = Alternative(other, 10.0, 5.0)
        assert bouncing.told(alternative) is alternative
    # beside a load it is told, beside another axis' transmission, which shakes the wrist, not
    assert bouncing.rattles(play, [candidate("payload", None)]) == bouncing.seen[6]
    for flaw in ("transmission_backlash", "elastic_joint"):
        assert bouncing.rattles(play, [candidate(flaw, 1)]) == 0.0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("place", "seed"),
    [
        # 67 nats of its law were refused beside the tilt; its neighbours say 29 more
        (5, 20261207),
        # not heard: of its torque, 9 % of the joint's, 0.6 % are slow enough to be compared
        (7, 20261209),
    ],
)
def test_play_of_a_wrist_axis_beside_a_tilt_is_named(place: int, seed: int) -> None:
    (case,) = suite("pairs", place, 1, seed)
    read = case.simulate()
    log = Log(read.time, read.q, read.tau, qd=read.qd, q_ref=read.q_ref, name=case.name)
    assert set(names(diagnose(ROBOT, log))) == {
        ("base_tilt", None),
        ("transmission_backlash", 6),
    }
