"""Laws whose simplest form is too simple for what an arm has."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from diagnosis.test_names import ROBOT, names, sound, speed, with_torque

from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.diagnosis.comparison.possible import possible
from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.effects.cable_spring import CableSpring
from irb2400_ctrl.effects.coulomb_asymmetry import CoulombAsymmetry
from irb2400_ctrl.effects.torque_offset import TorqueOffset
from irb2400_ctrl.effects.viscous_warmup import ViscousWarmup
from irb2400_ctrl.errors import InputError


def only(found: Any, kind: str, joint: int) -> Any:
    assert names(found) == [(kind, joint)]
    assert found.verdict == "explained"
    (finding,) = found.findings
    return finding.effect


def test_a_hose_that_stiffens_is_a_cable() -> None:
    """A cubic one (9.6 and 31 Nm at one radian, over one radian of travel) had no name."""
    angle = sound().q[:, 3]
    rest = float(np.mean(angle)) + 0.1
    half = float(np.ptp(angle)) / 2
    u = (angle - rest) / half
    spring = only(diagnose(ROBOT, with_torque(4, 2.0 * u + 6.0 * u**3)), "cable_spring", 4)
    assert isinstance(spring, CableSpring)
    assert spring.neutral_rad == pytest.approx(rest, abs=0.05 * half)
    assert spring.stiffness_Nm_rad * half == pytest.approx(2.0, abs=0.5)
    assert spring.stiffening_Nm_rad3 * half**3 == pytest.approx(6.0, rel=0.15)


@pytest.mark.slow
def test_one_that_pulls_along_a_line_is_told_by_its_stiffness_alone() -> None:
    angle = sound().q[:, 3]
    spring = only(diagnose(ROBOT, with_torque(4, 6.0 * (angle - 0.2))), "cable_spring", 4)
    assert spring.stiffening_Nm_rad3 == 0.0
    assert spring.one_sided == 0.0


@pytest.mark.parametrize("one_sided", [-1.0, -0.3, 0.0, 0.8])
def test_the_numbers_of_a_hose_come_back_from_its_polynomial(one_sided: float) -> None:
    hose = CableSpring.of(
        4, stiffness_Nm_rad=8.0, neutral_rad=0.7, stiffening_Nm_rad3=20.0, one_sided=one_sided
    )
    back = CableSpring.from_coefficients(4, hose.coefficients(), {})
    for name in CableSpring.linear:
        assert getattr(back, name) == pytest.approx(getattr(hose, name), abs=1e-6), name
    u = np.linspace(-2.0, 2.0, 9)
    k = 8.0
    c = 20.0
    torque = k * u + one_sided * np.sqrt(3 * k * c) * u**2 + c * u**3
    np.testing.assert_allclose(np.polyval(hose.coefficients(), u + 0.7), torque, atol=1e-9)
    assert (np.diff(torque) > 0.0).all()


@pytest.mark.parametrize(
    "polynomial",
    [(1.0, 5.0, 1.0, 0.0), (1.0, 0.0, -1.0, 0.0), (0.0, 0.1, 1.0, 0.0), (-0.3, 0.0, 1.0, 0.2)],
    ids=["falls on one side", "falls in the middle", "a parabola", "falls outside"],
)
def test_what_falls_somewhere_is_no_hose(polynomial: tuple[float, ...]) -> None:
    with pytest.raises((InputError, ValueError, ZeroDivisionError)):
        CableSpring.from_coefficients(4, polynomial, {})


@pytest.mark.slow
def test_friction_may_differ_by_direction_in_both_its_parts() -> None:
    """An arm with 2.1 Nm and 1.6 Nm s/rad more one way than on average had a law of the speed
    without a name."""
    rate = speed(4)
    more = 2.0 * np.tanh(np.abs(rate) / 0.002) + 1.6 * np.abs(rate)
    found = only(diagnose(ROBOT, with_torque(4, more)), "coulomb_asymmetry", 4)
    assert isinstance(found, CoulombAsymmetry)
    assert found.delta_Nm == pytest.approx(2.0, abs=0.3)
    assert found.viscous_Nms_rad == pytest.approx(1.6, rel=0.2)


@pytest.mark.slow
def test_an_offset_that_drifts_is_one_offset() -> None:
    """One of 3.4 Nm that drifted by a fifth was an offset in two steps and a friction that differs
    by direction (0.94)."""
    time = sound().time
    drifting = 3.0 * (0.8 + 0.4 * (time - time[0]) / np.ptp(time))
    offset = only(diagnose(ROBOT, with_torque(4, drifting)), "torque_offset", 4)
    assert isinstance(offset, TorqueOffset)
    assert offset.offset_Nm == pytest.approx(3.0, abs=0.8)
    # of the drift a file says nothing: another log begins elsewhere
    assert offset.discrepancy == ()


def test_a_drift_that_a_file_states_is_in_the_readings() -> None:
    time = np.linspace(0.0, 10.0, 5)
    true = np.ones((5, 6))
    read = TorqueOffset.of(4, offset_Nm=3.0, discrepancy=(-0.1,)).reported(time, true)
    np.testing.assert_allclose(read[:, 3], 4.0 - 0.1 * time)
    np.testing.assert_array_equal(np.delete(read, 3, axis=1), 1.0)


@pytest.mark.parametrize(
    ("viscous", "can_be"), [(1.6, True), (0.0, True), (-0.3, True), (-0.35, False), (-9.0, False)]
)
def test_friction_that_is_larger_one_way_is_so_at_every_speed(viscous: float, can_be: bool) -> None:
    """Twice the size of a speed, less a constant, passed for its square (0.98). One that fades with
    the speed (2,267 sigma) is one."""
    fastest = ROBOT.qd_max[3]  # 6.28 rad/s
    effect = CoulombAsymmetry.of(4, delta_Nm=2.0, viscous_Nms_rad=viscous)
    assert possible(ROBOT, effect) == can_be == (2.0 + viscous * fastest >= 0.0)
    other = CoulombAsymmetry.of(4, delta_Nm=-2.0, viscous_Nms_rad=-viscous)
    assert possible(ROBOT, other) == can_be


def test_play_is_looked_for_up_to_more_than_a_degree() -> None:
    """1.3 degrees on axis 5 had no name: half a degree was the widest flight of the grid."""
    flights = [point["flight_rad"] for point in LIBRARY["transmission_backlash"].grid(5)]
    assert max(flights) > np.radians(1.5)
    assert min(flights) == pytest.approx(1e-4)


@pytest.mark.parametrize(
    ("cold", "below"),
    [
        *(pytest.param(*pair, marks=pytest.mark.slow) for pair in ((5.0, 0.0), (0.0, 5.0))),
        (3.0, 4.0),
    ],
)
def test_a_gear_warms_up_from_whatever_the_file_states(cold: float, below: float) -> None:
    """One whose file holds its friction of the morning (5,710 and 617 sigma) had no name: what is
    left at the end of a record was taken for the file's."""
    time = sound().time - sound().time[0]
    level = np.exp(-time / 15.0)
    log = with_torque(4, (cold * level - below * (1.0 - level)) * speed(4))
    warm = only(diagnose(ROBOT, log), "viscous_warmup", 4)
    assert isinstance(warm, ViscousWarmup)
    assert warm.viscous_Nms_rad == pytest.approx(cold + below, rel=0.2)
    assert warm.below_Nms_rad == pytest.approx(below, abs=0.2 * (cold + below))
    assert warm.time_constant_s == pytest.approx(15.0, rel=0.35)


def test_what_stays_when_a_gear_is_warm_is_no_warm_up() -> None:
    """Its extra friction must stand clear of its error: what the file states has no say in it."""
    warm = ViscousWarmup.of(4, viscous_Nms_rad=3.0, below_Nms_rad=5.0, time_constant_s=15.0)
    assert warm.sizes() == (3.0,)
    assert warm.coefficients() == (3.0, 5.0)
