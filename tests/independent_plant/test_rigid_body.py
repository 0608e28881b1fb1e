"""The plant's rigid body: parity with an independent engine, and the laws of mechanics."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from . import native
from .parameters import FRICTION, Arm, drawn_arm, join, paper_arm

STATES = Path(__file__).parents[1] / "data" / "irb2400_states.json"
states = pytest.mark.skipif(not STATES.exists(), reason="the reference states are not here")


def _states() -> list[dict[str, np.ndarray]]:
    return [
        {k: np.array(v) for k, v in s.items()} for s in json.loads(STATES.read_text())["states"]
    ]


def _loaded_arm() -> Arm:
    """With a rod and rotors, so that these terms are in every identity."""
    arm, _ = drawn_arm(np.random.default_rng(5))
    return replace(
        arm, rod=np.array([14.0, 0.2, 3.0, 0.35]), rotor=np.array([3.0, 2.0, 2.0, 0.2, 0.1, 0.1])
    )


@states
def test_torques_mass_matrix_gravity_and_friction_match_the_reference() -> None:
    arm = paper_arm().packed()
    for s in _states():
        mass, bias = native.equations_of_motion(arm, s["q"], s["qd"])
        _, gravity = native.equations_of_motion(arm, s["q"], np.zeros(6))
        np.testing.assert_allclose(mass, s["mass_matrix"], atol=1e-10)
        np.testing.assert_allclose(gravity, s["gravity"], atol=1e-9)
        np.testing.assert_allclose(mass @ s["qdd"] + bias, s["tau_rigid"], atol=1e-9)
        np.testing.assert_allclose(
            native.inverse_dynamics(arm, s["q"], s["qd"], s["qdd"]), s["tau_rigid"], atol=1e-9
        )
        fs, fc, fv, stribeck = FRICTION.T
        dry = fc + (fs - fc) * np.exp(-((s["qd"] / stribeck) ** 2))
        np.testing.assert_allclose(dry * np.sign(s["qd"]) + fv * s["qd"], s["friction"], atol=1e-9)


@states
def test_tool_forces_match_the_reference_jacobian() -> None:
    tip = np.array([0.240, 0.0, 0.085 + 0.162])
    force = np.array([30.0, -20.0, 50.0])
    for s in _states():
        tau = native.torque_against_force(s["q"], tip, force)
        np.testing.assert_allclose(tau, -s["J_tcp"][:3].T @ force, atol=1e-9)


def test_mass_matrix_is_symmetric_and_inverse_dynamics_agrees_with_it() -> None:
    rng = np.random.default_rng(1)
    arm = _loaded_arm().packed()
    for _ in range(20):
        q = rng.uniform(-1, 1, 6)
        qd = rng.uniform(-3, 3, 6)
        qdd = rng.uniform(-9, 9, 6)
        mass, bias = native.equations_of_motion(arm, q, qd)
        np.testing.assert_allclose(mass, mass.T, atol=1e-11)
        np.testing.assert_allclose(
            native.inverse_dynamics(arm, q, qd, qdd), mass @ qdd + bias, atol=1e-9
        )


def _energy_drift(dt: float) -> float:
    """Kinetic energy gained less the work of gravity in 0.64 s of free swing [J], at most."""
    from scipy.integrate import simpson

    arm = _loaded_arm().packed()
    start = np.concatenate([[0.3, 0.2, -0.1, 0.4, 0.8, -0.3], [0.5, -0.4, 0.3, 1.0, -0.8, 0.6]])
    swung = native.swing(arm, dt, round(0.64 / dt) + 1, start)
    kinetic = []
    power = []
    for state in swung:
        q = state[:6]
        qd = state[6:]
        mass, _ = native.equations_of_motion(arm, q, qd)
        gravity = native.equations_of_motion(arm, q, np.zeros(6))[1]
        kinetic.append(0.5 * qd @ mass @ qd)
        power.append(-gravity @ qd)
    return float(abs(kinetic[-1] - kinetic[0] - simpson(power, dx=dt)))


def test_a_free_swing_keeps_its_energy_to_fourth_order() -> None:
    coarse = _energy_drift(0.02)
    fine = _energy_drift(0.01)
    assert fine < 1e-3
    assert 3.3 < np.log2(coarse / fine) < 5.0


def test_gravity_comes_from_a_potential() -> None:
    arm = _loaded_arm().packed()
    q = np.array([0.3, 0.2, -0.1, 0.4, 0.8, -0.3])
    h = 1e-5
    columns = []
    for j in range(6):
        step = h * np.eye(6)[j]
        ahead, behind = (
            native.equations_of_motion(arm, q + s, np.zeros(6))[1] for s in (step, -step)
        )
        columns.append((ahead - behind) / (2 * h))
    hessian = np.array(columns)
    np.testing.assert_allclose(hessian, hessian.T, atol=1e-6)


def test_joining_bodies_keeps_mass_moment_and_inertia() -> None:
    a = np.array([2.0, 0.1, 0.0, -0.2, 0.3, 0.2, 0.1, 0.0, 0.01, 0.0])
    b = np.array([3.0, -0.1, 0.2, 0.1, 0.1, 0.1, 0.1, 0.0, 0.0, 0.0])
    both = join(a, b)

    def at_origin(body: np.ndarray) -> np.ndarray:
        i = body[4:]
        c = body[1:4]
        tensor = np.array([[i[0], i[3], i[4]], [i[3], i[1], i[5]], [i[4], i[5], i[2]]])
        return np.asarray(tensor + body[0] * (c @ c * np.eye(3) - np.outer(c, c)))

    np.testing.assert_allclose(at_origin(both), at_origin(a) + at_origin(b))
    np.testing.assert_allclose(both[0] * both[1:4], a[0] * a[1:4] + b[0] * b[1:4])


@states
def test_the_tip_is_where_the_reference_has_the_tcp() -> None:
    given = _states()
    tips = native.tool_tip(np.array([s["q"] for s in given]))
    np.testing.assert_allclose(tips, [s["X_BT"][:3, 3] for s in given], atol=1e-12)
