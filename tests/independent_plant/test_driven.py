"""Somebody's controller instead of the plant's own servo: what it sees, when its torque acts, how
it may fail."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from . import native
from .case import Case
from .machine import Driven
from .parameters import TORQUE_LIMITS

CASE = Case(3, duration=1.0, validation_duration=4.0)


def _servo(case: Case, seen: list[tuple[np.ndarray, np.ndarray]]) -> Driven:
    """Gravity of the true arm and a stiff cascade."""
    reference = case.motions[1].q
    arm = case.machine.arm.packed()
    kv = case.machine.servo.table[:, 3] / 4

    def drive(sample: int, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
        seen.append((q, qd))
        weight = native.equations_of_motion(arm, q, np.zeros(6))[1]
        return weight + kv * (20.0 * (reference[sample] - q) - qd)

    return case.drive(drive)


def test_a_simple_servo_follows_the_motion() -> None:
    seen: list[tuple[np.ndarray, np.ndarray]] = []
    run = _servo(CASE, seen)
    assert len(run.q) == len(run.q_ref) == len(seen) - 1000
    error = np.degrees(run.q - run.q_ref)
    assert 0.1 < np.abs(error).max() < 8.0
    assert run.tip_error.max() < 0.3


def test_it_sees_quantised_angles_and_filtered_speeds() -> None:
    seen: list[tuple[np.ndarray, np.ndarray]] = []
    run = _servo(CASE, seen)
    q, qd = (np.array(x)[1000:] for x in zip(*seen, strict=True))
    np.testing.assert_allclose(q / 5e-6, np.round(q / 5e-6), atol=1e-6)
    np.testing.assert_allclose(q, run.q, atol=2.6e-6)
    assert 1e-4 < np.median(np.abs(qd - run.qd)) < 5e-3


def test_a_torque_acts_a_millisecond_late_and_within_the_limits() -> None:
    asked = np.linspace(0.0, 3.0, 40)[:, None] * TORQUE_LIMITS
    plant, laws = CASE.machine.structures()
    out = native.driven(
        plant,
        laws,
        0.0,
        np.zeros(6),
        40,
        lambda k, q, qd: asked[k],
        encoder_step=5e-6,
        speed_corner=1500.0,
    )
    np.testing.assert_array_equal(out[1:, 12:18], np.minimum(asked[:-1], TORQUE_LIMITS))


def test_a_wrong_encoder_zero_shows_in_the_true_angles_only() -> None:
    from .effects import Effect

    case = Case(3, (Effect("encoder_zero", 2, 0.05),), duration=5.0, validation_duration=2.0)
    size = case.truth[0].size
    seen: list[tuple[np.ndarray, np.ndarray]] = []
    run = _servo(case, seen)
    q = np.array([x for x, _ in seen])[1000:]
    np.testing.assert_allclose(q[:, 1] - run.q[:, 1], size, atol=3e-6)


def test_an_error_of_the_controller_comes_back() -> None:
    def broken(sample: int, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
        raise RuntimeError(f"broken at {sample}")

    with pytest.raises(RuntimeError, match="broken at 0"):
        CASE.drive(broken)


def test_the_plant_knows_nothing_of_the_library() -> None:
    here = Path(__file__)
    sources = [p for p in here.parent.rglob("*") if p.suffix in {".py", ".c", ".h"} and p != here]
    assert len(sources) > 15
    assert not [p.name for p in sources if "irb2400_ctrl" in p.read_text()]
