"""The friction law: one set of numbers, the same torque in every form, bounds that hold."""

from __future__ import annotations

import casadi as ca
import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from irb2400_ctrl import load_robot
from irb2400_ctrl.model import Model
from irb2400_ctrl.model.friction import FrictionLaw

Array = npt.NDArray[np.float64]

ROBOT = load_robot("irb2400")
LAW = FrictionLaw.of(ROBOT)
SPEEDS = np.random.default_rng(0).normal(size=(200, 6)) * np.geomspace(1e-4, 3, 200)[:, None]


def laws() -> st.SearchStrategy[FrictionLaw]:
    """Any numbers, static friction below Coulomb's included."""
    sizes = arrays(float, (4, 3), elements=st.floats(0.001, 200))
    return sizes.map(lambda numbers: FrictionLaw(*numbers))


def test_the_law_is_equation_55() -> None:
    static, coulomb, viscous, stribeck = ROBOT.friction.T
    size = coulomb + (static - coulomb) * np.exp(-((np.abs(SPEEDS) / stribeck) ** 2))
    expected = size * np.sign(SPEEDS) + viscous * SPEEDS
    np.testing.assert_allclose(LAW.torque(SPEEDS), expected, rtol=1e-14)
    np.testing.assert_allclose(LAW.dry(SPEEDS), expected - viscous * SPEEDS, rtol=1e-12)
    np.testing.assert_allclose(LAW.level(SPEEDS), size, rtol=1e-14)


def test_arrays_and_symbols_give_the_same_torque() -> None:
    qd = ca.SX.sym("qd", 6)
    table = ca.SX.sym("table", 6, 4)
    given_table = FrictionLaw.of_table(table).torque(qd)
    both = ca.Function("both", [qd, table], [LAW.torque(qd), given_table])
    expected = LAW.torque(SPEEDS)
    for speed, torque in zip(SPEEDS, expected, strict=True):
        for found in both(speed, ROBOT.friction):
            np.testing.assert_allclose(np.asarray(found).ravel(), torque, rtol=1e-13)
    np.testing.assert_allclose(Model(ROBOT).friction(SPEEDS), expected, rtol=1e-13)


def test_direction_can_be_given_at_rest() -> None:
    still = np.zeros(6)
    np.testing.assert_array_equal(LAW.torque(still), still)
    np.testing.assert_allclose(LAW.torque(still, -np.ones(6)), -LAW.static, rtol=1e-14)


def test_regressor_times_the_numbers_is_the_torque() -> None:
    parts = LAW.regressor(SPEEDS)
    numbers = (LAW.coulomb, LAW.viscous, LAW.static)
    found = sum(part * number for part, number in zip(parts, numbers, strict=True))
    np.testing.assert_allclose(found, LAW.torque(SPEEDS), rtol=1e-12)


@pytest.mark.parametrize(("place", "column"), [(0, 1), (1, 2), (2, 0)])
def test_regressor_is_the_derivative(place: int, column: int) -> None:
    step = np.zeros((6, 4))
    step[:, column] = 1e-3
    up = FrictionLaw.of_table(ROBOT.friction + step).torque(SPEEDS)
    down = FrictionLaw.of_table(ROBOT.friction - step).torque(SPEEDS)
    slope = (up - down) / 2e-3
    np.testing.assert_allclose(LAW.regressor(SPEEDS)[place], slope, rtol=1e-8, atol=1e-9)


@given(laws(), st.floats(0, 2))
def test_level_stays_in_its_range(law: FrictionLaw, slowest: float) -> None:
    least, largest = law.level_range(np.full((1, 3), slowest**2))
    seen = law.level(slowest + np.linspace(0, 5, 300)[:, None])
    room = 1e-12 * (law.static + law.coulomb)
    assert (seen >= least - room).all()
    assert (seen <= largest + room).all()


