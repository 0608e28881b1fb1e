"""The cheap friction of the controllers against eq. 55, which plant and model keep."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from simulation.arms import START, arm

from irb2400_ctrl.controllers import controller
from irb2400_ctrl.controllers.stribeck import BELL_ERROR, fade, faded_bell
from irb2400_ctrl.model import Model
from irb2400_ctrl.model.friction import FrictionLaw

X = ca.SX.sym("x")
WIDTH = np.array([0.01])


def bell_at(x: np.ndarray, height: float = 1.0) -> np.ndarray:
    """The bell beside a reference that moves, so that nothing fades."""
    bell = faded_bell(X, WIDTH, np.array([height]), ca.SX(1.0), ca.SX(0.0))
    fn = ca.Function("bell", [X], [bell])
    return np.asarray(fn(x.reshape(1, -1))).ravel()


@pytest.mark.parametrize("height", [1.0, 26.0, -3.0, 0.0])
def test_bell_is_the_exponential_within_its_bound(height: float) -> None:
    speed = np.concatenate([np.linspace(-0.1, 0.1, 20001), [-5.0, 5.0, 100.0]])
    found = bell_at(speed, height)
    exact = height * np.exp(-((speed / WIDTH) ** 2))
    assert np.abs(found - exact).max() <= BELL_ERROR * abs(height)
    # the bound is no wider than it has to be
    assert np.abs(found - exact).max() >= 0.98 * BELL_ERROR * abs(height)
    assert bell_at(np.zeros(1), height)[0] == pytest.approx(height, rel=1e-14)
    assert (found * np.sign(height) >= 0).all()
    rising = speed[:20001] > 0
    assert (np.diff(np.abs(found[:20001][rising])) <= 0).all()


def test_what_is_not_a_number_stays_so() -> None:
    assert np.isnan(bell_at(np.array([np.nan]))).all()


def test_fade() -> None:
    fn = ca.Function("fade", [X], [fade(X, ca.SX(0.005))])
    speeds = np.array([[0.0, 0.005, -0.005, 0.015, 1.0]])
    np.testing.assert_allclose(
        np.asarray(fn(speeds)).ravel(), [0, 0.5, 0.5, 0.9, 1 / (1 + 2.5e-5)], rtol=1e-14
    )


@pytest.mark.parametrize("name", ["computed_torque", "feedforward_pid"])
def test_friction_of_a_moving_reference_is_eq_55(name: str) -> None:
    """Whatever the measured speed: eq. 55 in the direction of the reference, within the bound and
    what fades."""
    robot = arm()
    block = controller(name, robot)
    static = robot.friction[:, 0]
    coulomb = robot.friction[:, 1]
    viscous = robot.friction[:, 2]
    ref = 0.5 * np.array([1.0, -1, 1, -1, 1, -1])
    slip = ca.SX.sym("slip", 6)
    wanted = ca.Function("wanted", [slip], [FrictionLaw.of(robot).dry(slip, ca.DM(np.sign(ref)))])
    for qd in np.linspace(0, 0.05, 40)[:, None] * np.ones(6):
        values = {f.name: f.start for f in (*block.states, *block.parameters)}
        values |= {"q": START, "q_ref": START, "qd": qd, "qd_ref": ref, "qdd_ref": np.zeros(6)}
        values |= {g: np.zeros(6) for g in ("kp", "kd", "kv", "ki", "feedforward") if g in values}
        given = [values[f.name] for f in (*block.states, *block.inputs, *block.parameters)]
        tau = np.asarray(block.step.call(given)[len(block.states)]).ravel()
        speed = qd if name == "computed_torque" else ref
        rigid = Model(robot).inverse_dynamics(START, speed, np.zeros(6), friction=False)
        dry = tau - rigid - viscous * ref
        exact = np.asarray(wanted(qd)).ravel()
        # sign and fade lack (0.002 / 0.5)^2 / 2 of all and (breakaway / 0.5)^2 of the static part
        bound = BELL_ERROR * (static - coulomb) + 8e-6 * static + 1e-4 * (static - coulomb)
        assert (np.abs(dry - exact) <= bound).all()
