"""A fitted explanation is borne out by its errors and by rows that did not fit it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from irb2400_ctrl.diagnosis.comparison import acceptance as module
from irb2400_ctrl.diagnosis.comparison.acceptance import Acceptance, stands_clear
from irb2400_ctrl.diagnosis.comparison.comparison import Alternative
from irb2400_ctrl.diagnosis.comparison.criteria import Criteria
from irb2400_ctrl.diagnosis.comparison.possible import usual
from irb2400_ctrl.diagnosis.comparison.step import Step
from irb2400_ctrl.diagnosis.estimation.candidate import Candidate
from irb2400_ctrl.diagnosis.estimation.effect_parameters import parameters_of
from irb2400_ctrl.diagnosis.estimation.evidence import Score
from irb2400_ctrl.diagnosis.preparation.noise_test import trimmed_rms
from irb2400_ctrl.diagnosis.regressors.bases import RegressorColumns
from irb2400_ctrl.effects import LIBRARY, Effect


def fitted(effect: Effect, *sigma: float) -> Any:
    return SimpleNamespace(
        effects=(effect,), parameters=tuple(parameters_of(effect, 0)), alone=np.array(sigma)
    )


def test_a_size_stands_three_standard_errors_from_nothing() -> None:
    offset = LIBRARY["torque_offset"].of(2, offset_Nm=3.0)
    # of errors that are half as large again as the noise alone makes them: 3.0 / (3 * 1.5)
    assert stands_clear(fitted(offset, 0.665), 0, 10.0)
    assert not stands_clear(fitted(offset, 0.668), 0, 10.0)


def test_of_one_effect_on_every_joint_those_stay_that_stand_clear() -> None:
    """Of a TX40 a rotor of 0.05 ± 0.10 kg m2 was told because five others stood clear."""
    rotors = tuple(LIBRARY["rotor_inertia"].of(j, inertia_kgm2=0.05 * j) for j in (1, 2, 3))
    parameters = tuple(p for k, one in enumerate(rotors) for p in parameters_of(one, k))
    fit: Any = SimpleNamespace(
        effects=rotors, parameters=parameters, alone=np.array([0.001, 0.065, 0.001])
    )
    clear = [stands_clear(fit, k, 10.0) for k in range(3)]
    assert clear == [True, False, True]
    law = RegressorColumns((0, 1, 2), np.ones((4, 3, 1)) * np.eye(3)[None])
    score = Score(30.0, np.array([0.05, 0.1, 0.15]), np.zeros(0))
    every = Candidate("rotor_inertia", None, "every", (), rotors, law, None, score)
    step = Step(every, 30.0, (Alternative(every, 50.0, 30.0),)).only(clear)
    assert [e.joint for e in step.candidate.effects] == [1, 3]
    np.testing.assert_allclose(step.candidate.torque(3)[0], [0.05, 0.0, 0.15])
    assert step.margin == 30.0  # it still finds itself among the alternatives


def judged(
    candidate: Any,
    told: list[float],
    *,
    worth: float = 1.0,
    elsewhere: float = 0.0,
    beyond: bool = True,
    fit: Any = None,
    n: int = 3,
    beside: Any = None,
    over_given: float = 1.0,
    of_the_fit: bool = False,
    of_one_size: bool = True,
    builds_up: bool = True,
    all_found: bool = True,
    of_its_law: bool = True,
) -> bool:
    """What `bears_out` says of an offset on joint 2 of three: worth [nats] by joint."""
    held_out = SimpleNamespace(
        worth=lambda place: SimpleNamespace(nats=np.array([0.0, worth, elsewhere])),
        told=lambda place: SimpleNamespace(nats=np.array(told)),
        over_given=lambda effects: SimpleNamespace(nats=np.full(3, over_given)),
        of_the_fit=lambda place: of_the_fit,
    )
    acceptance: Any = Acceptance.__new__(Acceptance)
    motion = SimpleNamespace(duration=10.0, n=n, row_known=np.ones((50, n), dtype=bool))
    acceptance.fitter = SimpleNamespace(robot=None, motion=motion)
    acceptance._beyond_base = lambda candidate, fit: beyond
    acceptance._of_its_law = lambda effect: of_its_law
    acceptance._of_one_size = lambda steps, fit, place: of_one_size
    acceptance._builds_up = lambda steps, fit, place: builds_up
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "HeldOut", lambda fitter, chosen, fit: held_out)
        step: Any = SimpleNamespace(candidate=candidate, gain=20.0)
        fit = fit or fitted(LIBRARY["torque_offset"].of(2, offset_Nm=3.0), 0.1)
        further = [] if beside is None else [SimpleNamespace(candidate=beside)]
        return bool(acceptance.bears_out([step, *further], fit, 0, all_found=all_found))


def test_a_name_stays_only_where_the_files_own_error_is_better_with_it() -> None:
    offset = LIBRARY["torque_offset"].of(2, offset_Nm=3.0)
    name = SimpleNamespace(
        known=True, everywhere=False, devices=frozenset(), effects=(offset,), joint=2
    )
    assert judged(name, [0.0, 5.0, -1.0])
    assert not judged(name, [0.0, 5.0, -1.0], worth=-1.0)
    assert not judged(name, [0.0, 5.0, -1.0], of_its_law=False)
    assert not judged(name, [9.0, -0.1, 0.0])  # worse where it sits
    assert not judged(name, [0.0, 5.0, -6.0])  # worse on all joints together
    # what sticks near reversals shows once all else is found
    assert not judged(name, [0.0, 5.0, -1.0], builds_up=False)
    assert judged(name, [0.0, 5.0, -1.0], builds_up=False, all_found=False)
    load = SimpleNamespace(
        known=True, everywhere=False, devices=frozenset(), effects=(offset,), joint=None
    )
    assert judged(load, [9.0, -5.0, 0.0])  # a balancer beside it is not found yet
    assert not judged(load, [4.0, -5.0, 0.0])
    assert not judged(load, [9.0, -5.0, 0.0], of_one_size=False)
    # as long as more may be found it need not be: an asymmetry of axis 1 beside a tilted base
    assert judged(load, [9.0, -5.0, 0.0], of_one_size=False, all_found=False)
    # what other numbers could say as well has the evidence against them to its credit
    assert judged(name, [0.0, -3.0, 0.0], beyond=False)
    assert not judged(name, [0.0, -21.0, 0.0], beyond=False)
    # and unseen rows that grow worse on other joints
    assert not judged(name, [0.0, 3.0, 0.0], elsewhere=-21.0, beyond=False)
    assert judged(name, [0.0, 3.0, 0.0], elsewhere=-19.0, beyond=False)
    assert not judged(load, [0.0, 3.0, 0.0], worth=-21.0, beyond=False)
    # on its own joint the file is asked alone: dry friction of axis 4 that the fit moved by eight
    # standard deviations of the file was refused for the few rows near its reversals
    assert judged(name, [0.0, 3.0, 0.0], worth=-21.0, beyond=False)


def test_beside_a_swing_the_fit_is_asked_of_the_joints_that_it_shakes() -> None:
    """Grease of axis 1, found to 2 % of its time constant beside a springy axis 1, was refused for
    what the file says of axes 4 and 5, which the spring shakes."""
    offset = LIBRARY["torque_offset"].of(2, offset_Nm=3.0)
    name = SimpleNamespace(
        known=True, everywhere=False, devices=frozenset(), effects=(offset,), joint=2
    )
    spring = SimpleNamespace(devices=frozenset({("transmission", 1)}), effects=())
    rigid = SimpleNamespace(devices=frozenset(), effects=())
    assert judged(name, [0.0, 5.0, -60.0], beside=spring)
    assert not judged(name, [0.0, 5.0, -60.0], beside=rigid)
    assert not judged(name, [60.0, -5.0, 0.0], beside=spring)
    assert not judged(name, [0.0, 5.0, 0.0], worth=-1.0, beside=spring)
    # a rotor of 1,075 nats was refused for what a fit beside play of another axis says unseen
    assert judged(name, [0.0, 670.0, 0.0], worth=-117.0, elsewhere=236.0, beside=spring)
    assert not judged(name, [0.0, 100.0, 0.0], worth=-117.0, elsewhere=236.0, beside=spring)
    assert not judged(name, [0.0, 670.0, 0.0], worth=-117.0, elsewhere=236.0, beside=rigid)


@pytest.mark.parametrize(("order", "named"), [(3.6, False), (3.9, True), (160.1, True)])
def test_an_order_that_left_the_grid_belongs_to_no_ripple(order: float, named: bool) -> None:
    ripple = LIBRARY["gear_ripple"].of(2, amplitude_Nm=1.0, order=order)
    assert usual(ripple) == named


@pytest.mark.parametrize(("damping", "named"), [(0.437, False), (0.351, False), (0.349, True)])
def test_a_swing_that_is_over_at_once_is_no_springs(damping: float, named: bool) -> None:
    """On both halves of a Panda's log the search for one ended at its last value, 0.437: a file of
    wrong bodies was given an elastic joint with 0.75."""
    spring = LIBRARY["elastic_joint"].of(1, stiffness_Nm_rad=400.0, damping_ratio=damping)
    assert usual(spring) == named
    swings = SimpleNamespace(
        known=True, everywhere=False, devices=frozenset({("transmission", 1)}), effects=(spring,),
        joint=1, rattles=False,
    )  # fmt: skip
    assert judged(swings, [0.0, 9.0, 0.0], fit=SimpleNamespace(effects=(spring,))) == named


@pytest.mark.parametrize(("seconds", "named"), [(1.07, False), (1.6, True), (33.0, True)])
def test_grease_that_is_warm_at_once_was_not_cold(seconds: float, named: bool) -> None:
    """Of 4.3 s of an LWA 4P a warm-up of 1.07 s was named with 0.78."""
    warm = LIBRARY["viscous_warmup"].of(2, viscous_Nms_rad=5.0, time_constant_s=seconds)
    assert usual(warm) == named


def test_nothing_of_a_gain_is_one() -> None:
    gain = LIBRARY["torque_gain"].of(2, gain=1.1)
    assert not stands_clear(fitted(gain, 0.05), 0, 10.0)
    assert stands_clear(fitted(gain, 0.02), 0, 10.0)


def test_of_a_force_its_length_counts() -> None:
    force = LIBRARY["process_force"].of(None, force_x_N=1.1, force_y_N=1.8, force_z_N=0.4)
    assert not stands_clear(fitted(force, 1.4, 0.3, 3.0), 0, 10.0)
    assert stands_clear(fitted(force, 0.3, 0.3, 0.3), 0, 10.0)


def test_a_time_constant_lies_inside_the_record() -> None:
    warm = LIBRARY["viscous_warmup"].of(2, viscous_Nms_rad=5.0, time_constant_s=33.0)
    assert stands_clear(fitted(warm, 0.1, 1.0), 0, 40.0)
    assert not stands_clear(fitted(warm, 0.1, 1.0), 0, 10.0)
    quick = LIBRARY["viscous_warmup"].of(2, viscous_Nms_rad=5.0, time_constant_s=0.5)
    assert stands_clear(fitted(quick, 0.1, 0.1), 0, 10.0)


def test_a_time_constant_of_nothing_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever size the effect has beside it."""
    monkeypatch.setattr(module, "value_of", lambda effect, parameter: 0.0)
    monkeypatch.setattr(module, "with_value", lambda effect, parameter, value: effect)
    warm = LIBRARY["viscous_warmup"].of(2, viscous_Nms_rad=5.0, time_constant_s=3.0)
    assert not stands_clear(fitted(warm, 0.1, 1.0), 0, 10.0)


