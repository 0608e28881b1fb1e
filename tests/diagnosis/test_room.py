"""A log whose search does not fit into the memory is refused before it pushes others out."""

from __future__ import annotations

import importlib

import pytest
from independent_plant import Case

from irb2400_ctrl.diagnosis import diagnose
from irb2400_ctrl.errors import InputError
from irb2400_ctrl.measurement import Log
from irb2400_ctrl.measurement.joined_log import prepare_together
from irb2400_ctrl.robot import load_robot
from irb2400_ctrl.system import free_memory

module = importlib.import_module("irb2400_ctrl.diagnosis.preparation.room")


def test_what_is_free_is_known_or_nothing_is_said() -> None:
    free = free_memory()
    assert free is None or 1e7 < free < 1e14


def test_a_search_without_room_is_refused_with_the_stretch_that_fits(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    run = Case(5, (), duration=20.0, validation_duration=12.0).simulate()[0]
    log = Log(run.time, run.q, run.tau, q_ref=run.q_ref, name="shift.csv")
    monkeypatch.setattr(module, "free_memory", lambda: 1e8)
    with pytest.raises(InputError, match=r"shift.csv: found 20 s.* 0\.2 GB.*at most \d+ s") as told:
        diagnose(load_robot("irb2400"), log)
    assert "--between" in str(told.value)
    most = float(str(told.value).split("at most ")[1].split(" s")[0])
    assert 5.0 < most < 12.0
    for enough in (None, 2.5e8):
        monkeypatch.setattr(module, "free_memory", lambda enough=enough: enough)
        module.check_room(prepare_together([log]))
