"""That a robot is this very arm as it was goes from `diagnose` to where names are weighed, and
which way the last joint's axis lies to where loads are looked for."""

from __future__ import annotations

import importlib
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from identification.test_gains import ROBOT, log

from irb2400_ctrl.diagnosis.comparison import selection as selection_module
from irb2400_ctrl.diagnosis.comparison.log_columns import LogColumns
from irb2400_ctrl.diagnosis.comparison.selection import Selection

module = importlib.import_module("irb2400_ctrl.diagnosis.diagnose")


class _Asked(Exception):
    pass


@pytest.mark.parametrize("change", [True, False])
def test_a_reference_says_that_what_is_found_has_changed(
    monkeypatch: pytest.MonkeyPatch, change: bool
) -> None:
    def asked(*_: Any, change: bool) -> None:
        raise _Asked(change)

    monkeypatch.setattr(module, "Selection", asked)
    with pytest.raises(_Asked, match=str(change)):
        module.diagnose(ROBOT, log(1, 0.0), reference=ROBOT if change else None)


@pytest.mark.parametrize("change", [True, False])
def test_every_ground_of_a_search_knows_it(monkeypatch: pytest.MonkeyPatch, change: bool) -> None:
    monkeypatch.setattr(selection_module, "StepComparison", lambda *_: None)
    monkeypatch.setattr(selection_module, "Ground", lambda *_, change: change)
    search: Any = Selection.__new__(Selection)
    fit = SimpleNamespace(y=None, Z=None)
    search.__dict__ |= {
        "change": change,
        "scan": None,
        "fitter": SimpleNamespace(fit=lambda chosen: fit, noise=None),
        "threshold": None,
        "turns": None,
        "load_changes": None,
    }
    assert search._beside([]) is change


def test_the_last_joints_axis_is_that_in_the_flanges_frame() -> None:
    """The x of the flange lies along it in many a URDF."""
    X = np.eye(4)
    X[:3, :3] = [[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]
    robot = SimpleNamespace(flange=SimpleNamespace(matrix=lambda: X), links=())
    columns: Any = LogColumns.__new__(LogColumns)
    model = SimpleNamespace(flange_pose=lambda q: np.tile(np.eye(4), (len(q), 1, 1)))
    columns.bases = SimpleNamespace(robot=robot, model=model)
    columns.motion = SimpleNamespace(q=np.zeros((100, 6)))
    np.testing.assert_array_equal(columns._scales[2], [1.0, 0.0, 0.0])