@given(laws(), st.floats(0, 2))
def test_dry_friction_stays_in_its_range(law: FrictionLaw, slowest: float) -> None:
    speeds = slowest + np.linspace(1e-9, 5, 100)[:, None]
    room = 1e-12 * (law.static + law.coulomb)
    for forwards, backwards in ((True, False), (False, True), (True, True)):
        masks = (np.array(forwards), np.array(backwards))
        bottom, top = law.dry_range(np.full((1, 3), slowest**2), *masks)
        for moves, sign in zip(masks, (1, -1), strict=True):
            if moves:
                seen = law.dry(sign * speeds)
                assert (seen <= top + room).all()
                assert (seen >= bottom - room).all()
    nothing = law.dry_range(np.zeros((1, 3)), np.array(False), np.array(False))
    np.testing.assert_array_equal(nothing, 0.0)


def test_largest_level_is_reached_at_the_slowest_speed() -> None:
    slowest = np.full((1, 6), 0.01)
    np.testing.assert_allclose(LAW.level_range(slowest**2)[1], LAW.level(slowest), rtol=1e-13)


def test_smooth_forms_are_on_the_safe_side_and_become_the_law() -> None:
    qd = ca.SX.sym("qd", 6)
    width = np.maximum(0.02, LAW.stribeck)
    forms = ca.Function("forms", [qd], [LAW.worst(qd, width), LAW.smoothed(qd, width)])
    for speed in SPEEDS:
        worst, smoothed = (np.asarray(v).ravel() for v in forms(speed))
        # tanh is within four per cent of one where the sign has turned
        assert (worst >= LAW.dry(speed) - 0.04 * LAW.level(speed)).all()
        fast = np.abs(speed) > 3 * width
        close = np.abs(smoothed - LAW.coulomb * np.sign(speed)) < 0.01 * LAW.coulomb
        assert close[fast].all()


def test_rate_of_a_reversal_adds_up_to_the_jump() -> None:
    qd = ca.SX.sym("qd", 6)
    qdd = ca.SX.sym("qdd", 6)
    rate = ca.Function("rate", [qd, qdd], [LAW.reversal_rate(qd, qdd)])
    acceleration = 2.0
    time = np.linspace(-0.3, 0.3, 6001)
    table = np.array([np.asarray(rate(acceleration * t, acceleration)).ravel() for t in time])
    jump = (table.sum(axis=0) - (table[0] + table[-1]) / 2) * (time[1] - time[0])
    np.testing.assert_allclose(jump, 2 * LAW.coulomb, rtol=1e-6)


def test_dry_friction_turns_over_within_twice_the_width() -> None:
    """One width behind its reversal a joint may stand, one width beyond it is sure to slide."""
    width = 0.01
    qd = ca.SX.sym("qd", 6)
    worst = ca.Function("worst", [qd], [LAW.worst(qd, width)])

    def at(speed: float) -> Array:
        return np.asarray(worst(np.full(6, speed))).ravel()

    rise = np.maximum(LAW.static - LAW.coulomb, 0.0)
    np.testing.assert_allclose(at(-width), rise * np.exp(-1.0), rtol=1e-12)
    np.testing.assert_allclose(at(0.0), np.tanh(2.0) * LAW.coulomb + rise, rtol=1e-12)


@pytest.mark.parametrize("gained", [0.1, 1.0, 20.0])
def test_the_jump_at_a_reversal_is_spread_over_its_time(gained: float) -> None:
    """Within 5 mrad/s, and what the joint gains in 5 ms."""
    qd, qdd = (ca.SX.sym(name, 6) for name in ("qd", "qdd"))
    rate = ca.Function("rate", [qd, qdd], [LAW.reversal_rate(qd, qdd)])
    found = np.asarray(rate(np.zeros(6), np.full(6, gained))).ravel()
    width = 0.005 + 0.005 * gained
    np.testing.assert_allclose(found * width / gained, LAW.coulomb, rtol=1e-12)
