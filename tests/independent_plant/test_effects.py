"""Every effect can be simulated, has the size it was asked for, and is where and what the truth
says."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from .case import Case
from .effects import KINDS, LIBRARY, OUTSIDE, Effect
from .suites import SUITES, suite
from .visibility import beyond_priors

NAMED_IN_CONTRACT = """
payload rotor_inertia coulomb_asymmetry coulomb_change viscous_change viscous_warmup
load_friction hysteresis gear_ripple balancer cable_spring wrist_coupling torque_gain
torque_offset time_delay elastic_joint base_tilt process_force linkage_inertia link_inertia
"""


def _case(kind: str) -> Case:
    chirp = KINDS[kind].where == "transmission"
    return Case(
        12, (Effect(kind, None, 0.03),), duration=15.0, validation_duration=2.0, chirp=chirp
    )


def test_all_kinds_of_the_contract_and_enough_outside_it_are_there() -> None:
    assert set(NAMED_IN_CONTRACT.split()) <= set(LIBRARY)
    assert len(OUTSIDE) >= 8
    assert not set(OUTSIDE) & set(LIBRARY)


@pytest.mark.parametrize("kind", KINDS)
def test_an_effect_comes_out_in_the_log_with_its_size(kind: str) -> None:
    case = _case(kind)
    truth = case.truth[0]
    assert truth.kind == kind
    assert truth.in_library == (kind in LIBRARY)
    assert 0.3 * 0.03 < truth.fraction < 1.5 * 0.03
    if KINDS[kind].where == "transmission":
        return  # its torque is judged against the motion it makes itself, below
    log = case.simulate()[0]
    plain = replace(case, effects=()).simulate()[0]
    j = truth.main_joint - 1
    difference = log.tau - plain.tau
    # a force moves the instants of sticking a little; what the measuring chain does, it does at
    # reversals too
    counted = (np.abs(plain.qd[:, j]) > 0.05) | (KINDS[kind].where == "chain")
    share = np.sqrt((difference[counted, j] ** 2).mean() / (plain.tau[:, j] ** 2).mean())
    assert 0.5 * truth.fraction < share < 2.0 * truth.fraction


@pytest.mark.parametrize("kind", ["elastic_joint", "transmission_backlash"])
def test_a_transmission_leaves_a_torque_the_rigid_arm_cannot_explain(kind: str) -> None:
    case = _case(kind)
    (drawn, size, _) = case.sized_effects[0]
    move = case.motions[0]
    j = case.truth[0].main_joint - 1
    with_it = case.machine.unexplained_torque(((drawn, size),), move)[:, j].std()
    assert with_it > 2.0 * case.machine.unexplained_torque((), move)[:, j].std()


def test_more_is_asked_for_more_comes() -> None:
    sizes = [Case(12, (Effect("cable_spring", 4, f),)).truth[0] for f in (0.02, 0.08)]
    assert sizes[1].fraction == pytest.approx(4 * sizes[0].fraction, rel=0.1)


def test_an_effect_switched_on_in_mid_record_is_absent_before() -> None:
    effects = (Effect("gear_ripple", 2, 0.1, on_at=8.0), Effect("payload", None, 0.1, on_at=8.0))
    case = Case(5, effects, duration=12.0, validation_duration=2.0)
    log = case.simulate()[0]
    plain = replace(case, effects=()).simulate()[0]
    before = log.time < 7.99
    np.testing.assert_array_equal(log.tau[before], plain.tau[before])
    assert np.abs(log.tau - plain.tau)[~before].max() > 10.0


def test_an_idle_axis_rests() -> None:
    log = Case(6, duration=4.0, validation_duration=2.0, idle=(4,)).simulate()[0]
    assert np.ptp(log.q, axis=0)[3] < 2e-3
    assert (np.ptp(np.delete(log.q, 3, axis=1), axis=0) > 0.02).all()


def test_wrong_requests_are_refused() -> None:
    with pytest.raises(ValueError, match="unknown effect 'gremlin'"):
        Effect("gremlin")
    with pytest.raises(ValueError, match="not on 4"):
        Effect("balancer", 4)
    with pytest.raises(ValueError, match="unknown suite"):
        suite("nothing", 1)


@pytest.mark.parametrize("name", SUITES)
def test_suites_are_reproducible_and_their_cases_run(name: str) -> None:
    once = suite(name, 15)
    again = suite(name, 15)
    other = suite(name, 15, seed=1)
    assert once == again
    assert once != other
    assert len({case.seed for case in once}) == 15
    short = replace(once[7], duration=min(once[7].duration, 6.0), validation_duration=2.0)
    for log in short.simulate():
        assert np.isfinite(log.table()).all()


def test_what_priors_can_explain_is_told_from_what_they_cannot() -> None:
    """A small payload hides in the uncertainty of the spindle's mass; a ripple of the same size
    does not."""
    payload = Effect("payload", None, 0.02)
    ripple = Effect("gear_ripple", 5, 0.02)
    hidden, plain = (Case(9, (effect,), duration=20.0) for effect in (payload, ripple))
    (_, weak) = beyond_priors(hidden)[0]
    (left, strong) = beyond_priors(plain)[0]
    assert weak < 6.0
    assert strong > 30.0
    assert 0.01 < left[4] < 0.021
