"""What of a diagnosed robot a controller is made for, and how windows of time are shown."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
from simulation.arms import START, STOP, arm, quintic_move

from irb2400_ctrl.effects import LIBRARY
from irb2400_ctrl.report.pages.diagnosis_page import parameter_rows
from irb2400_ctrl.simulation.close_the_loop import close_loop

SINCE = LIBRARY["gear_ripple"].of(4, amplitude_Nm=4.0, order=20.0, windows_s=((14.9, 1e9),))
EVENT = LIBRARY["process_force"].of(None, force_z_N=50.0, windows_s=((1.0, 2.0), (5.0, 6.0)))
ALWAYS = LIBRARY["payload"].of(None, mass_kg=4.0, com_m=(0.0, 0.0, 0.1))


def test_what_began_lasts_and_what_ended_is_over() -> None:
    now = arm().with_effects(SINCE, EVENT, ALWAYS).lasting()
    assert [(e.kind, e.windows_s) for e in now.effects] == [("gear_ripple", ()), ("payload", ())]
    assert now.effects[0].parameters()["amplitude_Nm"] == 4.0


def test_each_description_is_followed_and_the_effects_own_worth_stands_apart() -> None:
    loop = close_loop(arm(), arm().with_effects(SINCE, EVENT), quintic_move(START, STOP, 2.0))
    assert [len(run.robot.effects) for run in loop.runs.values()] == [0, 0, 1]
    assert [e.kind for e in loop.plant.effects] == ["gear_ripple"]
    # nothing was recalibrated here
    np.testing.assert_array_equal(loop.before.q, loop.recalibrated.q)
    error = [np.sqrt(np.mean((run.q - run.q_ref)[:, 3] ** 2)) for run in loop.runs.values()]
    assert error[2] < 0.5 * error[0]
    assert loop.summary().keys() == {"before", "recalibrated", "after"}


def test_windows_are_shown_as_times() -> None:
    rows: Any = [
        parameter_rows(SimpleNamespace(effect=e, standard_errors={})) for e in (SINCE, EVENT)
    ]  # type: ignore[arg-type]
    assert ["windows_s", "from 14.9 on", ""] in rows[0]
    assert ["windows_s", "1.00 to 2.00, 5.00 to 6.00", ""] in rows[1]
