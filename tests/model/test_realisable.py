"""Whether bodies exist that make a robot's torques."""

from __future__ import annotations

import casadi as ca
import numpy as np
from model.second_robots import ur_like
from model.states import States, random_states

import irb2400_ctrl as irb
from irb2400_ctrl.model import newton_euler
from irb2400_ctrl.model.consistency import check
from irb2400_ctrl.model.realisable import realise


def torque(robot: irb.Robot, phi: np.ndarray, states: States) -> np.ndarray:
    symbols = [ca.SX.sym(name, robot.n) for name in ("q", "qd", "qdd")]
    f = ca.Function("f", symbols, [newton_euler.inverse_dynamics(robot, *symbols, ca.DM(phi))])
    return np.array(f(states.q.T, states.qd.T, states.qdd.T)).T


def test_no_bodies_make_the_torques_of_table_3(robot: irb.Robot, states: States) -> None:
    """So every consistent set changes the torques: the projection's difference cannot be had for
    nothing."""
    found = realise(robot)
    assert not found.exists
    assert -0.12 < found.margin < -0.11
    expected = torque(robot, robot.inertial_parameters, states)
    np.testing.assert_allclose(
        torque(robot, found.phi, states), expected, rtol=0, atol=1e-9 * np.abs(expected).max()
    )


def test_the_margin_is_the_best_there_is(robot: irb.Robot) -> None:
    """No step along what the torque does not see makes the worst eigenvalue better (the problem is
    convex)."""
    from irb2400_ctrl.model.realisable import _pseudo_inertias

    found = realise(robot)
    matrix = irb.Model(robot).base_parameters.matrix
    unseen = np.linalg.svd(matrix)[2][36:]
    rng = np.random.default_rng(0)
    for size in (1e-3, 1e-2, 0.1):
        for z in rng.normal(size=(100, len(unseen))):
            moved = _pseudo_inertias(found.phi.ravel() + size * z @ unseen, 6)
            assert np.linalg.eigvalsh(moved).min() < found.margin + 1e-4


def test_bodies_are_found_behind_an_impossible_table() -> None:
    """A table spoilt only where the torque does not see it (mass moved along the axes) is repaired
    for nothing."""
    arm = ur_like()
    links = list(arm.links)
    body = links[5].body
    assert body.mass_kg > 0
    spoilt = body.model_copy(
        update={
            "inertia_kgm2": (
                *(value - 0.2 for value in body.inertia_kgm2[:2]),
                *body.inertia_kgm2[2:],
            )
        }
    )
    links[5] = links[5].model_copy(update={"body": spoilt})
    # what link 6 lost about x and y rides on link 5 instead
    carrier = links[4].body
    X = links[5].frame.matrix()
    added = X[:3, :3] @ np.diag([0.2, 0.2, 0.0]) @ X[:3, :3].T
    i = (0, 1, 2, 0, 0, 1)
    j = (0, 1, 2, 1, 2, 2)
    six = tuple(float(v + added[a, b]) for v, a, b in zip(carrier.inertia_kgm2, i, j, strict=True))
    links[4] = links[4].model_copy(
        update={"body": carrier.model_copy(update={"inertia_kgm2": six})}
    )
    table = arm.model_copy(update={"links": tuple(links)})
    assert check(table)
    found = realise(table)
    assert found.exists
    states = random_states(arm, 50)
    expected = torque(arm, arm.inertial_parameters, states)
    np.testing.assert_allclose(
        torque(arm, found.phi, states), expected, rtol=0, atol=1e-9 * np.abs(expected).max()
    )
