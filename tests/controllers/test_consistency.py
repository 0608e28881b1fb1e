"""The guard's observers a step at a time: limits at their edges, and what they add up."""

from __future__ import annotations

import numpy as np
import pytest
from simulation.guard_steps import MODEL, ROBOT, Q, T, block, step

BANDS = {"": (100.0, 0.035), "_slow": (10.0, 0.015)}
"""bandwidth, share of the torque limit that is left unexplained"""


def load_jacobian() -> np.ndarray:
    """Of the place 150 mm from the flange, by differences, shape (3, 6)."""

    def place(q: np.ndarray) -> np.ndarray:
        return (MODEL.flange_pose(q) @ [0.0, 0.0, 0.15, 1.0])[:3]

    return np.column_stack([(place(Q + h) - place(Q - h)) / 2e-6 for h in 1e-6 * np.eye(6)])


def test_numbers_of_the_observers() -> None:
    stated = {f.name: np.asarray(f.default) for f in block(consistency=True).parameters}
    for band, (bandwidth, share) in BANDS.items():
        limit = share * ROBOT.tau_max + 0.1 * ROBOT.friction[:, 0]
        np.testing.assert_allclose(stated[f"unexplained_limit{band}"], limit)
        np.testing.assert_allclose(stated[f"observer{band}"], bandwidth)
    np.testing.assert_allclose(stated["unknown_load"], 12.5)
    np.testing.assert_allclose(stated["unknown_friction"], 0.45)


@pytest.mark.parametrize("axis", range(6))
@pytest.mark.parametrize("acceleration", [(0.0, 0.0, 0.0), (6.0, -4.0, -25.0)])
@pytest.mark.parametrize("band", BANDS)
def test_the_brake_closes_on_what_neither_load_nor_friction_explains(
    band: str, acceleration: tuple[float, ...], axis: int
) -> None:
    """At rest the momentum is zero: the bandwidth times what is thought explained is left."""
    both = block(consistency=True)
    bandwidth, share = BANDS[band]
    a = np.array(acceleration)
    load = 12.5 * (load_jacobian().T @ (np.array([0.0, 0.0, -9.81]) - a))[axis]
    limit = share * ROBOT.tau_max[axis] + 0.1 * ROBOT.friction[axis, 0]
    for doubt in (0.0, 7.0):
        ends = (limit + doubt + max(load, 0.0), -limit - doubt + min(load, 0.0))
        for end, beyond in zip(ends, (1e-3, -1e-3), strict=True):
            for torque, shut in ((end - beyond, 0), (end + beyond, 1)):
                given = {
                    f"explained{band}": -torque * np.eye(6)[axis] / bandwidth,
                    f"load_speed{band}": -a / bandwidth,
                    f"doubt{band}": doubt,
                }
                assert step(both, **given)["brake"] == shut
    # nothing is judged before the controller has the arm for itself
    assert step(both, running=0.0, **{f"explained{band}": np.full(6, 1e3)})["brake"] == 0


@pytest.mark.parametrize("band", BANDS)
def test_doubt_and_the_loads_speed_are_low_passed_as_the_torque_is(band: str) -> None:
    both = block(consistency=True)
    bandwidth = BANDS[band][0]
    qd = np.array([0.0, -0.02, 0.04, 0.5, -0.6, 0.7])
    static, coulomb, viscous, _ = ROBOT.friction.T
    moving = coulomb + viscous * np.abs(qd)
    now = 0.45 * moving + 1.45 * static / (1 + (qd / 0.04) ** 2) ** 2
    speed = load_jacobian() @ qd
    motion = {"qd": qd, "qd_last": qd, "q_last": Q - T * qd}
    # a speed that is still wrong as the observers begin may look like momentum
    begin = bandwidth * (0.0012 * ROBOT.tau_max + 0.011 * static)
    for running, doubt, carried in ((1.0, 7.0, np.array([0.3, 0.1, -0.2])), (0.0, begin, speed)):
        found = step(
            both, running=running, **motion, **{f"doubt{band}": 7.0, f"load_speed{band}": carried}
        )
        expected = doubt + T * bandwidth * (now - doubt)
        np.testing.assert_allclose(found[f"doubt{band}"], expected, rtol=1e-9)
        expected = carried + T * bandwidth * (speed - carried)
        np.testing.assert_allclose(found[f"load_speed{band}"], expected, atol=1e-8)


@pytest.mark.parametrize("band", BANDS)
def test_the_observer_adds_up_torque_and_what_the_model_says(band: str) -> None:
    both = block(consistency=True)
    name = f"explained{band}"
    qd = np.array([0.3, -0.2, 0.4, 0.5, -0.6, 0.7])
    tau = MODEL.gravity(Q) + np.array([5.0, -4.0, 3.0, 2.0, -1.0, 0.5])
    p = MODEL.mass_matrix(Q) @ qd
    given = {"qd": qd, "qd_last": qd, "q_last": Q - T * qd, "tau_last": tau}
    # started anew the arm's momentum is explained, and the residual nothing
    found = step(both, running=0.0, **given)
    # d(qd' M qd / 2)/dq by differences; friction in the measured direction
    kinetic = [
        (qd @ MODEL.mass_matrix(Q + h) @ qd - qd @ MODEL.mass_matrix(Q - h) @ qd) / 4e-6
        for h in 1e-6 * np.eye(6)
    ]
    beta = np.array(kinetic) - MODEL.gravity(Q) - MODEL.friction(qd)
    # the sign is smoothed over 0.02 rad/s: some parts in a thousand of dry friction at these speeds
    expected = p + T * (tau + beta)
    np.testing.assert_allclose(found[name], expected, atol=T * 1.0, rtol=0)
    assert found["running"] == 1
    exact = found[name] - p
    again = step(both, running=1.0, **given, **{name: p - 0.01})
    # residual (bandwidth times 0.01 kg m2/s) on every axis enters with the torque
    left = BANDS[band][0] * 0.01
    np.testing.assert_allclose(again[name], p - 0.01 + exact + T * left, atol=1e-12)
    # a sample that is not believed starts it anew, and so does a start that is not over
    assert step(both, fresh=0.0, running=1.0, **given)["running"] == 0
    assert step(block(True, 0.01), blend=0.95, running=1.0, **given)["running"] == 0
    assert step(block(True, 0.01), blend=1.0, running=1.0, **given)["running"] == 1
