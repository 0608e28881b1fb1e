"""The numbers without further effects, held against those with them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from diagnosis.plain_motion import ROBOT
from independent_plant import Case

from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.diagnosis.comparison import selection
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
