"""The second plant's arm: equal to two other engines without effects, and to itself in motion."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest
from independent_plant import native
from independent_plant.parameters import FRICTION, RANGES, drawn_arm, paper_arm

from .machine import RATE, Machine
from .mjcf import TO_LINKS

STATES = Path(__file__).parents[1] / "data" / "irb2400_states.json"


def _machine(seed: int = 3) -> Machine:
    rng = np.random.default_rng(seed)
    return Machine.drawn(rng, *drawn_arm(rng))


@pytest.mark.skipif(not STATES.exists(), reason="the reference states are not here")
def test_torques_match_pinocchios() -> None:
    machine = replace(_machine(), arm=paper_arm())
    states = json.loads(STATES.read_text())["states"]
    q, qd, qdd = (np.array([s[k] for s in states]) for k in ("q", "qd", "qdd"))
    np.testing.assert_allclose(
        machine.rigid_torque(q, qd, qdd), [s["tau_rigid"] for s in states], atol=1e-7
    )
    np.testing.assert_allclose(machine.mass_matrix(q[0]), states[0]["mass_matrix"], atol=1e-9)


def test_a_drawn_loaded_arm_matches_the_first_plant() -> None:
    rng = np.random.default_rng(4)
    arm, friction = drawn_arm(rng)
    arm = replace(
        arm,
        rotor=np.array([3.0, 2.0, 4.0, 0.2, 0.1, 0.1]),
        payload=np.array([4.0, 0.05, 0.02, 0.2, 0.02, 0.02, 0.02, 0.0, 0.0, 0.0]),
        gravity=np.array([0.5, -0.3, -9.7]),
    )
    machine = Machine.drawn(rng, arm, friction)
    q = rng.uniform(RANGES[:, 0], RANGES[:, 1], (20, 6))
    qd = rng.uniform(-2, 2, (20, 6))
    qdd = rng.uniform(-5, 5, (20, 6))
    expected = native.inverse_dynamics(arm.packed(), q, qd, qdd)
    np.testing.assert_allclose(machine.rigid_torque(q, qd, qdd), expected, atol=1e-7)


def test_the_closed_loop_needs_what_inverse_dynamics_and_friction_say() -> None:
    machine = _machine()
    time = np.arange(3000) / RATE
    phase = np.arange(6)
    reference = 0.3 + 0.4 * np.sin(2 * np.pi * 0.5 * time[:, None] + phase)
    record = machine.closed_loop([], reference, 0.0)
    qdd = np.gradient(record[:, 6:12], 1 / RATE, axis=0)
    q, qd, tau, qdd = (x[1000:-10:5] for x in (*np.split(record, 3, axis=1), qdd))
    left = tau - machine.rigid_torque(q, qd, qdd) - machine.friction_torque(qd)
    moving = np.abs(qd) > 0.2
    for j in range(6):
        assert left[moving[:, j], j].std() < 0.02 * tau[:, j].std()


def test_friction_is_the_papers_in_steady_motion() -> None:
    machine = replace(_machine(), friction=FRICTION)
    steady = machine.friction_torque(np.full((1, 6), 1.0))[0]
    np.testing.assert_allclose(steady, FRICTION[:, 1] + FRICTION[:, 2], rtol=1e-9)


def test_axis_3_is_absolute_in_the_model_text() -> None:
    machine = _machine()
    data = mujoco.MjData(machine.model)
    q = np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
    data.qpos[:6] = TO_LINKS @ q
    mujoco.mj_forward(machine.model, data)
    np.testing.assert_allclose(data.actuator_length[:6], q, atol=1e-12)


def test_a_runaway_is_said() -> None:
    machine = replace(_machine(), bandwidth=np.full(6, 8000.0))
    reference = 0.3 * np.sin(np.arange(2000) / 200)[:, None] * np.ones(6)
    with pytest.raises(RuntimeError, match="ran away"):
        machine.closed_loop([], reference, 0.0)