def test_one_size_of_several_is_enough() -> None:
    """A load by its mass or by its first moment; of which one is zero, whatever its error."""
    load = LIBRARY["payload"].of(None, mass_kg=6.0, com_m=(0.0, 0.0, 0.0))
    assert load.sizes() == (6.0, 0.0)
    sigmas = (0.1,) * len(parameters_of(load, 0))
    assert stands_clear(fitted(load, *sigmas), 0, 10.0)


def test_one_effect_of_several_that_stands_clear_bears_a_name_out() -> None:
    offsets = tuple(LIBRARY["torque_offset"].of(j, offset_Nm=3.0) for j in (1, 2))
    name = SimpleNamespace(
        known=True, everywhere=False, devices=frozenset(), effects=offsets, joint=2
    )
    for sigmas, borne in (((0.1, 9.0), True), ((9.0, 9.0), False)):
        fit: Any = SimpleNamespace(
            effects=offsets,
            parameters=tuple(p for k, one in enumerate(offsets) for p in parameters_of(one, k)),
            alone=np.array(sigmas),
        )
        assert judged(name, [0.0, 5.0, 0.0], fit=fit) == borne


def test_what_is_on_every_joint_is_on_most_of_them() -> None:
    """Two joints with an offset, an asymmetry of friction as likely as that, are judged each by
    itself."""
    for joints, borne in (((1, 2), False), ((4, 5, 6), True), ((1, 2, 4, 6), True)):
        offsets = tuple(LIBRARY["torque_offset"].of(j, offset_Nm=3.0) for j in joints)
        law = RegressorColumns(tuple(range(6)), np.ones((4, 6, 1)))
        score = Score(30.0, np.ones(1), np.zeros(0))
        every = Candidate("torque_offset", None, "every", (), offsets, law, None, score)
        assert every.everywhere
        fit: Any = SimpleNamespace(
            effects=offsets,
            parameters=tuple(p for k, one in enumerate(offsets) for p in parameters_of(one, k)),
            alone=np.full(len(joints), 0.1),
        )
        assert judged(every, [1.0] * 6, fit=fit, n=6) == borne


