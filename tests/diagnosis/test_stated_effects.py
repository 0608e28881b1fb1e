"""An effect that the robot's file states may have changed: it keeps its shape, and what is found is
its strength."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from independent_plant import Case

from irb2400_ctrl.diagnosis import Curve, Finding, diagnose, findings
from irb2400_ctrl.diagnosis.estimation.effect_parameters import (
    changed_of,
    of_changing_strength,
    parameters_of,
)
from irb2400_ctrl.diagnosis.findings import changed_instead
from irb2400_ctrl.effects import LIBRARY, Effect
from irb2400_ctrl.effects.balancer import Balancer
from irb2400_ctrl.effects.gear_ripple import GearRipple
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.robot import load_robot

STATED = Balancer(joint=2, torque_Nm=600.0, neutral_rad=0.1, lever_ratio=0.25, free_ratio=-2.0)
ROBOT = load_robot("irb2400").with_effects(STATED)


@pytest.mark.parametrize(
    ("seed", "share", "said"),
    [
        (3528000, 0.7, "30 % weaker"),
        pytest.param(3528000, 1.2, "20 % stronger", marks=pytest.mark.slow),
        pytest.param(3528001, 0.0, "100 % weaker", marks=pytest.mark.slow),
    ],
)
def test_how_much_of_its_strength_a_balancer_has_lost(seed: int, share: float, said: str) -> None:
    """It was a second balancer of another shape that "helps the axis to carry its weight"."""
    seen = Case(seed, duration=16.0, validation_duration=3.0).simulate()[0]
    d = seen.q[:, 1] - 0.1
    length = np.sqrt(1.0 + 0.25**2 - 0.5 * np.cos(d))
    tau = seen.tau.copy()
    tau[:, 1] += share * 600.0 * (1.0 + 2.0 * 0.75 / length) * np.sin(d)
    found = diagnose(ROBOT, Log(seen.time, seen.q, tau, q_ref=seen.q_ref))
    assert found.verdict == "explained"
    (one,) = found.findings
    assert one.effect.nonlinear == STATED.nonlinear
    (strength,) = one.effect.coefficients()
    assert strength == pytest.approx((share - 1.0) * 600.0, abs=15.0)
    assert one.sentence == f"Joint 2: the balancer that the file states is {said} than it says."
    assert found.robot.effects[0] == STATED


def test_what_keeps_the_shape_of_a_stated_effect_is_a_change_of_it() -> None:
    weaker = STATED.model_copy(update={"torque_Nm": -100.0})
    assert changed_of(weaker, [STATED]) == STATED
    assert [p.name for p in parameters_of(weaker, 0, [STATED])] == ["torque_Nm"]
    other = weaker.model_copy(update={"lever_ratio": 0.3})
    assert changed_of(other, [STATED]) is None
    assert len(parameters_of(other, 0, [STATED])) == 4
    ripple = GearRipple(joint=2, amplitude_Nm=1.0, order=20.0)
    assert changed_of(ripple, [STATED, ripple.model_copy(update={"joint": 3})]) is None


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (-180.0, "is 30 % weaker than it says"),
        (90.0, "is 15 % stronger than it says"),
        (-605.0, "is 100 % weaker than it says"),
        (-900.0, "acts the other way round"),
    ],
)
def test_a_change_of_strength_in_words(change: float, said: str) -> None:
    weaker = STATED.model_copy(update={"torque_Nm": change})
    assert told(weaker, STATED) == f"the balancer that the file states {said}"


def test_what_a_file_has_twice_is_one_strength() -> None:
    """A diagnosis saves the change beside the effect."""
    weaker = STATED.model_copy(update={"torque_Nm": -180.0})
    (one,) = of_changing_strength([STATED, weaker])
    assert one.torque_Nm == pytest.approx(420.0)  # type: ignore[attr-defined]
    for other in (
        STATED.model_copy(update={"windows_s": ((0.0, 5.0),)}),
        STATED.model_copy(update={"torque_Nm": 0.0}),
        LIBRARY["time_delay"].of(2, delay_s=0.01),
        LIBRARY["elastic_joint"].of(2, stiffness_Nm_rad=1e5, damping_ratio=0.05),
        LIBRARY["payload"].of(None, mass_kg=2.0),
    ):
        assert of_changing_strength([other]) == ()
    late = STATED.model_copy(update={"windows_s": ((12.0, 1e9),)})
    assert changed_of(late, [STATED]) is None


def test_another_phase_is_no_other_strength() -> None:
    stated = GearRipple(joint=2, amplitude_Nm=1.0, order=20.0, phase_rad=0.3)
    said = "the gear_ripple that the file states"
    for phase in (1.8, 0.53):
        beside = stated.model_copy(update={"phase_rad": phase})
        assert (
            told(beside, stated)
            == f"{said} is not as it says: something else of its kind adds to it"
        )
    near = stated.model_copy(update={"phase_rad": 0.47})
    assert told(near, stated) == f"{said} is 99 % stronger than it says"
    assert told(stated, stated) == f"{said} is 100 % stronger than it says"
    assert told(stated, None) == stated.sentence


def told(effect: Effect, stated: Effect | None) -> str:
    curve = Curve(2, "q", "rad", *[np.zeros(1)] * 5)
    finding = Finding(effect, {}, 0.9, (), 1.0, 1.0, np.ones(6), curve, "special", stated=stated)
    return finding.says


@pytest.mark.slow
def test_what_passes_for_a_stated_effect_may_be_that_one_become_less() -> None:
    """A cable spring of 30 Nm/rad that the file states and the arm has lost is no spring of its
    kind, which only pulls: it was a balancer at 0.96 with no alternative."""
    seen = Case(3529900, duration=16.0, validation_duration=3.0).simulate()[0]
    spring = LIBRARY["cable_spring"].of(3, stiffness_Nm_rad=30.0, neutral_rad=0.3)
    robot = load_robot("irb2400").with_effects(spring)
    found = diagnose(robot, Log(seen.time, seen.q, seen.tau, q_ref=seen.q_ref))
    (one,) = found.findings
    assert one.effect.joint == 3
    assert one.confidence <= 0.75
    assert "cable_spring" in one.alternatives


@pytest.mark.parametrize(
    ("kind", "joint", "shares", "listed"),
    [
        ("balancer", 3, (0.9, 0.1), True),
        ("balancer", 3, (0.5, 0.9), False),  # of another course
        ("balancer", 3, (3.0, 0.0), False),  # more than the file states
        ("balancer", 2, (0.9, 0.1), False),  # elsewhere
        ("cable_spring", 3, (0.9, 0.1), False),  # that itself
    ],
)
def test_what_may_have_become_less_is_of_that_joint_and_course(
    kind: str, joint: int, shares: tuple[float, float], listed: bool, monkeypatch: Any
) -> None:
    rng = np.random.default_rng(3)
    lost, other = np.zeros((2, 400, 6))
    lost[:, 2], other[:, 2] = rng.normal(size=(2, 400))
    spring = LIBRARY["cable_spring"].of(3, stiffness_Nm_rad=30.0)
    fitter: Any = SimpleNamespace(
        robot=SimpleNamespace(effects=(spring,)), stated=(), bases=None, motion=None
    )
    monkeypatch.setattr(findings, "effect_torque", lambda *given, **options: lost)
    effect = LIBRARY[kind].of(joint, **LIBRARY[kind].example)
    torque = -shares[0] * lost + shares[1] * other + 5.0
    assert changed_instead(effect, torque, fitter) == (("cable_spring",) if listed else ())
    # what was looked for as another strength has had its turn
    fitter.stated = (spring,)
    assert changed_instead(effect, torque, fitter) == ()
