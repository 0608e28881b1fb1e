"""The whole diagnosis on arms of an independent plant: a reduced form of
`benchmarks/evaluate.py`."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from independent_plant import Case, Effect

from irb2400_ctrl.arrays import Array
from irb2400_ctrl.diagnosis import Diagnosis, diagnose
from irb2400_ctrl.diagnosis.comparison.selection import Selection
from irb2400_ctrl.diagnosis.findings import _share
from irb2400_ctrl.diagnosis.preparation.metrics import errors
from irb2400_ctrl.diagnosis.preparation.quick_rests import QuickRests, Vibration
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.report.elements.page import show
from irb2400_ctrl.report.pages.diagnosis_page import lines
from irb2400_ctrl.robot import Identified, load_robot


@cache
def diagnosed(seed: int, *effects: Effect, reference: bool = True) -> Diagnosis:
    # what is there must be found in less; that nothing else is must hold of more
    named = all(effect.kind != "sticky_window" for effect in effects) and bool(effects)
    seconds = (16.0, 8.0) if named else (25.0, 12.0)
    case = Case(seed, effects, duration=seconds[0], validation_duration=seconds[1])
    logs = [
        Log(one.time, one.q, one.tau, q_ref=one.q_ref if reference else None, name=name)
        for one, name in zip(case.simulate(), ("identification", "validation"), strict=True)
    ]
    return diagnose(load_robot("irb2400"), *logs)


@pytest.mark.parametrize(
    "seed", [31, *(pytest.param(seed, marks=pytest.mark.slow) for seed in (32, 33))]
)
def test_nothing_is_missing_on_a_clean_arm(seed: int) -> None:
    found = diagnosed(seed)
    assert found.verdict == "nothing_missing"
    assert found.robot.effects == ()


@pytest.mark.parametrize(
    ("kind", "joint"),
    [
        ("gear_ripple", 4),
        ("load_friction", 2),
        pytest.param("torque_gain", 5, marks=pytest.mark.slow),
        pytest.param("cable_spring", 4, marks=pytest.mark.slow),
        ("rotor_inertia", 3),
        pytest.param("torque_offset", 4, marks=pytest.mark.slow),
    ],
)
def test_an_effect_is_named_and_takes_the_validation_error_away(kind: str, joint: int) -> None:
    found = diagnosed(7, Effect(kind, joint, 0.1))
    assert found.verdict == "explained"
    assert [(f.effect.kind, f.effect.joint) for f in found.findings] == [(kind, joint)]
    assert found.findings[0].confidence > 0.6
    assert found.validation is not None
    before, after = (
        e.rmse[joint - 1] for e in (found.validation.error_before, found.validation.error_after)
    )
    assert after < 0.7 * before
    # the name alone, without new parameters, is not what made it better
    assert after < 0.8 * found.validation.error_recalibrated.rmse[joint - 1]


def test_recalibrated_is_the_best_that_numbers_alone_can_do() -> None:
    """They were the numbers found beside the effect, without it: the torque of joint 3 was further
    off than with the robot as given."""
    compared = diagnosed(7, Effect("rotor_inertia", 3, 0.1)).identification
    best = compared.error_recalibrated.rmse
    assert (best < 1.001 * compared.error_before.rmse).all()
    assert best[2] < 0.95 * compared.error_before.rmse[2]


def test_what_no_name_says_is_told_where_lesser_names_fall_for_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    weighed = Selection._weighty

    def nameless(self: Selection, *given: Any) -> Any:
        self.nameless = 4
        return weighed(self, *given)

    monkeypatch.setattr(Selection, "_weighty", nameless)
    log = Case(31, duration=8.0, validation_duration=3.0).simulate()[0]
    found = diagnose(load_robot("irb2400"), Log(log.time, log.q, log.tau, q_ref=log.q_ref))
    assert found.nameless == 4
    assert found.verdict == "unexplained"
    assert any("joint 4: what is left there without a name weighs" in said for said in found.weak)


def _with_misfit(found: Diagnosis, misfit: Array) -> Diagnosis:
    """As if so much more were left, shape (m, n) [Nm]."""
    compared = found.identification
    after = compared.after - misfit
    error = errors(compared.measured, after, compared.known)
    return replace(found, identification=replace(compared, after=after, error_after=error))


def test_much_more_than_noise_left_on_a_joint_is_not_explained() -> None:
    found = diagnosed(7, Effect("gear_ripple", 4, 0.1))
    assert found.left_over == ()
    measured = found.identification.measured
    size = np.sqrt(np.mean(measured[:, 2] ** 2))
    misfit = np.zeros_like(measured)
    misfit[:, 2] = 0.2 * size
    left = _with_misfit(found, misfit)
    assert left.left_over == (3,)
    assert left.verdict == "unexplained"
    assert any(said.startswith("  Joint 3: ") for said in lines(left))
    # a misfit as fast as noise is in the floor of the residual, not in that of its differences
    floor = np.full(6, 0.2 * size)
    fast = replace(left, identification=replace(left.identification, noise_floor=floor))
    assert fast.left_over == (3,)
    assert replace(fast, noise=None).left_over == ()
    # what is quicker than laws are compared on is left over, however little it is
    assert found.noise is not None
    hums = replace(found.noise, quick=QuickRests((Vibration(5, 20.0, 0.1),)))
    assert replace(found, noise=hums).left_over == (5,)
    assert replace(found, noise=hums).much_left == ()
    assert replace(found, noise=hums).verdict == "unexplained"
    # joints that stick where they turn leave much on few samples
    few = np.zeros_like(measured)
    few[::100, 2] = 2.0 * size
    sticks = _with_misfit(found, few)
    assert sticks.identification.error_after.rmse[2] > 0.15 * size
    assert sticks.left_over == ()
    # nor is a misfit news that the identification of this arm has left as well
    known = Identified.of(["m_1"], np.eye(1), ["a.csv"], 0.2 * size * np.eye(6)[2])
    usual = left.given.model_copy(update={"identified": known})
    assert replace(left, given=usual).left_over == ()
    # nor is what no name says, for which lesser names were taken back
    assert found.verdict == "explained"
    assert replace(found, nameless=2).verdict == "unexplained"


def test_more_than_noise_beside_a_name_is_said() -> None:
    found = diagnosed(7, Effect("gear_ripple", 4, 0.1))
    assert found.noise is not None
    assert not any("more than noise" in line for line in lines(found))
    left = 0.5 * found.noise.floor
    left[4] = 2.7 * found.noise.floor[4]
    more = replace(found, noise=replace(found.noise, left=left, means=np.zeros(6)))
    assert more.verdict == "explained"
    (told,) = (line for line in lines(more) if "more than noise" in line)
    assert told.strip().startswith("Joint 5: ")
    assert f"{left[4]:.2f} Nm rms are left" in told
    assert f"disagree by {found.noise.floor[4]:.2f}" in told


def test_no_share_is_above_one_hundred_per_cent() -> None:
    rng = np.random.default_rng(0)
    measured = rng.standard_normal((100, 2))
    balancer = np.column_stack([10.0 * np.ones(100), 0.1 * measured[:, 1]])
    share = _share(balancer, measured)
    assert share[0] <= 1.0
    assert share[0] > 0.9
    assert share[1] == pytest.approx(0.1)


def test_what_no_effect_explains_is_reported_with_joint_and_signal() -> None:
    found = diagnosed(9, Effect("sticky_window", 3, 0.1))
    assert found.verdict == "unexplained"
    assert 3 in [u.joint for u in found.unexplained]
    assert "q" in next(u for u in found.unexplained if u.joint == 3).depends_on


def test_without_the_commanded_motion_it_says_that_it_knows_less() -> None:
    found = diagnosed(7, Effect("gear_ripple", 4, 0.1), reference=False)
    assert [(f.effect.kind, f.effect.joint) for f in found.findings] == [("gear_ripple", 4)]
    assert any("q_ref" in text for text in found.weak)


def test_findings_file_keeps_the_contract(tmp_path: Path) -> None:
    found = diagnosed(7, Effect("gear_ripple", 4, 0.1))
    findings, toml = found.write(tmp_path)
    content = json.loads(findings.read_text())
    assert {"verdict", "effects", "recalibrated", "unexplained", "error"} <= set(content)
    effect = content["effects"][0]
    assert {"kind", "joint", "parameters", "standard_errors", "confidence", "alternatives"} <= set(
        effect
    )
    assert set(effect["parameters"]) >= {"amplitude_Nm", "order"}
    for name in ("identification", "validation"):
        for side in ("before", "after"):
            error = content["error"][name][side]
            assert all(
                len(error[key]) == 6 for key in ("mae_Nm", "rmse_Nm", "rmse_over_mean_percent")
            )
    assert len(content["error"]["noise_floor_Nm"]) == 6
    # of each log its own: beside the other log's it was above what was left
    assert found.validation is not None
    floors = [content["error"][key] for key in ("noise_floor_Nm", "validation_noise_floor_Nm")]
    assert floors[0] == list(found.noise_floor)
    assert floors[1] == list(found.validation.noise_floor) != floors[0]
    last = lines(found)[-1].split()
    assert last[2:] == [show(v) for v in floors[1]]
    again = load_robot(toml)
    assert again.effects == found.robot.effects
    np.testing.assert_allclose(again.friction, found.robot.friction)


def test_a_log_of_another_arm_is_refused() -> None:
    time = np.arange(0, 5, 0.004)
    log = Log(time, np.sin(time[:, None] * np.ones(3)), np.ones((len(time), 3)))
    with pytest.raises(InputError, match="found 3 joints, expected 6"):
        diagnose(load_robot("irb2400"), log)


def test_an_elastic_joint_comes_with_the_spread_of_its_stiffness() -> None:
    case = Case(
        3, (Effect("elastic_joint", 4, 0.1),), duration=16.0, validation_duration=3.0, chirp=True
    )
    log = next(iter(case.simulate()))
    found = diagnose(load_robot("irb2400"), Log(log.time, log.q, log.tau, q_ref=log.q_ref))
    assert [(f.effect.kind, f.effect.joint) for f in found.findings] == [("elastic_joint", 4)]
    # how it swings on unseen rows nobody knows
    assert found.findings[0].validation_gain is None
    value = found.findings[0].effect.parameters()
    sigma = found.findings[0].standard_errors
    for name in ("stiffness_Nm_rad", "damping_ratio"):
        assert 1e-4 * value[name] < sigma[name] < 0.5 * value[name]