def test_trimmed_rms_is_that_of_the_noise_whatever_a_few_samples_do() -> None:
    values = np.random.default_rng(0).standard_normal(20000)
    assert trimmed_rms(values) == pytest.approx(1.0, rel=0.02)
    values[::200] = 1000.0
    assert trimmed_rms(values) == pytest.approx(1.0, rel=0.05)


def test_worth_of_exactly_nothing_bears_nothing_out() -> None:
    offset = LIBRARY["torque_offset"].of(2, offset_Nm=3.0)
    name = SimpleNamespace(
        known=True, everywhere=False, devices=frozenset(), effects=(offset,), joint=2
    )
    assert not judged(name, [0.0, 5.0, 0.0], worth=0.0)
    assert not judged(name, [0.0, 0.0, 0.0])
    assert not judged(name, [0.0, -20.0, 0.0], beyond=False)  # with its 20 nats to its credit
    law = SimpleNamespace(known=False, everywhere=False, devices=frozenset(), effects=(), joint=2)
    assert judged(law, [], worth=1.0)
    assert not judged(law, [], worth=0.0)
    assert not judged(law, [], of_the_fit=True)


@pytest.mark.parametrize(("share", "beyond"), [(0.05, False), (0.0501, True)])
def test_what_other_numbers_of_the_robot_could_say(
    share: float, beyond: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    given: list[Any] = []

    def problem(y: Any, Z: Any, noise: Any) -> Any:
        given.append(Z)
        return SimpleNamespace(share_beyond_base=lambda torque: share)

    monkeypatch.setattr(module, "Problem", problem)
    acceptance: Any = Acceptance.__new__(Acceptance)
    acceptance.criteria = Criteria()
    acceptance.fitter = SimpleNamespace(motion=SimpleNamespace(n=1))
    # columns of the robot's own numbers alone, not those of fitted effects
    fit: Any = SimpleNamespace(
        y=None, noise=(), Z=np.arange(3.0)[None, None], owner=np.array([-1, 0, -1])
    )
    candidate: Any = SimpleNamespace(torque=lambda n: np.zeros((1, n)))
    assert acceptance._beyond_base(candidate, fit) == beyond
    np.testing.assert_array_equal(given[0], [[[0.0, 2.0]]])


def test_a_time_constant_lies_within_the_record() -> None:
    warm = LIBRARY["viscous_warmup"].of(2, viscous_Nms_rad=5.0, time_constant_s=33.0)
    for duration, clear in ((33.0, True), (32.5, False)):
        acceptance: Any = Acceptance.__new__(Acceptance)
        acceptance.fitter = SimpleNamespace(motion=SimpleNamespace(duration=duration))
        acceptance._beyond_base = lambda candidate, fit: True
        step: Any = SimpleNamespace(candidate=SimpleNamespace(effects=(warm,)))
        assert acceptance.clear([step], fitted(warm, 0.1, 1.0), 0) == [clear]


def test_errors_that_come_from_the_spread_of_other_numbers_are_not_inflated() -> None:
    """4.4 standard errors of a dry friction, nearly all of them the data sheet's own spread."""
    change = LIBRARY["coulomb_change"].of(6, coulomb_Nm=1.45)
    for beyond, sigma, clear in ((False, 0.33, True), (True, 0.33, False), (False, 0.49, False)):
        acceptance: Any = Acceptance.__new__(Acceptance)
        acceptance.fitter = SimpleNamespace(motion=SimpleNamespace(duration=10.0))
        acceptance._beyond_base = lambda candidate, fit, beyond=beyond: beyond
        step: Any = SimpleNamespace(candidate=SimpleNamespace(effects=(change,)))
        assert acceptance.clear([step], fitted(change, sigma), 0) == [clear]
