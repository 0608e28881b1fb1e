"""`irb2400 simulate` says first that a motion was not followed to its end."""

from __future__ import annotations

from irb2400_ctrl.cli.simulate import _lines


def summary(closed: float | None) -> dict[str, object]:
    return {
        "duration_s": 5.0,
        "tcp_error_mm": {"rms": 700.0, "max": 1800.0},
        "bounds_reached": {"brake_closed_s": closed},
    }


def test_a_closed_brake_is_said_before_the_errors() -> None:
    lines = _lines("pid", summary(0.094))
    assert lines[1] == "not followed to its end: the brake closes at 0.094 s and stays so"
    assert "the guard's torque_rate" in lines[-1]
    assert len(_lines("pid", summary(None))) == 2
