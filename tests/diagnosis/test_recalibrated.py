"""The numbers without further effects, held against those with them."""

from __future__ import annotations

from importlib import import_module
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from diagnosis.plain_motion import ROBOT
from independent_plant import Case

from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.diagnosis.comparison import selection
from irb2400_ctrl.diagnosis.estimation.fit import Fit
from irb2400_ctrl.measurement import Log


def test_where_no_effect_is_found_what_is_recalibrated_is_what_is_found(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Beside numbers that were let go further off, those without effects were told as a part of
    their way, and errors stood under "recalibrated" that no robot has."""
    wider = [3.0]

    def once(scan: Any, fitter: Any, *beside: Any) -> np.ndarray | None:
        return np.full(fitter.own, wider.pop()) if wider else None

    monkeypatch.setattr(selection, "rather_wider", once)
    seen = Case(5, duration=8.0, validation_duration=3.0).simulate()[0]
    found = diagnose(ROBOT, Log(seen.time, seen.q, seen.tau, q_ref=seen.q_ref))
    assert not wider
    assert not found.findings
    compared = found.identification
    np.testing.assert_allclose(compared.recalibrated, compared.after, atol=1e-9)
    assert not np.allclose(compared.before, compared.after, atol=1e-3)


@pytest.mark.parametrize(
    ("given", "moved", "steps", "kept"),
    [
        ([0.8, 1.0], [1.0, 0.9], [], True),
        ([0.8, 1.0], [0.7, 1.1], [], False),
        ([0.8, 1.0], [1.0, 0.9], [1], False),
        ([0.0, 1.0], [0.1, 1.1], [], True),
    ],
)
def test_numbers_that_leave_no_more_than_fitted_ones_stay(
    monkeypatch: pytest.MonkeyPatch,
    given: list[float],
    moved: list[float],
    steps: list[Any],
    kept: bool,
) -> None:
    """Of an unchanged arm the error of joint 1 went from 0.829 to 0.962 Nm, and robot.toml got the
    numbers that did it."""
    module = import_module("irb2400_ctrl.diagnosis.diagnose")
    monkeypatch.setattr(module, "_possible", lambda prior, fit: fit)
    monkeypatch.setattr(module, "_bases", lambda robot: None)
    monkeypatch.setattr(module, "predicted_torque", lambda robot, motion, bases: robot.tau)

    def robot(left: list[float]) -> Any:
        one = SimpleNamespace(tau=np.tile(left, (4, 1)))
        one.bare = lambda: one
        return one

    prior = SimpleNamespace(deviations=lambda z: z, updated=lambda deviations: robot(moved))
    motion = SimpleNamespace(tau=np.zeros((4, 2)), known=np.ones((4, 2), dtype=bool))
    fit = plain_fit(np.array([1.0, -2.0]))
    found = module._settled(prior, steps, fit, motion, robot(given))
    np.testing.assert_array_equal(found.z, [0.0, 0.0] if kept else [1.0, -2.0])


def plain_fit(z: np.ndarray) -> Fit:
    """Of numbers alone."""
    nothing = np.zeros(0)
    rows = np.zeros((4, 2))
    return Fit((), (), nothing, nothing, z, np.eye(2), rows, np.zeros((4, 2, 2)), rows, ())
