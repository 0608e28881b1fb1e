"""Each law of the second plant: there, of the size asked for, of the sign it says."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from .case import Case
from .draws import KINDS, LIBRARY, OUTSIDE
from .forces import BoucWen, Bristle, Dahl, Law, MaxwellSlip, State, TipPush
from .present import Wanted, draw
from .reading import Reading
from .suites import SUITES, suite

SHORT = 4.0
OWN = [k for k in KINDS if KINDS[k].where != "transmission"]


def _state(qd: float = 0.0, dt: float = 1e-3) -> State:
    state = State(dt, lambda force: np.concatenate([force, force]))
    state.at(0.0, np.zeros(6), np.full(6, qd), np.ones(6))
    return state


@pytest.mark.parametrize("kind", OWN)
def test_an_effect_has_the_share_of_torque_that_is_asked(kind: str) -> None:
    case = Case(12, (Wanted(kind, None, 0.03),), duration=20.0)
    ((effect, size, torque),) = case.present
    share = np.sqrt((torque**2).mean(axis=0) / (case.plain_torque**2).mean(axis=0))
    asked = share[effect.index] if effect.joint else share.max()
    assert 0.3 * 0.03 < asked < 1.5 * 0.03
    assert abs(size) <= effect.limit
    assert effect.in_library == (kind in LIBRARY)


@pytest.mark.parametrize("kind", ["viscous_change", "gear_ripple", "payload", "torque_gain"])
def test_what_an_effect_adds_is_what_the_log_shows(kind: str) -> None:
    quiet = Reading(torque_noise=(1e-6,) * 6, angle_noise=0.0, lost=0.0)
    case = Case(12, (Wanted(kind, None, 0.1),), duration=SHORT, reading=quiet)
    ((_, _, torque),) = case.present
    log = case.simulate()
    plain = replace(case, effects=()).simulate()
    shown = log.tau - plain.tau
    j = case.truth[0].main_joint - 1
    n = min(len(shown), len(torque))
    moving = np.abs(plain.qd[:n, j]) > 0.1
    assert np.corrcoef(shown[:n][moving, j], torque[:n][moving, j])[0, 1] > 0.95
    ratio = shown[:n][moving, j].std() / torque[:n][moving, j].std()
    assert ratio == pytest.approx(1.0, abs=0.15)


def test_a_spring_in_the_transmission_twists_by_the_load() -> None:
    case = Case(3, (Wanted("elastic_joint", 2),), duration=SHORT)
    ((_, _, torque),) = case.present
    plain = case._unexplained(case.machine)
    assert torque[:, 1].std() > 3.0 * plain[:, 1].std()


@pytest.mark.parametrize(
    "law",
    [
        Dahl(0, 2.0, Bristle(1e-3)),
        BoucWen(0, 2.0, 1e-3, 2.0, 0.7),
        MaxwellSlip(0, 2.0, np.array([1e-3, 3e-3]), np.array([0.6, 0.4])),
    ],
)
def test_a_hysteresis_opposes_the_motion_and_remembers(law: Law) -> None:
    torque = []
    for speed in (0.1, -0.1):
        for _ in range(300):
            out = np.zeros(6)
            law.add(_state(speed), out)
            torque.append(out[0])
    assert torque[299] == pytest.approx(2.0, rel=0.02)
    assert torque[301] > 1.0  # just after the reversal it still pushes as before
    assert torque[599] == pytest.approx(-2.0, rel=0.02)


def test_a_push_is_on_in_its_window_alone() -> None:
    push = TipPush(10.0, np.array([1.0, 0.0, 0.0]), 1.0, 2.0, 0.2, False)
    for time, expected in ((0.5, 0.0), (2.0, 10.0), (3.5, 0.0)):
        state = _state()
        state.time = time
        out = np.zeros(6)
        push.add(state, out)
        assert out[0] == pytest.approx(expected)


def test_shapes_differ_from_arm_to_arm() -> None:
    laws = [draw(Wanted("hysteresis", 1), np.random.default_rng(k)).make for k in range(12)]
    assert {type(make(1.0)) for make in laws if make} == {Dahl, BoucWen, MaxwellSlip}
    signs = {draw(Wanted("balancer", 2), np.random.default_rng(k)).sign for k in range(12)}
    assert signs == {-1.0, 1.0}


def test_conditions_are_what_they_say() -> None:
    rng = np.random.default_rng(0)
    n = 20000
    time = np.arange(n) / 1000
    record = np.sin(time)[:, None] * np.ones(18)
    reading = Reading(rate=100.0, jitter=1e-3, angle_step=1e-4, torque_step=(0.5,) * 6)
    log = reading.read(rng, time, record, record[:, :6])
    assert np.median(np.diff(log.time)) == pytest.approx(0.01, rel=0.2)
    assert np.std(log.time - 0.01 * np.round(log.time / 0.01)) == pytest.approx(1e-3, rel=0.2)
    np.testing.assert_allclose(log.q / 1e-4, np.round(log.q / 1e-4), atol=1e-6)
    np.testing.assert_allclose(log.tau / 0.5, np.round(log.tau / 0.5), atol=1e-9)
    kept = Reading(lost=0.2, burst=10.0).arrived(rng, n)
    assert kept.mean() == pytest.approx(0.8, abs=0.04)
    assert np.diff(np.flatnonzero(kept)).max() > 10


@pytest.mark.parametrize("name", SUITES)
def test_a_suite_follows_from_its_seed(name: str) -> None:
    first = suite(name, 0, 3, 5)
    assert first == suite(name, 0, 3, 5)
    assert suite(name, 2, 1, 5)[0] == first[2]
    assert len({case.seed for case in first}) == 3


def test_an_unknown_suite_is_refused() -> None:
    with pytest.raises(ValueError, match="known are clean"):
        suite("dirty", 0, 1, 5)


def test_kinds_outside_are_not_the_librarys() -> None:
    assert not set(OUTSIDE) & set(LIBRARY)
    assert len(OUTSIDE) >= 8
